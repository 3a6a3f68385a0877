"""Minimal coordinates and the engine on trees of rigid bodies: whether a method of its own is worth its code.

    python validation/minimal_cost.py [--quick]

Straight chains of rigid links strike sand with the tip (validation/chains.py). They are solved in minimal coordinates
and by the engine, with adaptive steps. Run times are processor times of the solve, the least of three rounds in turn.
The error is the largest distance of the tip from a run in minimal coordinates with an accuracy of 1e-6. One table
compares the methods at equal error: the cheapest run of each method within an error. The last table has the shipped
mechanisms that are trees of rigid bodies, with both methods. There the error is the largest distance of the tip from a
run in minimal coordinates with an accuracy of 1e-4, over the length of its path. Two more columns have the distance of
the engine's run with the same accuracy from that reference, and the error of the energy balance.
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
FINEST, FINE = 1e-6, 1e-4  # accuracies of the references for chains and for mechanisms
ACCURACIES = (3e-2, 1e-2, 3e-3, 1e-3, 1e-4)
END = 0.04  # s
LEVELS = (100.0, 30.0, 10.0)  # um
MECHANISMS = ("runner", "walker", "c_leg", "stepping_leg", "chain", "wheel", "double_pendulum", "free_link")
QUICK_MECHANISMS = ("runner", "walker")
SETTINGS = tuple((method, accuracy) for method in ("minimal", "engine") for accuracy in (1e-2, 3e-3, 1e-3))
LEVEL = 0.3  # % of the path
DROP_AT = 2.0  # run time of the engine over minimal coordinates, up to which the engine alone is enough


@dataclass(frozen=True)
class Run:
    """Result of a solve: processor time (s), steps, times (n,) s and positions (n, 2) m of the tip."""

    seconds: float
    steps: int
    time: Vector
    tip: Vector

    def error(self, truth: Run) -> float:
        """Largest distance (um) of the tip from that of a converged run."""
        reference = [np.interp(self.time, truth.time, place) for place in truth.tip.T]
        return 1e6 * float(np.linalg.norm(self.tip - np.column_stack(reference), axis=1).max())


def minimal(links: int, accuracy: float) -> Run:
    """Solve a chain in minimal coordinates."""
    scene = chain(links, method="minimal", end_time_s=END, accuracy=accuracy)
    built = tree(scene)
    return _timed(SolveTree(built), built.system, scene)


def engine(links: int, accuracy: float) -> Run:
    """Solve a chain by the engine."""
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
    """Fastest run of a chain by method and setting, each with its error (um)."""
    truth = minimal(links, FINEST)
    runs: dict[tuple[str, str], list[Run]] = {}
    for _ in range(ROUNDS):
        for method, solver in (("minimal", minimal), ("engine", engine)):
            for accuracy in ACCURACIES:
                runs.setdefault((method, f"{accuracy:g}"), []).append(solver(links, accuracy))
    least = {key: min(repeats, key=lambda run: run.seconds) for key, repeats in runs.items()}
    return {key: (fastest, fastest.error(truth)) for key, fastest in least.items()}


def _least(runs: dict[tuple[str, str], tuple[Run, float]], method: str, level: float) -> float:
    """Least time (s) of a method with an error of at most `level` (um); infinite if no run reaches it."""
    times = [run.seconds for key, (run, error) in runs.items() if key[0] == method and error <= level]
    return min(times, default=math.inf)


def mechanism(name: str, method: str, accuracy: float) -> Results:
    """Run a shipped config by a method with an accuracy."""
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
            cost = min((results.summary["cost"] for results in runs), key=lambda cost: cost["solve_s"])
            off, balance = _apart(runs[0], truth) / path, 100.0 * runs[0].summary["energy"]["imbalance_relative"]
            counts = cost["steps"], cost["newton_iterations"], cost["jacobians"]
            numbers = f"{1e3 * cost['solve_s']:.1f}", f"{off:.3f}", apart, f"{balance:.3f}"
            rows.append([name, method, f"{accuracy:g}", *(f"{count}" for count in counts), *numbers])
            if off <= LEVEL:
                least[method] = min(least.get(method, math.inf), cost["solve_s"])
        if len(least) == len(("minimal", "engine")):
            ratios.append(least["engine"] / least["minimal"])
    head = ["mechanism", "method", "accuracy", "steps", "iterations", "Jacobians", "ms"]
    return markdown(
        [*head, "error of path %", "distance from the engine with fine steps %", "error of energies %"], rows
    ), ratios


def _apart(results: Results, truth: Results) -> float:
    """Largest distance (cm) of the tip from that of a reference run."""
    reference = np.column_stack([np.interp(results["time_s"], truth["time_s"], axis) for axis in _tip(truth).T])
    return 100.0 * float(np.linalg.norm(_tip(results) - reference, axis=1).max())


def _tip(results: Results) -> Vector:
    return np.column_stack([results["tip_x_m"], results["tip_y_m"]])


def study(quick: bool) -> Outcome:
    """Run all chains and all mechanisms."""
    every, equal, ratios = [], [], []
    for links in QUICK if quick else SIZES:
        runs = measured(links)
        for (method, setting), (result, error) in runs.items():
            every.append(
                [f"{links}", method, setting, f"{result.steps}", f"{1e3 * result.seconds:.2f}", f"{error:.1f}"]
            )
        for level in LEVELS:
            in_minimal, by_engine = _least(runs, "minimal", level), _least(runs, "engine", level)
            if math.isfinite(in_minimal + by_engine):
                ratios.append(by_engine / in_minimal)
                cells = [f"{1e3 * in_minimal:.2f}", f"{1e3 * by_engine:.2f}", f"{by_engine / in_minimal:.1f}"]
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
    detail = (
        f"{min(ratios):.1f} to {max(ratios):.1f} times as fast (below {DROP_AT:g} the engine alone would be enough)"
    )
    least, most = min(of_mechanisms), max(of_mechanisms)
    spread = f"at {LEVEL:g} % of the path the engine takes {least:.1f} to {most:.1f} times as long"
    return Outcome(
        text,
        (
            Claim(
                "minimal_cost.minimal coordinates are faster than the engine on chains", min(ratios) > DROP_AT, detail
            ),
            Claim(
                "minimal_cost.minimal coordinates are faster than the engine on every mechanism", least > 1.0, spread
            ),
        ),
    )


if __name__ == "__main__":
    raise SystemExit(script(study))
