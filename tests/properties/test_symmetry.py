"""Where something is and which way it looks is nothing to the medium; above its surface there is nothing."""

from __future__ import annotations

from random import Random

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from support_properties import COMMON, State, floors, states

FAST = settings(max_examples=80, deadline=None)
RANDOM = st.randoms(use_true_random=False)
USUAL = st.one_of(states(COMMON), states(COMMON), floors(COMMON))
ANY = st.one_of(states(), states(), states(), floors())
MIRROR = np.array([-1.0, 1.0])


@FAST
@given(ANY)
def test_mirror_image_has_the_mirrored_force(body: State) -> None:
    F, totals = body.forces()
    run = body.run.copy()
    run["side"] *= -1
    run["turn"] *= -1
    mirrored = body.with_(
        P=body.P * MIRROR,
        V=body.V * MIRROR,
        anchors=body.anchors * MIRROR,
        profile=(body.profile * MIRROR)[::-1].copy(),
        run=run,
    )
    G, seen = mirrored.forces()
    # The same operations with other signs, but a slope is measured from its other end: round-off of 0.3 m in depths
    # and stretches, 1e-16 m next to u_y of at least 1e-5 m; times a dozen operations.
    scale = body.scale()
    np.testing.assert_allclose(G, F * MIRROR, atol=1e-9 * scale)
    np.testing.assert_allclose(seen, totals * [-1.0, 1.0, -1.0], atol=1e-9 * scale)


@FAST
@given(USUAL, RANDOM)  # round-off decides what just touches, or lies just between two layers or strips
def test_shift_of_everything_changes_nothing_but_the_moment(body: State, rng: Random) -> None:
    shift = np.array([rng.uniform(-2, 2), rng.uniform(-2, 2)])
    F, totals = body.forces()
    G, moved = body.with_(P=body.P + shift, anchors=body.anchors + shift, profile=body.profile + shift).forces()
    # Round-off of 2 m, 4e-16 m, in stretches of u_y >= 1e-5 m.
    scale = body.scale()
    np.testing.assert_allclose(G, F, atol=1e-8 * scale)
    moment = shift[0] * totals[:, 1] - shift[1] * totals[:, 0]
    np.testing.assert_allclose(moved[:, 2] - totals[:, 2], moment, atol=1e-7 * scale)


@FAST
@given(ANY)
def test_the_order_of_the_stations_does_not_matter(body: State) -> None:
    run = body.run.copy()
    run["cap"] = False  # which is at the last station only
    turned = run.copy()
    turned["side"] *= -1
    turned["turn"] *= -1
    F, totals = body.with_(run=run).forces()
    back = body.with_(P=body.P[::-1].copy(), V=body.V[::-1].copy(), anchors=body.anchors[::-1].copy(), run=turned)
    G, seen = back.forces()
    if body.kind == "ball":  # the first of its two stations takes the force
        G = G[::-1]
    # Round-off: xi and 1 - xi trade places.
    scale = body.scale()
    np.testing.assert_allclose(G[::-1], F, atol=1e-9 * scale)
    np.testing.assert_allclose(seen, totals, atol=1e-9 * scale)


@FAST
@given(ANY)
def test_totals_are_those_of_the_stations(body: State) -> None:
    F, totals = body.forces()
    scale = body.scale()
    np.testing.assert_allclose(F.sum(axis=0), totals[:, :2].sum(axis=0), atol=1e-12 * len(F) * scale)
    moment = float((body.P[:, 0] * F[:, 1] - body.P[:, 1] * F[:, 0]).sum())
    np.testing.assert_allclose(moment, totals[:, 2].sum(), atol=1e-12 * len(F) * scale)


@FAST
@given(ANY, st.floats(0.0, 10.0))
def test_nothing_above_the_surface(body: State, height: float) -> None:
    top = float(body.profile[:, 1].max())
    lift = np.array([0.0, top - float(body.P[:, 1].min()) + float(body.run["drop"][0]) + height + 1e-12])
    above = body.with_(P=body.P + lift, anchors=body.anchors + lift)
    F, totals = above.forces()
    assert not F.any()
    assert not totals.any()
