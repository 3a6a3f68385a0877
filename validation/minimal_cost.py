"""Minimal coordinates beside the engine on trees of rigid bodies, for whether a method of its own is worth its code.

    python validation/minimal_cost.py [--quick]

Straight chains of rigid links that strike sand with the tip (validation/chains.py), solved in minimal coordinates with
several tolerances, and by the engine with steps chosen by their error. Times are processor time of the solve, the least
of three rounds in turn; errors are the largest distance of the tip from a run in minimal coordinates with a tolerance
of 1e-9 and steps of at most 10 us. The last table compares at equal error: the cheapest run of each method that is no
farther off.
"""

from __future__ import annotations

import math
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

sys.path.insert(0, str(Path(__file__).parents[1]))

from granular_contact.minimal.solve import Solve as SolveTree
from granular_contact.minimal.tree import tree
from granular_contact.multibody.build import build
from granular_contact.multibody.kinematics import Kinematics
from granular_contact.multibody.solve import Solve
from validation.chains import chain
from validation.study import Claim, Outcome, script
from validation.tables import markdown

Vector = NDArray[np.float64]
SIZES, QUICK, ROUNDS = (1, 4, 16, 64), (1, 4), 3
TOLERANCES = ((1e-2, 8e-4), (1e-3, 4e-4), (1e-5, 2e-4))  # rtol, longest step (s)
FINEST = (1e-9, 1e-5)
ACCURACIES = (1e-2, 1e-3, 1e-4)
END = 0.04  # s
LEVELS = (100.0, 30.0, 10.0)  # um
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


def minimal(links: int, rtol: float, longest: float) -> Run:
    """In minimal coordinates."""
    scene = chain(links, method={"minimal": {"rtol": rtol}}, end_time_s=END, step_s=longest)
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
    truth = minimal(links, *FINEST)
    found: dict[tuple[str, str], list[Run]] = {}
    for _ in range(ROUNDS):
        for rtol, longest in TOLERANCES:
            words = f"rtol {rtol:g}, steps to {1e3 * longest:g} ms"
            found.setdefault(("minimal", words), []).append(minimal(links, rtol, longest))
        for accuracy in ACCURACIES:
            found.setdefault(("engine", f"accuracy {accuracy:g}"), []).append(engine(links, accuracy))
    least = {key: min(runs, key=lambda one: one.seconds) for key, runs in found.items()}
    return {key: (one, one.error(truth)) for key, one in least.items()}


def _least(found: dict[tuple[str, str], tuple[Run, float]], method: str, level: float) -> float:
    """Least time (s) of a method at an error of at most `level` (um); infinite if none is so exact."""
    times = [run.seconds for key, (run, error) in found.items() if key[0] == method and error <= level]
    return min(times, default=math.inf)


def study(quick: bool) -> Outcome:
    """All chains."""
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
    text = "\n\n".join(
        [
            markdown(["links", "method", "setting", "steps", "CPU ms", "error um"], every),
            "At equal error:",
            markdown(["links", "error at most um", "minimal, CPU ms", "engine, CPU ms", "ratio"], equal),
        ]
    )
    detail = f"{min(ratios):.1f} to {max(ratios):.1f} times (within {DROP_AT:g} the engine alone would do)"
    return Outcome(text, (Claim("minimal_cost.minimal coordinates earn their code", min(ratios) > DROP_AT, detail),))


if __name__ == "__main__":
    raise SystemExit(script(study))
