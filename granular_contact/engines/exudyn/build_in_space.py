"""Scene in space -> SpatialSystem: the mechanism in Exudyn, with the granular load on its parts in sand."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Any

import exudyn as exu
import numpy as np
from exudyn import itemInterface as items

from granular_contact.engines.exudyn.build import assembled
from granular_contact.engines.exudyn.coupling import Coupling
from granular_contact.engines.exudyn.joints import let_act, rigid_marker
from granular_contact.engines.exudyn.views import EngineCoordinates
from granular_contact.geometry import rotations
from granular_contact.mechanics.space.coordinates import coordinate
from granular_contact.mechanics.space.system import SpatialSystem
from granular_contact.mechanics.system import RigidHandle
from granular_contact.sand.space.from_scene import add_part, load_from_scene
from granular_contact.scene.space.layout import CONSTRAINED
from granular_contact.scene.space.types import SpatialJoint, SpatialRigidBody, SpatialScene

WHOLE = {
    "hinge": items.ObjectJointRevoluteZ,
    "slider": items.ObjectJointPrismaticX,
    "ball": items.ObjectJointSpherical,
    "elastic": items.ObjectJointSpherical,
}  # of others the constraint has the axes that are held


def build(scene: SpatialScene) -> SpatialSystem:
    """Set the scene up in Exudyn and assemble it, once."""
    container = exu.SystemContainer()
    mbs = container.AddSystem()
    ground = mbs.AddObject(items.ObjectGround())
    rigid = {body.name: _add(mbs, body) for body in scene.rigid}
    system = SpatialSystem(
        scene=scene, coordinates=EngineCoordinates(mbs), container=container, mbs=mbs, rigid=rigid, links={}, bed=None
    )
    for joint in scene.joints:
        _constrain(system, ground, joint)
        if joint.has_coordinate or joint.acts:
            let_act(system, joint, scene.drive(joint.name), partial(coordinate, system, joint))
    return assembled(replace(system, bed=_granular_load(system)))


def _add(mbs: Any, body: SpatialRigidBody) -> RigidHandle[SpatialRigidBody]:
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
    """Constraint of a joint: the engine's own of its kind, or of what is left of it where it closes a loop."""
    if joint.kind == "free":
        return
    mbs = system.mbs
    # The engine's slider has its axis along x.
    order = np.eye(3)[:, [2, 0, 1]] if joint.kind == "slider" and all(joint.constrained[3:]) else np.eye(3)
    ends = (
        (ground if joint.parent is None else system.rigid[joint.parent].object, joint.parent_point, joint.parent_turn),
        (system.rigid[joint.child].object, joint.child_point, joint.child_turn),
    )
    markers = [rigid_marker(mbs, body, point, turn @ order) for body, point, turn in ends]
    held = [int(one) for one in joint.constrained]
    if joint.kind in WHOLE and joint.constrained == CONSTRAINED[joint.kind]:
        mbs.AddObject(WHOLE[joint.kind](markerNumbers=markers))
    elif any(held):
        mbs.AddObject(items.ObjectJointGeneric(markerNumbers=markers, constrainedAxes=held))


def _granular_load(system: SpatialSystem) -> Coupling | None:
    """Load on all parts in sand, to be attached; None when there are none."""
    scene = system.scene
    parts = [(h, part) for h in system.rigid.values() for part in h.body.parts if part.in_sand]
    if scene.bed is None or not scene.media or not parts:
        return None
    load = load_from_scene(scene)
    coupling = Coupling(system.mbs, load)
    for handle, part in parts:
        add_part(load, coupling.body(handle.object, in_space=True), part, scene, handle.body.mass)
    return coupling
