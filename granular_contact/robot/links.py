"""`<link>` -> a link with its mass properties and its collision and visual shapes; `<joint>` -> a joint."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from granular_contact.robot.elements import PartialInertial, Reader
from granular_contact.robot.inertia import impossibility, rotated, with_raised_moments
from granular_contact.robot.source import Element
from granular_contact.robot.types import Geometry, Inertial, Joint, Link, Shape, Vector

MOMENTS = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
# Attributes of the primitives. The capsule is not in the standard, but several simulators read it.
_PRIMITIVES = {"cylinder": ("radius", "length"), "capsule": ("radius", "length"), "sphere": ("radius",)}
KINDS = ("box", *_PRIMITIVES, "mesh")


def read_link(reader: Reader, element: Element, name: str) -> Link:
    """Read a link with this name, without its faulty parts."""
    shapes = {kind: tuple(_shapes(reader, element, kind, name)) for kind in reader.shape_faults}
    return Link(name, element.sourceline, _inertial(reader, element, name), shapes["visual"], shapes["collision"])


def _shapes(reader: Reader, link: Element, kind: str, name: str) -> Iterator[Shape]:
    """Shapes of a kind, "visual" or "collision"; their faults go to `shape_faults`, as only one kind is used."""
    elements = link.findall(kind)
    for index, element in enumerate(elements):
        shape_reader, number = Reader(reader.file), f".{index}" * (len(elements) > 1)
        shape = _shape(shape_reader, element, f"link.{name}.{kind}{number}", name)
        reader.shape_faults[kind] += [(name, fault) for fault in shape_reader.faults]
        if shape is not None and not shape_reader.faults:
            yield shape


def _inertial(reader: Reader, link: Element, name: str) -> Inertial | None:
    """Mass properties in the frame of the link; None without a mass, or with faults."""
    key = f"link.{name}"
    element = reader.single(link, "inertial", key)
    if element is None:
        return None
    key += ".inertial"
    before = len(reader.faults)
    pose = reader.pose(element, key)
    mass = _mass(reader, element, f"{key}.mass")
    tensor = tensor_of(reader, element, key, mass)
    # A tensor of zeros is allowed: a point mass may be part of a body.
    if mass != 0.0 and tensor is not None and tensor.any():
        if (why := impossibility(tensor)) is not None:
            reader.fault(element.find("inertia"), f"{key}.inertia", why)
            tensor = None
        else:
            tensor = with_raised_moments(tensor)
    in_link = None if tensor is None else rotated(tensor, pose.rotation)
    if len(reader.faults) > before:
        reader.partial_inertials[name] = PartialInertial(mass, pose.xyz, in_link, element.sourceline)
    if mass is None or in_link is None or mass == 0.0:
        return None
    return Inertial(mass, pose.xyz, in_link, element.sourceline)


def _mass(reader: Reader, inertial: Element, key: str) -> float | None:
    element = reader.single(inertial, "mass", key.removesuffix(".mass"))
    if element is None:
        reader.fault(inertial, key, 'is missing; allowed is <mass value="..."/> (kg)')
        return None
    return reader.required(element, "value", key, 0.0)


def tensor_of(reader: Reader, inertial: Element, key: str, mass: float | None) -> np.ndarray | None:
    """Tensor (3, 3) of an `<inertial>` in its own frame; None if it is missing or faulty.

    A missing tensor is a fault unless the mass is 0.
    """
    element = reader.single(inertial, "inertia", key)
    if element is None:
        if mass != 0.0:
            reader.fault(inertial, f"{key}.inertia", f"is missing; allowed is <inertia {' '.join(MOMENTS)}/> (kg m^2)")
        return None
    diagonal = [reader.required(element, name, f"{key}.inertia") for name in MOMENTS[:3]]
    products = {name: reader.number(element, name, f"{key}.inertia") for name in MOMENTS[3:]}
    if None in diagonal or any(value is None and element.get(name) is not None for name, value in products.items()):
        return None
    xy, xz, yz = (value or 0.0 for value in products.values())
    xx, yy, zz = diagonal
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]], float)


def _shape(reader: Reader, element: Element, key: str, link: str) -> Shape | None:
    parent = reader.single(element, "geometry", key)
    if parent is None:
        reader.fault(element, f"{key}.geometry", f"is missing; allowed are {', '.join(KINDS)}")
        return None
    children = [child for child in parent if isinstance(child.tag, str)]
    if len(children) != 1 or children[0].tag not in KINDS:
        got = " and ".join(f"<{child.tag}>" for child in children) or "nothing"
        reader.fault(parent, f"{key}.geometry", f"got {got}; allowed is one of {', '.join(KINDS)}")
        return None
    geometry = _geometry(reader, children[0], f"{key}.geometry.{children[0].tag}")
    pose = reader.pose(element, key)
    return None if geometry is None else Shape(geometry, pose, children[0].sourceline, key, link)


def _geometry(reader: Reader, element: Element, key: str) -> Geometry | None:
    if element.tag == "mesh":
        return read_mesh(reader, element, key)
    if element.tag == "box":
        size = reader.vector(element, "size", key)
        if element.get("size") is None:
            reader.fault(element, f"{key}.size", "is missing; allowed are three numbers above 0 (m)")
        if size is None:
            return None
        if not (size > 0.0).all():
            reader.fault(element, f"{key}.size", f"got {element.get('size')!r}; allowed are three numbers above 0 (m)")
            return None
        return Geometry("box", tuple(size.tolist()))
    sizes = reader.positive(element, _PRIMITIVES[element.tag], key)
    return None if sizes is None else Geometry(element.tag, (2.0 * sizes[0], *sizes[1:]))


def read_mesh(reader: Reader, element: Element, key: str) -> Geometry | None:
    """Read the file name and the scale of a `<mesh>`; None, with faults, if they are missing or faulty."""
    file = reader.text(element, "filename", key)
    scale = reader.vector(element, "scale", key)
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
    """Read a joint with this name; None, with faults, if its type, parent or child is missing or faulty."""
    key = f"joint.{name}"
    kind = reader.text(element, "type", key)
    if kind and kind not in JOINT_KINDS:
        reader.fault(element, f"{key}.type", f"got {kind[:40]!r}; allowed are {', '.join(JOINT_KINDS)}")
    ends = {end: _end(reader, element, end, key) for end in ("parent", "child")}
    lines = {child.tag: child.sourceline for child in reversed(element) if isinstance(child.tag, str)}
    joint = Joint(
        name, element.sourceline, kind, ends["parent"], ends["child"],
        reader.pose(element, key), _axis(reader, element, kind, key),
        lines=lines,
        mimic=_mimic(reader, element, key),
        **_numbers(reader, element, kind, key),
    )  # fmt: skip
    return joint if kind in JOINT_KINDS and joint.parent and joint.child else None


def _end(reader: Reader, joint: Element, end: str, key: str) -> str:
    """Name of the link at an end of a joint, "parent" or "child"; empty, with a fault, if it is missing."""
    element = reader.single(joint, end, key)
    if element is None:
        reader.fault(joint, f"{key}.{end}", f'is missing; allowed is <{end} link="..."/>')
        return ""
    return reader.text(element, "link", f"{key}.{end}")


def _axis(reader: Reader, joint: Element, kind: str, key: str) -> Vector:
    """Unit vector (3,) along the axis of a joint; along x without one, as in URDF."""
    element = reader.single(joint, "axis", key)
    axis = None if element is None else reader.vector(element, "xyz", f"{key}.axis")
    if axis is None:
        return np.array([1.0, 0.0, 0.0])
    length = float(np.linalg.norm(axis))
    if length == 0.0:
        if kind not in ("fixed", "floating"):
            reader.fault(element, f"{key}.axis.xyz", "got 0 0 0; allowed is a direction")
        return np.array([1.0, 0.0, 0.0])
    return axis / length


def _mimic(reader: Reader, joint: Element, key: str) -> str | None:
    """Name of the joint that a joint follows; None without `<mimic>`."""
    element = reader.single(joint, "mimic", key)
    return None if element is None else reader.text(element, "joint", f"{key}.mimic")


def _numbers(reader: Reader, joint: Element, kind: str, key: str) -> dict[str, Any]:
    """Fields of a `Joint` from its `<limit>` and `<dynamics>`."""
    limit, dynamics = (reader.single(joint, tag, key) for tag in ("limit", "dynamics"))
    numbers: dict[str, Any] = {}
    if limit is not None:
        numbers |= {name: reader.number(limit, name, f"{key}.limit") for name in ("lower", "upper")}
        numbers |= {name: reader.number(limit, name, f"{key}.limit", 0.0) for name in ("effort", "velocity")}
        if kind in _LIMITED:
            _check_range(reader, limit, numbers, f"{key}.limit")
            numbers |= {name: numbers[name] or 0.0 for name in ("lower", "upper")}
    elif kind in _LIMITED:
        words = 'is missing; allowed is <limit lower="..." upper="..." effort="..." velocity="..."/>'
        reader.fault(joint, f"{key}.limit", f"{words}, or the type continuous" if kind == "revolute" else words)
        numbers |= {"lower": 0.0, "upper": 0.0}  # used if the config gives stops, so that the fault does not count
    if dynamics is not None:
        numbers |= {name: reader.number(dynamics, name, f"{key}.dynamics", 0.0) for name in ("damping", "friction")}
    return numbers


def _check_range(reader: Reader, limit: Element, numbers: dict[str, Any], key: str) -> None:
    """Check that `lower` is below `upper`; an end that is missing becomes 0, as in URDF."""
    for name in ("lower", "upper"):
        if numbers[name] is None and limit.get(name) is None:
            numbers[name] = 0.0
    if None not in (numbers["lower"], numbers["upper"]) and numbers["lower"] >= numbers["upper"]:
        words = f"got {numbers['lower']:g}; allowed is below upper, {numbers['upper']:g}"
        if limit.get("lower") is None and limit.get("upper") is None:
            words = "is missing, and so is upper, so that by URDF both are 0 and nothing moves; allowed are both"
        reader.fault(limit, f"{key}.lower", f"{words}, or a joint of the type fixed or continuous")
