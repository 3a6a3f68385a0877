"""Degrees of freedom of a mechanism in space along its motion, as `mechanics.freedoms` in the plane.

Rates are those of `SpatialKinematics`, six for each body; W spans the null space of the joints' constraints.
Neighbouring elements of a link with many elements move as one rigid body.
"""

from __future__ import annotations

import math
from collections import Counter
from typing import Any

import numpy as np

from granular_contact.geometry.rotations import vector_products
from granular_contact.mechanics.constraints import together
from granular_contact.mechanics.freedoms import followed, null_space, slopes
from granular_contact.mechanics.space.kinematics import SpatialKinematics
from granular_contact.scene.space import modes
from granular_contact.scene.space.types import SpatialBeam, Vector

GROUND = -1
# Degrees of freedom of all flexible links together. With 24 the estimate for a tail of 64 elements is 0.5 % smaller
# than with all 192 and takes a tenth of the time. For 8 elements it is 2 % larger with 12, and 5 % smaller with 3.
BENDING = 48


def freedoms(motion: SpatialKinematics, all_modes: bool = False) -> tuple[Vector, Vector, Vector]:
    """Jacobian W (n, m, d) of the degrees of freedom, and tangent stiffness and damping (n, d, d) of joints.

    all_modes: whether links that move in a few modes may move in all others, too.
    """
    n, scene = len(motion.trajectory.v), motion.scene
    size = elements_together(scene)
    group = groups(scene)
    joints: Any = [joint for joint in scene.joints if group[joint.parent] != group[joint.child]]
    moved = followed(scene)
    rows = [motion.constraints.held(joint) for joint in joints]
    rows += [motion.constraints.moved(joint) for joint in joints if joint.name in moved]
    W = _carried(motion, group)
    if rows and (held := together(rows).J).shape[1]:
        W = W @ null_space(held @ W)
    if scene.modes is not None and not all_modes and size == 1:
        for beam in scene.beams:
            W = W @ null_space(_without_modes(motion, beam) @ W)
    K, D = np.zeros((2, n, W.shape[2], W.shape[2]))
    for joint in joints:
        if joint.name in moved or not (joint.has_coordinate or joint.acts):
            continue
        J = motion.constraints.coordinates(joint).J @ W
        stiffness, damping = (value / size if joint.elastic is not None else value for value in _slopes(motion, joint))
        K += J.transpose(0, 2, 1) @ (stiffness * J)
        D += J.transpose(0, 2, 1) @ (damping * J)
    return W, K, D


def _without_modes(motion: SpatialKinematics, beam: SpatialBeam) -> Vector:
    """Jacobian (n, k, m) of the rotations within a link that are orthogonal to its modes."""
    joints, S = modes.shapes(motion.scene, beam)
    U, _, _ = np.linalg.svd(S.reshape(3 * len(joints), S.shape[2]))
    turns = np.concatenate([motion.constraints.coordinates(joint).J for joint in joints], axis=1)
    return np.asarray(U[:, S.shape[2] :].T @ turns)


def elements_together(scene: Any) -> int:
    """Number of neighbouring elements of flexible links that move as one: `BENDING` degrees of freedom remain at most.

    An odd number: the joint between two such groups is then in the middle of the joints whose compliance it stands for.
    """
    freedoms: int = sum((4 if beam.stretches else 3) * beam.elements for beam in scene.beams)
    return 2 * math.ceil(max(0.0, freedoms / BENDING - 1.0) / 2.0) + 1


def groups(scene: Any) -> dict[str | None, int]:
    """Group by body that moves as one: a single body, or neighbouring elements of a link and the bodies welded to them.

    The ground, None, and bodies welded to it are in the group GROUND.
    """
    size = elements_together(scene)
    group: dict[str | None, int] = {None: GROUND}
    for beam in scene.beams if size > 1 else ():
        names = [name for name, *_ in beam.pieces]
        for elements in np.split(np.array(names, object), range(size // 2 + 1, len(names), size)):
            number = next((group[name] for name in elements if name in group), len(group))
            group |= {name: group.get(name, number) for name in elements}
    return group | {body.name: len(scene.rigid) + i for i, body in enumerate(scene.rigid) if body.name not in group}


def _carried(motion: SpatialKinematics, group: dict[str | None, int]) -> Vector:
    """Jacobian (n, m, 6 g) from the rates of groups to those of bodies.

    Rates of a group: velocity of the centre of its first body, and angular velocity in the world frame; of a single
    body the rates of that body.
    """
    n, m = motion.trajectory.v.shape
    leads: dict[int, str] = {}
    for name in motion.system.rigid:
        if group[name] != GROUND:
            leads.setdefault(group[name], name)
    column = {number: 6 * i for i, number in enumerate(leads)}
    sizes = Counter(group.values())
    jacobian = np.zeros((n, m, 6 * len(leads)))
    for i, name in enumerate(motion.system.rigid):
        if group[name] == GROUND:
            continue
        first = column[group[name]]
        block = jacobian[:, 6 * i : 6 * i + 6, first : first + 6]
        block[:] = np.eye(6)
        if sizes[group[name]] > 1:
            arm = motion.center(name)[0] - motion.center(leads[group[name]])[0]
            block[:, :3, 3:] = vector_products(np.eye(3), arm[:, None]).transpose(0, 2, 1)
            block[:, 3:, 3:] = motion.rotation(name).transpose(0, 2, 1)
    return jacobian


def _slopes(motion: SpatialKinematics, joint: Any) -> tuple[Vector, Vector]:
    """Tangent stiffness and damping of a joint, which broadcast with the rows (n, k, m) of its coordinates."""
    elastic = joint.elastic
    if elastic is None:
        stiffness, damping = slopes(motion, joint, motion.scene.drive(joint.name))
        return stiffness[:, None, None], damping[:, None, None]
    axial = np.reshape(elastic.axial or (), (2, -1))
    return np.append(elastic.stiffness, axial[0])[:, None], np.append(elastic.damping, axial[1])[:, None]
