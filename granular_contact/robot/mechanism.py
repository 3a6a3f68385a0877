"""A robot -> what a config says of a mechanism in space, each part with the line of the robot file that says it."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from granular_contact.errors import Fault
from granular_contact.robot.elements import Reader, without_shape
from granular_contact.robot.files import find
from granular_contact.robot.massless import has_world, mimicking, unsupported
from granular_contact.robot.types import Geometry, Inertial, Joint, Link, Robot, Shape, Vector

GROUND = "ground"
_NAME = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_-]*")
_TAKEN = {"bodies": ("ground", "tip_body"), "joints": ("mean",)}  # names that a mechanism has for itself
_ENDLESS = 1e3  # rad or m: limits as far as this are none
_ARM = 0.1  # m, at which a stop holds the weight of the robot, where the file gives no effort
_DEGREE, _MILLIMETRE = np.pi / 180.0, 1e-3
_WEIGHT = 9.81  # N per kg: of the stiffness of stops alone


@dataclass(frozen=True)
class Said:
    """A value of a config and the line of the robot file that says it; below it values or more of these."""

    value: Any
    line: int


@dataclass(frozen=True)
class Wishes:
    """What the robot file leaves open.

    which: "collision" or "visual"; sand: links on whose shapes the medium acts, by their names in the file, None: on
    all; facet_size (m); base_fixed: whether the root is held; mimic_free: whether joints that follow others move by
    themselves; stiffness of stops (N m/rad, N/m), None: see `_stops`; dissipation (s/rad, s/m).
    """

    which: str = "collision"
    sand: frozenset[str] | None = None
    facet_size: float | None = None
    base_fixed: bool = False
    mimic_free: bool = False
    stiffness: tuple[float | None, float | None] = (None, None)
    dissipation: tuple[float, float] = (0.0, 0.0)
    packages: Mapping[str, Path] = field(default_factory=dict)


def mechanism_of(robot: Robot, reader: Reader, wishes: Wishes) -> Said:
    """Model of a robot without massless links; what it can't be is noted as faults of the reader."""
    refused = [*unsupported(robot), *(() if wishes.mimic_free else mimicking(robot))]
    for joint, key, words in refused:
        reader.fault(joint.lines.get(key, joint.line), f"joint.{joint.name}.{key}", words)
    bodies = _names("bodies", robot.links, reader)
    joints = _names("joints", robot.joints, reader)
    grounded = has_world(robot) or (wishes.base_fixed and robot.links[robot.root].inertial is None)
    if grounded:
        bodies[robot.root] = GROUND
    made = {joints[name]: _joint(joint, robot, bodies, wishes) for name, joint in robot.joints.items()}
    if not grounded:
        root = bodies[robot.root]
        name = root if root not in made else f"{root}_base"  # another joint may have that of the link
        made = {name: _base(robot, bodies, wishes), **made}
    links = [link for name, link in robot.links.items() if bodies[name] != GROUND]
    return Said(
        {
            "in_space": True,
            "name": robot.name if re.search("[A-Za-z]", robot.name) else f"robot {robot.name}",
            "bodies": {bodies[link.name]: _body(link, reader, wishes) for link in links if link.inertial is not None},
            "joints": made,
        },
        1,
    )


def _names(kind: str, given: Iterable[str], reader: Reader) -> dict[str, str]:
    """Names in a mechanism by those in the file: with _ in place of what no name there may hold."""
    found: dict[str, str] = {}
    for name in given:
        plain = plain_name(kind, name)
        if plain in found.values():
            reader.fault(None, f"{kind}.{name}", f"is written as {plain} here, as another is; give it another name")
        found[name] = plain
    return found


def plain_name(kind: str, name: str) -> str:
    """Name of a link or joint among the "bodies" or "joints" of a mechanism, which the ground has not either."""
    plain = re.sub(r"[^A-Za-z0-9_-]", "_", name)
    plain = plain if _NAME.fullmatch(plain) else f"_{plain}"
    return f"{plain}_" if plain in _TAKEN[kind] else plain


def _base(robot: Robot, bodies: Mapping[str, str], wishes: Wishes) -> Said:
    kind = "weld" if wishes.base_fixed else "free"
    root = robot.links[robot.root]
    return Said({"type": kind, "parent": GROUND, "child": bodies[root.name]}, root.line)


def _body(link: Link, reader: Reader, wishes: Wishes) -> Said:
    shapes = [_shape(shape, reader, wishes) for shape in link.shapes(wishes.which)]
    return Said({"type": "rigid", **_mass(link.inertial), "shapes": [s for s in shapes if s is not None]}, link.line)


def _mass(inertial: Inertial | None) -> dict[str, Said]:
    if inertial is None:
        return {}
    entries = {f"{a}{b}": float(inertial.tensor["xyz".index(a), "xyz".index(b)]) for a, b in
               ("xx", "yy", "zz", "xy", "xz", "yz")}  # fmt: skip
    found = {"mass_kg": inertial.mass, "center_of_mass_m": _three(inertial.center), "inertia_kg_m2": entries}
    return {key: Said(value, inertial.line) for key, value in found.items()}


def _shape(shape: Shape, reader: Reader, wishes: Wishes) -> Said | None:
    made, in_sand = _form(shape, reader, wishes.packages), wishes.sand is None or shape.link in wishes.sand
    if isinstance(made, Fault):
        (reader.faults if in_sand else reader.notices).append(made if in_sand else without_shape(made))
        return None
    made |= {"center_m": _three(shape.pose.xyz), "rpy_deg": _degrees(shape.pose.rpy)}
    if not in_sand:
        made["in_sand"] = False
        if made["type"] == "mesh":
            made["thin"] = True  # what is drawn alone need not be closed
    elif wishes.facet_size is not None:
        made["facet_size_m"] = wishes.facet_size
    return Said(made, shape.line)


def _form(shape: Shape, reader: Reader, packages: Mapping[str, Path]) -> dict[str, Any] | Fault:
    geometry = shape.geometry
    if geometry.kind == "mesh":
        path = find(geometry.file, Path(reader.file), packages)
        if isinstance(path, str):
            return Fault(reader.file, shape.line, f"{shape.key}.geometry.mesh.filename", path)
        return {"type": "mesh", "file": str(path.resolve()), **_scale(geometry)}
    if geometry.kind == "box":
        return {"type": "box", "size_m": list(geometry.size)}
    if geometry.kind == "sphere":
        return {"type": "sphere", "diameter_m": geometry.size[0]}
    return {"type": geometry.kind, "diameter_m": geometry.size[0], "length_m": geometry.size[1]}


def _scale(geometry: Geometry) -> dict[str, Any]:
    """Of a file in metres none, so that one that is too large for metres is reported."""
    x, y, z = geometry.scale
    return {} if (x, y, z) == (1.0, 1.0, 1.0) else {"scale": x if x == y == z and x > 0.0 else [x, y, z]}


def _joint(joint: Joint, robot: Robot, bodies: Mapping[str, str], wishes: Wishes) -> Said:
    made: dict[str, Any] = {
        "type": {"fixed": "weld", "prismatic": "slider", "floating": "free"}.get(joint.kind, "hinge"),
        "parent": Said(bodies[joint.parent], joint.lines["parent"]),
        "child": Said(bodies[joint.child], joint.lines["child"]),
    }
    at = joint.lines.get("origin", joint.line)
    made |= {"parent_point_m": Said(_three(joint.origin.xyz), at), "rpy_deg": Said(_degrees(joint.origin.rpy), at)}
    if made["type"] in ("hinge", "slider"):
        made["axis"] = Said(_three(joint.axis), joint.lines.get("axis", joint.line))
        made |= _resistance(joint, made["type"] == "hinge")
        if joint.kind != "continuous" and (stops := _stops(joint, robot, wishes)) is not None:
            made["stops"] = Said(stops, joint.lines.get("limit", joint.line))
    return Said(made, joint.line)


def _resistance(joint: Joint, rotary: bool) -> dict[str, Said]:
    """Damping and dry friction, where the file has any."""
    line, found = joint.lines.get("dynamics", joint.line), dict[str, Said]()
    if joint.damping:
        found["damping_Nm_s_per_rad" if rotary else "damping_N_s_per_m"] = Said(joint.damping, line)
    if joint.friction:
        found["friction"] = Said({"torque_Nm" if rotary else "force_N": joint.friction}, line)
    return found


def _stops(joint: Joint, robot: Robot, wishes: Wishes) -> dict[str, float] | None:
    """Springs at the limits, which reach the effort limit at one degree or mm; None where the joint has no limits.

    Where the file gives no effort they hold the weight of the robot there, in a hinge at an arm of 0.1 m [ours].
    """
    if joint.lower is None or joint.upper is None or max(-joint.lower, joint.upper) > _ENDLESS:
        return None
    weight = _WEIGHT * sum(link.inertial.mass for link in robot.links.values() if link.inertial is not None)
    slider = joint.kind == "prismatic"
    asked, dissipation = wishes.stiffness[slider], wishes.dissipation[slider]
    holds, travel = (weight, _MILLIMETRE) if slider else (weight * _ARM, _DEGREE)
    stiffness = asked if asked is not None else (joint.effort or holds) / travel
    if slider:
        found = {"lower_m": joint.lower, "upper_m": joint.upper, "stiffness_N_per_m": stiffness}
        return found | ({"dissipation_s_per_m": dissipation} if dissipation else {})
    ends = {"lower_deg": float(np.degrees(joint.lower)), "upper_deg": float(np.degrees(joint.upper))}
    found = {**ends, "stiffness_Nm_per_rad": stiffness}
    return found | ({"dissipation_s_per_rad": dissipation} if dissipation else {})


def _three(vector: Vector) -> list[float]:
    return [float(x) + 0.0 for x in vector]


def _degrees(rpy: Vector) -> list[float]:
    return _three(np.degrees(rpy))
