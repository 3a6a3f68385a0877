"""The same Scene through the engine and through the reduced model: the difference of two Results."""

from __future__ import annotations

from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from support_runs import simulate, tip, tip_error

from granular_contact.results import Results

FINE = ("solver.step_s=2e-5", "solver.end_time_s=0.026", "solver.rest_time_s=null")
# As many strips for both: 16 along the link.
BEAM = (*FINE, "model.bodies.link.flexible.elements=16", "load.strips_per_element=1")
BOW = "deflection_m"


@cache
def reduced(modes: int, static: str = "elastoplastic", *more: str) -> Results:
    name = "pendulum_rigid" if "rigid" in more else "pendulum"
    settings = [override for override in more if override != "rigid"] or [*BEAM]
    return simulate(name, *settings, f"method={{reduced: {{modes: {modes}, static: {static}, rtol: 1e-9}}}}")


def beam() -> Results:
    return simulate("pendulum", *BEAM)


def until_stop(results: Results) -> np.ndarray:
    return results["time_s"][results["time_s"] < beam().summary["stopping_time_s"]]


def worst(results: Results, column: str) -> float:
    times = until_stop(results)
    both = [np.interp(times, r["time_s"], r[column]) for r in (results, beam())]
    return float(np.abs(both[0] - both[1]).max())


def test_same_columns_and_same_keys():
    """But for strains and stresses along the link, which the reduced model does not tell."""
    assert reduced(1).columns == tuple(column for column in beam().columns if not column.name.endswith("strain"))
    assert set(reduced(1).summary) == set(beam().summary) - {"links"} | {"static_turns"}
    assert set(reduced(1).summary["cost"]) == set(beam().summary["cost"])
    rigid = reduced(0, "elastoplastic", *FINE, "rigid")
    assert rigid.columns == simulate("pendulum_rigid", *FINE).columns
    assert [o.part for s in reduced(1).snapshots for o in s.outlines] == [
        o.part for s in beam().snapshots for o in s.outlines
    ]


def test_rigid_model_is_the_engines_rigid_pendulum():
    rigid, engine = reduced(0, "elastoplastic", *FINE, "rigid"), simulate("pendulum_rigid", *FINE)
    # The engine's step of 2e-5 s: second order, 1e-9 of the motion; it damps a little at spectral radius 0.9.
    assert rigid.summary["stopping_time_s"] == pytest.approx(engine.summary["stopping_time_s"], rel=2e-5)
    assert rigid.summary["angle_at_stop_deg"] == pytest.approx(engine.summary["angle_at_stop_deg"], abs=2e-4)
    assert tip_error(rigid, engine, until_stop(rigid)) < 1e-6
    for column in ("kinetic_J", "gravity_J", "granular_work_J", "drag_moment_Nm", "vertical_static_force_y_N"):
        values = [np.interp(until_stop(rigid), r["time_s"], r[column]) for r in (rigid, engine)]
        np.testing.assert_allclose(values[0], values[1], atol=2e-3 * np.abs(values[1]).max())


@pytest.mark.parametrize("static", ["elastoplastic", "true_sign"])
def test_one_mode_stops_as_the_beam_does(static):
    one_mode = reduced(1, static)
    travel = beam().summary["angle_at_stop_deg"] - 31
    assert one_mode.summary["stopping_time_s"] == pytest.approx(beam().summary["stopping_time_s"], rel=5e-3)
    assert one_mode.summary["angle_at_stop_deg"] - 31 == pytest.approx(travel, rel=1e-2)
    assert one_mode.summary["angle_at_stop_deg"] == pytest.approx(beam().summary["angle_at_stop_deg"], abs=0.02)
    # What the one clamped shape can't do: the root of the link carries hardly any moment. A third of the bow at most.
    assert worst(one_mode, BOW) < 0.33 * np.abs(beam()[BOW]).max()


def test_modes_converge_to_the_beam():
    path = [tip_error(reduced(n), beam(), until_stop(reduced(n))) for n in (1, 2, 3, 5)]
    bows = [worst(reduced(n), BOW) for n in (1, 2, 3, 5)]
    assert all(b < 0.45 * a for a, b in pairwise(path))
    assert all(b < 0.45 * a for a, b in pairwise(bows))
    assert path[-1] < 0.5e-6  # m, of a path of 19 mm
    assert np.linalg.norm(np.diff(tip(beam(), until_stop(beam()))[[0, -1]], axis=0)) > 0.018


def test_elastic_energies_agree():
    times = until_stop(beam())
    five, beams = (np.interp(times, r["time_s"], r["elastic_J"]) for r in (reduced(5), beam()))
    assert np.abs(five - beams).max() < 0.01 * beams.max()
    assert five.mean() == pytest.approx(beams.mean(), rel=5e-3)


def test_energies_of_the_model_add_up():
    assert reduced(5).summary["energy"]["imbalance_relative"] < 1e-8
