"""Links that bend in a few of their natural modes (Rayleigh-Ritz): which links can, and the mode shapes.

A link is clamped where it is held, and its frame moves with the element there (floating frame of reference). With the
rotation vector t_k between two elements (`scene.space.beams`), the modal coordinates a_i give t_k(t) = sum_i S_ki
a_i(t). S is computed separately for each axis of the frame, from the straight link with everything that is welded to
its elements,

    K S = omega^2 M S,    K = diag(K_k),    M = sum over its bodies of m Jx^T Jx + Jw^T I Jw,

for the lowest `modes` modes of torsion, of bending about y, and of bending about z. Rotations are finite, and a bent
axis has the length of the straight one. The difference from the modes of a cantilever is proportional to l^2.

The error of the truncation is estimated by `mechanics.space.mode_error`.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from granular_contact.errors import SceneError, scene_fault
from granular_contact.scene.space.types import SpatialBeam, SpatialJoint, SpatialScene, Vector
from granular_contact.scene.types import link_of

IN_MODES = "in space the reduced model is for links that bend, held by one end, with nothing but welds along them"
KEY = "method.reduced.modes"


def check(scene: SpatialScene) -> None:
    """Refuse a scene whose links can't bend in so many modes.

    Raises
    ------
    SceneError
        With the key, all obstacles, and what is supported.
    """
    if scene.modes is None:
        return
    faults = []
    if scene.settle:
        faults.append(scene_fault("method", f"initial.settle is true: {IN_MODES}, from a given start"))
    if scene.modes > 0 and not scene.beams:
        faults.append(scene_fault(KEY, f"got {scene.modes}, but the model has no link that bends: allowed is 0"))
    for beam in scene.beams:
        if obstacles := list(_obstacles(scene, beam)):
            faults.append(scene_fault("method", f"{beam.name} {', and '.join(obstacles)}: {IN_MODES}"))
        elif scene.modes > beam.elements:
            words = (
                f"got {scene.modes}, but {beam.name} has {beam.elements} elements, which have no more modes than that"
            )
            faults.append(scene_fault(KEY, words))
    if faults:
        raise SceneError(faults)


def _obstacles(scene: SpatialScene, beam: SpatialBeam) -> Iterator[str]:
    """Properties of a link that modes do not support, in words."""
    if beam.stretches:
        yield "stretches"
    if len({scene.joint(name).child for name in beam.joints} & {beam.root[0], beam.tip[0]}) > 1:
        yield "is held between its ends"
    outer = {joint.child for joint in outward(scene, beam)}
    carried = [
        link_of(joint.child) for joint in scene.joints if joint.parent in outer and joint.name not in beam.joints
    ]
    if carried:
        yield f"carries {carried[0]}, which moves against it"


def outward(scene: SpatialScene, beam: SpatialBeam) -> list[SpatialJoint]:
    """Joints between the elements of a link, from where it is held to its free end."""
    joints = [scene.joint(name) for name in beam.joints]
    return joints if joints[0].parent == beam.root[0] else joints[::-1]


def shapes(scene: SpatialScene, beam: SpatialBeam) -> tuple[list[SpatialJoint], Vector]:
    """Joints of a link from where it is held outward, and mode shapes S (joints, 3, 3 modes) of their rotation vectors.

    Modes have a modal mass of 1 kg m2: first those of torsion, then of bending about y and about z.
    """
    joints, modes = outward(scene, beam), scene.modes or 0
    axes = scene.body(joints[0].child).motion.rotation @ joints[0].child_turn  # of the link's frame, in the world
    blocks = [np.zeros((len(joints), 3, 0))]
    for axis in range(3):
        M = _mass_matrix(scene, joints, axes[:, axis])
        stiffness = np.sqrt([joint.elastic.stiffness[axis] for joint in joints if joint.elastic is not None])
        inverse_squares, vectors = np.linalg.eigh(M / np.outer(stiffness, stiffness))  # 1 / omega^2, ascending
        lowest = vectors[:, ::-1][:, :modes] / stiffness[:, None] / np.sqrt(inverse_squares[::-1][:modes])
        block = np.zeros((len(joints), 3, modes))
        block[:, axis] = lowest
        blocks.append(block)
    return joints, np.concatenate(blocks, axis=2)


def _mass_matrix(scene: SpatialScene, joints: list[SpatialJoint], axis: Vector) -> Vector:
    """Mass matrix M (joints, joints) for rotations about an axis (3,) of the world, in the initial configuration."""
    bodies = [scene.body(joint.child) for joint in joints]
    points = np.array([body.motion.world(joint.child_point) for body, joint in zip(bodies, joints, strict=True)])
    M = np.zeros((len(joints), len(joints)))
    for k, body in enumerate(bodies):
        x = np.cross(axis, body.motion.position - points[: k + 1])
        turning = body.motion.rotation.T @ axis
        M[: k + 1, : k + 1] += body.mass * x @ x.T + turning @ body.inertia @ turning
    return M
