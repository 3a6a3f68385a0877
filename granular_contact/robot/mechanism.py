"""Robot -> config of a mechanism in space, as plain data in which values know their line of the robot file."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from granular_contact.errors import Fault
from granular_contact.robot.elements import Reader, not_drawn
from granular_contact.robot.files import find
from granular_contact.robot.massless import has_world, mimicking, unsupported
from granular_contact.robot.types import Geometry, Inertial, Joint, Link, Robot, Shape, Vector

GROUND = "ground"
_NAME = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_-]*")
_RESERVED = {"bodies": ("ground", "tip_body"), "joints": ("mean",)}  # names that bodies and joints may not have
_ENDLESS = 1e3  # rad or m: a joint with limits beyond this has no stops
_ARM = 0.1  # m: arm at which a stop of a hinge holds the weight of the robot, if the file gives no effort
_DEGREE, _MILLIMETRE = np.pi / 180.0, 1e-3
_WEIGHT = 9.81  # N per kg, for the stiffness of stops alone


@dataclass(frozen=True)
class AtLine:
    """Value of a config with its line of the robot file; a dict or list may hold plain values or more of these."""

    value: Any
    line: int


@dataclass(frozen=True)
class MechanismOptions:
    """Options of the mechanism that its robot file does not contain.

    which: kind of the shapes, "collision" or "visual". sand: links on whose shapes the medium acts, by their names in
    the file, None: all links. facet_size: m. base_fixed: whether the root is held. mimic_free: whether joints that
    follow others are independent joints. stiffness: of stops of hinges (N m/rad) and sliders (N/m), None: see `_stops`.
    dissipation: of these stops (s/rad, s/m). packages: folders of packages by name.
    """

    which: str = "collision"
    sand: frozenset[str] | None = None
    facet_size: float | None = None
    base_fixed: bool = False
    mimic_free: bool = False
    stiffness: tuple[float | None, float | None] = (None, None)
    dissipation: tuple[float, float] = (0.0, 0.0)
    packages: Mapping[str, Path] = field(default_factory=dict)


def mechanism_of(robot: Robot, reader: Reader, options: MechanismOptions) -> AtLine:
    """Model of a config for a robot without massless links; what it does not support becomes faults of the reader."""
    refused = [*unsupported(robot), *(() if options.mimic_free else mimicking(robot))]
    for joint, key, words in refused:
        reader.fault(joint.lines.get(key, joint.line), f"joint.{joint.name}.{key}", words)
    bodies = _plain_names("bodies", robot.links, reader)
    joint_names = _plain_names("joints", robot.joints, reader)
    grounded = has_world(robot) or (options.base_fixed and robot.links[robot.root].inertial is None)
    if grounded:
        bodies[robot.root] = GROUND
    joints = {joint_names[name]: _joint(joint, robot, bodies, options) for name, joint in robot.joints.items()}
    if not grounded:
        root = bodies[robot.root]
        name = root if root not in joints else f"{root}_base"  # a joint may already have the name of the root
        joints = {name: _base(robot, bodies, options), **joints}
    links = [link for name, link in robot.links.items() if bodies[name] != GROUND]
    return AtLine(
        {
            "in_space": True,
            "name": robot.name if re.search("[A-Za-z]", robot.name) else f"robot {robot.name}",
            "bodies": {bodies[link.name]: _body(link, reader, options) for link in links if link.inertial is not None},
            "joints": joints,
        },
        1,
    )


def _plain_names(kind: str, names: Iterable[str], reader: Reader) -> dict[str, str]:
    """Names in the mechanism by their names in the file; a fault if two become the same."""
    plain_names: dict[str, str] = {}
    for name in names:
        plain = plain_name(kind, name)
        if plain in plain_names.values():
            reader.fault(None, f"{kind}.{name}", f"is written as {plain} here, as is another name; give it another one")
        plain_names[name] = plain
    return plain_names


def plain_name(kind: str, name: str) -> str:
    """Name of a link or joint among the "bodies" or "joints" of a mechanism.

    _ takes the place of characters that names may not have, and is appended to reserved names.
    """
    plain = re.sub(r"[^A-Za-z0-9_-]", "_", name)
    plain = plain if _NAME.fullmatch(plain) else f"_{plain}"
    return f"{plain}_" if plain in _RESERVED[kind] else plain


def _base(robot: Robot, bodies: Mapping[str, str], options: MechanismOptions) -> AtLine:
    """Joint between the ground and the root link."""
    kind = "weld" if options.base_fixed else "free"
    root = robot.links[robot.root]
    return AtLine({"type": kind, "parent": GROUND, "child": bodies[root.name]}, root.line)


def _body(link: Link, reader: Reader, options: MechanismOptions) -> AtLine:
    shapes = [_shape(shape, reader, options) for shape in link.shapes(options.which)]
    usable = [shape for shape in shapes if shape is not None]
    return AtLine({"type": "rigid", **_mass(link.inertial), "shapes": usable}, link.line)


def _mass(inertial: Inertial | None) -> dict[str, AtLine]:
    if inertial is None:
        return {}
    entries = {f"{a}{b}": float(inertial.tensor["xyz".index(a), "xyz".index(b)]) for a, b in
               ("xx", "yy", "zz", "xy", "xz", "yz")}  # fmt: skip
    keys = {"mass_kg": inertial.mass, "center_of_mass_m": _three(inertial.center), "inertia_kg_m2": entries}
    return {key: AtLine(value, inertial.line) for key, value in keys.items()}


def _shape(shape: Shape, reader: Reader, options: MechanismOptions) -> AtLine | None:
    """Keys of a shape; None, with a fault, or with a notice if it is only drawn, if its mesh file is missing."""
    keys, in_sand = _form(shape, reader, options.packages), options.sand is None or shape.link in options.sand
    if isinstance(keys, Fault):
        (reader.faults if in_sand else reader.notices).append(keys if in_sand else not_drawn(keys))
        return None
    keys |= {"center_m": _three(shape.pose.xyz), "rpy_deg": _degrees(shape.pose.rpy)}
    if not in_sand:
        keys["in_sand"] = False
        if keys["type"] == "mesh":
            keys["thin"] = True  # a mesh that is only drawn need not be closed
    elif options.facet_size is not None:
        keys["facet_size_m"] = options.facet_size
    return AtLine(keys, shape.line)


def _form(shape: Shape, reader: Reader, packages: Mapping[str, Path]) -> dict[str, Any] | Fault:
    """Type and sizes of a shape; a fault if its mesh file is missing."""
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
    """Key `scale` of a mesh; none for 1, so that a file that is too large for metres is reported."""
    x, y, z = geometry.scale
    return {} if (x, y, z) == (1.0, 1.0, 1.0) else {"scale": x if x == y == z and x > 0.0 else [x, y, z]}


def _joint(joint: Joint, robot: Robot, bodies: Mapping[str, str], options: MechanismOptions) -> AtLine:
    keys: dict[str, Any] = {
        "type": {"fixed": "weld", "prismatic": "slider", "floating": "free"}.get(joint.kind, "hinge"),
        "parent": AtLine(bodies[joint.parent], joint.lines["parent"]),
        "child": AtLine(bodies[joint.child], joint.lines["child"]),
    }
    line, origin = joint.lines.get("origin", joint.line), joint.origin
    keys |= {"parent_point_m": AtLine(_three(origin.xyz), line), "rpy_deg": AtLine(_degrees(origin.rpy), line)}
    if keys["type"] in ("hinge", "slider"):
        keys["axis"] = AtLine(_three(joint.axis), joint.lines.get("axis", joint.line))
        is_hinge = keys["type"] == "hinge"
        keys |= _resistance(joint, is_hinge)
        names = ("effort_limit_Nm", "rate_limit_rad_s") if is_hinge else ("effort_limit_N", "speed_limit_m_s")
        limits = dict(zip(names, (joint.effort, joint.velocity), strict=True))
        keys |= {key: AtLine(limit, joint.lines.get("limit", joint.line)) for key, limit in limits.items() if limit}
        if joint.kind != "continuous" and (stops := _stops(joint, robot, options)) is not None:
            keys["stops"] = AtLine(stops, joint.lines.get("limit", joint.line))
    return AtLine(keys, joint.line)


def _resistance(joint: Joint, is_hinge: bool) -> dict[str, AtLine]:
    """Keys of damping and dry friction, if the file has them."""
    line, keys = joint.lines.get("dynamics", joint.line), dict[str, AtLine]()
    if joint.damping:
        keys["damping_Nm_s_per_rad" if is_hinge else "damping_N_s_per_m"] = AtLine(joint.damping, line)
    if joint.friction:
        keys["friction"] = AtLine({"torque_Nm" if is_hinge else "force_N": joint.friction}, line)
    return keys


def _stops(joint: Joint, robot: Robot, options: MechanismOptions) -> dict[str, float] | None:
    """Keys of stops at the limits of a joint; None without limits.

    Unless the options give a stiffness, a stop reaches the effort limit at a depth of 1 degree or 1 mm. If the file
    gives no effort, it holds the weight of the robot at this depth, in a hinge at an arm of 0.1 m [ours].
    """
    if joint.lower is None or joint.upper is None or max(-joint.lower, joint.upper) > _ENDLESS:
        return None
    weight = _WEIGHT * sum(link.inertial.mass for link in robot.links.values() if link.inertial is not None)
    slider = joint.kind == "prismatic"
    given, dissipation = options.stiffness[slider], options.dissipation[slider]
    weight_load, depth = (weight, _MILLIMETRE) if slider else (weight * _ARM, _DEGREE)
    stiffness = given if given is not None else (joint.effort or weight_load) / depth
    if slider:
        keys = {"lower_m": joint.lower, "upper_m": joint.upper, "stiffness_N_per_m": stiffness}
        return keys | ({"dissipation_s_per_m": dissipation} if dissipation else {})
    limits = {"lower_deg": float(np.degrees(joint.lower)), "upper_deg": float(np.degrees(joint.upper))}
    keys = {**limits, "stiffness_Nm_per_rad": stiffness}
    return keys | ({"dissipation_s_per_rad": dissipation} if dissipation else {})


def _three(vector: Vector) -> list[float]:
    """Numbers of a vector (3,), with 0.0 for -0.0."""
    return [float(x) + 0.0 for x in vector]


def _degrees(rpy: Vector) -> list[float]:
    return _three(np.degrees(rpy))
