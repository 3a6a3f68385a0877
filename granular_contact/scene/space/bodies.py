"""Mass properties of shapes in space, merged into rigid bodies, and the joints between these."""

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
from granular_contact.scene.joint_law import IDLE, joint_law
from granular_contact.scene.layout import GROUND
from granular_contact.scene.space.layout import CONSTRAINED, STILL, JointState, Pose, axis_of, slides
from granular_contact.scene.space.loops import joint_frame
from granular_contact.scene.space.mass_properties import Mass, merged
from granular_contact.scene.space.section import Element
from granular_contact.scene.space.shapes import moved, part_of
from granular_contact.scene.space.types import Elastic, Part, SpatialJoint, SpatialRigidBody, Vector
from granular_contact.scene.types import link_of


@dataclass(frozen=True)
class Made:
    """A body of the config by itself, in its own frame: parts with their mass properties, and mass."""

    parts: list[Part]
    mass: Mass


def bodies_of(
    model: schema.SpatialModel, media: Collection[str], load: Load, faults: list[Fault], notes: list[Fault]
) -> dict[str, Made] | None:
    """All bodies by name; None, with faults, if one can't be made; notes on uncertain forces are appended, too.

    media: as of `shapes.part_of`; load: of the config, which says how many strips bars have.
    """
    found, before = {}, len(faults)
    for name, body in model.all_bodies.items():
        specs = (body,) if isinstance(body, schema.SpatialLink | Element) else body.shapes
        parts, own, strips = [], [], load.strips_per_rigid_part
        if isinstance(body, Element):
            strips = math.ceil(body.share * load.strips_per_element)
        for i, spec in enumerate(specs):
            key = f"model.bodies.{link_of(name)}"
            key += f".shapes.{i}" if isinstance(body, schema.SpatialRigid) else ""
            place = f"{key}.file" if getattr(spec, "type", "") == "mesh" else key
            try:
                part, properties = part_of(link_of(name), spec, media, strips)
            except SceneError as error:
                keys = (f"{key}.facet_size_m" if one.key == FACET_SIZE else place for one in error.faults)
                told = [scene_fault(at, one.message) for at, one in zip(keys, error.faults, strict=True)]
                if _is_drawn_alone(body, spec):
                    notes += [replace(one, message=f"{one.message}; not in the sand, it is not drawn") for one in told]
                else:
                    faults += told
                continue
            parts.append(part)
            notes += [scene_fault(place, words) for words in part.notes]
            own.append(properties)
            if body.density_kg_m3 is not None and not properties.mass > 0.0:
                words = "a sheet without thickness_m has no mass, but its body has a density; give it a thickness"
                faults.append(scene_fault(key, words))
        if len(faults) == before:
            found[name] = _made(body, parts, own)
    return found if len(faults) == before else None


def _is_drawn_alone(body: schema.SpatialBody, spec: Any) -> bool:
    """Whether a mesh gives neither forces nor mass: a run can do without it."""
    return isinstance(spec, SpatialMesh) and not spec.in_sand and body.density_kg_m3 is None


def _made(body: schema.SpatialBody, parts: list[Part], own: list[Mass]) -> Made:
    """A body with its mass, as given or of its shapes; a ball knows its own mass."""
    if isinstance(body, schema.SpatialLink | Element) or body.density_kg_m3 is not None:
        density = body.density_kg_m3
        assert density is not None
        masses = [one.of_density(density) for one in own]
        of_parts = [_with_mass(part, one.mass) for part, one in zip(parts, masses, strict=True)]
        return Made(of_parts, merged(masses))
    assert body.mass_kg is not None  # the schema takes a density, or both
    assert body.inertia_kg_m2 is not None
    j = body.inertia_kg_m2
    inertia = np.array([[j.xx, j.xy, j.xz], [j.xy, j.yy, j.yz], [j.xz, j.yz, j.zz]])
    center = np.array(body.center_of_mass_m or (0.0, 0.0, 0.0), float)
    return Made([_with_mass(part, body.mass_kg) for part in parts], Mass(body.mass_kg, center, inertia))


def _with_mass(part: Part, mass: float) -> Part:
    """A ball with its own mass, for laws that ask for it."""
    return replace(part, shape=replace(part.shape, mass=mass)) if "ball" in part.meets else part


def rigid_body(made: dict[str, Made], group: list[str], placed: Pose) -> SpatialRigidBody:
    """Merge a group of welded bodies; the frame has the axes of the first and its origin at their centre of mass.

    Elements of links that bend come last, and have no part in the name.
    """
    group = sorted(group, key=lambda name: "." in name)
    whole = merged(made[name].mass.placed(placed[name].position, placed[name].rotation) for name in group)
    first = placed[group[0]]
    motion = replace(first, position=whole.center, velocity=first.speed_at(whole.center))
    R = motion.rotation
    parts = []
    for name in group:
        at, turn = motion.local(placed[name].position), R.T @ placed[name].rotation
        parts += [moved(part, at, turn) for part in made[name].parts]
    inertia = R.T @ whole.inertia @ R
    names = [name for name in group if "." not in name] or group[:1]
    own = 0.5 * (inertia + inertia.T)
    return SpatialRigidBody("+".join(names), whole.mass, own, tuple(parts), motion, tuple(group))


def joints_of(
    model: schema.SpatialModel,
    placed: Pose,
    rigid: tuple[SpatialRigidBody, ...],
    states: Mapping[str, JointState],
    needed: Mapping[str, tuple[bool, ...]],
) -> Iterator[SpatialJoint]:
    """Joints and closures between what moves on its own; needed: which constraints of closures count."""
    homes = {name: (body.name, body.motion) for body in rigid for name in body.members}
    for name, joint in (model.all_joints | model.closures).items():
        parent, parent_frame = homes.get(joint.parent, (None, STILL))
        child, child_frame = homes.get(joint.child, (None, STILL))
        if child == parent:
            continue
        assert child is not None  # closures with child and parent swapped are refused before
        turn, at_child = joint_frame(joint, placed)
        at_parent = _origin(placed, joint) if slides(joint) else at_child
        elastic: Elastic | None = getattr(joint, "elastic", None)
        on_child = turn  # closed to round-off
        if elastic is None and not all(CONSTRAINED[joint.type][3:]):
            on_child = placed[joint.child].rotation @ rotations.to_axis(axis_of(joint))
        start, rate = coordinate(name, joint, placed, states)
        yield SpatialJoint(
            name=name,
            kind=joint.type,
            parent=parent,
            parent_point=parent_frame.local(at_parent),
            parent_turn=parent_frame.rotation.T @ turn,
            child=child,
            child_point=child_frame.local(at_child),
            child_turn=child_frame.rotation.T @ on_child,
            constrained=needed.get(name, CONSTRAINED[joint.type]),
            start=start,
            rate=rate,
            closes=name in model.closures,
            law=joint_law(joint) if elastic is None else IDLE,
            elastic=elastic,
        )


def _origin(placed: Pose, joint: AnyJoint | AnyClosure) -> Vector:
    """Point (3,) m of a joint on its parent: of a slider another one than that on its child."""
    return placed[joint.parent].world(np.array(joint.parent_point_m))


def coordinate(
    name: str, joint: AnyJoint | AnyClosure, placed: Pose, states: Mapping[str, JointState]
) -> tuple[float, float]:
    """Coordinate of a hinge or slider at the start, and its rate; of a closure from the bodies that it joins."""
    if joint.type not in ("hinge", "slider"):
        return 0.0, 0.0
    if name in states:
        return states[name].coordinate, float(states[name].rates[0])
    turn, at_child = joint_frame(joint, placed)
    axis, parent, child = turn[:, 2], placed[joint.parent], placed[joint.child]
    if joint.type == "slider":
        apart, speed = at_child - _origin(placed, joint), child.speed_at(at_child) - parent.speed_at(at_child)
        return float(axis @ apart), float(axis @ speed)
    relative = turn.T @ child.rotation @ rotations.to_axis(axis_of(joint))
    # Which turn it is in can't be known: the one nearest to zero.
    angle = math.atan2(relative[1, 0], relative[0, 0])
    return angle, float(axis @ (child.rate - parent.rate))


def on_ground(model: schema.SpatialModel) -> list[AnyJoint]:
    """Joints on the ground."""
    return [joint for joint in model.all_joints.values() if joint.parent == GROUND]
