"""Errors against plain linear algebra, derivatives against finer ones, tests of residuals against chance."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import binom, chi2
from support_fit import NOISE, TRUE, TWO, four, problem

from granular_contact.studies.fit import diagnostics
from granular_contact.studies.fit.goodness import ljung_box
from granular_contact.studies.fit.problem import Loss, Problem
from granular_contact.studies.fit.solve import STEP, Solution, jacobian, minimise, solve
from granular_contact.studies.fit.uncertainty import uncertainty

KEYS = "parameters: {medium.eta_d: , medium.plunging.eta_v: , medium.plunging.lambda: {from: 0.5, to: 2}}"


@pytest.fixture(scope="module")
def exact(tmp_path_factory) -> Problem:
    """Four impacts without noise, started at the true values."""
    folder = tmp_path_factory.mktemp("exact")
    return problem(folder, f"{KEYS}\nloss: linear\n{four(folder, noise=0.0)}")


def noisy(made: Problem, seed: int) -> tuple[Problem, np.ndarray]:
    """The problem with noise, and that noise in a row."""
    random = np.random.default_rng(seed)
    added = [NOISE * random.standard_normal(run.measured.values.shape) for run in made.runs]
    runs = [
        replace(run, measured=replace(run.measured, values=run.measured.values + noise))
        for run, noise in zip(made.runs, added, strict=True)
    ]
    return replace(made, runs=tuple(runs)), np.concatenate([noise.ravel() for noise in added])


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(2))
def test_a_small_noise_moves_the_estimates_as_linear_theory_says(exact: Problem, seed: int) -> None:
    made, added = noisy(exact, seed)
    start = exact.start
    slopes = jacobian(exact, start, exact.times())
    expected = np.linalg.lstsq(slopes, added, rcond=None)[0]
    deviation = NOISE * np.sqrt(np.diag(np.linalg.inv(slopes.T @ slopes)))
    shift = minimise(made, start, np.full(2, NOISE), "linear").x - start
    # Curvature adds the square of the shift, 1 % of 1 %, against a shift of 1 %: 0.1 of a deviation is plenty.
    assert np.all(np.abs(shift - expected) < 0.1 * deviation)
    assert np.max(np.abs(expected) / deviation) > 0.3  # there is something to see


@pytest.mark.slow
def test_covariance_is_that_of_linear_least_squares(exact: Problem) -> None:
    made, _ = noisy(exact, 0)
    solution = solve(made)
    result = uncertainty(made, solution)
    # Noise of each column as the residuals have it, with as many degrees of freedom as the fit has left it.
    free = 1.0 - 3 / len(solution.residuals)
    column = made.column_indices()
    sizes = np.array([np.sqrt(np.mean(solution.residuals[column == k] ** 2) / free) for k in range(2)])
    slopes = solution.jacobian / sizes[column][:, None]
    # The noise that the fit weighed with is that of its last round but one, settled to 1e-3.
    np.testing.assert_allclose(result.covariance, np.linalg.inv(slopes.T @ slopes), rtol=3e-3)
    for estimate, row in zip(result.estimates, result.covariance.diagonal(), strict=True):
        value, unit = (
            estimate.value,
            estimate.parameter.value(estimate.parameter.scaled(estimate.value)) if estimate.parameter.log else 1.5,
        )
        assert estimate.error == pytest.approx(unit * np.sqrt(row), rel=1e-9)
        # Student's t of 405 - 3 degrees of freedom at 97.5 % is 1.966.
        ends = (
            np.log([estimate.low / value, estimate.high / value])
            if estimate.parameter.log
            else (np.array([estimate.low, estimate.high]) - value) / 1.5
        )
        np.testing.assert_allclose(ends, [-1.966 * np.sqrt(row), 1.966 * np.sqrt(row)], rtol=1e-3)


def at_truth(made: Problem, added: np.ndarray, slopes: np.ndarray) -> Solution:
    """The solution where a fit has left just this noise; each column weighed by the noise that was given."""
    given = np.array([size or NOISE for size in made.noise.values()])
    return Solution(made.start, given, added, slopes, np.zeros(3, dtype=np.int64), (), True)


@pytest.mark.parametrize("loss", ["linear", "soft_l1"])
def test_a_noise_given_far_too_large_leaves_the_errors_of_the_other_column(exact: Problem, loss: Loss) -> None:
    made, added = noisy(exact, 1)
    made = replace(made, noise={"tip_x_m": 50.0 * NOISE, "tip_y_m": None}, loss=loss)
    slopes = jacobian(made, made.start, made.times())
    stated = np.sqrt(np.diag(uncertainty(made, at_truth(made, added, slopes)).covariance))
    # x says next to nothing, being 50 times as rough: the errors are those of y alone, with its 202 values.
    slopes_of_column = slopes[made.column_indices() == 1]
    alone = NOISE * np.sqrt(np.diag(np.linalg.inv(slopes_of_column.T @ slopes_of_column)))
    # A scatter of 202 values is known to 1 in sqrt(404), 5 %; three of these. Pooled, errors would be 0.7 of this.
    np.testing.assert_allclose(stated, alone, rtol=0.15)


def test_parameters_without_effect_on_the_data_are_undetermined(exact: Problem) -> None:
    made, added = noisy(exact, 2)
    slopes = jacobian(made, made.start, made.times())
    slopes[:, 1] = 0.0
    with np.errstate(all="raise"):
        result = uncertainty(made, at_truth(made, added, slopes))
    assert (
        result.warnings[0] == "medium.plunging.eta_v is not determined by these data: its standard error is unlimited"
    )
    estimate = result.estimates[1]
    assert (estimate.error, estimate.low, estimate.high) == (np.inf, 0.0, np.inf)
    # and the others are as if it were not there
    without = np.delete(slopes, 1, axis=1)
    sizes = np.array([np.std(added[made.column_indices() == k]) for k in range(2)])[made.column_indices()][:, None]
    rest = np.linalg.inv((without / sizes).T @ (without / sizes))
    np.testing.assert_allclose(result.covariance[np.ix_([0, 2], [0, 2])], rest, rtol=0.1)
    assert np.isnan(result.correlation[0, 1])


@pytest.mark.slow
@pytest.mark.parametrize("modes", [0, 1])
def test_derivatives_are_right(tmp_path: Path, modes: int) -> None:
    text = f"{KEYS}\n{four(tmp_path, cases=TWO)}"
    both = [
        problem(tmp_path, f"set: {{method.reduced.modes: {modes}, method.reduced.rtol: {rtol}}}\n{text}")
        for rtol in ("1e-6", "1e-10")
    ]
    start = both[0].start
    derivatives = jacobian(both[0], start, both[0].times())
    for j in range(3):
        # Four points of the fine model: the error is of fourth order in the step.
        values = []
        for k in (-2, -1, 1, 2):
            moved = start.copy()
            moved[j] += k * STEP
            values.append(both[1].model(moved, both[1].times()))
        exact = (values[0] - 8.0 * values[1] + 8.0 * values[2] - values[3]) / (12.0 * STEP)
        error = np.max(np.abs(derivatives[:, j] - exact)) / np.max(np.abs(exact))
        assert error < (1e-4 if modes == 0 else 2.4e-2)  # as in test_jacobian


@pytest.mark.parametrize("bound", ["low", "high"])
def test_derivatives_stay_within_the_bounds(exact: Problem, bound: str) -> None:
    at = exact.start
    for j in range(2):
        parameter = exact.parameters[j]
        edge = replace(parameter, **{bound: parameter.value(at[j])})
        moved = replace(exact, parameters=tuple(edge if k == j else p for k, p in enumerate(exact.parameters)))
        inside, outside = jacobian(moved, at, exact.times())[:, j], jacobian(exact, at, exact.times())[:, j]
        # one-sided of second order: h^2/3 against h^2/6 of the curvature's change
        np.testing.assert_allclose(inside, outside, atol=1e-3 * np.max(np.abs(outside)))


# ---- noise ----


def test_expected_pull_of_normal_noise() -> None:
    points, weights = np.polynomial.hermite_e.hermegauss(100)
    mean = np.sum(weights * diagnostics.psi(points, "soft_l1") ** 2) / np.sum(weights)
    assert mean == pytest.approx(diagnostics._EXPECTED, rel=1e-8)
    slope = np.sum(weights * diagnostics.psi_slope(points, "soft_l1")) / np.sum(weights)
    assert slope**2 / mean == pytest.approx(0.98, abs=0.005)  # the 2 % that the module tells


def test_scale_of_normal_noise_and_of_noise_with_outliers() -> None:
    values = 3.0 * np.random.default_rng(1).standard_normal(4000)
    # 1 in sqrt(8000) is 1.1 %; four of these.
    for loss in ("linear", "soft_l1"):
        assert diagnostics.scale(values, loss, 0.0) == pytest.approx(3.0, rel=0.045)
    values[:200] = 300.0  # 5 %
    assert diagnostics.scale(values, "soft_l1", 0.0) < 4.5
    assert diagnostics.scale(values, "linear", 0.0) > 60.0


def test_roughness_sees_noise_under_a_motion() -> None:
    time = np.linspace(0.0, 1.0, 2000)
    motion = np.exp(-3.0 * time)
    # A median of 2000 values that overlap by three is good to some 4 %.
    values = motion + 1e-3 * np.random.default_rng(0).standard_normal(2000)
    assert diagnostics.roughness(values) == pytest.approx(1e-3, rel=0.12)
    assert diagnostics.roughness(values[:9]) is None


def test_ljung_box_is_fair_to_noise() -> None:
    random = np.random.default_rng(5)
    low = sum(ljung_box([random.standard_normal(60) for _ in range(4)], 3) < 0.05 for _ in range(400))
    # 5 % of 400 is 20; what chance leaves with 999 in 1000, a little more as the test is approximate.
    assert low <= binom.ppf(0.999, 400, 0.07)
    assert low >= binom.ppf(0.001, 400, 0.03)


def test_ljung_box_has_the_published_statistic() -> None:
    """n (n + 2) sum r_k^2 / (n - k) over the first n / 4 lags of 16 values, by hand; as many degrees of freedom."""
    values = np.array([0.3, -1.1, 0.8, 0.2, -0.4, 1.6, -0.9, 0.1, 0.5, -1.3, 0.7, 0.9, -0.2, -0.6, 1.2, -0.8])
    lagged = [np.sum(values[lag:] * values[:-lag]) / np.sum(values**2) for lag in (1, 2, 3, 4)]
    statistic = 16 * 18 * sum(r**2 / (16 - lag) for lag, r in enumerate(lagged, start=1))
    assert ljung_box([values], 1) == pytest.approx(chi2.sf(statistic, 3), rel=1e-12)


def test_ljung_box_sees_a_pattern_and_ignores_one_outlier() -> None:
    random = np.random.default_rng(2)
    series = random.standard_normal((4, 60))
    assert ljung_box([residual + 0.8 * np.sin(np.linspace(0, 6, 60)) for residual in series], 3) < 1e-3
    series[0, 30] = 100.0
    assert ljung_box(list(series), 3) > 1e-3


def test_true_values_are_the_preset() -> None:
    from support_runs import scenario_of

    from granular_contact.config import scenario_to_dict

    medium = scenario_to_dict(scenario_of("pendulum"))["medium"]
    assert [medium["eta_d"], medium["eta_h"], *medium["plunging"].values()] == list(TRUE.values())
