"""Read the robot file that a model names, as the tree of a mechanism in space with lines of the robot file."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

from granular_contact.config.messages import validated
from granular_contact.config.references import readable_path
from granular_contact.config.schema.robot import RobotFile
from granular_contact.config.tree import Broken, Items, Mapping, Node, Position, Scalar, from_plain, mapping, merge
from granular_contact.config.urdf_corrections import drop_replaced_faults, given_masses, without_merged_links
from granular_contact.errors import ConfigError, Fault
from granular_contact.robot.massless import has_world, matching, merge_massless, with_fixed_joints, with_given_inertials
from granular_contact.robot.mechanism import AtLine, MechanismOptions, mechanism_of
from granular_contact.robot.types import Robot
from granular_contact.robot.urdf import read_all
from granular_contact.values.strict import did_you_mean, no_such

URDF = "urdf"
# Keys of a mechanism in space that may stand beside `urdf`. They are merged over the mechanism of the robot file.
_MODEL_KEYS = ("in_space", "name", "description", "bodies", "joints", "closures", "chain")


def mechanism(node: Mapping, faults: list[Fault], notices: list[Fault]) -> Node:
    """Tree of the mechanism in the robot file that a model names; with faults, a mechanism with `Broken` parts.

    Notices about parts of the robot file that were skipped are appended to `notices`.
    """
    count_before = len(faults)
    options = _options(node, faults)
    if options is None:
        return _unknown_mechanism(node)
    at = node.nodes[URDF].position
    folder = Path(at.file).parent if at.line is not None else Path()
    try:
        tree = _translated(node, options, folder, faults, notices)
    except ConfigError as error:  # the file can't be read: faults without a line get the line that names the file
        file = error.faults[0].file
        at_name = [at.fault(("model", URDF), f"{file} {fault.message}") for fault in error.faults]
        faults += [old if old.line is not None else new for old, new in zip(error.faults, at_name, strict=True)]
        tree = None
    return _unknown_mechanism(node) if tree is None or len(faults) > count_before else tree


def _unknown_mechanism(node: Mapping) -> Node:
    """A model in space with `Broken` bodies and joints, so that the rest of the config is checked as one in space."""
    at = node.position
    named = {"in_space": from_plain(True, at), "name": from_plain("robot", at)}
    return mapping(named | {"bodies": Broken(at), "joints": Broken(at)}, at)


def _part(node: Mapping, keys: Any) -> Mapping:
    """A mapping with these keys alone."""
    return Mapping(node.position, {key: below for key, below in node.nodes.items() if key in keys}, node.keys)


def _options(node: Mapping, faults: list[Fault]) -> RobotFile | None:
    """The keys about the robot file; None, with faults, if they are not valid."""
    known = [*RobotFile.model_fields, *_MODEL_KEYS]
    for key in node.nodes:
        if key not in known:
            message = f"unknown key; {did_you_mean(key, known) or 'allowed are ' + ', '.join(known)}"
            faults.append(node.keys[key].fault(("model", key), message))
    in_space = node.nodes.get("in_space")
    if isinstance(in_space, Scalar) and in_space.value is False:
        faults.append(node.keys["in_space"].fault(("model", "in_space"), "got false, but a robot file is in space"))
    option_faults = list[Fault]()
    options = validated(RobotFile, _part(node, RobotFile.model_fields), option_faults)
    faults += [replace(fault, key=f"model.{fault.key}".rstrip(".")) for fault in option_faults]
    return options


def _translated(
    node: Mapping, options: RobotFile, folder: Path, faults: list[Fault], notices: list[Fault]
) -> Node | None:
    """Tree of the mechanism in a robot file, with the keys beside `urdf` merged over it; None with faults of the file.

    Raises
    ------
    ConfigError
        The file can't be read as XML.
    """
    robot, reader = read_all(readable_path(folder / options.urdf))
    sand = _sand(options, robot)
    reader.use_shapes(options.shapes, sand)
    drop_replaced_faults(node, robot, reader)
    if not reader.faults:
        faults += _unmatched(node, options, robot)
        if has_world(robot) and options.base is not None:
            message = f"got {options.base}, but the root link {robot.root} of {robot.file} is the ground; leave it out"
            faults.append(node.keys["base"].fault(("model", "base"), message))
        fixed = options.base == "fixed"
        fixed_robot = with_fixed_joints(robot, options.fix)
        whole = with_given_inertials(fixed_robot, reader, given_masses(node, robot, faults), fixed)
        bodies = merge_massless(whole, reader, fixed)
    if not reader.faults:
        model = mechanism_of(bodies, reader, _mechanism_options(options, sand, folder))
        drop_replaced_faults(node, robot, reader)  # those of missing meshes
    faults += reader.faults
    notices += reader.notices
    if reader.faults:
        return None
    tree = _tree(model, Position(robot.file, 1))
    return merge(tree, without_merged_links(_part(node, _MODEL_KEYS), tree, robot, faults))


def _sand(options: RobotFile, robot: Robot) -> frozenset[str] | None:
    """Names of the links on whose shapes the medium acts; None: all links."""
    if options.in_sand is None:
        return None
    return frozenset(name for pattern in options.in_sand for name in matching(pattern, robot.links))


def _mechanism_options(options: RobotFile, sand: frozenset[str] | None, folder: Path) -> MechanismOptions:
    """The keys about the robot file in the form of the room `robot`."""
    return MechanismOptions(
        which=options.shapes,
        sand=sand,
        facet_size=options.facet_size_m,
        base_fixed=options.base == "fixed",
        mimic_free=options.mimic == "ignore",
        stiffness=(options.stops.stiffness_Nm_per_rad, options.stops.stiffness_N_per_m),
        dissipation=(options.stops.dissipation_s_per_rad, options.stops.dissipation_s_per_m),
        packages={name: folder / path for name, path in options.packages.items()},
    )


def _unmatched(node: Mapping, options: RobotFile, robot: Robot) -> list[Fault]:
    """Faults of patterns that match no joint or link, or no link with a shape."""
    faults = []
    for key, noun, patterns, names in (
        ("fix", "joint", options.fix, list(robot.joints)),
        ("in_sand", "link", options.in_sand or (), list(robot.links)),
    ):
        for index, pattern in enumerate(patterns):
            matched = matching(pattern, names)
            path, at = ("model", key, index), node.keys.get(key, node.position)
            if not matched:
                faults.append(at.fault(path, no_such(noun, pattern, names)))
            elif key == "in_sand" and not any(robot.links[name].shapes(options.shapes) for name in matched):
                message = f"{', '.join(matched[:6])}: no {options.shapes} shape for the medium to act on"
                faults.append(at.fault(path, f"{message}; allowed are links with one"))
    return faults


def _tree(value: Any, at: Position) -> Node:
    """Tree of a value of `robot.mechanism`; at: position of parts without a line of their own."""
    if isinstance(value, AtLine):
        return _tree(value.value, Position(at.file, value.line))
    if isinstance(value, dict):
        return mapping({key: _tree(below, at) for key, below in value.items()}, at)
    if isinstance(value, list):
        return Items(at, tuple(_tree(item, at) for item in value))
    return from_plain(value, at)
