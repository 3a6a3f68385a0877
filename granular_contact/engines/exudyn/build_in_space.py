"""Scene in space -> SpatialSystem: the mechanism in Exudyn, with the granular load on the parts marked as in sand."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Any

import exudyn as exu
import numpy as np
from exudyn import itemInterface as items

from granular_contact.engines.exudyn.build import assembled
from granular_contact.engines.exudyn.coupling import Coupling
from granular_contact.engines.exudyn.joints import add_actions, rigid_marker
from granular_contact.engines.exudyn.views import EngineCoordinates
from granular_contact.geometry import rotations
from granular_contact.mechanics.space.coordinates import coordinate
from granular_contact.mechanics.space.system import SpatialSystem
from granular_contact.mechanics.system import RigidHandle
from granular_contact.sand.space.from_scene import add_part, load_from_scene
from granular_contact.scene.space.layout import CONSTRAINED
from granular_contact.scene.space.types import SpatialJoint, SpatialRigidBody, SpatialScene

# The engine's joint of each kind; for all other joints a generic constraint holds their constrained axes.
ENGINE_JOINTS = {
    "hinge": items.ObjectJointRevoluteZ,
    "slider": items.ObjectJointPrismaticX,
    "ball": items.ObjectJointSpherical,
    "elastic": items.ObjectJointSpherical,
}


def build(scene: SpatialScene) -> SpatialSystem:
    """Build the mechanism of a scene in space in a new Exudyn system, and assemble it."""
    container = exu.SystemContainer()
    mbs = container.AddSystem()
    ground = mbs.AddObject(items.ObjectGround())
    rigid = {body.name: _add_rigid(mbs, body) for body in scene.rigid}
    system = SpatialSystem(
        scene=scene, coordinates=EngineCoordinates(mbs), container=container, mbs=mbs, rigid=rigid, links={}, bed=None
    )
    for joint in scene.joints:
        _constrain(system, ground, joint)
        if joint.has_coordinate or joint.acts:
            add_actions(system, joint, scene.drive(joint.name), partial(coordinate, system, joint))
    bed = _granular_load(system)
    return assembled(replace(system, bed=bed, elements=() if bed is None else bed.load.lines))


def _add_rigid(mbs: Any, body: SpatialRigidBody) -> RigidHandle[SpatialRigidBody]:
    """Add a rigid body, with Euler parameters e; J (3, 3) kg m2: inertia tensor in the body's frame."""
    motion, J = body.motion, body.inertia
    e = rotations.quaternion_of(motion.rotation)
    node = mbs.AddNode(
        items.NodeRigidBodyEP(
            referenceCoordinates=[*motion.position, *e],
            initialVelocities=[*motion.velocity, *rotations.quaternion_rates(e, motion.rate)],
        )
    )
    obj = mbs.AddObject(
        items.ObjectRigidBody(
            mass=body.mass,
            inertia=[J[0, 0], J[1, 1], J[2, 2], J[1, 2], J[0, 2], J[0, 1]],
            nodeNumber=node,
            name=body.name,
        )
    )
    return RigidHandle(body, node, obj)


def _constrain(system: SpatialSystem, ground: Any, joint: SpatialJoint) -> None:
    """Add the constraint of a joint: the engine's joint of its kind, or a generic one.

    A joint that closes a loop has a generic constraint if it constrains fewer axes than its kind.
    """
    if joint.kind == "free":
        return
    mbs = system.mbs
    # The slider of the engine moves along its x axis, the slider of a scene along z.
    axes = np.eye(3)[:, [2, 0, 1]] if joint.kind == "slider" and all(joint.constrained[3:]) else np.eye(3)
    ends = (
        (ground if joint.parent is None else system.rigid[joint.parent].object, joint.parent_point, joint.parent_turn),
        (system.rigid[joint.child].object, joint.child_point, joint.child_turn),
    )
    markers = [rigid_marker(mbs, body, point, turn @ axes) for body, point, turn in ends]
    constrained_axes = [int(is_constrained) for is_constrained in joint.constrained]
    if joint.kind in ENGINE_JOINTS and joint.constrained == CONSTRAINED[joint.kind]:
        mbs.AddObject(ENGINE_JOINTS[joint.kind](markerNumbers=markers))
    elif any(constrained_axes):
        mbs.AddObject(items.ObjectJointGeneric(markerNumbers=markers, constrainedAxes=constrained_axes))


def _granular_load(system: SpatialSystem) -> Coupling | None:
    """Load on all parts in sand, not yet attached; None if there are none."""
    scene = system.scene
    parts = [(handle, part) for handle in system.rigid.values() for part in handle.body.parts if part.in_sand]
    if scene.bed is None or not scene.media or not parts:
        return None
    load = load_from_scene(scene)
    coupling = Coupling(system.mbs, load)
    for handle, part in parts:
        add_part(load, coupling.body(handle.object, in_space=True), part, scene, handle.body.mass)
    return coupling
