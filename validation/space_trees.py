"""Random trees in space: minimal coordinates against the engine, and the promise of `solver.accuracy`.

    python validation/space_trees.py [--quick]

Trees of up to five bodies on free, hinge, slider and ball joints, with springs, stops, friction and prescribed motions,
over sand or in vacuum (`validation/random_scenes/space_trees.py`). Both engines solve each with an accuracy of FINE.
The compared points are the centre of each body and the ends of its three axes, at the distance of the body's radius.
The table has the greatest distance between both solutions at any of 101 instants, relative to the longest path length
of a point. A tree that tumbles over sand on edges and corners amplifies the error of the steps. The distance between
runs in minimal coordinates with FINE and with twice FINE shows by how much (*finer steps*). Where the engine fails, it
runs again with the larger tolerance that its message names.

The promise: errors of the first trees at an accuracy, against runs with FINE, over the accuracy times the path length.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

import numpy as np
from numpy.typing import NDArray

from granular_contact.config import load
from granular_contact.mechanics.space.kinematics import SpatialKinematics
from granular_contact.results import Status
from granular_contact.results.interpolation import at_times
from granular_contact.run import begin
from granular_contact.scene import build
from validation.random_scenes.space_trees import random_tree
from validation.study import Claim, Outcome, script
from validation.tables import markdown

Vector = NDArray[np.float64]
TREES, TREES_QUICK, PROMISED, PROMISED_QUICK = 200, 4, 20, 2
FINE, APART, ACCURACIES, INSTANTS = 3e-5, 1e-4, (1e-2, 1e-3), 101
LEAST_WAY, LARGER = 1e-3, 1e-3  # m; tolerance of the engine where it fails with the default


@dataclass(frozen=True)
class Solved:
    """Paths of points (points, instants, 3) m, processor time (s) of the solve, and status at its end."""

    ways: Vector
    seconds: float
    status: Status


def solved(seed: int, method: str, accuracy: float, tolerance: float | None = None) -> Solved:
    """Solve a random tree by a method with an accuracy, and with another tolerance if one is given."""
    changes = {"method": method, "solver.accuracy": accuracy, "solver.tolerance": tolerance}
    scenario = load(random_tree(seed)).scenario.replace(changes)
    begun = begin(build(scenario))
    began = time.process_time()
    begun.solving.advance()
    spent = time.process_time() - began
    trajectory, at = begun.solving.trajectory(), np.linspace(0.0, scenario.solver.end_time_s, INSTANTS)
    paths = [at_times(trajectory.time, x, v, at) for x, v in points(SpatialKinematics(begun.system, trajectory))]
    begun.solving.close()
    return Solved(np.array(paths), spent, trajectory.status)


def points(motion: SpatialKinematics) -> Iterator[tuple[Vector, Vector]]:
    """Positions (n, 3) m and velocities (n, 3) m/s of the centre of each body and of the ends of its axes."""
    for body in motion.scene.rigid:
        (x, v), w, size = motion.center(body.name), motion.spin(body.name), motion.scene.radius(body)
        for arm in (np.zeros_like(x), *np.moveaxis(size * motion.rotation(body.name), 2, 0)):
            yield x + arm, v + np.cross(w, arm)


def apart(paths: Vector, other: Vector) -> float:
    """Greatest distance between the same points of two solutions, relative to the longest path length in the first."""
    longest = np.linalg.norm(np.diff(paths, axis=1), axis=2).sum(axis=1).max()
    return float(np.linalg.norm(paths - other, axis=2).max() / max(longest, LEAST_WAY))


@dataclass(frozen=True)
class Row:
    """Comparison of the solutions of a tree.

    engine: distance from the engine's motion, infinite where the engine failed; own: distance from the coarser run in
    minimal coordinates; seconds: processor time in minimal coordinates and of the engine; status: empty if the engine
    reached the end with the default tolerance, else its message.
    """

    seed: int
    engine: float
    own: float
    seconds: tuple[float, float]
    status: str


def compared(seed: int) -> Row:
    """Solve a tree in minimal coordinates and by the engine, and compare the motions."""
    minimal, by_engine = (solved(seed, method, FINE) for method in ("minimal", "engine"))
    coarser = solved(seed, "minimal", 2.0 * FINE)
    for solution in (minimal, coarser):
        if solution.status.code != "end_time":
            raise RuntimeError(f"seed {seed} in minimal coordinates: {solution.status.message}")
    problem = "" if by_engine.status.code == "end_time" else by_engine.status.message
    if problem:
        by_engine = solved(seed, "engine", FINE, LARGER)
    engine = apart(minimal.ways, by_engine.ways) if by_engine.status.code == "end_time" else np.inf
    own, seconds = apart(minimal.ways, coarser.ways), (minimal.seconds, by_engine.seconds)
    return Row(seed, engine, own, seconds, problem)


def promise(trees: int) -> tuple[list[list[str]], list[str]]:
    """Rows of the table of errors over the promise, and the seeds that break it."""
    broken, rows = [], []
    fine = [solved(seed, "minimal", FINE).ways for seed in range(trees)]
    for accuracy in ACCURACIES:
        ratios = [apart(fine[i], solved(i, "minimal", accuracy).ways) / accuracy for i in range(trees)]
        broken += [f"seed {i} at {accuracy:g}: {ratio:.2f}" for i, ratio in enumerate(ratios) if ratio > 1.0]
        rows.append([f"{accuracy:g}", *(f"{ratio:.2f}" for ratio in np.percentile(ratios, (50, 90, 100)))])
    return rows, broken


def study(quick: bool) -> Outcome:
    """Run all trees."""
    rows = [compared(seed) for seed in range(TREES_QUICK if quick else TREES)]
    finished, failed_first = [row for row in rows if np.isfinite(row.engine)], [row for row in rows if row.status]
    off = np.array([[row.engine, row.own] for row in finished])
    shares = np.percentile(off, (50, 90, 99, 100), axis=0).T
    table = [
        [name, *(f"{share:.1e}" for share in row)] for name, row in zip(("engine", "finer steps"), shares, strict=True)
    ]
    text = markdown(["distance over path length, from", "median", "90 %", "99 %", "largest"], table)
    spent = np.sum([row.seconds for row in finished], axis=0)
    text += f"\n\n{len(finished)} trees: {spent[0]:.0f} CPU s in minimal coordinates, {spent[1]:.0f} with the engine."
    text += "\n\n" + _listed("Largest distances", sorted(finished, key=lambda row: -row.engine)[:8])
    for row in failed_first:
        then = f"with {LARGER:g}: {row.engine:.1e}" if np.isfinite(row.engine) else f"it also gave up with {LARGER:g}"
        text += f"\n\nThe engine gave up on seed {row.seed}: {row.status}; {then}."
    table, broken = promise(PROMISED_QUICK if quick else PROMISED)
    text += "\n\n" + markdown(["accuracy", "error / promise: median", "90 %", "largest"], table)
    close = int((off[:, 0] <= APART).sum())
    detail = f"{close} of {len(rows)} within {APART:g} of the path length"
    if failed_first:
        detail += f", {len(failed_first)} of them with a tolerance of {LARGER:g} in the engine"
    claims = (
        Claim("space_trees.both engines give the same motion of random trees", close == len(rows), detail),
        Claim("space_trees.twenty trees keep their accuracy", not broken, ", ".join(broken) or "all of them"),
    )
    return Outcome(text, claims)


def _listed(head: str, rows: list[Row]) -> str:
    return f"{head} (finer steps): " + ", ".join(f"seed {row.seed} {row.engine:.1e} ({row.own:.1e})" for row in rows)


if __name__ == "__main__":
    raise SystemExit(script(study))
