"""The freedoms of a mechanism along its motion: how they move all coordinates, and what acts on them.

Freedoms are the coordinates of joints that nothing prescribes, three of a body that flies free; where loops close, what
of these the loops allow. Links that bend keep their length, and do so in two shapes (Ritz): from the end at which a
joint holds them, sections turn by x / L and (x / L)^2 at x m of L. A clamped link has a first natural frequency that is
0.5 % too high (of four elements 2.7 %), and a second that is 58 % too high. Where there would be more than `MOST`
freedoms, such links count as rigid in the shape that they have.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from granular_contact.mechanics.constraints import together
from granular_contact.mechanics.kinematics import Kinematics
from granular_contact.scene.types import Drive, Joint, Vector

REGULAR = 1e-8  # of the greatest singular value: what is less is no constraint of its own
BENDING = 2  # shapes in which a link bends, fewer where it has fewer elements
MOST = 100  # freedoms, by the third power of which an estimate grows
SLIDES = 10.0  # slips a second, from which on friction in a joint slides


@dataclass(frozen=True)
class Freedoms:
    """Of n instants, m coordinates and d freedoms: W (n, m, d), rates of the coordinates by those of the freedoms.

    K, D (n, d, d): stiffness and damping of what acts in joints, and of links as they bend.
    """

    W: Vector
    K: Vector
    D: Vector


def freedoms(motion: Kinematics) -> Freedoms:
    """The freedoms along a motion, at all of its instants."""
    scene, (n, m) = motion.scene, motion.trajectory.q.shape
    moved = {drive.joint for drive in scene.drives if drive.kind == "motion"}
    tree, closures = ([joint for joint in scene.joints if joint.closes is closes] for closes in (False, True))
    sizes = [3 if one.kind == "free" else int(one.has_coordinate and one.name not in moved) for one in tree]
    ends = np.cumsum([0, *sizes])
    columns, size = {joint.name: int(end) for joint, end in zip(tree, ends[:-1], strict=True)}, int(ends[-1])
    bending = _shapes(motion, tree, size)
    size = max([size, *(shapes.stop for shapes in bending.values())])
    W, K, D = np.zeros((n, m, size)), np.zeros((n, size, size)), np.zeros((n, size, size))
    for joint in (one for one in tree if one.child in bending):
        _bend(motion, joint, bending[joint.child], W, K, D)
    for name, twist in _twists(motion, tree, columns, moved, W).items():
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


def _shapes(motion: Kinematics, tree: list[Joint], size: int) -> dict[str, slice]:
    """Columns of the shapes in which links bend, after those of joints; none where they would be too many."""
    links, found, first = motion.system.links, {}, size
    for name in (joint.child for joint in tree if joint.child in links):
        found[name] = slice(size, size := size + min(BENDING, links[name].link.elements))
    return found if first == size or size <= MOST else {}


def _bend(motion: Kinematics, joint: Joint, columns: slice, W: Vector, K: Vector, D: Vector) -> None:
    """Fill in how a link bends from the end at which a joint holds it: its sections turn by powers of the way there."""
    handle, q = motion.system.links[joint.child], motion.trajectory.q
    link, nodes = handle.link, np.array(motion.nodes(joint.child))
    from_tip = handle.end(joint.child_point) == -1
    along, power = np.linspace(0.0, 1.0, len(nodes)), np.arange(1, columns.stop - columns.start + 1)
    turn = (1.0 - along if from_tip else along)[:, None] ** power
    steps = np.diff(q[:, nodes[:, :2]], axis=1)
    across = np.stack([-steps[..., 1], steps[..., 0]], axis=2)[..., None]
    moved = np.zeros((len(q), len(nodes), 2, len(power)))
    np.cumsum(across * 0.5 * (turn[1:] + turn[:-1])[:, None], axis=1, out=moved[:, 1:])
    if from_tip:
        moved = moved - moved[:, -1:]
    tilted = np.stack([-q[:, nodes[:, 3]], q[:, nodes[:, 2]]], axis=2)[..., None] * turn[:, None]
    W[:, nodes, columns] = np.concatenate([moved, tilted], axis=2)
    curvatures = power[:, None] * power / (power[:, None] + power - 1.0) / link.length  # integrals of their products
    K[:, columns, columns] = link.bending_stiffness * curvatures
    D[:, columns, columns] = link.bending_damping * curvatures


def _twists(
    motion: Kinematics, tree: list[Joint], columns: dict[str, int], moved: set[str], W: Vector
) -> dict[str, Vector]:
    """Of each body the rates (n, 3, d) of its centre (x, y) and of its turn, counter-clockwise.

    W (n, m, d): how links bend, which what hangs on them follows.
    """
    twists: dict[str, Vector] = {}
    waiting = list(tree)
    while waiting:
        joint = next(one for one in waiting if one.parent is None or one.parent in twists)
        waiting.remove(joint)
        twist, i = np.zeros((len(W), 3, W.shape[2])), columns[joint.name]
        twists[joint.child] = twist
        if joint.kind == "free":
            twist[:, [0, 1, 2], [i, i + 1, i + 2]] = 1.0
            continue
        place = motion.position(joint.child, joint.child_point)[0]
        if joint.parent is not None:
            twist[:] = _at(twists[joint.parent], place - motion.center(joint.parent)[0])
            if joint.parent in motion.system.links:
                twist += _end(motion, joint, W)
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


def _end(motion: Kinematics, joint: Joint, W: Vector) -> Vector:
    """Rates (n, 3, d) of the end of the parent of a joint by how this bends, W (n, m, d)."""
    node = motion.system.places(joint.parent or "", joint.parent_point)
    x, y = motion.trajectory.q[:, node[2:]].T[:, :, None]
    turn = (x * W[:, node[3]] - y * W[:, node[2]]) / (x**2 + y**2)
    return np.concatenate([W[:, node[:2]], turn[:, None]], axis=1)


def _move(motion: Kinematics, name: str, twist: Vector, W: Vector) -> None:
    """Add a body's rates to the rows of its coordinates in W."""
    if name in motion.system.rigid:
        W[:, motion.system.places(name, np.zeros(2))] = twist
        return
    center, q = motion.center(name)[0], motion.trajectory.q
    for node in motion.nodes(name):
        W[:, node[:2]] += _at(twist, q[:, node[:2]] - center)[:, :2]
        W[:, node[2]] -= q[:, node[3], None] * twist[:, 2]
        W[:, node[3]] += q[:, node[2], None] * twist[:, 2]


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
