"""Whether shipped configs, and the rule for configs that name no steps, have the fastest steps of their accuracy.

    python validation/default_steps.py [--quick]

Each config runs with its own method as shipped, with the steps of the rule (`scene/steps.py`), with fixed steps from
8 ms down, and with several accuracies. The error of a run is the greatest difference of any coordinate, at any step,
from a fine run, over the longest path length of any coordinate; angles are multiplied by the radius of their body. The
fine run has a tenth of the fixed step, or an accuracy of 1e-4. In space all runs of a config have facets for the
shipped accuracy. Where every joint follows a prescribed motion, coordinates have no error; there the work of the medium
is compared instead, which is the result of interest of such a run.

Run times are processor times of the solve, the least of two rounds in turn. A setting that then seems to be off the
front, and the faster one, run again in turn, since the speed of a machine can change. A setting lies on the front if no
setting with at most 1.1 times its error takes less than 1 / 1.3 of its time.

For configs that are shipped with adaptive steps, a looser accuracy should cost no more than a tighter one. That is
compared in iterations, which do not depend on the machine.
"""

from __future__ import annotations

import math
import sys
import time
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

from granular_contact.config import is_run, load_scenario
from granular_contact.results import Cost
from granular_contact.run import begin
from granular_contact.scene import Scene, build
from validation.accuracy_promise import CONFIGS, Run
from validation.study import Claim, Outcome, script
from validation.tables import markdown

STEPS, ACCURACIES = (8e-3, 4e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4), (1e-1, 3e-2, 1e-2, 3e-3, 1e-3)
REFERENCE, FINER = 1e-4, 0.1
OPEN = ("solver.accuracy=null", "solver.step_s=null")
ROUNDS, AGAIN, MOST = (
    2,
    4,
    2.0,
)  # fixed steps below one that takes MOST times as long as the shipped and the rule's run are skipped
NEAR, LIKE = 1.3, 1.1  # largest time, relative to the fastest setting with at most LIKE times the error
MORE = 1.1  # largest number of iterations, relative to a tighter accuracy
LEAST = 1e-5  # relative error below which differences come from the fine run itself
QUICK = ("free_link", "c_leg", "chain")


@dataclass(frozen=True)
class Setting:
    """A choice of steps with its least processor time (s), its counts and its error."""

    name: str
    seconds: float
    cost: Cost
    error: float


def scene_of(config: str, sets: tuple[str, ...]) -> Scene:
    """Build a shipped config with overrides."""
    return build(load_scenario(CONFIGS / f"{config}.yaml", sets))


def with_facets_of(shipped: Scene, config: str, sets: tuple[str, ...]) -> Scene:
    """Build a config with overrides; in space with facets for the accuracy of the shipped config."""
    scene = scene_of(config, sets)
    return replace(scene, solver=scene.solver.model_copy(update={"named": shipped.solver.named}))


def solved(scene: Scene) -> tuple[Run, Cost, float]:
    """Solve a scene; return the run, its cost and the processor time of the solve (s)."""
    begun = begin(scene)
    began = time.process_time()
    begun.solving.advance()
    seconds = time.process_time() - began
    trajectory = begun.solving.trajectory()
    assert begun.system is not None
    lever = begun.system.levers
    begun.solving.close()
    place = trajectory.q * lever
    if _is_prescribed(scene):
        assert trajectory.load is not None
        place = trajectory.load.work[:, None]
    return Run(trajectory.time, place, trajectory.status.code), trajectory.cost, seconds


def _is_prescribed(scene: Scene) -> bool:
    """Whether every joint follows a prescribed motion."""
    moved = {drive.joint for drive in scene.drives if drive.kind == "motion"}
    return {joint.name for joint in scene.joints if joint.kind != "weld"} <= moved


def fixed(step: float) -> tuple[str, str]:
    """Overrides for fixed steps (s)."""
    return "solver.accuracy=null", f"solver.step_s={step}"


def measured(config: str) -> tuple[list[Setting], str]:
    """Run all settings of a config; return them, the shipped one and that of the rule first, and the rule's reason."""
    scene = scene_of(config, ())
    of_config = partial(with_facets_of, scene, config)
    by_rule = of_config(OPEN)
    fine = fixed(FINER * scene.solver.step_s) if scene.solver.accuracy is None else (f"solver.accuracy={REFERENCE}",)
    reference, *_ = solved(of_config(fine))
    overrides: dict[str, tuple[str, ...]] = {f"{1e3 * step:g} ms": fixed(step) for step in STEPS}
    overrides |= {f"accuracy {accuracy:g}": (f"solver.accuracy={accuracy}",) for accuracy in ACCURACIES}
    scenes = {name: of_config(sets) for name, sets in overrides.items()}
    judged = [_like(built, scenes) for built in (scene, by_rule)]
    results: dict[str, Setting] = {}

    def run(name: str) -> float:
        result, cost, seconds = solved(scenes[name])
        least = min(seconds, results[name].seconds) if name in results else seconds
        results[name] = Setting(name, least, cost, _error(result, reference))
        return seconds

    for _ in range(ROUNDS):
        longest, enough = 0.0, False
        for name in [*judged, *(name for name in scenes if name not in judged)]:
            if enough and name.endswith("ms"):
                continue
            seconds = run(name)
            longest = max(longest, seconds) if name in judged else longest
            enough = enough or seconds > MOST * longest
    for _ in range(AGAIN):
        for name in judged:
            best = fastest([*results.values()], results[name].error)
            if results[name].seconds > NEAR * best.seconds:
                run(name)
                run(best.name)
    return [*(results[name] for name in judged), *results.values()], by_rule.solver.why


def _like(scene: Scene, scenes: dict[str, Scene]) -> str:
    """Name of the setting that has the steps of a scene; the scene is added as a new setting if there is none."""

    def key(built: Scene) -> tuple[float | None, float]:
        return built.solver.accuracy, built.solver.step_s if built.solver.accuracy is None else 0.0

    for name, built in scenes.items():
        if key(built) == key(scene):
            scenes[name] = scene  # its first step may differ from that of the setting
            return name
    accuracy, step = key(scene)
    name = f"{1e3 * step:g} ms" if accuracy is None else f"accuracy {accuracy:g}"
    scenes[name] = scene
    return name


def _error(run: Run, reference: Run) -> float:
    return run.error(reference) / reference.way if run.ending in ("end_time", "rest") else float("inf")


def fastest(results: list[Setting], error: float) -> Setting:
    """Fastest setting with at most LIKE times an error; errors below LEAST count as equal."""
    return min((s for s in results if s.error <= max(LIKE * error, LEAST)), key=lambda s: s.seconds)


def row(config: str, results: list[Setting], why: str) -> tuple[list[str], float, float]:
    """Row of the table; times of the shipped setting and of the rule's, over the fastest settings of their errors."""
    best = [fastest(results, setting.error) for setting in results[:2]]
    ratios = [setting.seconds / other.seconds for setting, other in zip(results, best, strict=False)]
    cells = [config]
    for setting, other, ratio in zip(results, best, ratios, strict=False):
        cells += [setting.name, f"{setting.cost.steps}", f"{setting.seconds:.3f}", f"{1e2 * setting.error:.3f}"]
        cells += [other.name, f"{ratio:.2f}"]
    return [*cells, why.partition(": ")[2]], ratios[0], ratios[1]


def counts(config: str, results: list[Setting]) -> tuple[list[str], float]:
    """Row of steps, iterations and Jacobians by accuracy; greatest iterations over those of a tighter accuracy."""
    by_name = {setting.name: setting for setting in results}
    chosen = [by_name[f"accuracy {accuracy:g}"] for accuracy in ACCURACIES]
    cells = [
        f"{s.cost.steps}, {s.cost.newton_iterations}, {s.cost.jacobians}" if math.isfinite(s.error) else "fails"
        for s in chosen
    ]
    iterations = [s.cost.newton_iterations for s in chosen if math.isfinite(s.error)]
    return [config, *cells], max(count / min(iterations[i:]) for i, count in enumerate(iterations))


def study(quick: bool) -> Outcome:
    """Run all configs."""
    names = [
        path.stem for path in sorted(CONFIGS.glob("*.yaml")) if is_run(path) and not path.stem.startswith("impact")
    ]
    every = {name: measured(name) for name in (QUICK if quick else names)}
    rows_by_config = {name: row(name, *settings) for name, settings in every.items()}
    counted = {name: counts(name, settings) for name, (settings, _) in every.items()}
    columns = ["steps", "CPU s", "error %", "fastest of equal accuracy", "time ratio"]
    head = ["config", "shipped", *columns, "setting of the rule", *columns, "reason of the rule"]
    shipped_off = [f"{name} {shipped:.2f}" for name, (_, shipped, _) in rows_by_config.items() if shipped > NEAR]
    rule_off = [f"{name} {rule:.2f}" for name, (_, _, rule) in rows_by_config.items() if rule > NEAR]
    choosing = [name for name, (settings, _) in every.items() if settings[0].name.startswith("accuracy")]
    most, where = max((counted[name][1], name) for name in choosing)
    table = markdown(
        ["config", *(f"{accuracy:g}" for accuracy in ACCURACIES)], [cells for cells, _ in counted.values()]
    )
    return Outcome(
        f"{markdown(head, [cells for cells, _, _ in rows_by_config.values()])}\n\n"
        f"Steps, iterations and Jacobians by accuracy:\n\n{table}",
        (
            Claim(
                "default_steps.shipped settings lie on the front",
                not shipped_off,
                _detail(shipped_off, len(rows_by_config)),
            ),
            Claim(
                "default_steps.settings of the rule lie on the front",
                not rule_off,
                _detail(rule_off, len(rows_by_config)),
            ),
            Claim(
                "default_steps.a looser accuracy needs no more iterations than a tighter one",
                most <= MORE,
                f"at most {most:.2f} times those of a tighter one where steps are chosen ({where}; required: {MORE:g})",
            ),
        ),
    )


def _detail(off: list[str], number: int) -> str:
    return (
        f"{number - len(off)} of {number} within {NEAR:g} times the time of the fastest setting of equal accuracy"
        + (f"; not: {', '.join(off)}" if off else "")
    )


if __name__ == "__main__":
    raise SystemExit(script(study))
