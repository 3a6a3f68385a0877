"""Links that bend in a few of their natural modes: which links can, and the shapes of the modes (Rayleigh and Ritz).

A link is clamped where it is held, and its frame floats with that element. With t_k the rotation vector between two
elements (`scene.space.beams`), modes are t_k(t) = sum_i S_ki a_i(t). S is found for each axis of the frame alone, from
the straight link with all that is welded to its elements,

    K S = omega^2 M S,    K = diag(K_k),    M = sum over its bodies of m Jx^T Jx + Jw^T I Jw,

the lowest `modes` of torsion, of bending about y and about z. Turns are finite, and a bent axis is as
long as a straight one. What differs from a cantilever's modes goes with l^2.

Modes that are left out would bend by what is out of balance along them: R_k, the moments that the joints between
elements lack, over K_k (the static correction of mode acceleration methods; Craig 1981). Phi^T R = 0 makes it
orthogonal to the modes that are there. Under a load that comes at once they swing twice as far, so that twice its
greatest deflection at the tip is told as the error: 0.5 to 1.2 times the true one in `validation/oblique_modes.py`.
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
    """Refuse a scene whose links can't be in so many modes.

    Raises
    ------
    SceneError
        With its key, every obstacle, and what is supported.
    """
    if scene.modes is None:
        return
    faults = []
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
    """What keeps a link from being in modes."""
    if beam.stretches:
        yield "stretches"
    if len({scene.joint(name).child for name in beam.joints} & {beam.root[0], beam.tip[0]}) > 1:
        yield "is held between its ends"
    moved = {joint.child for joint in outward(scene, beam)}
    carried = [link_of(one.child) for one in scene.joints if one.parent in moved and one.name not in beam.joints]
    if carried:
        yield f"carries {carried[0]}, which moves against it"


def outward(scene: SpatialScene, beam: SpatialBeam) -> list[SpatialJoint]:
    """Joints between the elements of a link, from where it is held to its free end."""
    joints = [scene.joint(name) for name in beam.joints]
    return joints if joints[0].parent == beam.root[0] else joints[::-1]


def shapes(scene: SpatialScene, beam: SpatialBeam) -> tuple[list[SpatialJoint], Vector]:
    """Joints from where a link is held outward, and S (joints, 3, modes) of their rotation vectors, by kg m2 of 1."""
    joints, modes = outward(scene, beam), scene.modes or 0
    root = scene.body(joints[0].child).motion.rotation @ joints[0].child_turn  # axes of the link's frame
    found = [np.zeros((len(joints), 3, 0))]
    for axis in range(3):
        M = _mass(scene, joints, root[:, axis])
        stiffness = np.sqrt([joint.elastic.stiffness[axis] for joint in joints if joint.elastic is not None])
        squares, vectors = np.linalg.eigh(M / np.outer(stiffness, stiffness))  # 1 / omega^2 in ascending order
        lowest = vectors[:, ::-1][:, :modes] / stiffness[:, None] / np.sqrt(squares[::-1][:modes])
        own = np.zeros((len(joints), 3, modes))
        own[:, axis] = lowest
        found.append(own)
    return joints, np.concatenate(found, axis=2)


def error(joints: list[SpatialJoint], length: float, lacks: Vector) -> float:
    """Estimated error (m) of the tip's deflection by the modes that are left out, the greatest over the instants.

    lacks (n, joints, 3) N m: R_k, in the coordinates of the joints, which are those that `shapes` gives.
    """
    stiffness = np.array([joint.elastic.stiffness for joint in joints if joint.elastic is not None])
    turns = np.stack([lacks[:, k] @ joint.parent_turn for k, joint in enumerate(joints)], axis=1) / stiffness
    arm = length * (np.arange(len(joints))[::-1] + 0.5) / len(joints)  # from each joint to the free end
    return 2.0 * float(np.linalg.norm(np.einsum("nkj,k->nj", turns[:, :, 1:], arm), axis=1).max())


def _mass(scene: SpatialScene, joints: list[SpatialJoint], axis: Vector) -> Vector:
    """M (joints, joints) of turns about an axis (3,) of the world, for the mechanism as it starts."""
    bodies = [scene.body(joint.child) for joint in joints]
    at = np.array([body.motion.world(joint.child_point) for body, joint in zip(bodies, joints, strict=True)])
    M = np.zeros((len(joints), len(joints)))
    for k, body in enumerate(bodies):
        x = np.cross(axis, body.motion.position - at[: k + 1])
        turning = body.motion.rotation.T @ axis
        M[: k + 1, : k + 1] += body.mass * x @ x.T + turning @ body.inertia @ turning
    return M
