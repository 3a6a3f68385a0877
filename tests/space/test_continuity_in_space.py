"""The force on a body in space is a continuous function of its place and motion, or states have no step."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from support_jumps import jump
from support_space import PAIRS, SAND, Array, load_on, state

from granular_contact import Box
from granular_contact.laws.reece import Reece
from granular_contact.laws.static_friction import Elastoplastic, Smooth
from granular_contact.sand.space.load import SpatialLoad

SINKAGE = Reece(1330.0, 20.0, 1.2, 29.0, cohesion=300.0, plate_width=0.05), Box((0.1, 0.07, 0.05))
CASES = {**PAIRS, "reece": SINKAGE}
POINTS, CLOSEST, HALVINGS = 100, 4, 40


@pytest.mark.parametrize("static", [Elastoplastic(1e-4, 1e-3), Smooth(0.01)], ids=["bristles", "smooth"])
@pytest.mark.parametrize("name", CASES)
def test_the_force_is_continuous(name: str, static: Any) -> None:
    """Along ways from one random state to another: where the force changes most they are halved until they are one."""
    load, rng, jumps = load_on(*CASES[name], static=static), np.random.default_rng(7), []
    for i in range(12):
        begin, at = _way(rng, aside=(1e-5, 2e-4, 2e-4)[i % 3], fast=(1.0, 1.0, 1e-3)[i % 3])
        load.start(begin)
        jumps += _greatest_jumps(_along(load, at))
    assert len(jumps) > 3 * CLOSEST
    # 2^-40 of 1 m/s and of 1 cm, where the steepest slopes are 1e5 /m: far below what a jump is.
    assert max(jumps) < 1e-7


def test_the_force_is_continuous_where_a_face_leads_by_its_turn_alone() -> None:
    """A box slides slowly along a face and away from it, and turns: a part of the face follows its bristle inward.

    As the bristle at the centroid comes to lie along the face, only the turn decides whether any of it leads.
    """
    load = load_on(SAND, Box((0.1, 0.07, 0.05)), size=1.0, static=Elastoplastic(1e-4, 0.0))  # a facet a face
    velocity, spin = np.array([-1e-4, 1e-4, 0.0]), np.array([0.0, 0.0, 2.8e-3])  # 0.98e-4 m/s at 35 mm: all moves away

    def force(x: float) -> Array:
        return load.force(*state(np.array([x, 1e-4, -0.02]), Rotation.identity(), velocity, spin), np.zeros(7))

    load.start(state(np.array([0.0, 0.0, -0.02]), Rotation.identity(), velocity, spin)[0])
    # Some 20 N over u_y are 2e5 N/m: 4e-7 N over 2e-12 m. What leads by its turn bears 0.02 N.
    np.testing.assert_allclose(force(-1e-12), force(1e-12), atol=1e-5)


def test_force_is_continuous_where_the_centroid_of_a_turning_facet_rests() -> None:
    """There the velocity of the middle has any direction, and only other places of the facet slide."""
    load = load_on(SAND, Box((0.1, 0.07, 0.05)), size=1.0, static=Elastoplastic(1e-5, 1e-3))  # a facet a face
    load.start(state(np.array([0.0, 0.0, -0.04]), Rotation.identity(), np.zeros(3), np.zeros(3))[0])
    middle, spin = np.array([0.05, 0.0, 0.0]), np.array([0.0, 0.2, 0.1])  # of the face ahead

    def force(x: float) -> Array:
        velocity = np.array([x, 0.0, 0.0]) - np.cross(spin, middle)
        return load.force(*state(np.array([2e-5, 0.0, -0.04]), Rotation.identity(), velocity, spin), np.zeros(7))

    # Some 100 N over STILL u_y / T, 1e-4 m/s, are 1e6 N per m/s.
    np.testing.assert_allclose(force(-1e-12), force(1e-12), atol=1e-5)


def _way(rng: np.random.Generator, aside: float, fast: float) -> tuple[Array, Callable[[float], tuple[Array, Array]]]:
    """Coordinates where bristles are at rest, so far aside (m), and coordinates and rates (7,) at s in [0, 1].

    fast: of the usual velocities.
    """
    place, turn = np.array([0.0, 0.0, rng.uniform(-0.06, 0.03)]), Rotation.from_quat(rng.normal(size=4))
    begin, _ = state(place + rng.normal(size=3) * aside, turn, np.zeros(3), np.zeros(3))
    far = rng.integers(2) * rng.normal(size=6) * np.repeat([0.01, 0.1], 3)  # half of the ways are of motions alone
    linear, quadratic = rng.normal(size=(2, 6)) * np.repeat([0.3, 3.0], 3) * fast

    def at(s: float) -> tuple[Array, Array]:
        v = (1.0 - s) * linear + s * quadratic
        return state(place + s * far[:3], Rotation.from_rotvec(s * far[3:]) * turn, v[:3], v[3:])

    return begin, at


def _along(load: SpatialLoad, at: Callable[[float], tuple[Array, Array]]) -> Callable[[float], Array]:
    """Force (7,) of a load at s."""
    return lambda s: load.force(*at(s), np.zeros(7))


def _greatest_jumps(force: Callable[[float], Array]) -> list[float]:
    """Jumps of a force (7,) along s in [0, 1], over its greatest, at the CLOSEST places; none where nothing acts."""
    places = np.linspace(0.0, 1.0, POINTS)
    forces = [force(s) for s in places]
    scale = np.repeat([np.abs(forces)[:, :3].max(), np.abs(forces)[:, 3:].max()], [3, 4])
    if not scale.any():
        return []
    scale[scale == 0.0] = 1.0  # a ball has no moment
    changes = [np.abs((b - a) / scale).max() for a, b in pairwise(forces)]
    return [jump(lambda s: force(s) / scale, *places[i : i + 2], HALVINGS) for i in np.argsort(changes)[-CLOSEST:]]
