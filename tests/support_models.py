"""Models that several tests share: texts of planar models, and mappings of models of one body.

lines: medium, start, solver and method, which a test adds to the text of a model.
"""

from __future__ import annotations

from typing import Any

BALL = """
model:
  name: ball
  bodies:
    ball: {type: rigid, density_kg_m3: 7700, shapes: [{type: sphere, diameter_m: 0.0254}]}
  joints:
    flight: {type: free, parent: ground, child: ball}
"""


def ball(*lines: str) -> str:
    """A steel ball of an inch that flies freely."""
    return BALL + "\n".join(lines)


def bent_arm(arm: float, finger: float, *lines: str) -> str:
    """An arm of 0.2 m on a pivot with a finger of 0.1 m welded to its end at 60 degrees; arm, finger: diameters (m)."""
    model = f"""
model:
  name: bent
  bodies:
    arm: {{type: link, length_m: 0.2, diameter_m: {arm}, density_kg_m3: 7700}}
    finger: {{type: link, length_m: 0.1, diameter_m: {finger}, density_kg_m3: 7700}}
  joints:
    pivot: {{type: hinge, parent: ground, child: arm}}
    knuckle: {{type: weld, parent: arm, child: finger, parent_point_m: [0.2, 0], home_deg: 60}}
"""
    return model + "\n".join(lines)


def chain(count: int, length: float, *lines: str, flexible: str = "null", diameter: float = 0.006) -> str:
    """A chain of steel links (m) on hinges."""
    link = f"length_m: {length}, diameter_m: {diameter}, density_kg_m3: 7700, flexible: {flexible}"
    return "\n".join(("model:", "  name: chain", f"  chain: {{count: {count}, link: {{{link}}}}}", *lines))


def one_body(name: str, body: dict[str, Any], joint: str = "flight", kind: str = "free", **keys: Any) -> dict[str, Any]:
    """A model in space of one body on a joint to the ground; keys: of the joint."""
    joints = {joint: {"type": kind, "parent": "ground", "child": name, **keys}}
    return {"in_space": True, "name": name, "bodies": {name: body}, "joints": joints}
