"""Processor time of stepwise control: the same run without pauses, with pauses of 1 ms, and with controls.

    python validation/control_cost.py [--quick]

The table has the processor time for each millisecond of a short run, the least of many repeats in turn, since other
programs on the machine can only add to it. The difference from the run without pauses is the cost of control: entering
and leaving the engine, checking controls, and storing the data for observations.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

from granular_contact import Simulation, build, load
from granular_contact.config import Scenario
from granular_contact.run import begin
from validation.study import Claim, Outcome, script
from validation.tables import markdown

CONFIGS = Path(__file__).parents[1] / "configs"
PAUSE, END = 1e-3, 0.02  # s
BOUND = 50e-6  # s of processor time that a step of 1 ms may add
TORQUE = {"type": "external", "torque_Nm": 0.0}
PD = {"type": "external", "gain_Nm_per_rad": 4.0, "rate_gain_Nm_s_per_rad": 0.04, "limit_Nm": 2.0}
CASES = {
    "rod without sand": ("pendulum_rigid", {"drives": {"pivot": TORQUE}, "solver.step_s": 1e-3, "medium": None}),
    "rod in sand": ("pendulum_rigid", {"drives": {"pivot": TORQUE}, "solver.step_s": 1e-3}),
    "leg with two joints": ("stepping_leg", {"drives": {"swing": PD | {"angle_deg": 60.0}, "knee": TORQUE}}),
    "runner": ("runner", {}),
}


def in_one_go(scenario: Scenario) -> Callable[[], float]:
    """Function that makes a run without pauses and returns its processor time (s)."""

    def run() -> float:
        solving = begin(build(scenario)).solving
        began = time.process_time()
        solving.advance()
        return time.process_time() - began

    return run


def paused(simulation: Simulation) -> Callable[[], float]:
    """Function that makes the same run with pauses, in which nothing is done, and returns its processor time (s)."""

    def run() -> float:
        simulation.reset()
        solving, count = simulation._begun.solving, 0
        began = time.process_time()
        while not solving.over:
            count += 1
            solving.advance(PAUSE * count)
        return time.process_time() - began

    return run


def stepped(simulation: Simulation) -> Callable[[], float]:
    """Function that makes the same run in steps, with all controls and observations; returns its processor time (s)."""
    zeros = {name: 60.0 if name.endswith("_deg") else 0.0 for name in simulation.controls}

    def run() -> float:
        simulation.reset()
        began = time.process_time()
        while simulation.ended is None:
            simulation.step(zeros, PAUSE)
        return time.process_time() - began

    return run


def study(quick: bool = False) -> Outcome:
    """Measure the processor time for each millisecond of several scenes."""
    rows, added = [], []
    for name, (config, changes) in CASES.items():
        scenario = load(CONFIGS / f"{config}.yaml").scenario.replace(
            {"solver.end_time_s": END, "solver.rest_time_s": None, **changes}
        )
        simulation = Simulation(scenario)
        runs = [in_one_go(scenario), paused(simulation), stepped(simulation)]
        times = [[run() for run in runs] for _ in range(30 if quick else 150)]
        per_step = [1e6 * min(column) * PAUSE / END for column in zip(*times, strict=True)]
        added.append(per_step[2] - per_step[0])
        rows.append([name, *(f"{value:.0f}" for value in per_step), f"{added[-1]:.0f}"])
    table = markdown(["scene", "one call us", "with pauses us", "steps us", "extra for control us"], rows)
    claim = Claim("control_cost.a step of 1 ms adds less than 50 us", max(added) < 1e6 * BOUND, f"{max(added):.0f} us")
    return Outcome(table, (claim,))


if __name__ == "__main__":
    sys.exit(script(study))
