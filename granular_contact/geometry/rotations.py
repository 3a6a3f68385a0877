"""Rotations: matrices R (..., 3, 3) that take components in the frame of a body to components in the outer frame.

Roll, pitch and yaw are those of robot files, R = Rz(yaw) Ry(pitch) Rx(roll). Quaternions are w, x, y, z.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

Vector = NDArray[np.float64]
LOCKED = 1.0 - 1e-12  # sine of the pitch above which roll and yaw can't be distinguished: then roll is 0


def of_rpy(rpy: ArrayLike) -> Vector:
    """Rotation matrix (3, 3) of roll, pitch and yaw (rad)."""
    roll, pitch, yaw = np.asarray(rpy, float)
    cr, sr, cp, sp, cy, sy = (f(a) for a in (roll, pitch, yaw) for f in (math.cos, math.sin))
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )


def rpy_of(R: Vector) -> Vector:
    """Roll, pitch and yaw (..., 3) rad of rotation matrices (..., 3, 3)."""
    pitch = np.arcsin(np.clip(-R[..., 2, 0], -1.0, 1.0))
    locked = np.abs(R[..., 2, 0]) > LOCKED
    roll = np.where(locked, 0.0, np.arctan2(R[..., 2, 1], R[..., 2, 2]))
    yaw = np.where(locked, np.arctan2(-R[..., 0, 1], R[..., 1, 1]), np.arctan2(R[..., 1, 0], R[..., 0, 0]))
    return np.stack([roll, pitch, yaw], axis=-1)


def of_quaternion(quaternion: ArrayLike) -> Vector:
    """Rotation matrices (..., 3, 3) of quaternions (..., 4) of any length."""
    e = np.asarray(quaternion, float)
    w, x, y, z = np.moveaxis(e / np.sqrt(np.sum(e * e, axis=-1, keepdims=True)), -1, 0)
    R = np.empty((*e.shape[:-1], 3, 3))
    R[..., 0, 0], R[..., 0, 1], R[..., 0, 2] = 1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)
    R[..., 1, 0], R[..., 1, 1], R[..., 1, 2] = 2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)
    R[..., 2, 0], R[..., 2, 1], R[..., 2, 2] = 2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)
    return R


def quaternion_of(R: Vector) -> Vector:
    """Unit quaternion (4,) of a rotation matrix (3, 3); its component of greatest magnitude is positive."""
    trace = np.trace(R)
    squares = 0.25 * (1.0 + np.array([trace, *(2.0 * np.diag(R) - trace)]))
    k = int(squares.argmax())
    pairs = {
        0: [4.0 * squares[0], R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]],
        1: [R[2, 1] - R[1, 2], 4.0 * squares[1], R[0, 1] + R[1, 0], R[0, 2] + R[2, 0]],
        2: [R[0, 2] - R[2, 0], R[0, 1] + R[1, 0], 4.0 * squares[2], R[1, 2] + R[2, 1]],
        3: [R[1, 0] - R[0, 1], R[0, 2] + R[2, 0], R[1, 2] + R[2, 1], 4.0 * squares[3]],
    }
    quaternion = np.array(pairs[k], float)
    return np.asarray(quaternion / np.linalg.norm(quaternion))


def quaternion_rates(e: Vector, w: Vector) -> Vector:
    """Rates (..., 4) of unit quaternions (..., 4) at angular velocities (..., 3) rad/s in the outer frame."""
    e_0, e_1 = e[..., :1], e[..., 1:]
    scalar_part = np.sum(w * e_1, axis=-1, keepdims=True)
    return np.asarray(0.5 * np.concatenate([-scalar_part, e_0 * w + vector_products(w, e_1)], axis=-1))


def cross(w: ArrayLike) -> Vector:
    """Matrix (3, 3) of the vector product with w (3,)."""
    x, y, z = np.asarray(w, float)
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def vector_products(a: Vector, b: Vector) -> Vector:
    """Vector products a x b (..., 3) of vectors (..., 3); `np.cross` takes three times as long for a thousand."""
    (a_x, a_y, a_z), (b_x, b_y, b_z) = ([v[..., i] for i in range(3)] for v in (a, b))
    return np.stack([a_y * b_z - a_z * b_y, a_z * b_x - a_x * b_z, a_x * b_y - a_y * b_x], axis=-1)


def about(axis: Vector, angle: float) -> Vector:
    """Matrix (3, 3) of a right-handed rotation about a unit axis (3,) by an angle (rad)."""
    K = cross(axis)
    return np.asarray(np.eye(3) + math.sin(angle) * K + (1.0 - math.cos(angle)) * (K @ K))


def of_vector(turn: Vector) -> Vector:
    """Rotation matrix (3, 3) of a rotation vector (3,) rad."""
    angle = float(np.linalg.norm(turn))
    return np.eye(3) if angle == 0.0 else about(turn / angle, angle)


def vector_of(R: Vector) -> Vector:
    """Rotation vector (3,) rad of a rotation matrix (3, 3), of at most half a turn."""
    e = quaternion_of(R)
    e = e if e[0] >= 0.0 else -e
    size = float(np.linalg.norm(e[1:]))
    return np.zeros(3) if size == 0.0 else np.asarray(2.0 * math.atan2(size, float(e[0])) / size * e[1:])


def to_axis(axis: Vector) -> Vector:
    """A rotation matrix (3, 3) whose z axis is the direction of `axis` (3,)."""
    z = axis / np.linalg.norm(axis)
    side = np.eye(3)[int(np.abs(z).argmin())]
    x = vector_products(side, z)
    x /= np.linalg.norm(x)
    return np.column_stack([x, vector_products(z, x), z])
