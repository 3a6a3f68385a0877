"""Candidates for the braked wheel: they begin at the level surface, they bear the load, and the rule can fail."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from validation import braked_wheel
from validation.braked.candidates import CANDIDATES, SAND, Effects, Model, passive, solve
from validation.braked.wheel import rim
from validation.measurements import cmu

BOUND = cmu.BOUNDS[braked_wheel.BOUND]
LEVEL = Effects()


def test_the_level_surface_is_the_package_s_wheel_and_that_of_the_first_trial() -> None:
    # 360 points of the rim against 96 strips: both miss the edge of the contact by a share of 1e-4 or less.
    assert braked_wheel.against_package(braked_wheel.BOUND) < 2e-3
    for place, force, sinkage in ((0, -18.5, 33.5), (2, -15.8, 27.1), (4, -3.4, 17.3)):
        found = solve(LEVEL, cmu.rolling()[place], BOUND)
        assert found == (pytest.approx(1e-3 * sinkage, rel=0.01), pytest.approx(force, abs=0.15))
    rut = solve(CANDIDATES["A1 rut to the wheel's bottom"], cmu.rolling()[0], BOUND)
    assert rut == (pytest.approx(0.0607, rel=0.01), pytest.approx(-27.0, abs=0.15))


@pytest.mark.parametrize("name", CANDIDATES)
def test_candidates_are_the_level_surface_at_no_strength_and_differ_at_full(name: str) -> None:
    effects = CANDIDATES[name]
    for place in (0, 2, 8):
        one = cmu.rolling()[place]
        level = np.array(solve(LEVEL, one, BOUND))
        assert solve(replace(effects, strength=0.0), one, BOUND) == pytest.approx(level, rel=1e-6)
    locked = cmu.rolling()[0]
    assert np.abs(np.array(solve(effects, locked, BOUND)) / np.array(solve(LEVEL, locked, BOUND)) - 1).max() > 0.01


def test_the_sinkage_bears_the_load() -> None:
    for effects in CANDIDATES.values():
        one = cmu.rolling()[1]
        sinkage, force = solve(effects, one, BOUND)
        x, z = Model(effects, rim(*BOUND, one.rim / one.forward), one.slip).force(sinkage)
        if effects.slip_sinkage:  # its pressure is scaled to the load at a given sinkage
            x, z = x * one.load / z, one.load
        assert (x, z) == (pytest.approx(force), pytest.approx(one.load, rel=1e-4))


def test_a_wedge_is_passive_earth_pressure_and_its_area_that_before_the_rim() -> None:
    # Coulomb's coefficient for an upright wall with the wall's friction as large as the internal one; the failure
    # plane is taken from a grid of 0.5 degrees, and the force is least there, so the error is of second order.
    phi = np.arctan(SAND.mu)
    under_root = np.sin(2 * phi) * np.sin(phi) / np.cos(phi)
    coulomb = np.cos(phi) / (1 - np.sqrt(under_root)) ** 2
    plane = passive(1.0, 0.03, crescents=False)
    assert plane == pytest.approx(0.5 * SAND.weight * coulomb * 0.03**2, rel=2e-3)
    wide = passive(100.0, 0.03, crescents=True) / 100.0
    assert wide == pytest.approx(plane, rel=2e-3)
    assert passive(0.05, 0.03, crescents=True) / 0.05 > 1.5 * wide
    one = rim(*BOUND, 0.0)
    x = np.linspace(0.0, one.front(0.03), 20001)
    under = np.trapezoid(one.radius - np.sqrt(one.radius**2 - x**2), x)
    assert Model(LEVEL, one, -1.0).area(0.03, float(x[-1])) == pytest.approx(under, rel=1e-4)


def test_the_verdict_of_the_rule() -> None:
    level = braked_wheel.found(LEVEL, braked_wheel.BOUND)
    for name in ("A3 rut by slip", "B2 swept heap, flow to the sides", "E1 growth with depth", "G10 E1, A3 and F2"):
        assert not braked_wheel.judge(braked_wheel.found(CANDIDATES[name], braked_wheel.BOUND), level).passes
    data, _ = braked_wheel.measured()
    assert braked_wheel.judge(0.4 * level + 0.6 * data, level).passes  # nearer everywhere
    assert not braked_wheel.judge(0.7 * level + 0.3 * data, level).passes  # by less than a third
    spoilt = data.copy()
    spoilt[4, 1] += abs(level[4, 1] - data[4, 1]) + 2.0  # perfect but for one slip
    assert braked_wheel.judge(spoilt, level).worse == (0, 1)
    assert not braked_wheel.judge(spoilt, level).passes
    assert not braked_wheel.judge(np.where(spoilt == spoilt[4, 1], np.nan, data), level).passes
