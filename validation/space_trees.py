"""Random trees in space: minimal coordinates against the engine, and the promise of `solver.accuracy`.

    python validation/space_trees.py [--quick]

Trees of up to five bodies on free, hinge, slider and ball joints, with springs, stops, friction and prescribed motions,
over sand or in vacuum (`validation/random_scenes/space_trees.py`). Both engines solve each with an accuracy of FINE.
Points are the middle of each body and the ends of its three axes, as far out as it reaches. How far one is from where
the other has it, at any of 101 instants, is told over the longest way of a point. A tree that tumbles over sand on
edges and corners multiplies what steps leave: how much, the distance of runs in minimal coordinates with FINE and twice
that tells (*own steps*). Where the engine gives up it is asked again with the larger tolerance that its message names.

The promise: of the first trees errors at an accuracy, against FINE, over the accuracy times the way.
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
LEAST_WAY, LARGER = 1e-3, 1e-3  # m; tolerance where the engine gives up with the default


@dataclass(frozen=True)
class Solved:
    """Ways of points (points, instants, 3) m, processor time (s) of the solve, and how it ended."""

    ways: Vector
    seconds: float
    status: Status


def solved(seed: int, method: str, accuracy: float, tolerance: float | None = None) -> Solved:
    """A tree solved by a method with an accuracy."""
    changes = {"method": method, "solver.accuracy": accuracy, "solver.tolerance": tolerance}
    scenario = load(random_tree(seed)).scenario.replace(changes)
    begun = begin(build(scenario))
    began = time.process_time()
    begun.solving.advance()
    spent = time.process_time() - began
    found, at = begun.solving.trajectory(), np.linspace(0.0, scenario.solver.end_time_s, INSTANTS)
    made = [at_times(found.time, x, v, at) for x, v in points(SpatialKinematics(begun.system, found))]
    begun.solving.close()
    return Solved(np.array(made), spent, found.status)


def points(motion: SpatialKinematics) -> Iterator[tuple[Vector, Vector]]:
    """Places (n, 3) m and velocities of the middle of each body and of the ends of its axes."""
    for body in motion.scene.rigid:
        (x, v), w, size = motion.center(body.name), motion.spin(body.name), motion.scene.radius(body)
        for arm in (np.zeros_like(x), *np.moveaxis(size * motion.rotation(body.name), 2, 0)):
            yield x + arm, v + np.cross(w, arm)


def apart(one: Vector, other: Vector) -> float:
    """Greatest distance of a point, over the longest way of one."""
    way = np.linalg.norm(np.diff(one, axis=1), axis=2).sum(axis=1).max()
    return float(np.linalg.norm(one - other, axis=2).max() / max(way, LEAST_WAY))


@dataclass(frozen=True)
class Row:
    """A tree: distance from the engine's motion, infinite where the engine gave up, and of its own coarser run.

    status: of the engine's run; empty of one that came to its end, the message with the default tolerance of another.
    """

    seed: int
    engine: float
    own: float
    seconds: tuple[float, float]
    status: str


def compared(seed: int) -> Row:
    """A tree by both engines."""
    ours, theirs = (solved(seed, method, FINE) for method in ("minimal", "engine"))
    coarser = solved(seed, "minimal", 2.0 * FINE)
    for one in (ours, coarser):
        if one.status.code != "end_time":
            raise RuntimeError(f"seed {seed} in minimal coordinates: {one.status.message}")
    problem = "" if theirs.status.code == "end_time" else theirs.status.message
    if problem:
        theirs = solved(seed, "engine", FINE, LARGER)
    engine = apart(ours.ways, theirs.ways) if theirs.status.code == "end_time" else np.inf
    own, seconds = apart(ours.ways, coarser.ways), (ours.seconds, theirs.seconds)
    return Row(seed, engine, own, seconds, problem)


def promise(trees: int) -> tuple[list[list[str]], list[str]]:
    """Rows of a table of errors over the promise, and what breaks it."""
    broken, rows = [], []
    fine = [solved(seed, "minimal", FINE).ways for seed in range(trees)]
    for accuracy in ACCURACIES:
        ratios = [apart(fine[i], solved(i, "minimal", accuracy).ways) / accuracy for i in range(trees)]
        broken += [f"seed {i} at {accuracy:g}: {one:.2f}" for i, one in enumerate(ratios) if one > 1.0]
        rows.append([f"{accuracy:g}", *(f"{one:.2f}" for one in np.percentile(ratios, (50, 90, 100)))])
    return rows, broken


def study(quick: bool) -> Outcome:
    """All trees."""
    rows = [compared(seed) for seed in range(TREES_QUICK if quick else TREES)]
    whole, helped = [row for row in rows if np.isfinite(row.engine)], [row for row in rows if row.status]
    off = np.array([[row.engine, row.own] for row in whole])
    shares = np.percentile(off, (50, 90, 99, 100), axis=0).T
    table = [[name, *(f"{one:.1e}" for one in row)] for name, row in zip(("engine", "own steps"), shares, strict=True)]
    text = markdown(["distance over the way, from", "median", "90 %", "99 %", "most"], table)
    spent = np.sum([row.seconds for row in whole], axis=0)
    text += f"\n\n{len(whole)} trees: {spent[0]:.0f} CPU s in minimal coordinates, {spent[1]:.0f} by the engine."
    text += "\n\n" + _told("Farthest apart", sorted(whole, key=lambda row: -row.engine)[:8])
    for row in helped:
        then = f"with {LARGER:g}: {row.engine:.1e}" if np.isfinite(row.engine) else f"so it did with {LARGER:g}"
        text += f"\n\nThe engine gave up on seed {row.seed}: {row.status}; {then}."
    table, broken = promise(PROMISED_QUICK if quick else PROMISED)
    text += "\n\n" + markdown(["accuracy", "error / promise: median", "90 %", "most"], table)
    close = int((off[:, 0] <= APART).sum())
    words = f"{close} of {len(rows)} within {APART:g} of the way"
    if helped:
        words += f", {len(helped)} of them with a tolerance of {LARGER:g} in the engine"
    claims = (
        Claim("space_trees.both engines move random trees alike", close == len(rows), words),
        Claim("space_trees.accuracy is kept by twenty trees", not broken, ", ".join(broken) or "all of them"),
    )
    return Outcome(text, claims)


def _told(head: str, rows: list[Row]) -> str:
    return f"{head} (own steps): " + ", ".join(f"seed {one.seed} {one.engine:.1e} ({one.own:.1e})" for one in rows)


if __name__ == "__main__":
    raise SystemExit(script(study))
