"""Keys beside `urdf` that replace values of a robot file: limits of joints, masses, inertias, shapes."""

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
from granular_contact.robot.elements import PartialInertial, Reader
from granular_contact.robot.mechanism import plain_name
from granular_contact.robot.types import Robot
from granular_contact.values.strict import Positive, Strict

# Key of a joint in a model -> parts of the joint in a robot file that it replaces.
_JOINT_PARTS = {
    "stops": ("limit",),
    "axis": ("axis",),
    "damping_Nm_s_per_rad": ("dynamics.damping",),
    "damping_N_s_per_m": ("dynamics.damping",),
    "friction": ("dynamics.friction",),
    "effort_limit_Nm": ("limit.effort",),
    "effort_limit_N": ("limit.effort",),
    "rate_limit_rad_s": ("limit.velocity",),
    "speed_limit_m_s": ("limit.velocity",),
    "parent_point_m": ("origin.xyz",),
    "rpy_deg": ("origin.rpy",),
    "quaternion": ("origin.rpy",),
}
# Key of a body in a model -> parts of the link in a robot file that it replaces.
_LINK_PARTS = {
    "mass_kg": ("inertial.mass",),
    "inertia_kg_m2": ("inertial.inertia", "inertial.origin.rpy"),
    "center_of_mass_m": ("inertial.origin.xyz",),
    "shapes": ("collision", "visual"),
}


class BodyMass(Strict):
    """Mass properties of a body that are given beside `urdf`."""

    mass_kg: Positive | None = None
    inertia_kg_m2: Inertia | None = None
    center_of_mass_m: Point3 | None = None


def drop_replaced_faults(node: Mapping, robot: Robot, reader: Reader) -> None:
    """Drop the faults of the robot file that are about parts which keys beside `urdf` replace."""
    replaced = tuple(_replaced(node, robot))
    reader.faults = [
        fault for fault in reader.faults if not any(f"{fault.key}.".startswith(f"{key}.") for key in replaced)
    ]


def _replaced(node: Mapping, robot: Robot) -> Iterator[str]:
    """Dotted keys of the parts of a robot file that keys beside `urdf` replace."""
    for kind, noun, parts, names in (
        ("joints", "joint", _JOINT_PARTS, list(robot.joints)),
        ("bodies", "link", _LINK_PARTS, list(robot.links)),
    ):
        for name, given in _given(node, kind, names):
            yield from (f"{noun}.{name}.{part}" for key in given.nodes for part in parts.get(key, ()))


def _given(node: Mapping, kind: str, names: list[str]) -> Iterator[tuple[str, Mapping]]:
    """Joints or links of a robot file for which the model has keys: the name, and the mapping with the keys.

    kind: `joints` or `bodies`; names: those in the robot file.
    """
    by_name = node.nodes.get(kind)
    for name in names:
        given = None if by_name is None else child(by_name, plain_name(kind, name))
        if isinstance(given, Mapping):
            yield name, given


def given_masses(node: Mapping, robot: Robot, faults: list[Fault]) -> dict[str, PartialInertial]:
    """Mass properties that are given beside `urdf`, by the name of the link."""
    masses = {}
    for name, given in _given(node, "bodies", list(robot.links)):
        mass_nodes = {key: below for key, below in given.nodes.items() if key in BodyMass.model_fields}
        part = Mapping(given.position, mass_nodes, given.keys)
        try:
            values = BodyMass.model_validate(plain(part))
        except ValidationError as error:
            mass_faults = faults_of(error.errors(include_url=False, include_input=False), part, SpatialRigid)
            faults += [replace(fault, key=f"model.bodies.{name}.{fault.key}") for fault in mass_faults]
            continue
        if mass_nodes:
            inertia, center = values.inertia_kg_m2, values.center_of_mass_m
            tensor = None if inertia is None else np.array(inertia.tensor)
            masses[name] = PartialInertial(values.mass_kg, None if center is None else np.array(center, float), tensor)
    return masses


def without_merged_links(corrections: Mapping, mechanism: Node, robot: Robot, faults: list[Fault]) -> Mapping:
    """The keys beside `urdf`, without the bodies that stand for links which were merged into another body.

    Their masses are part of that body already (`given_masses`). Any other key of such a link is a fault.

    corrections: the keys beside `urdf`; mechanism: that of the robot file.
    """
    bodies, merged_bodies = corrections.nodes.get("bodies"), child(mechanism, "bodies")
    if not isinstance(bodies, Mapping) or merged_bodies is None:
        return corrections
    kept = dict(bodies.nodes)
    for name, given in _given(corrections, "bodies", list(robot.links)):
        key = next(key for key, below in bodies.nodes.items() if below is given)
        if child(merged_bodies, key) is not None or "type" in given.nodes:
            continue
        del kept[key]
        message = f"the link {name} is part of another body here, as it is fixed to it; allowed are keys of that body"
        others = [other for other in given.nodes if other not in BodyMass.model_fields]
        faults += [given.keys[other].fault(("model", "bodies", key, other), message) for other in others]
    nodes = {**corrections.nodes, "bodies": Mapping(bodies.position, kept, bodies.keys)}
    return Mapping(corrections.position, nodes, corrections.keys)
