"""Minimal coordinates beside the engine on trees of rigid bodies, for whether a method of its own is worth its code.

    python validation/minimal_cost.py [--quick]

Straight chains of rigid links that strike sand with the tip (validation/chains.py), solved in minimal coordinates and
by the engine, with steps chosen by their error. Times are processor time of the solve, the least of three rounds in
turn; errors are the largest distance of the tip from a run in minimal coordinates with an accuracy of 1e-6. A table
compares at equal error: the cheapest run of each method that is no farther off. The last one has the shipped mechanisms
that are trees of rigid bodies, by both methods; there an error is the largest distance of the tip from a run with an
accuracy of 1e-4 in minimal coordinates, over the length of its path, and beside it stand how far the same of the engine
is from that, and the error of the energy balance.
"""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parent))

from granular_contact.config import load
from granular_contact.engines.exudyn.build import build
from granular_contact.engines.exudyn.solve import Solve
from granular_contact.engines.tree.solve import Solve as SolveTree
from granular_contact.engines.tree.tree import tree
from granular_contact.mechanics.kinematics import Kinematics
from granular_contact.results import Results
from granular_contact.run import run
from granular_contact.scene import build as build_scene
from validation.chains import chain
from validation.study import Claim, Outcome, script
from validation.tables import markdown

Vector = NDArray[np.float64]
SIZES, QUICK, ROUNDS = (1, 4, 16, 64), (1, 4), 3
FINEST, FINE = 1e-6, 1e-4  # accuracies of references
ACCURACIES = (3e-2, 1e-2, 3e-3, 1e-3, 1e-4)
END = 0.04  # s
LEVELS = (100.0, 30.0, 10.0)  # um
MECHANISMS = ("runner", "walker", "c_leg", "stepping_leg", "chain", "wheel", "double_pendulum", "free_link")
QUICK_MECHANISMS = ("runner", "walker")
SETTINGS = tuple((method, accuracy) for method in ("minimal", "engine") for accuracy in (1e-2, 3e-3, 1e-3))
LEVEL = 0.3  # % of the path
DROP_AT = 2.0  # times the time of minimal coordinates, within which the engine alone would do


@dataclass(frozen=True)
class Run:
    """Of a solve: processor time (s), steps, time (n,) s and place (n, 2) m of the tip."""

    seconds: float
    steps: int
    time: Vector
    tip: Vector

    def error(self, truth: Run) -> float:
        """Largest distance (um) of the tip from that of a converged run."""
        there = [np.interp(self.time, truth.time, place) for place in truth.tip.T]
        return 1e6 * float(np.linalg.norm(self.tip - np.column_stack(there), axis=1).max())


def minimal(links: int, accuracy: float) -> Run:
    """In minimal coordinates."""
    scene = chain(links, method="minimal", end_time_s=END, accuracy=accuracy)
    made = tree(scene)
    return _timed(SolveTree(made), made.system, scene)


def engine(links: int, accuracy: float) -> Run:
    """By the engine."""
    scene = chain(links, end_time_s=END, accuracy=accuracy)
    system = build(scene)
    return _timed(Solve(system), system, scene)


def _timed(solve: SolveTree | Solve, system: object, scene: object) -> Run:
    began = time.process_time()
    solve.advance()
    seconds, trajectory = time.process_time() - began, solve.trajectory()
    tip, _ = Kinematics(system, trajectory).position(*scene.tip)  # type: ignore[arg-type, attr-defined]
    solve.close()
    return Run(seconds, trajectory.cost.steps, trajectory.time, tip)


def measured(links: int) -> dict[tuple[str, str], tuple[Run, float]]:
    """Runs of one chain by method and setting, each with its error (um) and its least time."""
    truth = minimal(links, FINEST)
    found: dict[tuple[str, str], list[Run]] = {}
    for _ in range(ROUNDS):
        for method, way in (("minimal", minimal), ("engine", engine)):
            for accuracy in ACCURACIES:
                found.setdefault((method, f"{accuracy:g}"), []).append(way(links, accuracy))
    least = {key: min(runs, key=lambda one: one.seconds) for key, runs in found.items()}
    return {key: (one, one.error(truth)) for key, one in least.items()}


def _least(found: dict[tuple[str, str], tuple[Run, float]], method: str, level: float) -> float:
    """Least time (s) of a method at an error of at most `level` (um); infinite if none is so exact."""
    times = [run.seconds for key, (run, error) in found.items() if key[0] == method and error <= level]
    return min(times, default=math.inf)


def mechanism(name: str, method: str, accuracy: float) -> Results:
    """Results of a shipped config."""
    scenario = load(HERE.parent / "configs" / f"{name}.yaml").scenario
    scenario = scenario.replace({"solver.accuracy": accuracy, "solver.step_s": None, "method": method})
    return run(build_scene(scenario), scenario)


def mechanisms(names: Sequence[str]) -> tuple[str, list[float]]:
    """Table of shipped mechanisms by both methods, and the ratios of their least times at equal error."""
    rows, ratios = [], []
    for name in names:
        truth, other = (mechanism(name, method, FINE) for method in ("minimal", "engine"))
        path, least = float(np.linalg.norm(np.diff(_tip(truth), axis=0), axis=1).sum()), {}
        apart = f"{_apart(other, truth) / path:.3f}"
        for method, accuracy in SETTINGS:
            runs = [mechanism(name, method, accuracy) for _ in range(ROUNDS)]
            cost = min((one.summary["cost"] for one in runs), key=lambda cost: cost["solve_s"])
            off, balance = _apart(runs[0], truth) / path, 100.0 * runs[0].summary["energy"]["imbalance_relative"]
            counts = cost["steps"], cost["newton_iterations"], cost["jacobians"]
            numbers = f"{1e3 * cost['solve_s']:.1f}", f"{off:.3f}", apart, f"{balance:.3f}"
            rows.append([name, method, f"{accuracy:g}", *(f"{count}" for count in counts), *numbers])
            if off <= LEVEL:
                least[method] = min(least.get(method, math.inf), cost["solve_s"])
        if len(least) == len(("minimal", "engine")):
            ratios.append(least["engine"] / least["minimal"])
    head = ["mechanism", "method", "accuracy", "steps", "iterations", "Jacobians", "ms"]
    return markdown([*head, "error of path %", "of the engine, fine, %", "of energies %"], rows), ratios


def _apart(one: Results, truth: Results) -> float:
    """Largest distance (cm) of two tips."""
    there = np.column_stack([np.interp(one["time_s"], truth["time_s"], at) for at in _tip(truth).T])
    return 100.0 * float(np.linalg.norm(_tip(one) - there, axis=1).max())


def _tip(results: Results) -> Vector:
    return np.column_stack([results["tip_x_m"], results["tip_y_m"]])


def study(quick: bool) -> Outcome:
    """All chains, and all mechanisms."""
    every, equal, ratios = [], [], []
    for links in QUICK if quick else SIZES:
        found = measured(links)
        for (method, setting), (one, error) in found.items():
            every.append([f"{links}", method, setting, f"{one.steps}", f"{1e3 * one.seconds:.2f}", f"{error:.1f}"])
        for level in LEVELS:
            ours, theirs = _least(found, "minimal", level), _least(found, "engine", level)
            if math.isfinite(ours + theirs):
                ratios.append(theirs / ours)
                cells = [f"{1e3 * ours:.2f}", f"{1e3 * theirs:.2f}", f"{theirs / ours:.1f}"]
                equal.append([f"{links}", f"{level:g}", *cells])
    table, of_mechanisms = mechanisms(QUICK_MECHANISMS if quick else MECHANISMS)
    text = "\n\n".join(
        [
            markdown(["links", "method", "accuracy", "steps", "CPU ms", "error um"], every),
            "At equal error:",
            markdown(["links", "error at most um", "minimal, CPU ms", "engine, CPU ms", "ratio"], equal),
            "Shipped mechanisms:",
            table,
        ]
    )
    detail = f"{min(ratios):.1f} to {max(ratios):.1f} times (within {DROP_AT:g} the engine alone would do)"
    least, most = min(of_mechanisms), max(of_mechanisms)
    spread = f"at {LEVEL:g} % of the path the engine takes {least:.1f} to {most:.1f} times as long"
    return Outcome(
        text,
        (
            Claim("minimal_cost.minimal coordinates earn their code", min(ratios) > DROP_AT, detail),
            Claim("minimal_cost.and are faster on every mechanism", least > 1.0, spread),
        ),
    )


if __name__ == "__main__":
    raise SystemExit(script(study))
