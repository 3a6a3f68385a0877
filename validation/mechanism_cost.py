"""Cost of the shipped mechanisms: steps, iterations, Jacobians and processor time, with their errors.

    python validation/mechanism_cost.py [--quick]

Each mechanism runs as shipped, with fixed steps (`FIXED`, `BENDING`), and with adaptive steps. Run times are processor
times of the solve alone, after a warm-up, the least of some repeats in turn, since other programs on the machine can
only add to them. The error is the largest distance of the tip from the path of a run with an accuracy of 1e-4, over the
length of the path. That reference is compared with a run with a quarter of the fixed step.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

sys.path.insert(0, str(Path(__file__).parents[1]))

from granular_contact.config import load_scenario
from granular_contact.mechanics.kinematics import Kinematics
from granular_contact.results import Cost
from granular_contact.run import begin
from granular_contact.scene import build
from validation.study import Claim, Outcome, script
from validation.tables import markdown

Vector = NDArray[np.float64]
CONFIGS = Path(__file__).parents[1] / "configs"
# Fixed step (s) by config.
FIXED = {"runner": 2e-4, "walker": 5e-4, "c_leg": 2e-4, "stepping_leg": 5e-4, "chain": 1e-4}
BENDING = {"flexible_leg": 5e-4, "chain_flexible": 1e-4}
ACCURACIES = (1e-2, 1e-3)
REFERENCE, FINER = 1e-4, 0.25
PROMISED = 1.5  # error allowed, relative to the accuracy; README states it, too
LIMITS = {"runner": 0.35, "walker": 1.5}  # CPU s of the solve, for an error of at most NEAR
NEAR = 3e-3
SHIPPED = "shipped"


@dataclass(frozen=True)
class Run:
    """Result of a solve: cost, least processor time (s), times (n,) s and positions (n, 2) m of the tip."""

    cost: Cost
    seconds: float
    time: Vector
    tip: Vector

    @property
    def way(self) -> float:
        """Path length of the tip (m)."""
        return float(np.linalg.norm(np.diff(self.tip, axis=0), axis=1).sum())

    def error(self, other: Run) -> float:
        """Largest distance (m) of the tip from that of a finer run."""
        reference = [np.interp(self.time, other.time, place) for place in other.tip.T]
        return float(np.linalg.norm(self.tip - np.column_stack(reference), axis=1).max())


def run(name: str, *overrides: str) -> Run:
    """Solve a config with overrides, by the engine or in minimal coordinates, as its method is."""
    scene = build(load_scenario(CONFIGS / f"{name}.yaml", overrides))
    begun = begin(scene)
    began = time.process_time()
    begun.solving.advance()
    seconds, trajectory = time.process_time() - began, begun.solving.trajectory()
    tip, _ = Kinematics(begun.system, trajectory).position(*scene.tip)
    begun.solving.close()
    return Run(trajectory.cost, seconds, trajectory.time, tip)


def settings(step: float) -> dict[str, tuple[str, ...]]:
    """Overrides by name of the setting; step: fixed step, s."""
    chosen = {f"accuracy {accuracy:g}": (f"solver.accuracy={accuracy}",) for accuracy in ACCURACIES}
    return {SHIPPED: (), f"steps of {1e3 * step:g} ms": ("solver.accuracy=null", f"solver.step_s={step}"), **chosen}


def measured(name: str, step: float, repeats: int) -> tuple[dict[str, Run], Run, float]:
    """Runs of all settings, the reference, and the distance (m) of a run with finer fixed steps from the reference."""
    reference = run(name, f"solver.accuracy={REFERENCE}")
    check = run(name, "solver.accuracy=null", f"solver.step_s={FINER * step}").error(reference)
    runs: dict[str, Run] = {}
    for _ in range(repeats):
        for setting, overrides in settings(step).items():
            latest = run(name, *overrides)
            before = runs.get(setting)
            runs[setting] = latest if before is None else replace(before, seconds=min(before.seconds, latest.seconds))
    return runs, reference, check


def row(name: str, setting: str, result: Run, reference: Run) -> list[str]:
    """Row of the table."""
    cost, end = result.cost, result.time[-1]
    counts = [f"{cost.steps}", f"{cost.newton_iterations}", f"{cost.jacobians}"]
    error = result.error(reference) / reference.way
    return [name, setting, *counts, f"{result.seconds:.3f}", f"{result.seconds / end:.2f}", f"{1e2 * error:.3f}"]


def study(quick: bool) -> Outcome:
    """Run all mechanisms."""
    rows, checks, claims, promises, slower = [], [], [], [], []
    newton: dict[str, Cost] = {}
    for name, step in (FIXED if quick else FIXED | BENDING).items():
        runs, reference, check = measured(name, step, 2 if quick else 3)
        rows += [row(name, setting, result, reference) for setting, result in runs.items()]
        checks.append(f"{name} {1e2 * check / reference.way:.3f} %")
        errors = {accuracy: runs[f"accuracy {accuracy:g}"].error(reference) / reference.way for accuracy in ACCURACIES}
        promises += [(error / accuracy, name, accuracy) for accuracy, error in errors.items()]
        shipped, fixed = runs[SHIPPED], runs[f"steps of {1e3 * step:g} ms"]
        if shipped.cost.steps != fixed.cost.steps:  # skipped if the config is shipped with these steps
            slower.append((shipped.seconds / fixed.seconds, name))
        newton[name] = shipped.cost
        if name in LIMITS:
            error = shipped.error(reference) / reference.way
            held = shipped.seconds <= LIMITS[name] and error <= NEAR
            detail = (
                f"{shipped.seconds:.2f} CPU s at {1e2 * error:.2f} % of the path (required: {LIMITS[name]:g} s, 0.3 %)"
            )
            claims.append(Claim(f"mechanism_cost.{name} is fast", held, detail))
    head = ["mechanism", "steps", "number", "iterations", "Jacobians", "CPU s", "CPU s per s", "error of path %"]
    return Outcome(
        f"{markdown(head, rows)}\n\nErrors of fixed steps of a quarter of the shipped length, against the "
        f"reference: {', '.join(checks)}.",
        (*claims, _few_jacobians(newton), *_on_all(promises, slower)),
    )


def _few_jacobians(newton: dict[str, Cost]) -> Claim:
    worst, name = max((cost.jacobians / cost.steps, name) for name, cost in newton.items())
    return Claim(
        "mechanism_cost.fewer Jacobians than steps",
        worst < 1.0,
        f"at most {worst:.2f} per step with shipped settings ({name}; required: less than 1)",
    )


def _on_all(promises: Sequence[tuple[float, str, float]], slower: Sequence[tuple[float, str]]) -> list[Claim]:
    worst, where, accuracy = max(promises)
    ratio, slowest = max(slower)
    return [
        Claim(
            "mechanism_cost.accuracy is kept",
            worst <= PROMISED,
            f"at most {worst:.2f} times the accuracy asked for ({where}, {accuracy:g}; required: {PROMISED:g})",
        ),
        Claim(
            "mechanism_cost.shipped settings are no slower than fixed steps",
            ratio <= 1.0,
            f"at most {ratio:.2f} times their time, in configs that do not ship the same fixed steps ({slowest})",
        ),
    ]


if __name__ == "__main__":
    raise SystemExit(script(study))
