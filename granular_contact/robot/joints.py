"""`<joint>` -> a joint."""

from __future__ import annotations

from typing import Any

import numpy as np

from granular_contact.robot.elements import Reader
from granular_contact.robot.source import Element
from granular_contact.robot.types import Joint, Vector

KINDS = ("revolute", "continuous", "prismatic", "fixed", "floating", "planar")
_LIMITED = ("revolute", "prismatic")


def read_joint(reader: Reader, element: Element, name: str) -> Joint | None:
    """A joint of this name; None, with faults, if it can't be placed in the tree."""
    key = f"joint.{name}"
    kind = reader.text(element, "type", key)
    if kind and kind not in KINDS:
        reader.fault(element, f"{key}.type", f"got {kind[:40]!r}; allowed are {', '.join(KINDS)}")
    ends = {end: _end(reader, element, end, key) for end in ("parent", "child")}
    lines = {child.tag: child.sourceline for child in reversed(element) if isinstance(child.tag, str)}
    found = Joint(
        name, element.sourceline, kind, ends["parent"], ends["child"],
        reader.pose(element, key), _axis(reader, element, kind, key),
        lines=lines,
        mimic=_mimic(reader, element, key),
        **_numbers(reader, element, kind, key),
    )  # fmt: skip
    return found if kind in KINDS and found.parent and found.child else None


def _end(reader: Reader, joint: Element, end: str, key: str) -> str:
    held = reader.only(joint, end, key)
    if held is None:
        reader.fault(joint, f"{key}.{end}", f'is missing; allowed is <{end} link="..."/>')
        return ""
    return reader.text(held, "link", f"{key}.{end}")


def _axis(reader: Reader, joint: Element, kind: str, key: str) -> Vector:
    """Unit vector (3,); along x, as URDF has it, unless it is given."""
    element = reader.only(joint, "axis", key)
    found = None if element is None else reader.three(element, "xyz", f"{key}.axis")
    if found is None:
        return np.array([1.0, 0.0, 0.0])
    length = float(np.linalg.norm(found))
    if length == 0.0:
        if kind not in ("fixed", "floating"):
            reader.fault(element, f"{key}.axis.xyz", "got 0 0 0; allowed is a direction")
        return np.array([1.0, 0.0, 0.0])
    return found / length


def _mimic(reader: Reader, joint: Element, key: str) -> str | None:
    element = reader.only(joint, "mimic", key)
    return None if element is None else reader.text(element, "joint", f"{key}.mimic")


def _numbers(reader: Reader, joint: Element, kind: str, key: str) -> dict[str, Any]:
    limit, dynamics = (reader.only(joint, tag, key) for tag in ("limit", "dynamics"))
    found: dict[str, Any] = {}
    if limit is not None:
        found |= {name: reader.number(limit, name, f"{key}.limit") for name in ("lower", "upper")}
        found["effort"] = reader.number(limit, "effort", f"{key}.limit", 0.0)
        if kind in _LIMITED:
            _check_range(reader, limit, found, f"{key}.limit")
            found |= {name: found[name] or 0.0 for name in ("lower", "upper")}
    elif kind in _LIMITED:
        words = 'is missing; allowed is <limit lower="..." upper="..." effort="..." velocity="..."/>'
        reader.fault(joint, f"{key}.limit", f"{words}, or the type continuous" if kind == "revolute" else words)
        found |= {"lower": 0.0, "upper": 0.0}  # where stops are given beside the file
    if dynamics is not None:
        found |= {name: reader.number(dynamics, name, f"{key}.dynamics", 0.0) for name in ("damping", "friction")}
    return found


def _check_range(reader: Reader, limit: Element, found: dict[str, Any], key: str) -> None:
    """URDF takes 0 for an end that is left out."""
    for name in ("lower", "upper"):
        if found[name] is None and limit.get(name) is None:
            found[name] = 0.0
    if None not in (found["lower"], found["upper"]) and found["lower"] >= found["upper"]:
        words = f"got {found['lower']:g}; allowed is below upper, {found['upper']:g}"
        if limit.get("lower") is None and limit.get("upper") is None:
            words = "is missing, and so is upper, so that by URDF both are 0 and nothing moves; allowed are both"
        reader.fault(limit, f"{key}.lower", f"{words}, or a joint of the type fixed or continuous")
