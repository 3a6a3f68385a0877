"""Degrees of freedom of a mechanism along its motion: their velocity Jacobian, stiffness and damping.

Degrees of freedom are the joint coordinates that are not `followed` and three coordinates of a free-flying body. With
closed loops they are the null space of the loop constraints. Flexible links keep their length and bend in two shapes
(Ritz): seen from the end at which a joint holds the link of length L, the section at x turns by x / L and (x / L)^2.
The first natural frequency of a clamped link is then 0.5 % too high (2.7 % with four elements), the second 58 % too
high. Where this would be more than `MOST` degrees of freedom, flexible links count as rigid in their present shape.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from granular_contact.mechanics.constraints import together
from granular_contact.mechanics.joint_history import targets
from granular_contact.mechanics.kinematics import Kinematics
from granular_contact.scene.layout import FREEDOMS
from granular_contact.scene.types import Drive, Joint, Vector

REGULAR = 1e-8  # of the greatest singular value: constraints with smaller ones are redundant
BENDING = 2  # shapes in which a link bends; one for a link of one element
MOST = 100  # degrees of freedom; the cost of an error estimate grows with their third power
SLIDES = 10.0  # 1/s, rate over `slip` from which friction in a joint counts as sliding


@dataclass(frozen=True)
class Freedoms:
    """Degrees of freedom at n instants: Jacobian W (n, m, d) from their d rates to the rates of m coordinates.

    K, D (n, d, d): tangent stiffness and damping of the forces in joints, and of the bending of links.
    """

    W: Vector
    K: Vector
    D: Vector


def freedoms(motion: Kinematics) -> Freedoms:
    """Degrees of freedom at all instants of a motion."""
    scene, (n, m) = motion.scene, motion.trajectory.q.shape
    moved = followed(scene)
    tree, closures = ([joint for joint in scene.joints if joint.closes is closes] for closes in (False, True))
    sizes = [0 if joint.name in moved else sum(FREEDOMS[joint.kind]) for joint in tree]
    ends = np.cumsum([0, *sizes]).tolist()
    columns = {joint.name: slice(*pair) for joint, pair in zip(tree, pairwise(ends), strict=True)}
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
    Z = null_space(together(held).J @ W)
    Z_T = Z.transpose(0, 2, 1)
    return Freedoms(W @ Z, Z_T @ K @ Z, Z_T @ D @ Z)


def followed(scene: Any) -> set[str]:
    """Joints without a degree of freedom: of prescribed motions, and of drives whose torque or force a program sets.

    Such a program is taken to keep the joint on its motion [ours], as a controller does. With the same torques over
    time in its place, legs that a controller holds up would give way: an estimate was 600 times the error.
    """
    return {drive.joint for drive in scene.drives if drive.kind == "motion" or (drive.kind == "load" and drive.sets)}


def _shapes(motion: Kinematics, tree: list[Joint], size: int) -> dict[str, slice]:
    """Columns of the bending shapes by link, after the columns of joints; none where they would be too many."""
    links, columns, first = motion.system.links, {}, size
    for name in (joint.child for joint in tree if joint.child in links):
        columns[name] = slice(size, size := size + min(BENDING, links[name].link.elements))
    return columns if first == size or size <= MOST else {}


def _bend(motion: Kinematics, joint: Joint, columns: slice, W: Vector, K: Vector, D: Vector) -> None:
    """Fill W, K and D with the bending of a link from the end at which a joint holds it."""
    handle, q = motion.system.links[joint.child], motion.trajectory.q
    link, nodes = handle.link, np.array(motion.nodes(joint.child))
    from_tip = handle.end(joint.child_point) == -1
    x, power = np.linspace(0.0, 1.0, len(nodes)), np.arange(1, columns.stop - columns.start + 1)
    turn = (1.0 - x if from_tip else x)[:, None] ** power
    chords = np.diff(q[:, nodes[:, :2]], axis=1)
    across = np.stack([-chords[..., 1], chords[..., 0]], axis=2)[..., None]
    displacements = np.zeros((len(q), len(nodes), 2, len(power)))
    np.cumsum(across * 0.5 * (turn[1:] + turn[:-1])[:, None], axis=1, out=displacements[:, 1:])
    if from_tip:
        displacements = displacements - displacements[:, -1:]
    slope_rates = np.stack([-q[:, nodes[:, 3]], q[:, nodes[:, 2]]], axis=2)[..., None] * turn[:, None]
    W[:, nodes, columns] = np.concatenate([displacements, slope_rates], axis=2)
    curvatures = power[:, None] * power / (power[:, None] + power - 1.0) / link.length  # integrals of products
    K[:, columns, columns] = link.bending_stiffness * curvatures
    D[:, columns, columns] = link.bending_damping * curvatures


class Turns(NamedTuple):
    """Rigid motion of the carried bodies by each degree of freedom: a point r has velocity s e_z x (r - place) + along.

    s (n, d): angular velocity, counter-clockwise; place (n, d, 2) m; along (n, d, 2); all for a rate of 1.
    """

    s: Vector
    place: Vector
    along: Vector


def _turn_by_joint(motion: Kinematics, joint: Joint, columns: slice, turns: Turns) -> None:
    """Fill in the rigid motions by the degrees of freedom of a joint."""
    if joint.kind == "free":  # two translations, and a rotation about the centre of mass
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
    """Fill in the rigid motions by the bending shapes of a link, W (n, m, d), of all that hangs on its other end."""
    handle = motion.system.links[joint.child]
    end = motion.nodes(joint.child)[-1 - handle.end(joint.child_point)]
    turns.s[:, columns], turns.place[:, columns] = 1.0, motion.trajectory.q[:, None, end[:2]]
    turns.along[:, columns] = W[:, end[:2], columns].transpose(0, 2, 1)


def _carried(
    motion: Kinematics, tree: list[Joint], columns: dict[str, slice], bending: dict[str, slice], size: int
) -> dict[str, Vector]:
    """Mark by body the degrees of freedom that carry it: (d,) with 1 for those, else 0."""
    carried: dict[str, Vector] = {}
    held: dict[str, int] = {}  # by link, the end at which a joint holds it
    waiting = list(tree)
    while waiting:
        joint = next(joint for joint in waiting if joint.parent is None or joint.parent in carried)
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
    """Add to W (n, m, d) the rigid motions of bodies and of the nodes of links by the degrees of freedom."""
    q, rigid = motion.trajectory.q, motion.system.rigid
    bodies = [(motion.system.places(name, np.zeros(2)), marks) for name, marks in carried.items() if name in rigid]
    nodes = [(node, marks) for name, marks in carried.items() if name not in rigid for node in motion.nodes(name)]
    x, y = np.array([places[:2] for places, _ in (*bodies, *nodes)]).T
    along, (place_x, place_y), s = turns.along[:, None], turns.place.transpose(2, 0, 1)[:, :, None], turns.s[:, None]
    all_marks = np.array([marks for _, marks in (*bodies, *nodes)])
    W[:, x] += all_marks * (along[..., 0] - s * (q[:, y, None] - place_y))
    W[:, y] += all_marks * (along[..., 1] + s * (q[:, x, None] - place_x))
    for places, marks in bodies:
        W[:, places[2]] = marks * turns.s
    for (_, _, tx, ty), marks in nodes:
        W[:, tx] -= q[:, ty, None] * marks * turns.s
        W[:, ty] += q[:, tx, None] * marks * turns.s


def slopes(motion: Kinematics, joint: Joint, drive: Drive | None) -> tuple[Vector, Vector]:
    """Tangent stiffness and damping (n,) of all forces along the coordinate of a joint."""
    s, rate = motion.coordinate(joint)
    law = joint.law
    K, D = np.full_like(s, law.stiffness), np.full_like(s, law.damping)
    if law.has_stops:
        beyond = np.maximum(0.0, np.maximum(s - law.upper, law.lower - s))
        K += law.stop_stiffness * (beyond > 0.0)
        D += law.stop_stiffness * law.dissipation * beyond
    if law.friction > 0.0:  # secant, as if linear in the rate: leaves at most twice the departure that sliding leaves
        D += law.friction / np.maximum(np.abs(rate), SLIDES * law.slip)
    if drive is not None and drive.kind == "control":
        target, target_rate = targets(drive, motion.trajectory.time, motion.trajectory.set_to.get(joint.name)).T
        gain = 0.0 if drive.of_rate else drive.gain
        unlimited = np.abs(gain * (target - s) + drive.rate_gain * (target_rate - rate)) < drive.limit
        K += gain * unlimited
        D += drive.rate_gain * unlimited
    return K, D


def null_space(J: Vector) -> Vector:
    """Orthonormal bases (n, d, d - r) of the null spaces of J (n, k, d); r: the greatest rank at any instant."""
    _, values, V_T = np.linalg.svd(J, full_matrices=True)
    rank = int((values > REGULAR * np.max(values, axis=1, keepdims=True)).sum(axis=1).max(initial=0))
    return np.ascontiguousarray(V_T[:, rank:].transpose(0, 2, 1))
