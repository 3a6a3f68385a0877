"""Benefit of each part of the numerics: shipped runs by the engine with one part at a time switched off or changed.

    python validation/numerics.py [--quick]

The constants are in `granular_contact/mechanics/kernels/numerics.py`. Each config runs by the engine (also the chain,
which is shipped for minimal coordinates), as shipped and with every change. Run times are processor times of the solve,
the least of two rounds in turn. The error is that of `default_steps`: the greatest difference of any coordinate from a
fine run without changes, over the longest path length. A part pays if a run without it takes at least 1.25 times as
long, or has more than twice the error, or does not reach its end.
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
    """Results of a run: processor time of the solve (s), cost with its counts, and error over the path length."""

    seconds: float
    cost: Cost
    error: float


def _without_acceleration(solver: Any, _lever: Any, apply: Any, allowed: Any) -> Predictor:
    return Predictor(solver, None, apply, allowed)


def _with_full_newton(scene: Any) -> Any:
    simulation = settings.settings(scene)
    simulation.timeIntegration.newton.useModifiedNewton = False
    return simulation


def _with_full_matrices(scene: Any) -> Any:
    simulation = settings.settings(scene)
    simulation.linearSolver.solverType = exu.LinearSolverType.EigenDense
    return simulation


def _with_tolerance(factor: float) -> Callable[[Any], Any]:
    def changed_settings(scene: Any) -> Any:
        simulation = settings.settings(scene)
        simulation.timeIntegration.newton.absoluteTolerance *= factor
        return simulation

    return changed_settings


# Changes by name: object, attribute and its new value.
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
    """Apply a change within the block."""
    patches = [patch.object(*change) for change in CHANGES[name]]
    for active in patches:
        active.start()
    try:
        yield
    finally:
        for active in patches:
            active.stop()


def solved(config: str, sets: tuple[str, ...]) -> tuple[Run, Cost, float]:
    """Solve a config by the engine; return the run, its cost and the processor time of the solve (s)."""
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
    """Run a config with each change; results by name of the change."""
    solver = scene_of(config, ()).solver
    fine = fixed(FINER * solver.step_s) if solver.accuracy is None else (f"solver.accuracy={REFERENCE}",)
    reference, *_ = solved(config, fine)
    results: dict[str, Solved] = {}
    for _ in range(ROUNDS):
        for name in CHANGES:
            with changed(name):
                run, cost, seconds = solved(config, ())
            ended = run.ending in ("end_time", "rest")
            least = min(seconds, results[name].seconds) if name in results else seconds
            results[name] = Solved(least, cost, run.error(reference) / reference.way if ended else math.inf)
    return results


def gain(modified: Solved, shipped: Solved) -> float:
    """Run time of a changed run over the shipped one; infinite if its error is more than WORSE times the latter's."""
    worse = modified.error > WORSE * max(shipped.error, LEAST)
    return math.inf if worse else modified.seconds / shipped.seconds


def cell(modified: Solved, shipped: Solved) -> str:
    """Cell of the table: run time over that of the shipped run, iterations and Jacobians, and the error in per cent."""
    counts = f"{modified.cost.newton_iterations}, {modified.cost.jacobians}"
    if modified is shipped:
        return f"{modified.seconds:.3f} s; {counts}; {1e2 * modified.error:.3f}"
    return f"{modified.seconds / shipped.seconds:.2f}; {counts}; {1e2 * modified.error:.3f}"


def _ratio(ratio: float) -> str:
    return "lost accuracy" if math.isinf(ratio) else f"{ratio:.2f}"


def constants() -> list[str]:
    """Names of the constants in the module `numerics`."""
    body = ast.parse(Path(numerics.__file__).read_text(encoding="utf-8")).body
    return [
        node.targets[0].id for node in body if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name)
    ]


def study(quick: bool) -> Outcome:
    """Run all configs with all changes."""
    every = {config: measured(config) for config in (QUICK if quick else CONFIGS)}
    rows = [[name, *(cell(results[name], results["as shipped"]) for results in every.values())] for name in CHANGES]
    most = {
        name: max((gain(results[name], results["as shipped"]), config) for config, results in every.items())
        for name in PARTS
    }
    parts = [f"{name} {_ratio(ratio)} ({config})" for name, (ratio, config) in most.items()]
    useless = [line for name, line in zip(PARTS, parts, strict=True) if most[name][0] < PAYS]
    names = constants()
    return Outcome(
        f"{markdown(['change', *every], rows)}",
        (
            Claim(
                "numerics.each part saves time",
                not useless,
                f"{', '.join(parts)}; required: {PAYS:g} on at least one config",
            ),
            Claim("numerics.few constants", len(names) <= MOST_CONSTANTS, f"{len(names)} (required: {MOST_CONSTANTS})"),
        ),
    )


if __name__ == "__main__":
    raise SystemExit(script(study))
