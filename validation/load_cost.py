"""What the granular load costs in the engine: no sand, the plugin, and one Python load function per quadrature point.

    python validation/load_cost.py

The pendulum of configs/pendulum.yaml with 16 elements, 0.1 ms steps, processor time of the solve only. The plugin must
cost at most half as much again as no sand at all. The naive way is measured as one first writes it, and as it is once
it has been made fast and the engine is told to differentiate loads.

In space the same link strikes the same sand, as a link of a scene (rigid elements, by the engine and in minimal
coordinates) and as cables of a script, hinged at the pivot; in media of bars and of surfaces. By the engine and as
cables it must cost at most 1.6 times no sand.
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
PLANE, SPACE = 1.5, 1.6  # times no sand
MEDIA = None, "play_sand", "rft3d_sand"
OUT_OF_REACH = "rft3d_sand out of reach"  # what the call from the engine into Python takes
SETTINGS = [
    f"model.bodies.link.flexible.elements={ELEMENTS}",
    f"solver.step_s={STEP}",
    f"solver.end_time_s={END}",
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

    def untriggered(self) -> AbstractContextManager[None]:
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


# ---- in space ----


def of_scene(medium: str | None, method: str) -> Callable[[], tuple[float, int, int]]:
    """Solve a scene: processor time (s), iterations and steps."""
    given = into_space(pendulum(15.1642, ELEMENTS), 0.0)
    given["solver"] = {"end_time_s": END, "step_s": STEP, "rest_time_s": None}
    scene = build_scene(load(given | {"medium": medium, "method": method}).scenario)

    def solve_once() -> tuple[float, int, int]:
        solving = begin(scene).solving
        began = time.process_time()
        solving.advance()
        took, cost = time.process_time() - began, solving.trajectory().cost
        solving.close()
        return took, cost.newton_iterations, cost.steps

    return solve_once


def of_cables(medium: str | None, lower: float = 0.0) -> tuple[float, int, int]:
    """The same of 16 cables of a script, hinged, which begin as a straight link that turns; lower (m): surface."""
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
    done = mbs.sys["dynamicSolver"].it
    return time.process_time() - began, done.newtonStepsCount, done.currentStepIndex - 1


def in_space(repeats: int) -> tuple[str, dict[tuple[str, str], float]]:
    """Table of the cost in space, and how many times no sand it is by way and medium."""
    ways = {
        "link, by the engine": {medium: of_scene(medium, "engine") for medium in MEDIA},
        "link, minimal coordinates": {medium: of_scene(medium, "minimal") for medium in MEDIA},
        "cables of a script": {
            **{medium: partial(of_cables, medium) for medium in MEDIA},
            OUT_OF_REACH: partial(of_cables, "rft3d_sand", 5.0),
        },
    }
    rows, ratios = [], {}
    for name, of in ways.items():
        runs = [{medium: once() for medium, once in of.items()} for _ in range(repeats + 1)][1:]
        seconds = {medium: statistics.median(run[medium][0] for run in runs) for medium in of}
        for medium, (_, iterations, steps) in runs[-1].items():
            ratio = statistics.median(run[medium][0] / run[None][0] for run in runs)
            rows.append([name, medium or "no sand", f"{1e3 * seconds[medium]:.1f}", f"{ratio:.2f}", iterations, steps])
            if medium is not None:
                ratios[name, medium] = ratio
    return markdown(["in space", "medium", "CPU ms", "to no sand", "Newton iterations", "steps"], rows), ratios


def study(quick: bool) -> Outcome:
    """Processor time with and without sand; quick: two repeats in place of five."""
    repeats = 2 if quick else 5
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
    table, ratios = in_space(repeats)
    claims = [claim("in the plane", seconds["plugin"] / seconds["no sand"], PLANE)]
    claims += [claim(f"{way}, {medium}", r, SPACE) for (way, medium), r in ratios.items() if "minimal" not in way]
    header = ["load", "CPU ms", "to no sand", "to the plugin", "Newton iterations", "steps"]
    text = f"Median of {repeats} after a warm-up.\n\n{markdown(header, rows)}\n\n{table}"
    return Outcome(text, tuple(claims))


def claim(name: str, ratio: float, most: float) -> Claim:
    """A claim on a time over that of the run without sand."""
    return Claim(f"load_cost.{name}", ratio <= most, f"{ratio:.2f} times no sand (at most {most:g})")


if __name__ == "__main__":
    sys.exit(script(study))
