"""Fits recover the coefficients that made the data; fits to data of another model are judged a misfit."""

from __future__ import annotations

import pickle
from concurrent.futures import BrokenExecutor, Future, ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support_fit import CONFIG, FOUR, NOISE, RIGID, TRUE, TWO, fitted, four, measure, near, problem

from granular_contact.errors import SolveError
from granular_contact.studies import processes
from granular_contact.studies.fit import fit
from granular_contact.studies.fit.solve import DIED, Start, starting_points

ALL = "\n".join(f"  {key}: {{start: {1.3 * value}}}" for key, value in TRUE.items())
# Beyond four standard errors normal noise takes an estimate once in 16 000 times; the seeds are fixed anyway.
FAR = 4.0


def one_run(*more: str, name: str = "data.csv") -> str:
    """A fit of eta_d and eta_v to one run; `more` lines go before it."""
    head = [line for line in more if not line.startswith(" ")] or []
    inside = [line for line in more if line.startswith(" ")]
    keys = "parameters: [medium.eta_d, medium.plunging.eta_v]"
    return "\n".join([keys, *head, "runs:", f"  - config: {CONFIG}", f"    data: {name}", *inside])


@pytest.fixture(scope="module")
def recovered(tmp_path_factory):
    folder = tmp_path_factory.mktemp("four")
    return fitted(folder, f"parameters:\n{ALL}\n{four(folder)}")


@pytest.mark.slow
def test_four_impacts_give_all_four_coefficients_within_their_errors(recovered) -> None:
    assert max(near(recovered)) < FAR
    assert recovered.goodness.status == "fits"
    assert recovered.solution.converged
    assert recovered.warnings == ()
    # and the errors mean something: a few per cent at most (validation/fit_recovery.py), and not nothing
    relative = [e.error / e.value for e in recovered.uncertainty.estimates]
    assert min(relative) > 5e-4
    assert max(relative) < 0.05


@pytest.mark.slow
def test_noise_is_estimated(recovered) -> None:
    # A standard deviation of 200 values is known to 1 in sqrt(400): 5 %; three of these.
    for column in recovered.goodness.columns:
        assert column.noise == pytest.approx(NOISE, rel=0.15)
        assert not column.noise_given


@pytest.mark.slow
def test_the_beam_of_the_engine_fits_as_well(tmp_path: Path) -> None:
    measure(tmp_path / "data.csv", "method=engine", end=0.06)
    text = "parameters: {medium.eta_d: {start: 7}}\nset: {method: engine}\n" + "\n".join(one_run().split("\n")[1:])
    result = fitted(tmp_path, text)
    assert max(near(result, ["medium.eta_d"])) < FAR
    assert result.goodness.status == "fits"


OTHERS = {
    "another exponent": (RIGID, "medium.plunging.lambda=1.8"),
    "static resistance smeared over speed": (
        "method={reduced: {modes: 0, static: smooth}}",
        "load.friction={type: smooth, reference_speed_m_s: 0.3}",
    ),
    "a force that was not modelled": (RIGID, "gravity_m_s2=14"),
}


@pytest.mark.slow
@pytest.mark.parametrize("overrides", OTHERS.values(), ids=OTHERS)
def test_data_of_another_model_are_a_misfit(tmp_path: Path, overrides: tuple[str, ...]) -> None:
    keys = "parameters: [medium.eta_d, medium.eta_h, medium.plunging.eta_v]"
    # (With two impacts the static coefficients take the place of the exponent.)
    cases = FOUR if "medium.plunging.lambda=1.8" in overrides else TWO
    result = fitted(tmp_path, f"{keys}\n{four(tmp_path, *overrides, cases=cases)}")
    assert result.goodness.status == "misfit"
    assert result.goodness.ljung_box < 1e-6
    assert any("the model does not describe these data" in warning for warning in result.warnings)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(1, 3))
def test_the_right_model_is_no_misfit(tmp_path: Path, seed: int) -> None:
    result = fitted(tmp_path, f"parameters: [medium.eta_d, medium.plunging.eta_v]\n{four(tmp_path, seed=seed)}")
    assert result.goodness.status == "fits"


def test_a_given_noise_that_is_too_small_is_a_misfit(tmp_path: Path) -> None:
    measure(tmp_path / "data.csv")
    text = one_run("noise: {tip_x_mm: 0.05, tip_y_mm: 0.1}")
    result = fitted(tmp_path, text)
    # 50 values that scatter by twice what was said: chi-square of 4 a degree of freedom.
    by_column = {column.column: column for column in result.goodness.columns}
    assert by_column["tip_x_m"].reduced_chi_square == pytest.approx(4.0, rel=0.6)
    assert by_column["tip_y_m"].reduced_chi_square == pytest.approx(1.0, rel=0.6)
    assert result.goodness.status == "misfit"
    assert "tip_x_m are" in result.goodness.reasons[0]
    assert len(result.goodness.reasons) == 1


@pytest.mark.slow
@pytest.mark.parametrize("end", [0.06, 0.1])
def test_an_unknown_clock_is_fitted(tmp_path: Path, end: float) -> None:
    measure(tmp_path / "data.csv", offset=0.0113, end=end)
    result = fitted(tmp_path, one_run("    time_offset_s: fit"))
    clock = result.uncertainty.estimates[-1]
    assert clock.parameter.label == "time_offset_s @ data"
    assert abs(clock.value - 0.0113) < FAR * clock.error
    assert clock.error < 1e-4
    assert max(near(result, ["medium.eta_d", "medium.plunging.eta_v"])) < FAR


def test_rows_before_the_touch_are_used(tmp_path: Path) -> None:
    # The true motion before the touch: free fall of the rigid pendulum, J q'' = M cos q (physics: 1.4955e-3, 0.08593),
    # here to second order in the time: 10 ms at 50 rad/s2 are 2.5e-3 rad, the third order is below 3e-5 rad = 8 um.
    exact = measure(tmp_path / "after.csv", columns=("pivot_angle_deg",), noise=0.0).read_text().splitlines()
    rate, angle = 6.24, np.radians(31.0)
    acceleration = 0.08593 * np.cos(angle) / 1.4955e-3
    early = [-1e-3 * k for k in (10, 8, 6, 4, 2)]
    rows = [f"{t!r},{float(np.degrees(angle + rate * t + 0.5 * acceleration * t * t))!r}" for t in early]
    (tmp_path / "data.csv").write_text("\n".join([exact[0], *rows, *exact[1:]]), encoding="utf-8")
    result = fitted(tmp_path, one_run())
    before = result.residuals[0][:5, 0]
    assert np.max(np.abs(before)) < np.degrees(3e-5)
    # straight lines would be off by a hundred times that
    assert np.degrees(0.5 * acceleration * 1e-4) > 50 * np.max(np.abs(before))


def test_a_parameter_of_one_run_alone(tmp_path: Path) -> None:
    measure(tmp_path / "data.csv", RIGID, "initial.impact_speed_rad_s=6.4")
    text = one_run("    parameters: {initial.impact_speed_rad_s: {from: 5.5, to: 7}}")
    result = fitted(tmp_path, text)
    speed = result.uncertainty.estimates[-1]
    assert speed.parameter.label == "initial.impact_speed_rad_s @ data"
    assert abs(speed.value - 6.4) < FAR * speed.error
    assert speed.error < 0.1


@pytest.mark.slow
def test_outliers_pull_a_robust_fit_less(tmp_path: Path) -> None:
    # One column only: a linear fit of two would take all noise for that of the spoilt one, and use the other.
    file = measure(tmp_path / "data.csv", columns=("tip_x_m",))
    lines = file.read_text().splitlines()
    for row in (3, 9, 12, 20, 31):  # 5 of 50 rows, off by 5 mm: swapped markers
        time, x = lines[row].split(",")
        lines[row] = f"{time},{float(x) + 5e-3}"
    file.write_text("\n".join(lines), encoding="utf-8")
    robust = fitted(tmp_path, one_run())
    linear = fitted(tmp_path, one_run("loss: linear"))
    assert max(near(robust, ["medium.eta_d", "medium.plunging.eta_v"])) < FAR
    errors = [f.uncertainty.estimates[1].error for f in (robust, linear)]
    assert errors[0] < 0.5 * errors[1]
    off = [abs(f.values[1] / TRUE["medium.plunging.eta_v"] - 1.0) for f in (robust, linear)]
    assert off[0] < 0.5 * off[1]
    assert robust.goodness.outliers == pytest.approx(0.1)
    # The noise is still about its own, and not that of the outliers, 1.5 mm.
    assert robust.goodness.columns[0].noise < 2.5 * NOISE


def test_data_without_noise_are_met(tmp_path: Path) -> None:
    measure(tmp_path / "data.csv", noise=0.0)
    result = fitted(tmp_path, one_run())
    np.testing.assert_allclose(result.values, [6.5, 22.0], rtol=1e-3)
    assert result.goodness.status == "fits"
    assert result.uncertainty.estimates[0].error > 1e-6  # the computation has errors too


@pytest.mark.slow
def test_one_impact_does_not_separate_the_static_coefficients(tmp_path: Path) -> None:
    measure(tmp_path / "data.csv")
    text = one_run().replace("[medium.eta_d, medium.plunging.eta_v]", "[medium.eta_h, medium.plunging.eta_v]")
    result = fitted(tmp_path, text)
    (warning,) = (w for w in result.uncertainty.warnings if "only their combination" in w)
    assert warning.startswith("medium.eta_h and medium.plunging.eta_v: only their combination is determined")
    assert abs(result.uncertainty.correlation[0, 1]) > 0.99


def test_a_coefficient_beyond_its_bounds_is_reported(tmp_path: Path) -> None:
    measure(tmp_path / "data.csv")
    text = one_run().replace("[medium.eta_d, medium.plunging.eta_v]", "{medium.eta_d: {from: 7, to: 9}}")
    result = fitted(tmp_path, text)
    assert result.values[0] == pytest.approx(7.0, abs=1e-3)
    assert "medium.eta_d is at its lower bound, 7: the best value is beyond it" in result.warnings[-1]


@pytest.mark.slow
def test_starts_agree_and_are_the_same_for_a_seed(tmp_path: Path) -> None:
    measure(tmp_path / "data.csv")
    made = problem(tmp_path, one_run("starts: 4", "seed: 3"))
    points = starting_points(made)
    low, high = made.bounds
    assert len(points) == 4
    assert all(np.all((low <= p) & (p <= high)) for p in points)
    np.testing.assert_array_equal(points, starting_points(made))
    result = fit(made)
    assert result.agreeing == 4


@pytest.mark.slow
def test_workers_change_nothing(tmp_path: Path, monkeypatch) -> None:
    """Threads in place of processes, which take seconds to begin; what is sent to those is pickled all the same."""
    measure(tmp_path / "data.csv")
    made = problem(tmp_path, one_run("starts: 2"))
    monkeypatch.setattr(processes, "local_processes", Pickling)
    progress: list[tuple[int, int]] = []
    alone, both = fit(made), fit(made, workers=2, progress=lambda done, count: progress.append((done, count)))
    np.testing.assert_array_equal(alone.solution.scaled, both.solution.scaled)
    assert progress == [(1, 2), (2, 2)]


class Pickling(ThreadPoolExecutor):
    """Threads that get and give what processes would."""

    def submit(self, *arguments: Any, **keywords: Any) -> Any:
        def call(sent: bytes) -> Any:
            function, *rest = pickle.loads(sent)
            return pickle.loads(pickle.dumps(function(*rest, **keywords)))

        return super().submit(call, pickle.dumps(arguments))


class Dying(ThreadPoolExecutor):
    """Workers that die with the next start, so many times over."""

    lives = 0

    def submit(self, *arguments: Any, **keywords: Any) -> Any:
        if Dying.lives == 0:
            return super().submit(*arguments, **keywords)
        Dying.lives -= 1
        future: Future[Any] = Future()
        future.set_exception(BrokenExecutor("a child process terminated abruptly"))
        return future


@pytest.mark.parametrize("deaths", [1, 4])
def test_a_process_that_is_killed_ends_no_fit(tmp_path: Path, monkeypatch, deaths: int) -> None:
    measure(tmp_path / "data.csv")
    made = problem(tmp_path, one_run("starts: 2"))
    monkeypatch.setattr(processes, "local_processes", Dying)
    monkeypatch.setattr(Dying, "lives", deaths)
    if deaths == 4:  # both starts, and both again
        with pytest.raises(SolveError, match="every starting point; at the first: the process died"):
            fit(made, workers=2)
    else:
        np.testing.assert_array_equal(fit(made, workers=2).values, fit(made).values)


def test_a_start_whose_process_died_is_reported(recovered) -> None:
    dead = Start(recovered.solution.scaled, np.inf, DIED)
    with_failure = replace(recovered, solution=replace(recovered.solution, starts=(*recovered.solution.starts, dead)))
    assert "1 of 2 starting points failed: the process died" in with_failure.warnings[-1]


def test_a_model_that_fails_everywhere_is_reported(tmp_path: Path, monkeypatch) -> None:
    from granular_contact.studies.fit import responses

    measure(tmp_path / "data.csv")
    made = problem(tmp_path, one_run())

    def fails(*_: object) -> None:
        raise SolveError("no such luck")

    for run in made.runs:
        run.simulator._responses.clear()
    monkeypatch.setattr(responses, "run", fails)
    with pytest.raises(SolveError, match="every starting point; at the first: no such luck"):
        fit(made)
