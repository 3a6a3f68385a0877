"""Convergence of the default case with the step, the elements and the strips, and the error of its energy balance.

    python validation/convergence.py

The case is configs/pendulum.yaml to 40 ms. Errors are relative to the finest run of each family, which has a step of
10 us: the largest distance of the tip, and the differences in stopping time and angle at stop. Orders are least-squares
slopes in the logarithms.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parent))

from granular_contact.config import load_scenario
from granular_contact.results import Results
from granular_contact.run import run
from granular_contact.scene import build
from validation.study import Claim, Outcome, script
from validation.tables import markdown

CONFIG = HERE.parent / "configs" / "pendulum.yaml"
REFERENCE = {"step": 1e-5, "elements": 32, "strips": 4}
DEFAULT = {"step": 2e-4, "elements": 4, "strips": 4}
# Varied parameter, its values, the other parameters, and the converged case of the family. Each step is a multiple of
# the finer ones, so that the compared instants exist in all runs.
FAMILIES: list[tuple[str, list[Any], dict[str, Any], dict[str, Any]]] = [
    ("step", [1e-3, 5e-4, 2e-4, 1e-4], {"elements": 4, "strips": 4}, {"step": 1e-5, "elements": 4, "strips": 4}),
    ("elements", [1, 2, 4, 8, 16], {"step": 2e-5, "strips": 4}, REFERENCE),
    ("strips", [1, 2, 4, 8], {"step": 2e-5, "elements": 4}, {"step": 1e-5, "elements": 4, "strips": 32}),
]


def simulate(step: float, elements: int, strips: int) -> Results:
    """Run the case with these parameters to 40 ms, with a tolerance so small that its error is negligible."""
    scenario = load_scenario(
        CONFIG,
        [
            "solver.end_time_s=0.04",
            "solver.rest_time_s=null",
            "solver.tolerance=1e-7",
            f"solver.step_s={step}",
            f"model.bodies.link.flexible.elements={elements}",
            f"load.strips_per_element={strips}",
        ],
    )
    return run(build(scenario), scenario)


def tip(results: Results) -> NDArray[np.float64]:
    """Path of the tip (n, 2) m."""
    return np.column_stack([results["tip_x_m"], results["tip_y_m"]])


def tip_error(results: Results, truth: Results) -> float:
    """Largest distance (m) of the tip from the reference, at the instants of both runs."""
    every = np.searchsorted(truth["time_s"], results["time_s"] - 1e-9)
    return float(np.max(np.linalg.norm(tip(results) - tip(truth)[every], axis=1)))


def family(
    name: str, values: list[Any], others: dict[str, Any], reference: dict[str, Any]
) -> tuple[list[list[str]], float]:
    """Rows of a family in the table, the last with the fitted order; and that order."""
    truth = simulate(**reference)
    rows, errors = [], []
    for value in values:
        results = simulate(**others, **{name: value})
        errors.append(tip_error(results, truth))
        stop = results.summary["stopping_time_s"] - truth.summary["stopping_time_s"]
        angle = results.summary["angle_at_stop_deg"] - truth.summary["angle_at_stop_deg"]
        energy = results.summary["energy"]["imbalance_relative"]
        cells = f"{1e6 * errors[-1]:.3f}", f"{1e6 * stop:+.2f}", f"{1e3 * angle:+.3f}", f"{energy:.1e}"
        rows.append([name, f"{value:g}", *cells])
    order = float(abs(np.polyfit(np.log(values), np.log(errors), 1)[0]))
    return [*rows, [f"order in {name}", "", f"{order:.2f}", "", "", ""]], order


def study(quick: bool) -> Outcome:
    """Table, errors of the defaults, and two claims; the quick form is the same as the full one."""
    del quick
    truth, default = simulate(**REFERENCE), simulate(**DEFAULT)
    families = {name: family(name, *rest) for name, *rest in FAMILIES}
    head = ["varied", "value", "tip path um", "stopping time us", "angle at stop mdeg", "energy imbalance"]
    table = markdown(head, [row for rows, _ in families.values() for row in rows])
    stop = default.summary["stopping_time_s"] / truth.summary["stopping_time_s"] - 1
    angle = default.summary["angle_at_stop_deg"] - truth.summary["angle_at_stop_deg"]
    defaults = f"tip path {1e6 * tip_error(default, truth):.2f} um, stopping time {100 * stop:+.3f} %"
    orders = [families[name][1] for name in ("elements", "strips")]
    return Outcome(
        f"{table}\n\nDefaults: {defaults}, angle at stop {angle:+.5f} deg.",
        (
            Claim(
                "convergence.the default case is converged",
                abs(stop) < 5e-3 and abs(angle) < 0.01,
                f"stopping time {100 * stop:+.3f} % (required: 0.5), angle at stop {angle:+.5f} deg (required: 0.01)",
            ),
            Claim(
                "convergence.elements and strips are of second order",
                min(orders) > 1.8,
                f"{orders[0]:.2f} and {orders[1]:.2f} fitted (required: at least 1.8)",
            ),
        ),
    )


if __name__ == "__main__":
    sys.exit(script(study))
