"""Robustness at extreme values: a matrix of runs from gentle to absurd, each compared with its own finer run.

    python validation/stability.py [--quick]

The difference of a run is the greatest distance of the tip's path from that of the same scene with a quarter of the
step (with adaptive steps: an accuracy of 1e-5) and, where the structure is varied, more elements. It is divided by the
length of that path, which counts as at least a hundredth of the mechanism's size. Every run has `max_wall_s`, so that
no run can hang unnoticed. A run is accepted if it ends at rest or at its end time without a warning about its own
accuracy; warnings that the sand was not measured in this range are not of this kind. The full form also compares every
config with the same config at ten times its step.
"""

from __future__ import annotations

import math
import statistics
import sys
import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parent))

from granular_contact.config import is_run, load_scenario
from granular_contact.errors import GranularContactError
from granular_contact.run import run
from granular_contact.scene import build
from granular_contact.scene.steps import steps
from granular_contact.studies.processes import cores, local_processes
from validation.stability_cases import Case, cases, heat
from validation.study import Claim, Outcome, script
from validation.tables import markdown

CONFIGS, FIGURES = HERE.parent / "configs", HERE / "figures"
FINER = 4.0
LIMIT = {False: 20.0, True: 6.0}  # wall-clock limit of a run, s; by `quick`
OF_RANGES = ("outside the range", "the floor was", "wall of the container", "without moving a grain")
GOOD = ("rest", "end_time")
ACCEPTED, BALANCE = 0.02, 1e-2  # difference and energy imbalance allowed in a run without a warning
STIFFEST, PAPER = ("EI and EA, 64 elements", "1e6"), ("EI and EA, 64 elements", "1e0")


@dataclass(frozen=True)
class Found:
    """Results of a case; NaN for values that it does not have. drift: of the tip in the last half of a rest, m."""

    case: Case
    status: str
    message: str
    warnings: tuple[str, ...] = ()
    cost: dict[str, Any] | None = None
    imbalance: float = math.nan
    drift: float = math.nan
    difference: float = math.nan
    finite: bool = True

    @property
    def accepted(self) -> bool:
        """Whether the run ended well without a warning about its accuracy."""
        return self.status in GOOD and not self.warnings

    @property
    def seconds(self) -> float:
        """Solve time (s)."""
        return math.nan if self.cost is None else float(self.cost["solve_s"])


def simulate(case: Case, finer: bool, limit: float) -> Any:
    """Run a case, or its reference (`finer`); limit: wall-clock time, s."""
    step = case.step / FINER if finer else case.step
    overrides = (f"solver.end_time_s={case.until}", f"solver.step_s={step:.9g}", f"solver.max_wall_s={limit}")
    if case.until > 1.0:
        overrides = (*overrides, "solver.rest_time_s=null")
    of_case = case.overrides
    if finer:
        of_case = (
            tuple("solver.accuracy=1e-5" if key.startswith("solver.accuracy") else key for key in of_case) + case.finer
        )
    scenario = load_scenario(CONFIGS / f"{case.config}.yaml", [*overrides, *of_case])
    return run(build(scenario), scenario)


def look(case: Case, quick: bool) -> Found:
    """Run a case and its reference, in a process of a pool."""
    try:
        results = simulate(case, False, LIMIT[quick])
    except GranularContactError as error:
        return Found(case, "refused", str(error).splitlines()[0])
    outcome = Found(
        case,
        results.status.code,
        results.status.message,
        tuple(w for w in results.warnings if not any(word in w for word in OF_RANGES)),
        results.summary["cost"],
        imbalance=results.summary["energy"]["imbalance_relative"],
        drift=_drift(results),
        finite=bool(np.isfinite(results.table).all()),
    )
    if outcome.status not in GOOD:
        return outcome
    try:
        reference = simulate(case, True, 2.0 * LIMIT[quick])
    except GranularContactError:
        return outcome
    if reference.status.code not in GOOD:
        return outcome
    return Found(**{**vars(outcome), "difference": difference(results, reference)})


@dataclass(frozen=True)
class Coarse:
    """Comparison of a config with itself at ten times its step (s)."""

    config: str
    step: float
    status: str
    warnings: tuple[str, ...]
    imbalance: float
    difference: float


def ten_times(path: Path) -> Coarse:
    """Run a config, and again at ten times its fixed step; for adaptive steps at ten times the usual step."""
    shipped = load_scenario(path)
    step = 10.0 * steps(shipped).step_s
    wide = load_scenario(path, [f"solver.step_s={step:.9g}", "solver.accuracy=null"])
    fine, results = (run(build(scenario), scenario) for scenario in (shipped, wide))
    imbalance = results.summary["energy"]["imbalance_relative"]
    return Coarse(path.stem, step, results.status.code, results.warnings, imbalance, difference(results, fine))


def coarse_table(results: Sequence[Coarse]) -> str:
    """Table with a row for each config."""
    rows = [
        [
            result.config,
            f"{result.step:g}",
            result.status,
            len(result.warnings),
            f"{result.imbalance:.1e}",
            f"{result.difference:.2%}",
        ]
        for result in results
    ]
    return markdown(["config", "step s", "end", "warnings", "imbalance", "difference"], rows)


def coarse_claim(results: Sequence[Coarse]) -> Claim:
    """Claim that differences are at most 5 % with a warning, and at most ACCEPTED without one."""
    bad = [
        result
        for result in results
        if not result.difference <= (0.05 if result.warnings else ACCEPTED) and result.status in GOOD
    ]
    worst = max(results, key=lambda result: result.difference)
    quiet = max((result.difference for result in results if not result.warnings), default=0.0)
    return Claim(
        "stability.every config at ten times its step is within 5 %, and within 2 % without a warning",
        not bad,
        f"largest {worst.difference:.2%} of the path length ({worst.config}), without a warning {quiet:.2%}",
    )


def _tip(results: Any) -> np.ndarray:
    return np.column_stack([results[name] for name in ("tip_x_m", "tip_y_m", "tip_z_m") if name in results.names])


def difference(results: Any, reference: Any) -> float:
    """Greatest distance between the tips of two runs at the same times, over the path length in the second run."""
    path, other = _tip(results), _tip(reference)
    end = min(results["time_s"][-1], reference["time_s"][-1])
    common = results["time_s"] <= end * (1.0 + 1e-12)
    at = np.column_stack([np.interp(results["time_s"][common], reference["time_s"], axis) for axis in other.T])
    length = float(np.linalg.norm(np.diff(other, axis=0), axis=1).sum())
    size = float(np.linalg.norm(other[0]))
    return float(np.linalg.norm(path[common] - at, axis=1).max()) / max(length, 1e-2 * size)


def _drift(results: Any) -> float:
    """Displacement (m) of the tip in the second half of a run of at least 1 s; NaN for other runs."""
    if results.status.code not in GOOD or results["time_s"][-1] < 1.0:
        return math.nan
    path = _tip(results)[results["time_s"] > 0.5 * results["time_s"][-1]]
    return float(np.linalg.norm(path[-1] - path[0]))


def every(wanted: Sequence[Case], quick: bool) -> list[Found]:
    """Run all cases on all cores."""
    with local_processes(cores()) as pool:
        return list(pool.map(look, wanted, [quick] * len(wanted)))


# ---- tables and claims ----


def _number(value: float, form: str = ".1e") -> str:
    return "-" if math.isnan(value) else format(value, form)


def table(results: Sequence[Found]) -> str:
    """Table with a row for each run."""
    rows = []
    for result in results:
        cost = result.cost or {}
        repeated = sum(cost.get(key, 0) for key in ("full_newton", "shortened_steps", "refused_steps"))
        end = result.status + (", warned" if result.warnings and result.status in GOOD else "")
        counts = [cost.get("steps", "-"), cost.get("newton_iterations", "-"), repeated if cost else "-"]
        numbers = [
            _number(result.imbalance),
            _number(result.drift),
            _number(result.difference),
            _number(1e3 * result.seconds, ".0f"),
        ]
        rows.append([result.case.factor, result.case.value, end, *counts, *numbers])
    head = ["factor", "value", "end", "steps", "iterations", "repeated", "imbalance", "drift m", "difference", "ms"]
    return markdown(head, rows)


def summary(results: Sequence[Found]) -> str:
    """Table of how the runs ended, by factor."""
    rows = []
    for factor in dict.fromkeys(result.case.factor for result in results):
        group = [result for result in results if result.case.factor == factor]
        ends = Counter(
            "accepted" if result.accepted else "warned" if result.status in GOOD else result.status for result in group
        )
        worst = max(
            (result.difference for result in group if result.accepted and not math.isnan(result.difference)),
            default=math.nan,
        )
        balance = max((result.imbalance for result in group if result.accepted), default=math.nan)
        rows.append([factor, len(group), *(ends.get(k, 0) or "" for k in ENDS), _number(worst), _number(balance)])
    head = ["factor", "runs", *ENDS, "largest difference without a warning", "largest imbalance without a warning"]
    return markdown(head, rows)


ENDS = ("accepted", "warned", "failed", "refused", "time_limit")


def unexplained(results: Sequence[Found]) -> list[Found]:
    """Runs that failed or hit the time limit without a sentence that says what to change."""
    advice = ("take a smaller", "take a larger", "allowed", "no rest", "needs", "can")
    return [
        result for result in results if result.status not in GOOD and not any(word in result.message for word in advice)
    ]


def claims(results: Sequence[Found], seconds: float, quick: bool) -> tuple[Claim, ...]:
    """Claims on the matrix of runs; seconds: wall-clock time of the whole matrix."""
    accepted = [result for result in results if result.accepted]
    unbalanced = [result for result in accepted if result.imbalance > BALANCE]
    wrong = [result for result in accepted if result.difference > ACCEPTED]
    worst = max((result.difference for result in accepted if not math.isnan(result.difference)), default=math.nan)
    lost = unexplained(results)
    by_name = {(result.case.factor, result.case.value): result for result in results}
    coarse = [result for result in results if result.case.factor == "step" and result.case.step >= 2e-3]
    silent = [
        result for result in coarse if result.accepted or (result.case.step <= 2e-3 and not result.difference <= 0.05)
    ]
    limit = 120.0 if quick else 1200.0
    statements = [
        Claim(
            "stability.no result is NaN",
            all(result.finite for result in results),
            f"{len(results)} runs, all numbers of all tables",
        ),
        Claim("stability.no run hangs or fails without an explanation", not lost, f"{_names(lost)} of {len(results)}"),
        Claim(
            "stability.energy balance of runs without a warning",
            not unbalanced,
            f"{len(accepted)} runs, {_names(unbalanced)} above {BALANCE:g}",
        ),
        Claim(
            "stability.difference of runs without a warning",
            not wrong,
            f"largest {worst:.2%} of the path length (required: {ACCEPTED:.0%}); above that: {_names(wrong)}",
        ),
        Claim(
            "stability.steps ten times too large have a warning and an error within 5 %",
            not silent,
            "; ".join(f"{result.case.value}: {result.difference:.2%}" for result in coarse),
        ),
        Claim("stability.run time of all cases", seconds < limit, f"{seconds:.0f} s (required: {limit:.0f})"),
    ]
    if STIFFEST in by_name and PAPER in by_name:
        ratio = by_name[STIFFEST].seconds / by_name[PAPER].seconds
        statements.append(
            Claim(
                "stability.the stiffest beam takes at most 3 times the time of the paper's",
                ratio <= 3.0,
                f"{ratio:.1f} times",
            )
        )
    return tuple(statements)


def _names(results: Sequence[Found]) -> str:
    if not results:
        return "none"
    return f"{len(results)} ({'; '.join(f'{r.case.factor} {r.case.value}: {r.status}' for r in results)})"


def _draw(results: Sequence[Found], places: Sequence[tuple[str, float, float, Case]]) -> None:
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.colors import LogNorm
    from matplotlib.figure import Figure

    from granular_contact.report.figures.style import DOUBLE, DPI, style

    by_case = {r.case: r for r in results}
    with style():
        figure = Figure(figsize=(DOUBLE / 25.4, 82 / 25.4), layout="constrained")
        image = None
        for axes, name, label in zip(
            figure.subplots(1, 2),
            ("speed", "stiffness"),
            ("impact speed (rad/s)", "EI and EA (times the paper's)"),
            strict=True,
        ):
            group = [(x, y, by_case[case]) for which, x, y, case in places if which == name]
            xs, ys = sorted({x for x, _, _ in group}), sorted({y for _, y, _ in group})
            values = np.full((len(ys), len(xs)), np.nan)
            for x, y, r in group:
                i, j = ys.index(y), xs.index(x)
                values[i, j] = r.difference
                mark = (
                    ""
                    if r.accepted
                    else "w"
                    if r.status in GOOD
                    else {"failed": "F", "refused": "R"}.get(r.status, "T")
                )
                axes.text(
                    j,
                    i,
                    mark,
                    ha="center",
                    va="center",
                    fontsize=7,
                    color="white" if r.difference > 0.02 else "black",
                )
            image = axes.imshow(
                np.maximum(values, 1e-6), norm=LogNorm(1e-5, 1.0), cmap="cividis_r", origin="lower", aspect="auto"
            )
            axes.set_xticks(range(len(xs)), [f"{x:g}" for x in xs], rotation=45)
            axes.set_yticks(range(len(ys)), [f"{y:g}" for y in ys])
            axes.set_xlabel(label)
            axes.set_ylabel("step (s)")
            axes.grid(visible=False)
        figure.colorbar(image, ax=figure.axes, label="difference from a finer run over path length")
        FIGURES.mkdir(exist_ok=True)
        FigureCanvasAgg(figure).print_figure(FIGURES / "stability_maps.png", dpi=DPI)


def study(quick: bool) -> Outcome:
    """Run the matrix or its quick form; unless quick draw the maps and run every config at ten times its step."""
    began = time.perf_counter()
    places = [] if quick else heat()
    wanted = [case for case in cases() if case.quick or not quick]
    results = every([*wanted, *(place[3] for place in places)], quick)
    seconds = time.perf_counter() - began
    if places:
        _draw(results, places)
    times = [result.seconds for result in results if not math.isnan(result.seconds)]
    ended = [result for result in results if result.status not in GOOD]
    text = [
        f"{len(results)} runs and their references, median solve {1e3 * statistics.median(times):.0f} ms.",
        "Outcomes by factor (accepted: no warning about accuracy):",
        summary(results),
        "Messages of the runs that did not end well:",
        *(f"- {result.case.factor}, {result.case.value}: {result.status}: {result.message}" for result in ended),
        "All runs:",
        table(results[: len(wanted)]),
    ]
    statements = claims(results, seconds, quick)
    if not quick:
        coarse = [ten_times(path) for path in sorted(CONFIGS.glob("*.yaml")) if is_run(path)]
        text += ["Every config at ten times its step:", coarse_table(coarse)]
        statements += (coarse_claim(coarse),)
    return Outcome("\n\n".join(text), statements)


if __name__ == "__main__":
    sys.exit(script(study))
