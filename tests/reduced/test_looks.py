"""Extremes between the rows of a reduced run: by its kernel as by `results.interpolation`."""

from __future__ import annotations

import numpy as np
import pytest

from granular_contact import load
from granular_contact.engines.modal.model import model
from granular_contact.engines.modal.observe import Motion
from granular_contact.engines.modal.solve import solve
from granular_contact.results.interpolation import Track
from granular_contact.results.stopping import find_touch
from granular_contact.results.summary import extremes
from granular_contact.scene import build


@pytest.mark.parametrize(("modes", "static", "lower"), [(0, "true_sign", 0.02), (2, "elastoplastic", -0.01)])
def test_greatest_and_touch_are_those_of_the_cubics_of_all_ends(modes, static, lower):
    base = load("pendulum", method={"reduced": {"modes": modes, "static": static}}).scenario
    height = build(base).surface - lower
    scene = build(base.replace({"surface_height_m": height, "solver.step_s": 5e-4, "solver.end_time_s": 0.06}))
    made = model(scene, scene.method)
    run = solve(made)
    every = slice(None, None, 15)  # rows so far apart that what is greatest lies well between them
    for name in ("time", "q", "v"):
        object.__setattr__(run, name, np.ascontiguousarray(getattr(run, name)[every]))
    seen, tracks = Motion(made, run), []
    for bar in made.bars:
        places = bar.places(bar.strips + 1)[:: 1 if bar.bends else bar.strips]
        at, speed = seen.positions(bar, places), seen.velocities(bar, places)
        tracks += [Track(height - at[:, i, 1], -speed[:, i, 1]) for i in range(len(places))]
    known, expected = seen.known(), extremes(run.time, tracks, seen.deflection())
    assert known.greatest.depth == pytest.approx(expected.depth, rel=1e-12)
    assert known.touch == pytest.approx(find_touch(run.time, tracks).time, rel=1e-12, abs=1e-15)
    assert (known.touch > 0.0) == (lower > 0.0)
    if modes:
        assert known.greatest.deflection == pytest.approx(expected.deflection, rel=1e-12)
    deepest = np.max([track.values for track in tracks], axis=0)
    np.testing.assert_allclose(known.depth, deepest, rtol=1e-12, atol=1e-15)
    assert known.greatest.depth[0] > deepest.max() * (1.0 + 1e-6)
