"""The medium gives no energy beyond what its bristles can store."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import pairwise
from random import Random

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from support_properties import Array, State, floors, states, static_bound

from granular_contact.laws.static_friction import Elastoplastic

FAST = settings(max_examples=30, deadline=None)
RANDOM = st.randoms(use_true_random=False)


def closed_path(rng: Random) -> Array:
    """Corners (k, 2) m of a closed path from the origin, legs of 1 um to 10 cm."""
    legs = [10.0 ** rng.uniform(-6, -1) * np.array([math.cos(a), math.sin(a)]) for a in _angles(rng)]
    return np.vstack([np.zeros(2), np.cumsum(legs, axis=0), np.zeros(2)])


def _angles(rng: Random) -> Iterator[float]:
    for _ in range(rng.randint(1, 6)):
        yield rng.choice((rng.uniform(-math.pi, math.pi), 0.0, 0.5 * math.pi, math.pi, -0.5 * math.pi))


def carried(body: State, path: Array, steps: int, speed: float) -> float:
    """Work (J) of the medium on a body that is carried along a path without turning.

    Forces at the ends of the steps, after each of which the anchors follow, as implicit integration has it.
    """
    work, start = 0.0, body.P
    body = body.rested()
    for a, b in pairwise(path):
        length = float(np.linalg.norm(b - a))
        if length == 0.0:
            continue
        body = body.with_(V=np.tile(speed * (b - a) / length, (len(start), 1)))
        for share in np.arange(1, steps + 1) / steps:
            body = body.with_(P=start + a + share * (b - a))
            work += float((body.forces()[0] @ (b - a)).sum()) / steps
            body = body.accepted()
    return work


@FAST
@given(states(), RANDOM)
def test_a_closed_path_gives_no_more_than_the_bristles_hold(body: State, rng: Random) -> None:
    path = closed_path(rng)
    work = carried(body, path, rng.choice((3, 10, 20)), 10.0 ** rng.uniform(-4, 1))
    if not isinstance(body.static, Elastoplastic):
        # The direction is that of the velocity: no law and no drag drives. Round-off of what was taken.
        assert work <= 1e-12 * max(1.0, abs(work))
        return
    # Per leg, with the static force of a strip at most B:
    # by component  a component gives while its bristle shortens, once a leg: u_y B / 2 each, u_y B for both;
    # as a whole    until the bristle leans forward it moves by 2 u_y at most, then it swings in as a tractrix,
    #               d(angle)/d(way) = sin(angle) / u_y, where the part of the force along the way is at most
    #               B sin(angle): 2 u_y B and pi/2 u_y B.
    # Steps end where the bristle is shorter than it was on the way, so they give less. Drag only takes.
    bound = static_bound(body, float(body.P[:, 1].min() + path[:, 1].min()))
    share = 1.0 if body.medium is not None and body.medium.by_component else 2.0 + 0.5 * math.pi
    assert work <= share * (len(path) - 1) * body.static.yield_displacement * bound * (1 + 1e-9) + 1e-15


@FAST
@given(states(yields=(1e-9, 1e-8)), RANDOM)
def test_sliding_takes_energy(body: State, rng: Random) -> None:
    """Bristles that hold nothing: there and back, whatever is touched resists."""
    path = np.vstack([np.zeros(2), 0.05 * np.array([math.cos(a := rng.uniform(-4, 4)), math.sin(a)]), np.zeros(2)])
    work = carried(body, path, 20, 0.1)
    if not isinstance(body.static, Elastoplastic):
        return
    bound = static_bound(body, float(body.P[:, 1].min() + path[:, 1].min()))
    assert work <= 8.0 * body.static.yield_displacement * bound + 1e-15  # as above, two legs


@FAST
@given(floors(), RANDOM)
def test_a_floor_gives_back_no_more_than_it_took(body: State, rng: Random) -> None:
    path, steps = closed_path(rng), 20
    work = carried(body, path, steps, 10.0 ** rng.uniform(-3, 1))
    # Forces at the ends of the steps: the spring is off by half its change over a step, stiffness of the whole body x
    # step^2 / 2 a step; the damper only takes.
    lengths = np.linalg.norm(np.diff(body.P, axis=0), axis=1).sum() if body.kind != "ball" else body.run["width"][0]
    legs = np.linalg.norm(np.diff(path, axis=0), axis=1)
    slope = float(body.record["stiffness"][0]) * lengths
    assert work <= 0.5 * slope * float((legs**2).sum()) / steps * (1 + 1e-9) + 1e-15
