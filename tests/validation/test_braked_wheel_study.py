"""Candidates for the braked wheel: they start from the level surface and carry the load, and the rule can fail."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from granular_contact import preset
from validation import braked_wheel
from validation.braked import pressed
from validation.braked.candidates import CANDIDATES, SAND, Effects, Model, passive, solve
from validation.braked.wheel import rim
from validation.measurements import cmu

BOUND = cmu.BOUNDS[braked_wheel.BOUND]
LEVEL = Effects()


def test_level_surface_agrees_with_the_package_and_the_first_trial() -> None:
    # 360 points of the rim against 96 strips: both miss the edge of the contact by a share of 1e-4 or less.
    assert braked_wheel.against_package(braked_wheel.BOUND) < 2e-3
    for place, force, sinkage in ((0, -18.5, 33.5), (2, -15.8, 27.1), (4, -3.4, 17.3)):
        solution = solve(LEVEL, cmu.rolling()[place], BOUND)
        assert solution == (pytest.approx(1e-3 * sinkage, rel=0.01), pytest.approx(force, abs=0.15))
    rut = solve(CANDIDATES["A1 rut to the wheel's bottom"], cmu.rolling()[0], BOUND)
    assert rut == (pytest.approx(0.0607, rel=0.01), pytest.approx(-27.0, abs=0.15))


@pytest.mark.slow
@pytest.mark.parametrize("name", CANDIDATES)
def test_candidates_of_zero_strength_equal_the_level_surface(name: str) -> None:
    effects = CANDIDATES[name]
    for place in (0, 2, 8):
        trial = cmu.rolling()[place]
        level = np.array(solve(LEVEL, trial, BOUND))
        assert solve(replace(effects, strength=0.0), trial, BOUND) == pytest.approx(level, rel=1e-6)
    locked = cmu.rolling()[0]
    assert np.abs(np.array(solve(effects, locked, BOUND)) / np.array(solve(LEVEL, locked, BOUND)) - 1).max() > 0.01


def test_the_sinkage_bears_the_load() -> None:
    for effects in CANDIDATES.values():
        trial = cmu.rolling()[1]
        sinkage, force = solve(effects, trial, BOUND)
        x, z = Model(effects, rim(*BOUND, trial.rim / trial.forward), trial.slip).force(sinkage)
        if effects.slip_sinkage:  # its pressure is scaled to the load at a given sinkage
            x, z = x * trial.load / z, trial.load
        assert (x, z) == (pytest.approx(force), pytest.approx(trial.load, rel=1e-4))


def test_wedge_force_is_coulomb_passive_earth_pressure() -> None:
    # Coulomb's coefficient for an upright wall with the wall's friction as large as the internal one; the failure
    # plane is taken from a grid of 0.5 degrees, and the force is least there, so the error is of second order.
    phi = np.arctan(SAND.mu)
    under_root = np.sin(2 * phi) * np.sin(phi) / np.cos(phi)
    coulomb = np.cos(phi) / (1 - np.sqrt(under_root)) ** 2
    plane = passive(1.0, 0.03, "plane")
    assert plane == pytest.approx(0.5 * SAND.weight * coulomb * 0.03**2, rel=2e-3)
    # The balance of forces on the plane wedge, W sin(beta + phi) = P cos(beta + 2 phi): its plane, so m of Godwin's.
    optimum = minimize_scalar(
        lambda beta: np.sin(beta + phi) / np.cos(beta + 2 * phi) / np.tan(beta), bounds=(0.1, 0.5), method="bounded"
    )
    m = 1.0 / np.tan(optimum.x)
    for kind in ("crescents", "godwin"):
        wide = passive(100.0, 0.03, kind) / 100.0
        assert wide == pytest.approx(plane, rel=2e-3)
        assert passive(0.05, 0.03, kind) / 0.05 > 1.5 * wide
    # The grid is 0.5 degrees apart, so m is off by at most half of it times m'(beta) = 1 / sin^2(beta).
    share = passive(0.05, 0.03, "godwin") / 0.05 / plane
    off = 0.6 * np.radians(0.25) / np.sin(optimum.x) ** 2 * 2 / 3 + 2e-3 * share
    assert share == pytest.approx(1 + 0.6 * (m - (m - 1) / 3), abs=off)
    wheel_rim = rim(*BOUND, 0.0)
    x = np.linspace(0.0, wheel_rim.front(0.03), 20001)
    under = np.trapezoid(wheel_rim.radius - np.sqrt(wheel_rim.radius**2 - x**2), x)
    assert Model(LEVEL, wheel_rim, -1.0).area(0.03, float(x[-1])) == pytest.approx(under, rel=1e-4)


def test_load_of_a_body_pressed_straight_down() -> None:
    depth = np.array([0.01, 0.03])
    want = cmu.pressed_wheel(preset("cmu_dry_sand"), braked_wheel.BOUND, depth)
    got = [pressed.wheel(LEVEL, BOUND, float(z)) for z in depth]
    assert got == pytest.approx(want, rel=3e-3)  # 48 chords over the lower half: a share of 1e-3 of the pressure
    assert pressed.plate(LEVEL, 0.06, 0.02) == pytest.approx(2.0 * pressed.plate(LEVEL, 0.08, 0.01))
    for name, effects in pressed.NAMES.items():
        none = replace(effects, strength=0.0)
        assert pressed.wheel(none, BOUND, 0.03) == pytest.approx(got[1], rel=1e-6)
        assert name == "level surface" or pressed.wheel(effects, BOUND, 0.03) > 1.001 * got[1]
    # Friction of both sides: mu (1 - sin phi) gamma times the first moment of the circle's segment below the surface.
    r, low = BOUND[0], 0.028
    area = r**2 * np.arccos(low / r) - low * np.sqrt(r**2 - low**2)
    moment = 2 / 3 * (r**2 - low**2) ** 1.5 - low * area
    friction = 2 * SAND.mu * (1 - np.sin(np.arctan(SAND.mu))) * SAND.weight * moment
    assert pressed.wheel(Effects(sides="rest"), BOUND, 0.03) - got[1] == pytest.approx(friction, rel=1e-3)
    # The one number is a mean in logarithms: over the depths of its plate, growth is neither too strong nor too weak.
    rows = cmu.table("plates_large_box")
    rows = rows[rows["diameter_mm"] == 60]
    for name in ("E1 growth with depth", "E2 growth with depth and size"):
        forces = [1e-3 * pressed.plate(CANDIDATES[name], 0.06, 1e-3 * z) for z in rows["depth_mm"]]
        assert np.mean(np.log(forces / rows["pressure_kPa"])) == pytest.approx(0.0, abs=1e-9)
    assert braked_wheel.pressed_claim(pressed.compared()[1]).held


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
