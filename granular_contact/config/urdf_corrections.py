"""Keys beside `urdf` that put right what a robot file says: limits of joints, masses, inertias, shapes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from pydantic import ValidationError

from granular_contact.config.messages import faults_of
from granular_contact.config.schema.space.bodies import Inertia, SpatialRigid
from granular_contact.config.schema.space.turned import Point3
from granular_contact.config.tree import Mapping, Node, child, plain
from granular_contact.errors import Fault
from granular_contact.robot.elements import Incomplete, Reader
from granular_contact.robot.mechanism import plain_name
from granular_contact.robot.types import Robot
from granular_contact.values.strict import Positive, Strict

# A key of a joint or body here -> the parts of the file's joint or link that it replaces.
_OF_JOINTS = {
    "stops": ("limit",),
    "axis": ("axis",),
    "damping_Nm_s_per_rad": ("dynamics.damping",),
    "damping_N_s_per_m": ("dynamics.damping",),
    "friction": ("dynamics.friction",),
    "parent_point_m": ("origin.xyz",),
    "rpy_deg": ("origin.rpy",),
    "quaternion": ("origin.rpy",),
}
_OF_BODIES = {
    "mass_kg": ("inertial.mass",),
    "inertia_kg_m2": ("inertial.inertia", "inertial.origin.rpy"),
    "center_of_mass_m": ("inertial.origin.xyz",),
    "shapes": ("collision", "visual"),
}


class BodyMass(Strict):
    """Mass properties of a body, as they stand beside `urdf`."""

    mass_kg: Positive | None = None
    inertia_kg_m2: Inertia | None = None
    center_of_mass_m: Point3 | None = None


def put_right(node: Mapping, robot: Robot, reader: Reader) -> None:
    """Leave out the faults of the file about what keys beside `urdf` replace."""
    replaced = tuple(_replaced(node, robot))
    reader.faults = [
        fault for fault in reader.faults if not any(f"{fault.key}.".startswith(f"{key}.") for key in replaced)
    ]


def _replaced(node: Mapping, robot: Robot) -> Iterator[str]:
    """Dotted keys of the parts of a robot file that are replaced."""
    for kind, noun, parts, names in (
        ("joints", "joint", _OF_JOINTS, list(robot.joints)),
        ("bodies", "link", _OF_BODIES, list(robot.links)),
    ):
        for name, given in _given(node, kind, names):
            yield from (f"{noun}.{name}.{part}" for key in given.nodes for part in parts.get(key, ()))


def _given(node: Mapping, kind: str, names: list[str]) -> Iterator[tuple[str, Mapping]]:
    """Names in the file, of joints or links, for which there are keys beside `urdf`, and these."""
    held = node.nodes.get(kind)
    for name in names:
        given = None if held is None else child(held, plain_name(kind, name))
        if isinstance(given, Mapping):
            yield name, given


def masses(node: Mapping, robot: Robot, faults: list[Fault]) -> dict[str, Incomplete]:
    """Mass properties beside `urdf` by the names of links."""
    found = {}
    for name, given in _given(node, "bodies", list(robot.links)):
        held = {key: below for key, below in given.nodes.items() if key in BodyMass.model_fields}
        part = Mapping(given.position, held, given.keys)
        try:
            read = BodyMass.model_validate(plain(part))
        except ValidationError as error:
            own_faults = faults_of(error.errors(include_url=False, include_input=False), part, SpatialRigid)
            faults += [replace(fault, key=f"model.bodies.{name}.{fault.key}") for fault in own_faults]
            continue
        if held:
            inertia, center = read.inertia_kg_m2, read.center_of_mass_m
            tensor = None if inertia is None else np.array(inertia.tensor)
            found[name] = Incomplete(read.mass_kg, None if center is None else np.array(center, float), tensor)
    return found


def without_used(over: Mapping, mechanism: Node, robot: Robot, faults: list[Fault]) -> Mapping:
    """The keys that are put over a mechanism, without those of links that became part of another body.

    Their masses have been used; of other keys of theirs there is a fault.
    """
    bodies, there = over.nodes.get("bodies"), child(mechanism, "bodies")
    if not isinstance(bodies, Mapping) or there is None:
        return over
    left = dict(bodies.nodes)
    for name, given in _given(over, "bodies", list(robot.links)):
        key = next(key for key, held in bodies.nodes.items() if held is given)
        if child(there, key) is not None or "type" in given.nodes:
            continue
        del left[key]
        words = f"the link {name} is part of another body here, as it is fixed to it; allowed are keys of that body"
        more = [at for at in given.nodes if at not in BodyMass.model_fields]
        faults += [given.keys[at].fault(("model", "bodies", key, at), words) for at in more]
    return Mapping(over.position, {**over.nodes, "bodies": Mapping(bodies.position, left, bodies.keys)}, over.keys)
