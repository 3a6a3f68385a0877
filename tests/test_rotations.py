"""Conversions of rotations, compared with scipy's; orientations at which angles or signs are not unique."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from granular_contact.geometry import rotations

TURNS = Rotation.from_quat(np.random.default_rng(5).normal(size=(200, 4)))
CLOSE = {"rtol": 0.0, "atol": 1e-14}
# Half turns, where the real part of a quaternion is 0, and turns near to them.
HALF_TURNS = [np.pi * axis for axis in (*np.eye(3), np.array([0.6, 0.0, -0.8]))]


def quaternions(turns: Rotation) -> NDArray[np.float64]:
    """Quaternions (n, 4) w, x, y, z; scipy has the real part last."""
    return np.roll(turns.as_quat(), 1, axis=1)


def test_matrices_follow_from_roll_pitch_yaw_and_quaternions() -> None:
    for turn in TURNS:
        np.testing.assert_allclose(rotations.of_rpy(turn.as_euler("xyz")), turn.as_matrix(), **CLOSE)
    np.testing.assert_allclose(rotations.of_quaternion(-3.0 * quaternions(TURNS)), TURNS.as_matrix(), **CLOSE)


def test_roll_pitch_and_yaw_follow_from_matrices() -> None:
    np.testing.assert_allclose(rotations.rpy_of(TURNS.as_matrix()), TURNS.as_euler("xyz"), rtol=0.0, atol=1e-12)


@pytest.mark.parametrize("pitch", [0.5 * np.pi, -0.5 * np.pi])
@pytest.mark.parametrize(("roll", "yaw"), [(0.0, 2.5), (0.7, -0.4), (-2.0, 3.0)])
def test_straight_up_or_down_the_roll_is_zero(roll: float, pitch: float, yaw: float) -> None:
    R = rotations.of_rpy([roll, pitch, yaw])
    angles = rotations.rpy_of(R)
    assert angles[0] == 0.0
    assert angles[1] == pytest.approx(pitch, abs=1e-7)  # arcsin at 1: round-off of 1e-16 is 1e-8 rad
    np.testing.assert_allclose(rotations.of_rpy(angles), R, rtol=0.0, atol=1e-7)


def test_quaternions_follow_from_matrices() -> None:
    for R in (*TURNS.as_matrix(), *(Rotation.from_rotvec(vector).as_matrix() for vector in HALF_TURNS)):
        e = rotations.quaternion_of(R)
        assert np.linalg.norm(e) == pytest.approx(1.0, abs=1e-15)
        assert e[np.abs(e).argmax()] > 0.0
        np.testing.assert_allclose(rotations.of_quaternion(e), R, **CLOSE)


def test_rates_of_quaternions_are_those_of_turning_bodies() -> None:
    """Central differences over 2 h have an error of h^2 |w|^3 / 48 = 1e-8."""
    w, h = np.array([3.0, -2.0, 1.0]), 1e-4
    before, after = (Rotation.from_rotvec(side * h * w) * TURNS for side in (-1.0, 1.0))
    start, ends = quaternions(TURNS), [quaternions(turns) for turns in (before, after)]
    ends = [end * np.sign(np.sum(end * start, axis=1, keepdims=True)) for end in ends]
    rates = rotations.quaternion_rates(start, np.tile(w, (len(start), 1)))
    np.testing.assert_allclose(rates, (ends[1] - ends[0]) / (2.0 * h), rtol=0.0, atol=2e-8)


def test_rotation_vectors_and_matrices_follow_from_each_other() -> None:
    for vector in (*TURNS.as_rotvec(), *HALF_TURNS, np.zeros(3), np.array([0.0, 1e-9, 0.0])):
        R = rotations.of_vector(vector)
        np.testing.assert_allclose(R, Rotation.from_rotvec(vector).as_matrix(), **CLOSE)
        back = rotations.vector_of(R)
        assert np.linalg.norm(back) <= np.pi * (1.0 + 1e-15)
        np.testing.assert_allclose(rotations.of_vector(back), R, **CLOSE)


def test_vector_products_and_frames_of_axes() -> None:
    a, b = np.array([0.3, -1.2, 2.0]), np.array([-0.7, 0.4, 1.1])
    np.testing.assert_allclose(rotations.cross(a) @ b, np.cross(a, b), **CLOSE)
    for axis in (*np.eye(3), -np.eye(3)[2], a, b):
        R = rotations.to_axis(axis)
        np.testing.assert_allclose(R[:, 2], axis / np.linalg.norm(axis), **CLOSE)
        np.testing.assert_allclose(R.T @ R, np.eye(3), **CLOSE)
        assert np.linalg.det(R) == pytest.approx(1.0, abs=1e-14)
