"""All configs in space: run time, error compared with the accuracy, and energy balance.

    python validation/space_configs.py [--quick]

The cases are the shipped configs and two scenes in which facets of a fixed size failed: a plate and a capsule on a ball
joint, thrown at a slope, and a foot that stands on a ball. "Solve" is the CPU time of the first solve, with compiled
kernels in the cache; "all" is the CPU time of the whole run, with estimates and repetitions. The error is the greatest
distance of any point from a finer run, over the path length of the fastest point; the finer run has facets of a third
of the size, and steps for a third of the error. Bounds: the error is at most the accuracy (of steps 1e-3 and of facets
0.3 % unless the config names one); the energy balance holds at each instant to 1e-3 of the greatest energy; the depths
of the two scenes are within 0.3 % of the finer run, and of the foot within 0.3 % of the law's integral over its cap.
"""

from __future__ import annotations

import math
import sys
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[1]))

from granular_contact import config, scene
from granular_contact import run as run_module
from granular_contact.mechanics.space.kinematics import SpatialKinematics
from granular_contact.sand.space.facets import FACET_ERROR
from validation.facet_estimates import apart
from validation.gallery import number
from validation.study import Claim, Outcome, script
from validation.tables import markdown

CONFIGS, HARD = Path(__file__).parents[1] / "configs", Path(__file__).parent / "hard_facets"
BALANCE, DEPTH, FINER = 1e-3, 3e-3, 3.0
FOOT = 2.767e-3  # m, depth at which the integral of the law over the cap bears the foot's weight
HEAD = ["config", "s", "accuracy", "error", "error estimated by facets", "steps", "facets", "solve s", "whole run s"]
HEAD += ["energy imbalance", "number", "warnings"]


def files(quick: bool) -> list[Path]:
    """Paths of the shipped configs of one run in space and of the two hard scenes; quick: one config."""
    shipped = [path for path in sorted(CONFIGS.glob("*.yaml")) if config.is_run(path)]
    in_space = [path for path in shipped if scene.build(config.load(path)).in_space]
    return [CONFIGS / "screw.yaml"] if quick else [*in_space, *sorted(HARD.glob("*.yaml"))]


def solved(built: Any) -> tuple[SpatialKinematics, float]:
    """Solve a scene once; return the motion and the processor time (s)."""
    begun = run_module.begin(built)
    began = time.process_time()
    begun.solving.advance()
    spent = time.process_time() - began
    assert begun.system is not None
    return SpatialKinematics(begun.system, begun.solving.trajectory()), spent  # type: ignore[arg-type]


def finer(built: Any) -> Any:
    """Scene with facets of a third of the size and steps for a third of the error, without a limit on run time."""
    accuracy = (built.solver.accuracy or 1e-3) / FINER
    by_accuracy = math.sqrt(
        accuracy / (built.solver.named or FACET_ERROR)
    )  # ratio of the facet sizes that a run chooses first for both accuracies
    solver = built.solver.model_copy(update={"accuracy": accuracy, "named": accuracy, "max_wall_s": None})
    return replace(built, solver=solver).with_facets(1.0 / FINER / by_accuracy)


def judged(path: Path) -> tuple[list[Any], float, float, float, float]:
    """Row of a config, its error over the bound, its energy imbalance, and its depth (m) in the run and the finer run.

    A body at rest has no path length to relate an error to: its error counts as 0, and its depth is compared instead.
    """
    built: Any = scene.build(config.load(path))
    first = solved(built)[1]
    inspected: list[Any] = []
    began = time.process_time()
    results = run_module.run(built, inspect=lambda *both: inspected.append(both))
    spent = time.process_time() - began
    motion = SpatialKinematics(*inspected[0])
    reference, _ = solved(finer(motion.system.scene))
    error, summary = apart(motion, reference), results.summary
    imbalance = summary["energy"]["imbalance_relative"]
    asked = built.solver.named or FACET_ERROR
    stands = reference.path_length < reference.scene.least_path
    facets = summary.get("facets", {"error": 0.0, "bodies": {}})
    count = sum(body["number"] for body in facets["bodies"].values())
    row = [
        path.stem,
        f"{results['time_s'][-1]:.3g}",
        f"{asked:g}",
        "stands" if stands else f"{error:.2%}",
        f"{facets['error']:.2%}",
    ]
    row += [summary["cost"]["steps"], count, f"{first:.2f}", f"{spent:.2f}", f"{imbalance:.1e}", number(summary)]
    row.append("; ".join(results.warnings) or "none")
    depths = (
        max(track.values.max() for tracks in moved.depths().values() for track in tracks)
        for moved in (motion, reference)
    )
    return row, 0.0 if stands else error / asked, imbalance, *depths


def study(quick: bool) -> Outcome:
    """Run all configs."""
    results = {path.stem: judged(path) for path in files(quick)}
    over = max(results, key=lambda name: results[name][1])
    broken = max(results, key=lambda name: results[name][2])
    claims = [
        Claim(
            "space_configs.every config keeps its accuracy",
            results[over][1] <= 1.0,
            f"{len(results)} configs; at most {results[over][1]:.2f} times the accuracy asked for ({over})",
        ),
        Claim(
            "space_configs.energy is balanced",
            results[broken][2] <= BALANCE,
            f"to {results[broken][2]:.1e} of the largest energy ({broken}; required: {BALANCE:g})",
        ),
    ]
    for path in () if quick else sorted(HARD.glob("*.yaml")):
        _, _, _, depth, fine = results[path.stem]
        true = FOOT if path.stem == "ball_foot" else fine
        off = abs(depth / true - 1.0)
        detail = f"{1e3 * depth:.2f} mm of {1e3 * true:.2f}, {off:.2%} off"
        claims.append(Claim(f"space_configs.{path.stem} has the correct depth", off <= DEPTH, detail))
    return Outcome(markdown(HEAD, [row for row, *_ in results.values()]), tuple(claims))


if __name__ == "__main__":
    sys.exit(script(study))
