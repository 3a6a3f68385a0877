"""What each part of the numerics buys: shipped runs by the engine with one part at a time switched off or changed.

    python validation/numerics.py [--quick]

The constants: `granular_contact/mechanics/kernels/numerics.py`. Each config is run as shipped, by the engine (a chain
too, that minimal coordinates suit), and with every change; times are processor time of the solve, the least of two
rounds in turn. An error is that of `default_steps`: the greatest distance of any coordinate from a fine run as shipped,
over the longest way. A part pays if without it a run takes 1.25 times as long or more, or its error is twice as large,
or it does not come to its end.
"""

from __future__ import annotations

import ast
import math
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from unittest.mock import patch

sys.path.insert(0, str(Path(__file__).parents[1]))

import exudyn as exu

from granular_contact.engines.exudyn import settings, solve
from granular_contact.engines.exudyn.build import build
from granular_contact.engines.exudyn.predictor import Predictor
from granular_contact.mechanics import scheme
from granular_contact.mechanics.kernels import numerics
from granular_contact.results import Cost
from validation.accuracy_promise import Run
from validation.default_steps import FINER, REFERENCE, fixed, scene_of
from validation.study import Claim, Outcome, script
from validation.tables import markdown

CONFIGS = "pendulum", "flexible_leg", "chain_flexible", "chain"
QUICK = "pendulum", "chain"
ROUNDS, PAYS, WORSE, LEAST = 2, 1.25, 2.0, 1e-4
MOST_CONSTANTS = 15


@dataclass(frozen=True)
class Solved:
    """A run: processor time of its solve (s), what it counts, its error over the way."""

    seconds: float
    cost: Cost
    error: float


def _without_acceleration(solver: Any, _lever: Any, apply: Any, allowed: Any) -> Predictor:
    return Predictor(solver, None, apply, allowed)


def _with_full_newton(scene: Any) -> Any:
    made = settings.settings(scene)
    made.timeIntegration.newton.useModifiedNewton = False
    return made


def _with_full_matrices(scene: Any) -> Any:
    made = settings.settings(scene)
    made.linearSolver.solverType = exu.LinearSolverType.EigenDense
    return made


def _with_tolerance(factor: float) -> Callable[[Any], Any]:
    def changed_settings(scene: Any) -> Any:
        made = settings.settings(scene)
        made.timeIntegration.newton.absoluteTolerance *= factor
        return made

    return changed_settings


# What is changed: objects, their attributes and what they become.
CHANGES: dict[str, tuple[tuple[Any, str, Any], ...]] = {
    "as shipped": (),
    "start without the last accelerations, no Anderson": ((solve.Solve, "_make_predictor", lambda _: None),),
    "no Anderson acceleration": ((solve, "Predictor", _without_acceleration),),
    "full Newton": ((solve, "settings", _with_full_newton),),
    "a thousandth of the tolerance": ((solve, "settings", _with_tolerance(1e-3)),),
    "ten times the tolerance": ((solve, "settings", _with_tolerance(10.0)),),
    "full matrices": ((solve, "settings", _with_full_matrices),),
    "DAMPED_SPECTRAL_RADIUS 0.9": ((scheme, "DAMPED_SPECTRAL_RADIUS", 0.9),),
    "SPECTRAL_RADIUS 0.5": ((scheme, "SPECTRAL_RADIUS", 0.5),),
    "CONTRACTION 0.25": ((settings, "CONTRACTION", 0.25),),
    "CONTRACTION 0.7": ((settings, "CONTRACTION", 0.7),),
    "MOST_ITERATIONS 14": ((settings, "MOST_ITERATIONS", 14),),
    "MOST_ITERATIONS 60": ((settings, "MOST_ITERATIONS", 60),),
}
PARTS = (
    "start without the last accelerations, no Anderson",
    "no Anderson acceleration",
    "full Newton",
    "DAMPED_SPECTRAL_RADIUS 0.9",
)


@contextmanager
def changed(name: str) -> Iterator[None]:
    """Within it a part is changed."""
    patches = [patch.object(*one) for one in CHANGES[name]]
    for one in patches:
        one.start()
    try:
        yield
    finally:
        for one in patches:
            one.stop()


def solved(config: str, sets: tuple[str, ...]) -> tuple[Run, Cost, float]:
    """A run by the engine, what it cost, and the processor time of its solve (s)."""
    scene = scene_of(config, (*(("method=engine",) if config == "chain" else ()), *sets))
    system = build(scene)
    under_way = solve.Solve(system)
    began = time.process_time()
    under_way.advance()
    seconds = time.process_time() - began
    trajectory = under_way.trajectory()
    place = trajectory.q * system.levers
    under_way.close()
    return Run(trajectory.time, place, trajectory.status.code), trajectory.cost, seconds


def measured(config: str) -> dict[str, Solved]:
    """Runs of a config by what is changed."""
    solver = scene_of(config, ()).solver
    fine = fixed(FINER * solver.step_s) if solver.accuracy is None else (f"solver.accuracy={REFERENCE}",)
    reference, *_ = solved(config, fine)
    found: dict[str, Solved] = {}
    for _ in range(ROUNDS):
        for name in CHANGES:
            with changed(name):
                one, cost, seconds = solved(config, ())
            ended = one.ending in ("end_time", "rest")
            least = min(seconds, found[name].seconds) if name in found else seconds
            found[name] = Solved(least, cost, one.error(reference) / reference.way if ended else math.inf)
    return found


def gain(one: Solved, shipped: Solved) -> float:
    """How many times as long a changed run takes; infinite where its error is WORSE times that of the shipped one."""
    worse = one.error > WORSE * max(shipped.error, LEAST)
    return math.inf if worse else one.seconds / shipped.seconds


def cell(one: Solved, shipped: Solved) -> str:
    """Of the table: time, iterations and Jacobians over those of the shipped run, and the error in per cent."""
    counts = f"{one.cost.newton_iterations}, {one.cost.jacobians}"
    if one is shipped:
        return f"{one.seconds:.3f} s; {counts}; {1e2 * one.error:.3f}"
    return f"{one.seconds / shipped.seconds:.2f}; {counts}; {1e2 * one.error:.3f}"


def _said(ratio: float) -> str:
    return "lost accuracy" if math.isinf(ratio) else f"{ratio:.2f}"


def constants() -> list[str]:
    """Names of the constants of the one module."""
    body = ast.parse(Path(numerics.__file__).read_text(encoding="utf-8")).body
    return [one.targets[0].id for one in body if isinstance(one, ast.Assign) and isinstance(one.targets[0], ast.Name)]


def study(quick: bool) -> Outcome:
    """All configs and changes."""
    every = {config: measured(config) for config in (QUICK if quick else CONFIGS)}
    rows = [[name, *(cell(one[name], one["as shipped"]) for one in every.values())] for name in CHANGES]
    most = {name: max((gain(one[name], one["as shipped"]), config) for config, one in every.items()) for name in PARTS}
    told = [f"{name} {_said(ratio)} ({config})" for name, (ratio, config) in most.items()]
    off = [line for name, line in zip(PARTS, told, strict=True) if most[name][0] < PAYS]
    names = constants()
    return Outcome(
        f"{markdown(['change', *every], rows)}",
        (
            Claim("numerics.each part pays", not off, f"{', '.join(told)}; asked: {PAYS:g} on one config each"),
            Claim("numerics.few constants", len(names) <= MOST_CONSTANTS, f"{len(names)} (asked: {MOST_CONSTANTS})"),
        ),
    )


if __name__ == "__main__":
    raise SystemExit(script(study))
