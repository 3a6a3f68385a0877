"""A model that names a robot file -> the tree of a mechanism in space, each key at its line in that file."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

from granular_contact.config.messages import validated
from granular_contact.config.references import shown
from granular_contact.config.schema.robot import RobotFile
from granular_contact.config.tree import Broken, Items, Mapping, Node, Position, Scalar, made, mapping, merge
from granular_contact.config.urdf_corrections import masses, put_right, without_used
from granular_contact.errors import ConfigError, Fault
from granular_contact.robot.massless import completed, has_world, held, matching, merged
from granular_contact.robot.mechanism import Said, Wishes, mechanism_of
from granular_contact.robot.types import Robot
from granular_contact.robot.urdf import read_all
from granular_contact.values.strict import did_you_mean, no_such

URDF = "urdf"
# Keys of a mechanism in space that may stand beside those of a robot file, and are put over what it gives.
_OVER = ("in_space", "name", "description", "bodies", "joints", "closures", "chain")


def mechanism(node: Mapping, faults: list[Fault], notices: list[Fault]) -> Node:
    """The mechanism in the robot file that a model names; with faults, one whose parts are `Broken`.

    notices: what was passed over in the file is appended.
    """
    before = len(faults)
    asked = _asked(node, faults)
    if asked is None:
        return _lost(node)
    at = node.nodes[URDF].position
    folder = Path(at.file).parent if at.line is not None else Path()
    try:
        found = _translated(node, asked, folder, faults, notices)
    except ConfigError as error:  # of the file as a whole; without a line of its own it is a fault of its name
        file = error.faults[0].file
        own_faults = [at.fault(("model", URDF), f"{file} {one.message}") for one in error.faults]
        faults += [one if one.line is not None else new for one, new in zip(error.faults, own_faults, strict=True)]
        found = None
    return _lost(node) if found is None or len(faults) > before else found


def _lost(node: Mapping) -> Node:
    """A model in space of which nothing is known, so that the rest of the config is checked as one in space."""
    at = node.position
    named = {"in_space": made(True, at), "name": made("robot", at)}
    return mapping(named | {"bodies": Broken(at), "joints": Broken(at)}, at)


def _part(node: Mapping, keys: Any) -> Mapping:
    return Mapping(node.position, {key: held for key, held in node.nodes.items() if key in keys}, node.keys)


def _asked(node: Mapping, faults: list[Fault]) -> RobotFile | None:
    """The keys of a robot file."""
    known = [*RobotFile.model_fields, *_OVER]
    for key in node.nodes:
        if key not in known:
            words = f"unknown key; {did_you_mean(key, known) or 'allowed are ' + ', '.join(known)}"
            faults.append(node.keys[key].fault(("model", key), words))
    plane = node.nodes.get("in_space")
    if isinstance(plane, Scalar) and plane.value is False:
        faults.append(node.keys["in_space"].fault(("model", "in_space"), "got false, but a robot file is in space"))
    own_faults = list[Fault]()
    asked = validated(RobotFile, _part(node, RobotFile.model_fields), own_faults)
    faults += [replace(fault, key=f"model.{fault.key}".rstrip(".")) for fault in own_faults]
    return asked


def _translated(
    node: Mapping, asked: RobotFile, folder: Path, faults: list[Fault], notices: list[Fault]
) -> Node | None:
    """The mechanism with the keys beside `urdf` put over it; raises ConfigError if the file can't be read as XML."""
    robot, reader = read_all(shown(folder / asked.urdf))
    sand = _sand(asked, robot)
    reader.use(asked.shapes, sand)
    put_right(node, robot, reader)
    if not reader.faults:
        faults += _unmatched(node, asked, robot)
        if has_world(robot) and asked.base is not None:
            words = f"got {asked.base}, but the root link {robot.root} of {robot.file} is the ground; leave it out"
            faults.append(node.keys["base"].fault(("model", "base"), words))
        fixed = asked.base == "fixed"
        whole = completed(held(robot, asked.fix), reader, masses(node, robot, faults), fixed)
        bodies = merged(whole, reader, fixed)
    if not reader.faults:
        said = mechanism_of(bodies, reader, _wishes(asked, sand, folder))
        put_right(node, robot, reader)  # of meshes that are not there
    faults += reader.faults
    notices += reader.notices
    if reader.faults:
        return None
    made = _placed(said, Position(robot.file, 1))
    return merge(made, without_used(_part(node, _OVER), made, robot, faults))


def _sand(asked: RobotFile, robot: Robot) -> frozenset[str] | None:
    """Links on whose shapes the medium acts; None: on all."""
    if asked.in_sand is None:
        return None
    return frozenset(name for pattern in asked.in_sand for name in matching(pattern, robot.links))


def _wishes(asked: RobotFile, sand: frozenset[str] | None, folder: Path) -> Wishes:
    return Wishes(
        which=asked.shapes,
        sand=sand,
        facet_size=asked.facet_size_m,
        base_fixed=asked.base == "fixed",
        mimic_free=asked.mimic == "ignore",
        stiffness=(asked.stops.stiffness_Nm_per_rad, asked.stops.stiffness_N_per_m),
        dissipation=(asked.stops.dissipation_s_per_rad, asked.stops.dissipation_s_per_m),
        packages={name: folder / path for name, path in asked.packages.items()},
    )


def _unmatched(node: Mapping, asked: RobotFile, robot: Robot) -> list[Fault]:
    """Faults of patterns that mean no joint or link, or no link with a shape."""
    found = []
    for key, what, patterns, names in (
        ("fix", "joint", asked.fix, list(robot.joints)),
        ("in_sand", "link", asked.in_sand or (), list(robot.links)),
    ):
        for index, pattern in enumerate(patterns):
            meant = matching(pattern, names)
            path, at = ("model", key, index), node.keys.get(key, node.position)
            if not meant:
                found.append(at.fault(path, no_such(what, pattern, names)))
            elif key == "in_sand" and not any(robot.links[name].shapes(asked.shapes) for name in meant):
                words = f"{', '.join(meant[:6])}: no {asked.shapes} shape for the medium to act on"
                found.append(at.fault(path, f"{words}; allowed are links with one"))
    return found


def _placed(said: Any, at: Position) -> Node:
    """The tree of a mechanism of `robot.mechanism`."""
    if isinstance(said, Said):
        return _placed(said.value, Position(at.file, said.line))
    if isinstance(said, dict):
        return mapping({key: _placed(held, at) for key, held in said.items()}, at)
    if isinstance(said, list):
        return Items(at, tuple(_placed(held, at) for held in said))
    return made(said, at)
