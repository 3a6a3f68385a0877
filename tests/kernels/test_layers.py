"""Layers of one medium add up to the bed without layers."""

from __future__ import annotations

import numpy as np
import pytest
from support_laws import BAR_LAWS, SOFT, SURFACE_LAWS, Array, G, label
from support_slow import middles

from granular_contact.kernels import law, strips

LEVEL = np.array([[0.0, 0.0]])


def layered(top: float, bottom: float, width: float = 0.01) -> np.ndarray:
    run = np.zeros(1, law.RUN)
    run["width"], run["layered"], run["top"], run["bottom"] = width, True, top, bottom
    return run


def forces(P: Array, V: Array, anchors: Array, run: np.ndarray, record: np.ndarray, profile: Array = LEVEL) -> Array:
    F, totals = np.zeros_like(P), np.zeros((law.TERMS, 3))
    strips.distributed_forces(P, V, anchors, run[0], profile, record[0], F, totals)
    # What reaches the stations is what is in the totals.
    np.testing.assert_allclose(F.sum(axis=0), totals[:, :2].sum(axis=0), atol=1e-12 * max(1.0, np.abs(F).max()))
    return F


@pytest.mark.parametrize("medium", SURFACE_LAWS + BAR_LAWS, ids=label)
def test_layers_of_one_medium_are_the_whole_bed(medium: object) -> None:
    rng = np.random.default_rng(1)
    record, whole = medium.record(SOFT, G), np.zeros(1, law.RUN)
    whole["width"] = 0.01
    for _ in range(50):
        P = np.cumsum(rng.uniform(-0.05, 0.05, (5, 2)), axis=0) - np.array([0.0, 0.02])
        # One velocity: the direction is taken in the middle of what lies in a layer.
        V = np.tile(rng.uniform(-1, 1, 2), (5, 1))
        anchors = middles(P) + rng.uniform(-0.03, 0.03, (4, 2))
        want = forces(P, V, anchors, whole, record)
        got = sum(
            forces(P, V, anchors, layered(*bounds), record) for bounds in ((0, 0.01), (0.01, 0.03), (0.03, np.inf))
        )
        # Closed forms with cancellation, see test_lee_marghitu: 1e-10, and z^lam over thin clipped parts likewise.
        np.testing.assert_allclose(got, want, atol=1e-9 * max(1e-3, np.abs(want).max()))
