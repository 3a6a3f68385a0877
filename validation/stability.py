"""What happens at the edges: a matrix of runs from gentle to absurd, each against a finer one of its own.

    python validation/stability.py [--quick]

Difference: greatest distance of the tip's path from that of the same scene with a quarter of the step (an accuracy of
1e-5 where steps are chosen) and, where the structure is varied, more elements; over the length of that path, which
counts as a hundredth of the mechanism at least. Every run has max_wall_s, so that none can hang unseen. A run is
accepted when it ends at rest or at its end time without a warning about its own accuracy; warnings of what lies outside
the range that the sand was measured in are no such warnings. The full form also runs every config at ten times its step
against itself.
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
LIMIT = {False: 20.0, True: 6.0}  # s of the clock, by quick
OF_RANGES = ("outside the range", "the floor was", "wall of the container", "without moving a grain")
GOOD = ("rest", "end_time")
ACCEPTED, BALANCE = 0.02, 1e-2  # what a run without a warning may differ by, and its energy imbalance
STIFFEST, PAPER = ("EI and EA, 64 elements", "1e6"), ("EI and EA, 64 elements", "1e0")


@dataclass(frozen=True)
class Found:
    """What came of a case; NaN for what it has not. drift (m): of the tip over the last half of a rest."""

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
        """Whether it claims to be right."""
        return self.status in GOOD and not self.warnings

    @property
    def seconds(self) -> float:
        """Time of the solve (s)."""
        return math.nan if self.cost is None else float(self.cost["solve_s"])


def simulate(case: Case, finer: bool, limit: float) -> Any:
    """Results of a case, or of its reference."""
    step = case.step / FINER if finer else case.step
    more = (f"solver.end_time_s={case.until}", f"solver.step_s={step:.9g}", f"solver.max_wall_s={limit}")
    if case.until > 1.0:
        more = (*more, "solver.rest_time_s=null")
    own = case.overrides
    if finer:
        own = tuple("solver.accuracy=1e-5" if one.startswith("solver.accuracy") else one for one in own) + case.finer
    scenario = load_scenario(CONFIGS / f"{case.config}.yaml", [*more, *own])
    return run(build(scenario), scenario)


def look(case: Case, quick: bool) -> Found:
    """Run a case and its reference, in a process of a pool."""
    try:
        results = simulate(case, False, LIMIT[quick])
    except GranularContactError as error:
        return Found(case, "refused", str(error).splitlines()[0])
    found = Found(
        case,
        results.status.code,
        results.status.message,
        tuple(w for w in results.warnings if not any(word in w for word in OF_RANGES)),
        results.summary["cost"],
        imbalance=results.summary["energy"]["imbalance_relative"],
        drift=_drift(results),
        finite=bool(np.isfinite(results.table).all()),
    )
    if found.status not in GOOD:
        return found
    try:
        reference = simulate(case, True, 2.0 * LIMIT[quick])
    except GranularContactError:
        return found
    if reference.status.code not in GOOD:
        return found
    return Found(**{**vars(found), "difference": difference(results, reference)})


@dataclass(frozen=True)
class Coarse:
    """A config at ten times its step (s), against itself."""

    config: str
    step: float
    status: str
    warnings: tuple[str, ...]
    imbalance: float
    difference: float


def ten_times(path: Path) -> Coarse:
    """Run a config, and again at ten times its step; where that is chosen, at ten times the usual one."""
    own = load_scenario(path)
    step = 10.0 * steps(own).step_s
    wide = load_scenario(path, [f"solver.step_s={step:.9g}", "solver.accuracy=null"])
    fine, results = (run(build(scenario), scenario) for scenario in (own, wide))
    imbalance = results.summary["energy"]["imbalance_relative"]
    return Coarse(path.stem, step, results.status.code, results.warnings, imbalance, difference(results, fine))


def coarse_table(found: Sequence[Coarse]) -> str:
    """A row a config."""
    rows = [
        [one.config, f"{one.step:g}", one.status, len(one.warnings), f"{one.imbalance:.1e}", f"{one.difference:.2%}"]
        for one in found
    ]
    return markdown(["config", "step s", "end", "warnings", "imbalance", "difference"], rows)


def coarse_claim(found: Sequence[Coarse]) -> Claim:
    """Within 5 % with a warning, and within what a run without one may differ by."""
    bad = [one for one in found if not one.difference <= (0.05 if one.warnings else ACCEPTED) and one.status in GOOD]
    worst = max(found, key=lambda one: one.difference)
    quiet = max((one.difference for one in found if not one.warnings), default=0.0)
    return Claim(
        "stability.every config at ten times its step is within 5 %, or 2 % without a warning",
        not bad,
        f"largest {worst.difference:.2%} of the path length ({worst.config}), without a warning {quiet:.2%}",
    )


def _tip(results: Any) -> np.ndarray:
    return np.column_stack([results[name] for name in ("tip_x_m", "tip_y_m", "tip_z_m") if name in results.names])


def difference(results: Any, reference: Any) -> float:
    """Greatest distance of two paths of the tip at the same times, over the length of the second."""
    path, other = _tip(results), _tip(reference)
    end = min(results["time_s"][-1], reference["time_s"][-1])
    known = results["time_s"] <= end * (1.0 + 1e-12)
    at = np.column_stack([np.interp(results["time_s"][known], reference["time_s"], axis) for axis in other.T])
    way = float(np.linalg.norm(np.diff(other, axis=0), axis=1).sum())
    size = float(np.linalg.norm(other[0]))
    return float(np.linalg.norm(path[known] - at, axis=1).max()) / max(way, 1e-2 * size)


def _drift(results: Any) -> float:
    """How far the tip moves in the second half of a run that ends at rest or lies for long (m)."""
    if results.status.code not in GOOD or results["time_s"][-1] < 1.0:
        return math.nan
    path = _tip(results)[results["time_s"] > 0.5 * results["time_s"][-1]]
    return float(np.linalg.norm(path[-1] - path[0]))


def every(wanted: Sequence[Case], quick: bool) -> list[Found]:
    """All cases, on all cores."""
    with local_processes(cores()) as pool:
        return list(pool.map(look, wanted, [quick] * len(wanted)))


# ---- what it shows ----


def _number(value: float, form: str = ".1e") -> str:
    return "-" if math.isnan(value) else format(value, form)


def table(found: Sequence[Found]) -> str:
    """One line per run."""
    rows = []
    for one in found:
        cost = one.cost or {}
        repeated = sum(cost.get(key, 0) for key in ("full_newton", "shortened_steps", "refused_steps"))
        what = one.status + (", warned" if one.warnings and one.status in GOOD else "")
        counts = [cost.get("steps", "-"), cost.get("newton_iterations", "-"), repeated if cost else "-"]
        rest = [_number(one.imbalance), _number(one.drift), _number(one.difference), _number(1e3 * one.seconds, ".0f")]
        rows.append([one.case.factor, one.case.value, what, *counts, *rest])
    head = ["factor", "value", "end", "steps", "iterations", "repeated", "imbalance", "drift m", "difference", "ms"]
    return markdown(head, rows)


def summary(found: Sequence[Found]) -> str:
    """Ends by factor."""
    rows = []
    for factor in dict.fromkeys(one.case.factor for one in found):
        mine = [one for one in found if one.case.factor == factor]
        ends = Counter("accepted" if one.accepted else "warned" if one.status in GOOD else one.status for one in mine)
        worst = max(
            (one.difference for one in mine if one.accepted and not math.isnan(one.difference)), default=math.nan
        )
        balance = max((one.imbalance for one in mine if one.accepted), default=math.nan)
        rows.append([factor, len(mine), *(ends.get(k, 0) or "" for k in ENDS), _number(worst), _number(balance)])
    head = ["factor", "runs", *ENDS, "largest difference without a warning", "largest imbalance without a warning"]
    return markdown(head, rows)


ENDS = ("accepted", "warned", "failed", "refused", "time_limit")


def unexplained(found: Sequence[Found]) -> list[Found]:
    """Failures and ends by the time limit without a sentence that says what to change."""
    said = ("take a smaller", "take a larger", "allowed", "no rest", "needs", "can")
    return [one for one in found if one.status not in GOOD and not any(word in one.message for word in said)]


def claims(found: Sequence[Found], seconds: float, quick: bool) -> tuple[Claim, ...]:
    """What must hold of the matrix."""
    accepted = [one for one in found if one.accepted]
    off = [one for one in accepted if one.imbalance > BALANCE]
    wrong = [one for one in accepted if one.difference > ACCEPTED]
    worst = max((one.difference for one in accepted if not math.isnan(one.difference)), default=math.nan)
    lost = unexplained(found)
    by = {(one.case.factor, one.case.value): one for one in found}
    coarse = [one for one in found if one.case.factor == "step" and one.case.step >= 2e-3]
    silent = [one for one in coarse if one.accepted or (one.case.step <= 2e-3 and not one.difference <= 0.05)]
    limit = 120.0 if quick else 1200.0
    made = [
        Claim("stability.no NaN", all(one.finite for one in found), f"{len(found)} runs, every number of every table"),
        Claim("stability.no hang, no unexplained failure", not lost, f"{_names(lost)} of {len(found)}"),
        Claim(
            "stability.energy balance of runs without a warning",
            not off,
            f"{len(accepted)} runs, {_names(off)} above {BALANCE:g}",
        ),
        Claim(
            "stability.difference of runs without a warning",
            not wrong,
            f"largest {worst:.2%} of the path length (asked: {ACCEPTED:.0%}); above it: {_names(wrong)}",
        ),
        Claim(
            "stability.steps ten times too large warn, and are within 5 %",
            not silent,
            "; ".join(f"{one.case.value}: {one.difference:.2%}" for one in coarse),
        ),
        Claim("stability.time of the matrix", seconds < limit, f"{seconds:.0f} s (asked: {limit:.0f})"),
    ]
    if STIFFEST in by and PAPER in by:
        ratio = by[STIFFEST].seconds / by[PAPER].seconds
        made.append(Claim("stability.stiffest beam at most 3 times the paper's", ratio <= 3.0, f"{ratio:.1f} times"))
    return tuple(made)


def _names(found: Sequence[Found]) -> str:
    if not found:
        return "none"
    return f"{len(found)} ({'; '.join(f'{one.case.factor} {one.case.value}: {one.status}' for one in found)})"


def _draw(found: Sequence[Found], places: Sequence[tuple[str, float, float, Case]]) -> None:
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.colors import LogNorm
    from matplotlib.figure import Figure

    from granular_contact.report.figures.style import DOUBLE, DPI, style

    by = {one.case: one for one in found}
    with style():
        figure = Figure(figsize=(DOUBLE / 25.4, 82 / 25.4), layout="constrained")
        shown = None
        for axes, name, label in zip(
            figure.subplots(1, 2),
            ("speed", "stiffness"),
            ("impact speed (rad/s)", "EI and EA (times the paper's)"),
            strict=True,
        ):
            mine = [(x, y, by[case]) for which, x, y, case in places if which == name]
            xs, ys = sorted({x for x, _, _ in mine}), sorted({y for _, y, _ in mine})
            values = np.full((len(ys), len(xs)), np.nan)
            for x, y, one in mine:
                i, j = ys.index(y), xs.index(x)
                values[i, j] = one.difference
                mark = (
                    ""
                    if one.accepted
                    else "w"
                    if one.status in GOOD
                    else {"failed": "F", "refused": "R"}.get(one.status, "T")
                )
                axes.text(
                    j,
                    i,
                    mark,
                    ha="center",
                    va="center",
                    fontsize=7,
                    color="white" if one.difference > 0.02 else "black",
                )
            shown = axes.imshow(
                np.maximum(values, 1e-6), norm=LogNorm(1e-5, 1.0), cmap="cividis_r", origin="lower", aspect="auto"
            )
            axes.set_xticks(range(len(xs)), [f"{x:g}" for x in xs], rotation=45)
            axes.set_yticks(range(len(ys)), [f"{y:g}" for y in ys])
            axes.set_xlabel(label)
            axes.set_ylabel("step (s)")
            axes.grid(visible=False)
        figure.colorbar(shown, ax=figure.axes, label="difference from a finer run over path length")
        FIGURES.mkdir(exist_ok=True)
        FigureCanvasAgg(figure).print_figure(FIGURES / "stability_maps.png", dpi=DPI)


def study(quick: bool) -> Outcome:
    """Run the matrix, or its quick form."""
    began = time.perf_counter()
    places = [] if quick else heat()
    wanted = [case for case in cases() if case.quick or not quick]
    found = every([*wanted, *(place[3] for place in places)], quick)
    seconds = time.perf_counter() - began
    if places:
        _draw(found, places)
    times = [one.seconds for one in found if not math.isnan(one.seconds)]
    ended = [one for one in found if one.status not in GOOD]
    text = [
        f"{len(found)} runs and their references, median solve {1e3 * statistics.median(times):.0f} ms.",
        "Ends by factor (accepted: no warning about accuracy):",
        summary(found),
        "Runs that did not end well, in their own words:",
        *(f"- {one.case.factor}, {one.case.value}: {one.status}: {one.message}" for one in ended),
        "All runs:",
        table(found[: len(wanted)]),
    ]
    made = claims(found, seconds, quick)
    if not quick:
        coarse = [ten_times(path) for path in sorted(CONFIGS.glob("*.yaml")) if is_run(path)]
        text += ["Every config at ten times its step:", coarse_table(coarse)]
        made += (coarse_claim(coarse),)
    return Outcome("\n\n".join(text), made)


if __name__ == "__main__":
    sys.exit(script(study))
