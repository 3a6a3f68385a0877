"""The freedoms of a mechanism along its motion: how they move all coordinates, and what acts on them.

Freedoms are the coordinates of joints that nothing prescribes, three of a body that flies free; where loops close, what
of these the loops allow. Links that bend keep their length, and do so in two shapes (Ritz): from the end at which a
joint holds them, sections turn by x / L and (x / L)^2 at x m of L. A clamped link has a first natural frequency that is
0.5 % too high (of four elements 2.7 %), and a second that is 58 % too high. Where there would be more than `MOST`
freedoms, such links count as rigid in the shape that they have.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from granular_contact.mechanics.constraints import together
from granular_contact.mechanics.kinematics import Kinematics
from granular_contact.scene.layout import FREEDOMS
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
    sizes = [0 if one.name in moved else sum(FREEDOMS[one.kind]) for one in tree]
    ends = np.cumsum([0, *sizes]).tolist()
    columns = {joint.name: slice(*both) for joint, both in zip(tree, pairwise(ends), strict=True)}
    bending = _shapes(motion, tree, ends[-1])
    size = max([ends[-1], *(shapes.stop for shapes in bending.values())])
    W, K, D = np.zeros((n, m, size)), np.zeros((n, size, size)), np.zeros((n, size, size))
    turns = Turns(np.zeros((n, size)), np.zeros((n, size, 2)), np.zeros((n, size, 2)))
    for joint in tree:
        if joint.child in bending:
            _bend(motion, joint, bending[joint.child], W, K, D)
            _turn_by_bending(motion, joint, bending[joint.child], W, turns)
        if columns[joint.name].start < columns[joint.name].stop:
            _turn_by_joint(motion, joint, columns[joint.name], turns)
            if joint.has_coordinate:
                i = columns[joint.name].start
                K[:, i, i], D[:, i, i] = slopes(motion, joint, scene.drive(joint.name))
    _carry(motion, turns, _carried(motion, tree, columns, bending, size), W)
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


class Turns(NamedTuple):
    """What freedoms do to all that they carry: a point r moves at s e_z x (r - place) + along.

    s (n, d): turn, counter-clockwise; place (n, d, 2) m; along (n, d, 2).
    """

    s: Vector
    place: Vector
    along: Vector


def _turn_by_joint(motion: Kinematics, joint: Joint, columns: slice, turns: Turns) -> None:
    """Fill in the freedoms of a joint."""
    if joint.kind == "free":  # two ways, and a turn about the centre
        turns.along[:, columns] = [[1.0, 0.0], [0.0, 1.0], [0.0, 0.0]]
        turns.s[:, columns] = [0.0, 0.0, 1.0]
        turns.place[:, columns] = motion.center(joint.child)[0][:, None]
        return
    if joint.axis is not None:
        angle = motion.angle(joint.parent, joint.parent_point)[0] + np.arctan2(joint.axis[1], joint.axis[0])
        turns.along[:, columns.start] = np.column_stack([np.cos(angle), np.sin(angle)])
    if FREEDOMS[joint.kind][1]:  # clockwise
        last = columns.stop - 1
        turns.s[:, last], turns.place[:, last] = -1.0, motion.position(joint.child, joint.child_point)[0]


def _turn_by_bending(motion: Kinematics, joint: Joint, columns: slice, W: Vector, turns: Turns) -> None:
    """Fill in what the shapes of a link that bends, W (n, m, d), do to all that hangs on its other end."""
    handle = motion.system.links[joint.child]
    end = motion.nodes(joint.child)[-1 - handle.end(joint.child_point)]
    turns.s[:, columns], turns.place[:, columns] = 1.0, motion.trajectory.q[:, None, end[:2]]
    turns.along[:, columns] = W[:, end[:2], columns].transpose(0, 2, 1)


def _carried(
    motion: Kinematics, tree: list[Joint], columns: dict[str, slice], bending: dict[str, slice], size: int
) -> dict[str, Vector]:
    """By body which freedoms carry it (d,): 1, else 0."""
    carried: dict[str, Vector] = {}
    held: dict[str, int] = {}  # by link the end at which a joint holds it
    waiting = list(tree)
    while waiting:
        joint = next(one for one in waiting if one.parent is None or one.parent in carried)
        waiting.remove(joint)
        by = np.zeros(size) if joint.parent is None else carried[joint.parent].copy()
        if joint.parent in bending and motion.system.links[joint.parent].end(joint.parent_point) != held[joint.parent]:
            by[bending[joint.parent]] = 1.0
        by[columns[joint.name]] = 1.0
        carried[joint.child] = by
        if joint.child in bending:
            held[joint.child] = motion.system.links[joint.child].end(joint.child_point)
    return carried


def _carry(motion: Kinematics, turns: Turns, carried: dict[str, Vector], W: Vector) -> None:
    """Add to W (n, m, d) how freedoms carry bodies, and the nodes of links."""
    q, rigid = motion.trajectory.q, motion.system.rigid
    bodies = [(motion.system.places(name, np.zeros(2)), by) for name, by in carried.items() if name in rigid]
    nodes = [(node, by) for name, by in carried.items() if name not in rigid for node in motion.nodes(name)]
    x, y = np.array([place[:2] for place, _ in (*bodies, *nodes)]).T
    along, (place_x, place_y), s = turns.along[:, None], turns.place.transpose(2, 0, 1)[:, :, None], turns.s[:, None]
    by = np.array([one for _, one in (*bodies, *nodes)])
    W[:, x] += by * (along[..., 0] - s * (q[:, y, None] - place_y))
    W[:, y] += by * (along[..., 1] + s * (q[:, x, None] - place_x))
    for place, one in bodies:
        W[:, place[2]] = one * turns.s
    for (_, _, tx, ty), one in nodes:
        W[:, tx] -= q[:, ty, None] * one * turns.s
        W[:, ty] += q[:, tx, None] * one * turns.s


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
