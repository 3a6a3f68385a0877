"""What the granular load costs in the engine: no sand, the plugin, and one Python load function per quadrature point.

    python validation/load_cost.py

The pendulum of configs/pendulum.yaml with 16 elements, 0.1 ms steps, processor time of the solve only. The plugin must
cost at most half as much again as no sand at all. The naive way is measured as one first writes it, and as it is once
it has been made fast and the engine is told to differentiate loads.
"""

from __future__ import annotations

import statistics
import sys
import time
from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from dataclasses import replace
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[1]))

from granular_contact.config import load_scenario
from granular_contact.engines.exudyn.build import System, build
from granular_contact.engines.exudyn.solve import settings, solve
from granular_contact.results import Cost
from granular_contact.scene import Scene
from granular_contact.scene import build as build_scene
from validation.naive import FloatPoint, VectorPoint, add_points
from validation.tables import machine, markdown

CONFIG = Path(__file__).parents[1] / "configs" / "pendulum.yaml"
SETTINGS = [
    "model.bodies.link.flexible.elements=16",
    "solver.step_s=1e-4",
    "solver.end_time_s=0.04",
    "solver.rest_time_s=null",
]


class _PointBed:
    """Stands where the bed stands in a system, so that the same recorder serves the naive way."""

    active = True  # whether anything may be touched
    building_s = 0.0  # nothing is built before the solve

    def __init__(self, system: System, points: list[FloatPoint]) -> None:
        self.system, self.points, self.load_calls = system, points, 0
        self.load = self.history = self.overlay = self

    def apply(self, _: float) -> None:
        """The engine asks the points itself."""

    def unasked(self) -> AbstractContextManager[None]:
        """It goes on asking."""
        return nullcontext()

    def since(self, _: float) -> None:
        """No history is kept."""

    def accept(self) -> None:
        """Let the points keep the present state of the system."""
        for point in self.points:
            point.accept(self.system.mbs)

    def accept_state(self, *_: object) -> None:
        """`accept`, whatever the state."""
        self.accept()


def by_processor(system: System, **options: Any) -> Cost:
    """Cost of a solve, with the processor time that it took (s), which other programs hardly change."""
    began = time.process_time()
    cost = solve(system, **options).cost
    return replace(cost, solve_s=time.process_time() - began)


def solve_naive(sand: Scene, kind: type[FloatPoint], load_jacobian: int) -> Cost:
    """Cost of the scene with a Python load function per point; load_jacobian: the engine's `computeLoadsJacobian`."""
    system = replace(build(replace(sand, bed=None)), scene=sand)
    points = add_points(system, kind)
    simulation = settings(sand)
    simulation.timeIntegration.computeLoadsJacobian = load_jacobian
    return by_processor(replace(system, bed=_PointBed(system, points)), simulation=simulation)


def main(repeats: int = 5) -> int:
    """Print the table; 0 when the plugin keeps its bound, else 1."""
    sand = build_scene(load_scenario(CONFIG, SETTINGS))
    vacuum = replace(sand, bed=None)
    ways: dict[str, Callable[[], Cost]] = {
        "no sand": lambda: by_processor(build(vacuum)),
        "plugin": lambda: by_processor(build(sand)),
        "naive, NumPy": lambda: solve_naive(sand, VectorPoint, 0),
        "naive, floats": lambda: solve_naive(sand, FloatPoint, 0),
        "naive, floats, load Jacobian": lambda: solve_naive(sand, FloatPoint, 2),
    }
    # In turn, not one after the other: a machine that slows down for a while then slows all of them.
    costs = [{name: way() for name, way in ways.items()} for _ in range(repeats + 1)][1:]
    seconds = {name: statistics.median(cost[name].solve_s for cost in costs) for name in ways}
    rows = []
    for name, value in seconds.items():
        last = costs[-1][name]
        ratios = [f"{value / seconds[other]:.2f}" for other in ("no sand", "plugin")]
        rows.append([name, f"{1e3 * value:.1f}", *ratios, last.newton_iterations, last.steps])
    print(f"{machine('exudyn', 'numba')}; median of {repeats} after a warm-up\n")
    print(markdown(["load", "CPU ms", "to no sand", "to the plugin", "Newton iterations", "steps"], rows))
    return 0 if seconds["plugin"] <= 1.5 * seconds["no sand"] else 1


if __name__ == "__main__":
    sys.exit(main())
