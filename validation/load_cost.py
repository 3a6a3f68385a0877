"""CPU time of the granular load in the engine: no sand, the plugin, and one Python load function per quadrature point.

    python validation/load_cost.py

The case is the pendulum of configs/pendulum.yaml with 16 elements and steps of 0.1 ms; times are processor times of the
solve only. A run with the plugin must take at most 1.5 times as long as one without sand. The naive implementation is
measured in its simplest form, and in an optimised form, with and without load Jacobian of the engine.

In space the same link strikes the same sand: as a link of a scene (rigid elements, by the engine and in minimal
coordinates), and as cables in a script, hinged at the pivot; in media of bars and of surfaces. A run by the engine or
with cables must take at most 1.6 times as long as one without sand.
"""

from __future__ import annotations

import statistics
import sys
import time
from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import exudyn as exu
import numpy as np
from exudyn import itemInterface as items

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE.parent), str(HERE.parent / "tests" / "space")]

from support_bending import into_space, pendulum

from granular_contact import GranularBed, load, preset
from granular_contact.config import load_scenario
from granular_contact.engines.exudyn.build import System, build
from granular_contact.engines.exudyn.solve import settings, solve
from granular_contact.results import Cost
from granular_contact.run import begin
from granular_contact.scene import Scene
from granular_contact.scene import build as build_scene
from validation.naive import FloatPoint, VectorPoint, add_points
from validation.spatial_beam import heavy_cables, hold, implicit
from validation.study import Claim, Outcome, script
from validation.tables import markdown

CONFIG = HERE.parent / "configs" / "pendulum.yaml"
STEP, END, ELEMENTS = 1e-4, 0.04, 16
PLANE, SPACE = 1.5, 1.6  # run time allowed, relative to no sand
MEDIA = None, "play_sand", "rft3d_sand"
OUT_OF_REACH = "rft3d_sand out of reach"  # case that shows the cost of the engine's call into Python
SETTINGS = [
    f"model.bodies.link.flexible.elements={ELEMENTS}",
    f"solver.step_s={STEP}",
    f"solver.end_time_s={END}",
    "solver.rest_time_s=null",
]


class _PointBed:
    """Stand-in for the bed of a system, so that the recorder also works with the naive implementation."""

    active = True  # contact is possible
    building_s = 0.0  # no time for building before the solve

    def __init__(self, system: System, points: list[FloatPoint]) -> None:
        self.system, self.points, self.load_calls = system, points, 0
        self.load = self.history = self.overlay = self

    def apply(self, _: float) -> None:
        """Do nothing, as the engine calls the points itself."""

    def untriggered(self) -> AbstractContextManager[None]:
        """Change nothing: the engine keeps calling the points."""
        return nullcontext()

    def since(self, _: float) -> None:
        """Do nothing, as there is no history."""

    def accept(self) -> None:
        """Let the points accept the present state of the system."""
        for point in self.points:
            point.accept(self.system.mbs)

    def accept_state(self, *_: object) -> None:
        """Call `accept`, with any arguments."""
        self.accept()


def by_processor(system: System, **options: Any) -> Cost:
    """Cost of a solve, with its processor time (s) as time, which other programs hardly change."""
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


# ---- in space ----


def of_scene(medium: str | None, method: str) -> Callable[[], tuple[float, int, int]]:
    """Function that solves the scene of a link and returns processor time (s), iterations and steps."""
    given = into_space(pendulum(15.1642, ELEMENTS), 0.0)
    given["solver"] = {"end_time_s": END, "step_s": STEP, "rest_time_s": None}
    scene = build_scene(load(given | {"medium": medium, "method": method}).scenario)

    def solve_once() -> tuple[float, int, int]:
        solving = begin(scene).solving
        began = time.process_time()
        solving.advance()
        seconds, cost = time.process_time() - began, solving.trajectory().cost
        solving.close()
        return seconds, cost.newton_iterations, cost.steps

    return solve_once


def of_cables(medium: str | None, lower: float = 0.0) -> tuple[float, int, int]:
    """Solve 16 hinged cables in a script, which start as a straight rotating link.

    lower: depth of the surface below the tip at the start, m. Returns processor time (s), iterations and steps.
    """
    link = build_scene(load(pendulum(15.1642, ELEMENTS)).scenario).links[0]
    mbs, angle, rate = exu.SystemContainer().AddSystem(), np.radians(31.0), 6.24
    along, turned = (
        np.array([np.cos(angle), 0.0, -np.sin(angle)]),
        -rate * np.array([np.sin(angle), 0.0, np.cos(angle)]),
    )
    nodes = [
        mbs.AddNode(
            items.NodePointSlope1(
                referenceCoordinates=[*(s * along), *along], initialVelocities=[*(s * turned), *turned]
            )
        )
        for s in np.linspace(0.0, link.length, ELEMENTS + 1)
    ]
    line = {"massPerLength": link.mass / link.length, "length": link.length / ELEMENTS}
    stiff = {"bendingStiffness": link.bending_stiffness, "axialStiffness": link.axial_stiffness}
    cables = heavy_cables(mbs, nodes, **line, **stiff)
    hold(mbs, nodes[0], range(3))
    if medium is not None:
        bed = GranularBed(mbs, preset(medium), float(link.length * along[2]) - lower, up=(0, 0, 1))
        bed.add_cables(cables, link.thickness)
        bed.attach()
    mbs.Assemble()
    exu.config.printToConsole = False
    settings = implicit(END, STEP)
    began = time.process_time()
    mbs.SolveDynamic(settings)
    iterator = mbs.sys["dynamicSolver"].it
    return time.process_time() - began, iterator.newtonStepsCount, iterator.currentStepIndex - 1


def in_space(repeats: int) -> tuple[str, dict[tuple[str, str], float]]:
    """Table of the cost in space, and run times relative to no sand by method and medium."""
    solvers = {
        "link, engine": {medium: of_scene(medium, "engine") for medium in MEDIA},
        "link, minimal coordinates": {medium: of_scene(medium, "minimal") for medium in MEDIA},
        "cables in a script": {
            **{medium: partial(of_cables, medium) for medium in MEDIA},
            OUT_OF_REACH: partial(of_cables, "rft3d_sand", 5.0),
        },
    }
    rows, ratios = [], {}
    for name, by_medium in solvers.items():
        runs = [{medium: once() for medium, once in by_medium.items()} for _ in range(repeats + 1)][1:]
        seconds = {medium: statistics.median(run[medium][0] for run in runs) for medium in by_medium}
        for medium, (_, iterations, steps) in runs[-1].items():
            ratio = statistics.median(run[medium][0] / run[None][0] for run in runs)
            rows.append([name, medium or "no sand", f"{1e3 * seconds[medium]:.1f}", f"{ratio:.2f}", iterations, steps])
            if medium is not None:
                ratios[name, medium] = ratio
    return markdown(["in space", "medium", "CPU ms", "ratio to no sand", "Newton iterations", "steps"], rows), ratios


def study(quick: bool) -> Outcome:
    """Measure processor times with and without sand; quick: two repeats instead of five."""
    repeats = 2 if quick else 5
    sand = build_scene(load_scenario(CONFIG, SETTINGS))
    vacuum = replace(sand, bed=None)
    solvers: dict[str, Callable[[], Cost]] = {
        "no sand": lambda: by_processor(build(vacuum)),
        "plugin": lambda: by_processor(build(sand)),
        "naive, NumPy": lambda: solve_naive(sand, VectorPoint, 0),
        "naive, floats": lambda: solve_naive(sand, FloatPoint, 0),
        "naive, floats, load Jacobian": lambda: solve_naive(sand, FloatPoint, 2),
    }
    # All solvers run in turn in each round, so that a slow phase of the machine affects all of them.
    costs = [{name: solver() for name, solver in solvers.items()} for _ in range(repeats + 1)][1:]
    seconds = {name: statistics.median(cost[name].solve_s for cost in costs) for name in solvers}
    rows = []
    for name, value in seconds.items():
        last = costs[-1][name]
        ratios = [f"{value / seconds[other]:.2f}" for other in ("no sand", "plugin")]
        rows.append([name, f"{1e3 * value:.1f}", *ratios, last.newton_iterations, last.steps])
    table, ratios = in_space(repeats)
    claims = [claim("in the plane", seconds["plugin"] / seconds["no sand"], PLANE)]
    claims += [
        claim(f"{method}, {medium}", r, SPACE) for (method, medium), r in ratios.items() if "minimal" not in method
    ]
    header = ["load", "CPU ms", "ratio to no sand", "ratio to the plugin", "Newton iterations", "steps"]
    text = f"Median of {repeats} after a warm-up.\n\n{markdown(header, rows)}\n\n{table}"
    return Outcome(text, tuple(claims))


def claim(name: str, ratio: float, most: float) -> Claim:
    """Make a claim on a run time relative to the run without sand."""
    return Claim(f"load_cost.{name}", ratio <= most, f"{ratio:.2f} times the run without sand (at most {most:g})")


if __name__ == "__main__":
    sys.exit(script(study))
