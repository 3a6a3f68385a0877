"""Impacts of the paper's link and of links with other properties, run by every model."""

from __future__ import annotations

import math
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh

from granular_contact import scene
from granular_contact.config import Scenario, load, load_sweep
from granular_contact.engines.modal.arrays import arrays_of
from granular_contact.engines.modal.model import model as reduce
from granular_contact.report import yaml_text
from granular_contact.results import Results
from granular_contact.run import run
from granular_contact.studies import sweep

CONFIG = Path(__file__).parents[2] / "configs" / "pendulum.yaml"
ELEMENTS = "model.bodies.link.flexible.elements"
EI, DENSITY, LENGTH, DIAMETER = 15.1642, 7700.0, 0.23876, 0.00635  # N m2, kg/m3, m, m
HUB = 0.009525 + 0.01524  # m, distance of the link's root from the pivot

# Modes of each reduced model; elements, and steps in a rigid stopping time, of each beam. The last is the reference.
MODES = {"rigid": 0, "one": 1, "two": 2, "five": 5}
BEAMS = {"coarse": (16, 400), "fine": (32, 800)}
QUICK_BEAMS = {"coarse": (4, 200), "fine": (8, 400)}
SPANS = (3.0, 12.0)  # end of a run over the rigid stopping time; the second if it does not stop before the first
# Limit on the steps of a run over their expected number. Modes without centrifugal stiffening diverge in a fast spin,
# and then the steps become ever smaller.
MOST_STEPS = 20
MEASURES = ("stopping time", "travel", "deflection")
BOTH = MEASURES[:2]


@dataclass(frozen=True)
class Case:
    """One impact: ratios to the paper's EI, density and length; impact speed, rad/s; impact angle, deg."""

    family: str
    stiffness: float = 1.0
    speed: float = 6.24
    angle: float = 31.0
    density: float = 1.0
    length: float = 1.0

    @property
    def values(self) -> dict[str, Any]:
        """Overrides of the config."""
        link = "model.bodies.link"
        return {
            f"{link}.flexible.bending_stiffness_N_m2": self.stiffness * EI,
            f"{link}.density_kg_m3": self.density * DENSITY,
            f"{link}.length_m": self.length * LENGTH,
            "initial.impact_speed_rad_s": self.speed,
            "initial.impact_angle_deg": self.angle,
        }


def design(quick: bool) -> list[Case]:
    """All cases: a grid of EI and speed at 31 degrees, and lines in density, length and angle at two stiffnesses."""
    if quick:
        grid = [Case("EI, speed", k) for k in (1e-2, 1.0, 1e2)]
        lines = [Case("density", 1e-2, density=5.0), Case("angle", 1e-2, angle=61.5)]
        return [*grid, Case("EI, speed", 1.0, 0.5), *lines]
    grid = [Case("EI, speed", 10.0**k, w) for k in range(-4, 3) for w in (0.1, 0.5, 2.0, 6.24, 11.0, 20.0)]
    lines = []
    for k in (1e-2, 1.0):
        lines += [Case("density", k, density=ratio) for ratio in (0.1, 0.3, 3.0, 10.0)]
        lines += [Case("length", k, length=ratio) for ratio in (0.4, 0.7, 1.5, 2.5)]
        lines += [Case("angle", k, angle=angle) for angle in (12.0, 22.0, 45.0, 61.5, 75.0)]
    return grid + lines


# ---- running ----


def simulate(scenario: Scenario) -> Results:
    """Run a scenario; its summary also has the values up to the stop that the study needs."""
    solver, reduced = scenario.solver, scenario.method.reduced is not None
    each = 4096 if reduced else 64  # steps between two calls of the progress
    left = MOST_STEPS * solver.end_time_s / solver.step_s / each + 4

    def count(_now: float, _end: float) -> None:
        nonlocal left
        left -= 1
        if left < 0:
            raise RuntimeError("far more steps than it should take: the motion diverges, or the solver can't follow")

    results = run(scene.build(scenario), scenario, count)
    stop = results.summary["stopping_time_s"]
    until = results["time_s"] <= (math.inf if stop is None else stop)
    if any(column.name == "deflection_m" for column in results.columns):
        results.summary["peak_m"] = float(np.max(np.abs(results["deflection_m"][until])))
    results.summary["work_J"] = float(results["granular_work_J"][until][-1])
    results.summary["depth_at_stop_m"] = float(np.max(results["depth_m"][until]))
    return results


def rows(cases: dict[str, dict[str, Any]]) -> dict[str, dict[str, Any]]:
    """Run named cases on all cores; summaries by name."""
    if not cases:
        return {}
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "study.yaml"
        file.write_text(yaml_text({"config": str(CONFIG), "set": {"solver.rest_time_s": None}, "cases": cases}))
        with sweep.WorkerPool() as pool:
            return {row.name: row.summary for row in sweep.run(load_sweep(file), pool, function=simulate)}


def method(modes: int) -> dict[str, Any]:
    """Overrides for a reduced model with a number of modes; its strips follow from the elements."""
    return {"method": {"reduced": {"modes": modes, "static": "elastoplastic"}}, ELEMENTS: 32}


@dataclass(frozen=True)
class Point:
    """Results of a case: summaries by model, also of the rigid link in the same impact.

    A number is None if a model does not have it, because it did not stop or failed.
    """

    case: Case
    runs: dict[str, dict[str, Any]]

    def value(self, model: str, measure: str) -> float | None:
        """Stopping time (s), travel (deg) or peak deflection up to the stop (m)."""
        summary = self.runs[model]
        if summary.get("stopping_time_s") is None:
            return None
        if measure == "travel":
            return float(summary["angle_at_stop_deg"] - self.case.angle)
        number = summary.get({"stopping time": "stopping_time_s", "deflection": "peak_m"}[measure])
        return None if number is None else float(number)

    def error(self, model: str, measure: str) -> float:
        """Relative difference from the fine beam; inf if only the model does not stop, nan without a value."""
        computed, exact = self.value(model, measure), self.value("fine", measure)
        if not exact or (measure == "deflection" and model == "rigid"):
            return math.nan
        return math.inf if computed is None else abs(computed / exact - 1.0)

    def doubt(self, measure: str) -> float:
        """Relative difference of the two beams."""
        error = self.error("coarse", measure)
        return math.inf if math.isnan(error) else error

    def known(self, model: str, measure: str) -> bool:
        """Whether an error is significant: the two beams agree to 0.2 %, or to a fifth of the error."""
        error = self.error(model, measure)
        return not math.isnan(error) and self.doubt(measure) <= max(2e-3, 0.2 * min(error, 1.0))

    # ---- numbers that follow from the rigid run and the link ----

    @cached_property
    def rigid(self) -> dict[str, float]:
        """Stopping time T (s), travel Q (rad), depth z (m), mean force at the tip F (N) of the rigid link."""
        summary = self.runs["rigid"]
        travel = math.radians(summary["angle_at_stop_deg"] - self.case.angle)
        force = -summary["work_J"] / (travel * self.reach)
        return {"T": summary["stopping_time_s"], "Q": travel, "z": summary["depth_at_stop_m"], "F": force}

    @property
    def reach(self) -> float:
        """Distance from the pivot to the tip (m)."""
        return HUB + self.case.length * LENGTH

    @cached_property
    def sag(self) -> float:
        """Static deflection of the clamped link under the mean force at its tip (m)."""
        return self.rigid["F"] * (self.case.length * LENGTH) ** 3 / (3.0 * self.case.stiffness * EI)

    @cached_property
    def first(self) -> float:
        """First angular frequency of the link on its hinge in vacuum (rad/s)."""
        return float(frequencies(self.case, 20)[0])


def points(cases: Sequence[Case], beams: dict[str, tuple[int, int]] = BEAMS) -> list[Point]:
    """Run every case by every model."""
    impacts = {key: case for case in cases for key in [_impact(case)]}
    first = rows(
        {
            name: {**case.values, **method(0), "solver.end_time_s": 3.0, "solver.step_s": 1e-3}
            for name, case in impacts.items()
        }
    )
    scale = {name: summary["stopping_time_s"] for name, summary in first.items()}
    summaries: list[dict[str, dict[str, Any]]] = [{} for _ in cases]
    for span in SPANS:
        asked = {}
        for i, case in enumerate(cases):
            for name, overrides in models(scale[_impact(case)], span, beams).items():
                if summaries[i].get(name, {}).get("stopping_time_s") is None and not _given_up(summaries[i].get(name)):
                    asked[f"c{i}_{name}"] = {**case.values, **overrides}
        for name, summary in rows(asked).items():
            index, kind = name[1:].split("_")
            summaries[int(index)][kind] = summary
    return [Point(case, runs) for case, runs in zip(cases, summaries, strict=True)]


def _given_up(summary: dict[str, Any] | None) -> bool:
    return summary is not None and summary["status"] in ("failed", "error")


def _impact(case: Case) -> str:
    """Name of the impact: the same for all stiffnesses."""
    return f"w{case.speed:g}_a{case.angle:g}_d{case.density:g}_l{case.length:g}"


def models(stop: float, span: float, beams: dict[str, tuple[int, int]]) -> dict[str, dict[str, Any]]:
    """Overrides that select each model, by its name; stop: stopping time of the rigid link, s; span: end over stop."""
    finest = max(steps for _, steps in beams.values())
    end = {"solver.end_time_s": span * stop}
    reduced = {name: {**method(n), **end, "solver.step_s": stop / finest} for name, n in MODES.items()}
    full = {
        name: {"method": "engine", ELEMENTS: elements, **end, "solver.step_s": stop / steps, "solver.tolerance": 1e-6}
        for name, (elements, steps) in beams.items()
    }
    return reduced | full


def frequencies(case: Case, modes: int) -> NDArray[np.float64]:
    """Angular frequencies (rad/s) of the link on its hinge, in vacuum, with a number of modes."""
    overrides = [f"{key}={value!r}" for key, value in case.values.items()]
    built = scene.build(load(CONFIG, [*overrides, f"method={{reduced: {{modes: {modes}}}}}"]).scenario)
    assert built.method is not None
    record = arrays_of(reduce(built, built.method)).pendulum[0]
    mass = record["m"] * np.eye(modes + 1)
    mass[0, 0] = record["J"]
    mass[0, 1:] = mass[1:, 0] = record["c"][:modes]
    stiffness = np.diag([0.0, *record["k"][:modes]])
    omega: NDArray[np.float64] = np.sqrt(eigh(stiffness, mass, eigvals_only=True)[1:])
    return omega


def shortfall(case: Case, modes: int) -> float:
    """Tip deflection under a steady force at the tip of the link on its free hinge, over the deflection with 20 modes.

    The inertia along the link balances the force, so that the moment at the root of a light hub is small.
    """
    built = scene.build(
        load(CONFIG, [*(f"{k}={v!r}" for k, v in case.values.items()), "method={reduced: {modes: 20}}"]).scenario
    )
    assert built.method is not None
    record = arrays_of(reduce(built, built.method)).pendulum[0]
    reach = HUB + case.length * LENGTH
    parts = (1.0 - record["c"] * reach / record["J"]) / record["k"]
    return float(parts[:modes].sum() / parts.sum())
