"""The freedoms of a mechanism along its motion: how they move all coordinates, and what acts on them in joints.

Links that bend count as rigid in the shape that they have. Freedoms are the coordinates of joints that nothing
prescribes, three of a body that flies free; where loops close, what of these the loops allow.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from granular_contact.mechanics.constraints import together
from granular_contact.mechanics.kinematics import Kinematics
from granular_contact.scene.types import Drive, Joint, Vector

REGULAR = 1e-8  # of the greatest singular value: what is less is no constraint of its own
SLIDES = 10.0  # slips a second, from which on friction in a joint slides


@dataclass(frozen=True)
class Freedoms:
    """Of n instants, m coordinates and d freedoms: W (n, m, d), rates of the coordinates by those of the freedoms.

    K, D (n, d, d): stiffness and damping of what acts in joints.
    """

    W: Vector
    K: Vector
    D: Vector


def freedoms(motion: Kinematics) -> Freedoms:
    """The freedoms along a motion, at all of its instants."""
    scene, (n, m) = motion.scene, motion.trajectory.q.shape
    moved = {drive.joint for drive in scene.drives if drive.kind == "motion"}
    tree, closures = ([joint for joint in scene.joints if joint.closes is closes] for closes in (False, True))
    columns, size = {}, 0
    for joint in tree:
        columns[joint.name] = size
        size += 3 if joint.kind == "free" else int(joint.has_coordinate and joint.name not in moved)
    twists = _twists(motion, tree, columns, moved, size)
    W, K, D = np.zeros((n, m, size)), np.zeros((n, size, size)), np.zeros((n, size, size))
    for name, twist in twists.items():
        _move(motion, name, twist, W)
    for joint in tree:
        if joint.has_coordinate and joint.name not in moved:
            i = columns[joint.name]
            K[:, i, i], D[:, i, i] = slopes(motion, joint, scene.drive(joint.name))
    if not closures:
        return Freedoms(W, K, D)
    held = [motion.constraints.held(joint) for joint in closures]
    held += [motion.constraints.moved(joint) for joint in closures if joint.name in moved]
    Z = left_by(together(held).J @ W)
    turned = Z.transpose(0, 2, 1)
    return Freedoms(W @ Z, turned @ K @ Z, turned @ D @ Z)


def _twists(
    motion: Kinematics, tree: list[Joint], columns: dict[str, int], moved: set[str], size: int
) -> dict[str, Vector]:
    """Of each body the rates (n, 3, size) of its centre (x, y) and of its turn, counter-clockwise."""
    twists: dict[str, Vector] = {}
    waiting = list(tree)
    while waiting:
        joint = next(one for one in waiting if one.parent is None or one.parent in twists)
        waiting.remove(joint)
        twist, i = np.zeros((len(motion.trajectory.time), 3, size)), columns[joint.name]
        twists[joint.child] = twist
        if joint.kind == "free":
            twist[:, [0, 1, 2], [i, i + 1, i + 2]] = 1.0
            continue
        place = motion.position(joint.child, joint.child_point)[0]
        if joint.parent is not None:
            twist[:] = _at(twists[joint.parent], place - motion.center(joint.parent)[0])
        if joint.name not in moved and joint.kind == "slider":
            assert joint.axis is not None
            angle = motion.angle(joint.parent, joint.parent_point)[0] + np.arctan2(joint.axis[1], joint.axis[0])
            twist[:, 0, i], twist[:, 1, i] = np.cos(angle), np.sin(angle)
        elif joint.name not in moved and joint.kind == "hinge":
            twist[:, 2, i] = -1.0  # coordinates of hinges turn clockwise
        twist[:] = _at(twist, motion.center(joint.child)[0] - place)
    return twists


def _at(twist: Vector, arm: Vector) -> Vector:
    """The twist (n, 3, size) as of a point that is farther by arm (n, 2) m."""
    there = twist.copy()
    there[:, 0] -= arm[:, 1:] * twist[:, 2]
    there[:, 1] += arm[:, :1] * twist[:, 2]
    return there


def _move(motion: Kinematics, name: str, twist: Vector, W: Vector) -> None:
    """Fill the rows of a body's coordinates in W."""
    if name in motion.system.rigid:
        W[:, motion.system.places(name, np.zeros(2))] = twist
        return
    center, q = motion.center(name)[0], motion.trajectory.q
    for node in motion.nodes(name):
        W[:, node[:2]] = _at(twist, q[:, node[:2]] - center)[:, :2]
        W[:, node[2]], W[:, node[3]] = -q[:, node[3], None] * twist[:, 2], q[:, node[2], None] * twist[:, 2]


def slopes(motion: Kinematics, joint: Joint, drive: Drive | None) -> tuple[Vector, Vector]:
    """Stiffness and damping (n,) of all that acts along the coordinate of a joint."""
    s, rate = motion.coordinate(joint)
    law = joint.law
    K, D = np.full_like(s, law.stiffness), np.full_like(s, law.damping)
    if law.has_stops:
        beyond = np.maximum(0.0, np.maximum(s - law.upper, law.lower - s))
        K += law.stop_stiffness * (beyond > 0.0)
        D += law.stop_stiffness * law.dissipation * beyond
    if law.friction > 0.0:  # as if it grew with the rate: no more than twice what sliding leaves of a departure
        D += law.friction / np.maximum(np.abs(rate), SLIDES * law.slip)
    if drive is not None and drive.kind == "control":
        signal = [(drive.signal.value(t), drive.signal.rate(t)) for t in motion.trajectory.time.tolist()]
        value, wanted = np.transpose(signal)
        gain, wanted = (0.0, value) if drive.of_rate else (drive.gain, wanted)
        acts = np.abs(gain * (value - s) + drive.rate_gain * (wanted - rate)) < drive.limit
        K += gain * acts
        D += drive.rate_gain * acts
    return K, D


def left_by(J: Vector) -> Vector:
    """What rows J (n, k, d) leave of d freedoms, (n, d, the fewest at any instant)."""
    _, values, turned = np.linalg.svd(J, full_matrices=True)
    rank = int((values > REGULAR * np.max(values, axis=1, keepdims=True)).sum(axis=1).max(initial=0))
    return np.ascontiguousarray(turned[:, rank:].transpose(0, 2, 1))
