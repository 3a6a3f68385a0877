"""Scene -> Tree: bodies from the ground outward, and all that the medium meets on them, as the kernels read it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from granular_contact.bed.contact_lines import Body
from granular_contact.bed.load import GranularLoad
from granular_contact.bed.of_scene import lines_of, load_of
from granular_contact.kernels.kinematics import STATION
from granular_contact.kernels.law import LAW, LINE
from granular_contact.kernels.tree import BODY, motion
from granular_contact.kernels.tree_load import TreeArrays
from granular_contact.multibody.system import RigidHandle, System
from granular_contact.scene.types import Joint, RigidBody, Scene, Vector
from granular_contact.scene.workspace import can_be_immersed


class Numbers:
    """Stands where observers ask an Exudyn system how it numbers coordinates.

    Body i has the coordinates 3 i to 3 i + 2: x and y of its centre of mass and its angle, without reference values.
    """

    def __init__(self, bodies: int) -> None:
        self.bodies = bodies
        self.systemData = self

    def GetNodeLTGODE2(self, node: int) -> list[int]:
        """Coordinates of a body."""
        return [3 * node, 3 * node + 1, 3 * node + 2]

    def ODE2Size(self) -> int:
        """Number of coordinates."""
        return 3 * self.bodies


@dataclass(frozen=True)
class Tree:
    """A scene in minimal coordinates.

    system: for observers, with its bodies in the kernels' order; load: None where the medium meets nothing; start:
    state of `kernels.tree_load`.
    """

    system: System
    load: GranularLoad | None
    arrays: TreeArrays
    start: Vector

    @property
    def scene(self) -> Scene:
        """The scene."""
        return self.system.scene


def tree(scene: Scene) -> Tree:
    """Set up a scene that `scene.minimal_support` allows."""
    joints = outward(scene.joints)
    bodies = [body for joint in joints for body in scene.rigid if body.name == joint.child]
    handles = {body.name: RigidHandle(body, i, i) for i, body in enumerate(bodies)}
    system = System(scene, None, Numbers(len(bodies)), handles, {}, None)
    load = _granular_load(scene, bodies)
    start = np.concatenate([[b.motion.angle for b in bodies], [b.motion.rate for b in bodies], [0.0]])
    return Tree(system, load, _arrays_of(system, joints, bodies, load), start)


def _granular_load(scene: Scene, bodies: list[RigidBody]) -> GranularLoad | None:
    """Load on all shapes that can reach the surface; None when there are none."""
    if scene.bed is None or not scene.media:
        return None
    load, strips = load_of(scene), scene.load.strips_per_rigid_part
    for i, body in enumerate(bodies):
        for shape in body.shapes:
            if can_be_immersed(scene.bed, body, shape):
                load.add(lines_of(Body(body.name, 3 * i + np.arange(3)), shape, strips))
    load.close()
    return load if load.lines else None


def outward(joints: tuple[Joint, ...]) -> list[Joint]:
    """Joints in an order in which every parent comes before its children."""
    of_parent: dict[str | None, list[Joint]] = {}
    for joint in joints:
        of_parent.setdefault(joint.parent, []).append(joint)
    ordered, waiting = [], of_parent.pop(None, [])[::-1]
    while waiting:
        ordered.append(waiting.pop())
        waiting += of_parent.pop(ordered[-1].child, [])[::-1]
    return ordered


def _arrays_of(system: System, joints: list[Joint], bodies: list[RigidBody], load: GranularLoad | None) -> TreeArrays:
    records = np.zeros(len(bodies), BODY)
    for record, joint, body in zip(records, joints, bodies, strict=True):
        record["parent"] = -1 if joint.parent is None else system.rigid[joint.parent].node
        record["on_parent"], record["hinge"] = joint.parent_point, joint.child_point
        record["mass"], record["inertia"] = body.mass, body.inertia
        record["radius"] = system.scene.radius(body)
    gravity, nowhere = np.array([system.scene.gravity]), np.zeros(3 * len(bodies))
    return TreeArrays(records, gravity, motion(len(bodies)), nowhere, *_sand(load))


def _sand(load: GranularLoad | None) -> tuple[NDArray[Any], ...]:
    """The fields of `TreeArrays` from active to proximity."""
    if load is None:
        flat, places = np.zeros((1, 2)), np.zeros((0, 2), np.int64)
        nothing = np.zeros((1, 2), np.int64), places, np.zeros(0, STATION), np.zeros(0, LINE)
        medium, work = np.zeros(1, LAW), (np.zeros((0, 2)), np.zeros((7, 0, 2)), np.zeros((0, 0)))
        return np.zeros(0, dtype=bool), *nothing, flat, medium, *work, np.zeros((0, 3), np.int64), np.zeros((0, 3))
    (batch,) = load.batches  # of one medium on bodies of one kind, or the scene was refused
    return (
        batch.active, batch.ends, batch.places, batch.geometry, batch.records, batch.profile, batch.medium,
        batch.anchors, *batch.work, batch.columns, batch.proximity,
    )  # fmt: skip
