"""Forces are finite everywhere, continuous, and those of a straight bar do not depend on how it is cut."""

from __future__ import annotations

import math
from random import Random

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from support_jumps import jump
from support_properties import COMMON, LEVEL, Array, State, floors, states

from granular_contact.laws.static_friction import Elastoplastic, Smooth
from granular_contact.laws.table import StressTable

FAST = settings(max_examples=100, deadline=None)
RANDOM = st.randoms(use_true_random=False)
ANY = st.one_of(states(), states(), states(), floors())
SIZES = (0.0, 1e-300, 1e-160, 1e-12, 1e-9, 1e-3, 1.0, 1e3)


@FAST
@given(ANY, RANDOM)
def test_forces_are_finite(body: State, rng: Random) -> None:
    """Depths, velocities and lengths of strips from nothing to a kilometre, in any combination."""
    n = len(body.P)
    lengths = [rng.choice(SIZES) for _ in range(n - 1)]
    heading = rng.choice((0.0, 0.5 * math.pi, rng.uniform(-math.pi, math.pi)))
    along = np.concatenate([[0.0], np.cumsum(lengths if body.kind != "ball" else [0.0])])
    P = along[:, None] * np.array([math.cos(heading), math.sin(heading)])
    P[:, 1] += -rng.choice((1.0, 1.0, -1.0)) * rng.choice(SIZES) - (P[:, 1].min() if rng.random() < 0.5 else 0.0)
    V = np.array([[rng.choice((1.0, -1.0)) * rng.choice(SIZES) for _ in range(2)] for _ in range(n)])
    anchors = P + rng.choice(SIZES)
    extreme = body.with_(P=P, V=V, anchors=anchors, profile=LEVEL)
    F, totals = extreme.forces()
    assert np.isfinite(F).all()
    assert np.isfinite(totals).all()
    assert np.isfinite(extreme.accepted().anchors).all()


@FAST
@given(ANY, RANDOM)
def test_force_is_continuous(body: State, rng: Random) -> None:
    """Halve the way between two states until they are one: the force closes up, at the touch, at yield, everywhere."""
    if body.run["resultant"][0] or body.run["cap"][0]:
        return  # what is immersed may fall into two parts, and an end face is in the medium or not
    n = len(body.P)
    up = float(body.profile[:, 1].max() - body.P[:, 1].min() + body.run["drop"][0])
    lift = np.array([0.0, rng.choice((0.0, 1.0)) * up])  # half of the ways begin or end above all
    ends = [(body.P, body.V), (body.P + lift + _noise(rng, n, 0.05), body.V + _noise(rng, n, 1.0))]
    if body.kind == "ball":
        ends = [(np.tile(P[:1], (2, 1)), np.tile(V[:1], (2, 1))) for P, V in ends]
    rises = np.array([np.diff(P[:, 1]) for P, _ in ends])
    if body.run["layered"][0] and not (np.abs(rises.sum(axis=0)) > 1e-3 + np.abs(rises[0] - rises[1])).all():
        return  # a thin bar that lies level at any moment of the way passes from layer to layer at once
    sizes = [1e-6]

    def force(state: Array) -> Array:
        F = body.with_(P=state[0], V=state[1]).forces()[0]
        sizes.append(float(np.abs(F).max()))
        return F

    change = jump(force, *map(np.array, ends), halvings=48)
    # 2^-48 of 5 cm and 1 m/s: 2e-16 m, 4e-15 m/s, hardly more than the round-off of positions. The steepest slopes are
    # 1 / u_y of 1e5 /m and, where an element of an outline begins to lead, a thousand times that: 2e-8 of the force.
    # A force that grows as the depth to a power below one has no slope at the touch; to the power of zero it jumps.
    names = {"p", "n", "lam_plunge", "lam_withdraw"} & set(body.record.dtype.names or ())
    power = min([1.0, *(float(body.record[name][0]) for name in names)])
    assert change <= 1e-6**power * max(sizes)


def _noise(rng: Random, n: int, size: float) -> Array:
    return size * np.array([[rng.uniform(-1, 1), rng.uniform(-1, 1)] for _ in range(n)])


@FAST
@given(states(COMMON), RANDOM)
def test_how_a_straight_bar_is_cut_does_not_matter(body: State, rng: Random) -> None:
    """One straight piece: a bar in any motion, a plate as it moves as one with all bristles alike."""
    if body.kind in ("ball", "outline") or len(body.profile) > 1 or isinstance(body.medium, StressTable):
        return  # (a table has kinks, which strips of any cut miss)
    run = body.run.copy()
    run["cap"] = False
    ends = body.P[[0, -1]]
    V, e = np.tile(body.V[:1], (2, 1)), np.tile(body.P[:1] - body.anchors[:1], (2, 1))
    exact = body.medium is not None and body.medium.by_component
    if exact and isinstance(body.static, Smooth):
        return  # three Gauss points, on a power of the depth
    if exact:  # integrated exactly also where they vary along the bar and change their sign
        # From half the yield displacement on a bristle that slides counts for more (see `friction`): no straight line.
        assert isinstance(body.static, Elastoplastic)
        u_y = body.static.yield_displacement
        V, e = body.V[[0, -1]] + _noise(rng, 2, 1.0), np.clip((body.P - body.anchors)[[0, -1]], -0.5 * u_y, 0.5 * u_y)

    def cut(places: Array) -> tuple[Array, Array]:
        P, speeds, stretch = (X[0] + places[:, None] * (X[1] - X[0]) for X in (ends, V, e))
        F, totals = body.with_(P=P, V=speeds, anchors=P - stretch, run=run).forces()
        return F.sum(axis=0), totals

    inner = sorted(rng.uniform(0.0, 1.0) for _ in range(rng.randint(1, 8)))
    F, totals = cut(np.array([0.0, 1.0]))
    G, sums = cut(np.array([0.0, *inner, 1.0]))
    # Closed forms over each strip: those of z^lambda cancel to 1e-11 of themselves, and stretches next to u_y >= 1e-5 m
    # carry round-off of positions, 1e-16 m. Parts of opposite sign may cancel: next to what a strip can bear.
    scale = max(1e-9, float(np.abs(totals).max()), float(np.abs(sums).max()), body.scale() if exact else 0.0)
    # Where the stress is a power z^n of the depth, three Gauss points err in the strip that pierces the surface: by
    # 0.05 % for n = 1.3, by 0.5 % for n = 0.3.
    close = 0.02 if hasattr(body.medium, "traction") else 1e-8
    np.testing.assert_allclose(G, F, atol=close * scale)
    np.testing.assert_allclose(sums, totals, atol=close * scale)
