"""`<link>` -> a link with its mass and its shapes for the medium and for pictures; `<joint>` -> a joint."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from granular_contact.robot.elements import Incomplete, Reader
from granular_contact.robot.inertia import impossible, raised, turned
from granular_contact.robot.source import Element
from granular_contact.robot.types import Geometry, Inertial, Joint, Link, Shape, Vector

MOMENTS = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
# Attributes of the primitives. capsule is no part of the standard; several simulators read it.
_PRIMITIVES = {"cylinder": ("radius", "length"), "capsule": ("radius", "length"), "sphere": ("radius",)}
KINDS = ("box", *_PRIMITIVES, "mesh")


def read_link(reader: Reader, element: Element, name: str) -> Link:
    """A link of this name; what is faulty in it is left out."""
    shapes = {which: tuple(_shapes(reader, element, which, name)) for which in reader.of_shapes}
    return Link(name, element.sourceline, _inertial(reader, element, name), shapes["visual"], shapes["collision"])


def _shapes(reader: Reader, link: Element, which: str, name: str) -> Iterator[Shape]:
    """Shapes of a kind; their faults are kept apart, as only one kind is used."""
    found = link.findall(which)
    for index, one in enumerate(found):
        apart, number = Reader(reader.file), f".{index}" * (len(found) > 1)
        shape = _shape(apart, one, f"link.{name}.{which}{number}", name)
        reader.of_shapes[which] += [(name, fault) for fault in apart.faults]
        if shape is not None and not apart.faults:
            yield shape


def _inertial(reader: Reader, link: Element, name: str) -> Inertial | None:
    """Mass properties in the frame of the link; None of one without mass, or with faults."""
    key = f"link.{name}"
    element = reader.only(link, "inertial", key)
    if element is None:
        return None
    key += ".inertial"
    before = len(reader.faults)
    pose = reader.pose(element, key)
    mass = _mass(reader, element, f"{key}.mass")
    tensor = tensor_of(reader, element, key, mass)
    # A mass in a point may be part of a body.
    if mass != 0.0 and tensor is not None and tensor.any():
        if (why := impossible(tensor)) is not None:
            reader.fault(element.find("inertia"), f"{key}.inertia", why)
            tensor = None
        else:
            tensor = raised(tensor)
    own = None if tensor is None else turned(tensor, pose.rotation)
    if len(reader.faults) > before:
        reader.incomplete[name] = Incomplete(mass, pose.xyz, own, element.sourceline)
    if mass is None or own is None or mass == 0.0:
        return None
    return Inertial(mass, pose.xyz, own, element.sourceline)


def _mass(reader: Reader, inertial: Element, key: str) -> float | None:
    held = reader.only(inertial, "mass", key.removesuffix(".mass"))
    if held is None:
        reader.fault(inertial, key, 'is missing; allowed is <mass value="..."/> (kg)')
        return None
    return reader.needed(held, "value", key, 0.0)


def tensor_of(reader: Reader, element: Element, key: str, mass: float | None) -> np.ndarray | None:
    """Tensor (3, 3) of an `<inertial>` in its own frame; None, with faults, if it has none."""
    held = reader.only(element, "inertia", key)
    if held is None:
        if mass != 0.0:
            reader.fault(element, f"{key}.inertia", f"is missing; allowed is <inertia {' '.join(MOMENTS)}/> (kg m^2)")
        return None
    diagonal = [reader.needed(held, name, f"{key}.inertia") for name in MOMENTS[:3]]
    beside = [reader.number(held, name, f"{key}.inertia") for name in MOMENTS[3:]]
    if None in diagonal or any(v is None and held.get(n) is not None for v, n in zip(beside, MOMENTS[3:], strict=True)):
        return None
    xy, xz, yz = (value or 0.0 for value in beside)
    xx, yy, zz = diagonal
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]], float)


def _shape(reader: Reader, element: Element, key: str, link: str) -> Shape | None:
    held = reader.only(element, "geometry", key)
    if held is None:
        reader.fault(element, f"{key}.geometry", f"is missing; allowed are {', '.join(KINDS)}")
        return None
    found = [child for child in held if isinstance(child.tag, str)]
    if len(found) != 1 or found[0].tag not in KINDS:
        got = " and ".join(f"<{child.tag}>" for child in found) or "nothing"
        reader.fault(held, f"{key}.geometry", f"got {got}; allowed is one of {', '.join(KINDS)}")
        return None
    geometry = _geometry(reader, found[0], f"{key}.geometry.{found[0].tag}")
    pose = reader.pose(element, key)
    return None if geometry is None else Shape(geometry, pose, found[0].sourceline, key, link)


def _geometry(reader: Reader, element: Element, key: str) -> Geometry | None:
    if element.tag == "mesh":
        return read_mesh(reader, element, key)
    if element.tag == "box":
        size = reader.three(element, "size", key)
        if element.get("size") is None:
            reader.fault(element, f"{key}.size", "is missing; allowed are three numbers above 0 (m)")
        if size is None:
            return None
        if not (size > 0.0).all():
            reader.fault(element, f"{key}.size", f"got {element.get('size')!r}; allowed are three numbers above 0 (m)")
            return None
        return Geometry("box", tuple(size.tolist()))
    found = reader.positive(element, _PRIMITIVES[element.tag], key)
    return None if found is None else Geometry(element.tag, (2.0 * found[0], *found[1:]))


def read_mesh(reader: Reader, element: Element, key: str) -> Geometry | None:
    """The file of a `<mesh>` and its scale; None, with faults, where they can't be told."""
    file = reader.text(element, "filename", key)
    scale = reader.three(element, "scale", key)
    if scale is not None and (scale == 0.0).any():
        reader.fault(element, f"{key}.scale", f"got {element.get('scale')!r}; allowed are three numbers that are not 0")
        return None
    if not file or (scale is None and element.get("scale") is not None):
        return None
    x, y, z = (1.0, 1.0, 1.0) if scale is None else scale.tolist()
    return Geometry("mesh", file=file, scale=(x, y, z))


JOINT_KINDS = ("revolute", "continuous", "prismatic", "fixed", "floating", "planar")
_LIMITED = ("revolute", "prismatic")


def read_joint(reader: Reader, element: Element, name: str) -> Joint | None:
    """A joint of this name; None, with faults, if it can't be placed in the tree."""
    key = f"joint.{name}"
    kind = reader.text(element, "type", key)
    if kind and kind not in JOINT_KINDS:
        reader.fault(element, f"{key}.type", f"got {kind[:40]!r}; allowed are {', '.join(JOINT_KINDS)}")
    ends = {end: _end(reader, element, end, key) for end in ("parent", "child")}
    lines = {child.tag: child.sourceline for child in reversed(element) if isinstance(child.tag, str)}
    found = Joint(
        name, element.sourceline, kind, ends["parent"], ends["child"],
        reader.pose(element, key), _axis(reader, element, kind, key),
        lines=lines,
        mimic=_mimic(reader, element, key),
        **_numbers(reader, element, kind, key),
    )  # fmt: skip
    return found if kind in JOINT_KINDS and found.parent and found.child else None


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
