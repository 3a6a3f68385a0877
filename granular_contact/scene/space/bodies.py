"""Rigid bodies in space from the merged mass properties of their shapes, and the joints between them."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from granular_contact.config.schema import Load
from granular_contact.config.schema import space as schema
from granular_contact.config.schema.space.joints import AnyClosure, AnyJoint
from granular_contact.config.schema.space.shapes import SpatialMesh
from granular_contact.errors import Fault, SceneError, scene_fault
from granular_contact.geometry import rotations
from granular_contact.sand.space.triangles import FACET_SIZE
from granular_contact.scene.joint_law import IDLE, actuator_limits, joint_law
from granular_contact.scene.layout import GROUND
from granular_contact.scene.space.layout import CONSTRAINED, STILL, JointState, Pose, axis_of, slides
from granular_contact.scene.space.loops import joint_frame
from granular_contact.scene.space.mass_properties import Mass, merged
from granular_contact.scene.space.section import Element
from granular_contact.scene.space.shapes import moved, part_of
from granular_contact.scene.space.types import Elastic, Part, SpatialJoint, SpatialRigidBody, Vector
from granular_contact.scene.types import link_of


@dataclass(frozen=True)
class SingleBody:
    """A body of the config, not yet merged with others: its parts and its mass properties, in its own frame."""

    parts: list[Part]
    mass: Mass


def bodies_of(
    model: schema.SpatialModel, media: Collection[str], load: Load, faults: list[Fault], notes: list[Fault]
) -> dict[str, SingleBody] | None:
    """All bodies of a model by name; None if one has faults. Faults, and notes on uncertain forces, are appended.

    media: see `shapes.part_of`; load: of the config, with the numbers of strips of bars.
    """
    bodies, before = {}, len(faults)
    for name, body in model.all_bodies.items():
        specs = (body,) if isinstance(body, schema.SpatialLink | Element) else body.shapes
        parts, volumes, strips = [], [], load.strips_per_rigid_part
        if isinstance(body, Element):
            strips = math.ceil(body.share * load.strips_per_element)
        for i, spec in enumerate(specs):
            key = f"model.bodies.{link_of(name)}"
            key += f".shapes.{i}" if isinstance(body, schema.SpatialRigid) else ""
            file_key = f"{key}.file" if getattr(spec, "type", "") == "mesh" else key
            try:
                part, volume = part_of(link_of(name), spec, media, strips)
            except SceneError as error:
                shape_faults = [
                    scene_fault(f"{key}.facet_size_m" if fault.key == FACET_SIZE else file_key, fault.message)
                    for fault in error.faults
                ]
                if _is_only_drawn(body, spec):
                    suffix = "; not in the sand, it is not drawn"
                    notes += [replace(fault, message=f"{fault.message}{suffix}") for fault in shape_faults]
                else:
                    faults += shape_faults
                continue
            parts.append(part)
            notes += [scene_fault(file_key, words) for words in part.notes]
            volumes.append(volume)
            if body.density_kg_m3 is not None and not volume.mass > 0.0:
                words = "a sheet without thickness_m has no mass, but its body has a density; give it a thickness"
                faults.append(scene_fault(key, words))
        if len(faults) == before:
            bodies[name] = _single_body(body, parts, volumes)
    return bodies if len(faults) == before else None


def _is_only_drawn(body: schema.SpatialBody, spec: Any) -> bool:
    """Whether a mesh gives neither forces nor mass, so that a run can do without it."""
    return isinstance(spec, SpatialMesh) and not spec.in_sand and body.density_kg_m3 is None


def _single_body(body: schema.SpatialBody, parts: list[Part], volumes: list[Mass]) -> SingleBody:
    """A body with its mass properties: those of the config, or of its shapes with its density.

    volumes: mass properties of the parts at a density of 1.
    """
    if isinstance(body, schema.SpatialLink | Element) or body.density_kg_m3 is not None:
        density = body.density_kg_m3
        assert density is not None
        masses = [volume.of_density(density) for volume in volumes]
        weighed = [_with_mass(part, mass.mass) for part, mass in zip(parts, masses, strict=True)]
        return SingleBody(weighed, merged(masses))
    assert body.mass_kg is not None  # the schema requires a density, or mass and inertia
    assert body.inertia_kg_m2 is not None
    j = body.inertia_kg_m2
    inertia = np.array([[j.xx, j.xy, j.xz], [j.xy, j.yy, j.yz], [j.xz, j.yz, j.zz]])
    center = np.array(body.center_of_mass_m or (0.0, 0.0, 0.0), float)
    return SingleBody([_with_mass(part, body.mass_kg) for part in parts], Mass(body.mass_kg, center, inertia))


def _with_mass(part: Part, mass: float) -> Part:
    """Store its own mass (kg) in a ball, for laws that need it; other parts are unchanged."""
    return replace(part, shape=replace(part.shape, mass=mass)) if "ball" in part.meets else part


def rigid_body(bodies: dict[str, SingleBody], group: list[str], pose: Pose) -> SpatialRigidBody:
    """Merge a group of welded bodies; the frame has the axes of the first and its origin at their centre of mass.

    Elements of links that bend come last, and are left out of the name.
    """
    group = sorted(group, key=lambda name: "." in name)
    total = merged(bodies[name].mass.placed(pose[name].position, pose[name].rotation) for name in group)
    first = pose[group[0]]
    motion = replace(first, position=total.center, velocity=first.speed_at(total.center))
    R = motion.rotation
    parts = []
    for name in group:
        position, turn = motion.local(pose[name].position), R.T @ pose[name].rotation
        parts += [moved(part, position, turn) for part in bodies[name].parts]
    inertia = R.T @ total.inertia @ R
    names = [name for name in group if "." not in name] or group[:1]
    symmetric = 0.5 * (inertia + inertia.T)
    return SpatialRigidBody("+".join(names), total.mass, symmetric, tuple(parts), motion, tuple(group))


def joints_of(
    model: schema.SpatialModel,
    pose: Pose,
    rigid: tuple[SpatialRigidBody, ...],
    states: Mapping[str, JointState],
    closure_constraints: Mapping[str, tuple[bool, ...]],
) -> Iterator[SpatialJoint]:
    """Joints and closures between bodies that move against each other; welds within a rigid body are left out.

    states: of the joints of the tree; closure_constraints: masks (6,) of the independent constraints of closures.
    """
    merged_into = {name: (body.name, body.motion) for body in rigid for name in body.members}
    for name, joint in (model.all_joints | model.closures).items():
        parent, parent_frame = merged_into.get(joint.parent, (None, STILL))
        child, child_frame = merged_into.get(joint.child, (None, STILL))
        if child == parent:
            continue
        assert child is not None  # `closure_faults` refuses a closure whose child is the ground
        turn, at_child = joint_frame(joint, pose)
        at_parent = _point_on_parent(pose, joint) if slides(joint) else at_child
        elastic: Elastic | None = getattr(joint, "elastic", None)
        child_axes = turn  # without free rotations both frames agree to round-off
        if elastic is None and not all(CONSTRAINED[joint.type][3:]):
            child_axes = pose[joint.child].rotation @ rotations.to_axis(axis_of(joint))
        start, rate = coordinate(name, joint, pose, states)
        yield SpatialJoint(
            name=name,
            kind=joint.type,
            parent=parent,
            parent_point=parent_frame.local(at_parent),
            parent_turn=parent_frame.rotation.T @ turn,
            child=child,
            child_point=child_frame.local(at_child),
            child_turn=child_frame.rotation.T @ child_axes,
            constrained=closure_constraints.get(name, CONSTRAINED[joint.type]),
            start=start,
            rate=rate,
            closes=name in model.closures,
            law=joint_law(joint) if elastic is None else IDLE,
            elastic=elastic,
            **({} if elastic is not None else actuator_limits(joint)),
        )


def _point_on_parent(pose: Pose, joint: AnyJoint | AnyClosure) -> Vector:
    """World position (3,) m of a joint's point on its parent; for a slider it differs from the point on the child."""
    return pose[joint.parent].world(np.array(joint.parent_point_m))


def coordinate(
    name: str, joint: AnyJoint | AnyClosure, pose: Pose, states: Mapping[str, JointState]
) -> tuple[float, float]:
    """Initial coordinate (rad or m) of a hinge or slider and its rate; for a closure from the poses of its bodies.

    Both are 0 for other joints.
    """
    if joint.type not in ("hinge", "slider"):
        return 0.0, 0.0
    if name in states:
        return states[name].coordinate, float(states[name].rates[0])
    turn, at_child = joint_frame(joint, pose)
    axis, parent, child = turn[:, 2], pose[joint.parent], pose[joint.child]
    if joint.type == "slider":
        gap, velocity = at_child - _point_on_parent(pose, joint), child.speed_at(at_child) - parent.speed_at(at_child)
        return float(axis @ gap), float(axis @ velocity)
    relative = turn.T @ child.rotation @ rotations.to_axis(axis_of(joint))
    # Poses do not show the number of whole turns: the angle is the one between -pi and pi.
    angle = math.atan2(relative[1, 0], relative[0, 0])
    return angle, float(axis @ (child.rate - parent.rate))


def on_ground(model: schema.SpatialModel) -> list[AnyJoint]:
    """Joints on the ground."""
    return [joint for joint in model.all_joints.values() if joint.parent == GROUND]
