"""Static equilibrium that one method of solution found, as a start for another one.

The engine finds the equilibrium (`initial.settle`); a tree begins from it, with the same poses and the same friction
state of the sand and of the joints. Both methods have the same laws on the same lines and facets, so the forces are in
balance there, too.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from granular_contact.geometry import rotations
from granular_contact.mechanics.kinematics import Kinematics
from granular_contact.sand.state import BatchState, batch_states


@dataclass(frozen=True)
class Equilibrium:
    """A scene in static equilibrium.

    scene: the scene with its bodies and the coordinates of its joints in equilibrium, without velocities. batches:
    friction states of its media, in the order of `GranularLoad.batches`. anchors: of the dry friction in joints (rad or
    m), by joint.
    """

    scene: Any
    batches: tuple[BatchState, ...]
    anchors: dict[str, float]


def equilibrium(motion: Kinematics) -> Equilibrium:
    """Static equilibrium at the first instant of a motion, whose system still has its state at that instant."""
    system = motion.system
    rigid = tuple(replace(body, motion=_motion(motion, body)) for body in motion.scene.rigid)
    joints = tuple(_at_rest(motion, joint) for joint in motion.scene.joints)
    batches = () if system.bed is None else batch_states(system.bed.load.batches)
    anchors = {name: load.first_anchor for name, load in system.loads.items()}
    return Equilibrium(replace(motion.scene, rigid=rigid, joints=joints), batches, anchors)


def _motion(motion: Kinematics, body: Any) -> Any:
    """Initial motion of a rigid body at the first instant, without velocity."""
    before, in_space = body.motion, motion.scene.in_space
    position = motion.position(body.name, np.zeros_like(before.position))[0][0]
    if in_space:
        turned: dict[str, Any] = {"rotation": rotations.of_quaternion(motion.quaternion(body.name)[0])}  # type: ignore[attr-defined]
    else:
        turned = {"angle": float(motion.angle(body.name, position)[0][0])}
    return replace(before, position=position, velocity=0.0 * position, rate=0.0 * before.rate, **turned)


def _at_rest(motion: Kinematics, joint: Any) -> Any:
    """A joint with its coordinate at the first instant as start; other joints follow from the poses of their bodies."""
    if not joint.has_coordinate:
        return joint
    return replace(joint, start=float(motion.coordinate(joint)[0][0]), rate=0.0)
