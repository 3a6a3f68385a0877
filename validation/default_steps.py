"""Whether the steps of every shipped config, and those of the rule for what names none, are the fastest as exact.

    python validation/default_steps.py [--quick]

Each config, by the method that suits it: as shipped, by the rule (`scene/steps.py`), with fixed steps from 8 ms down,
and with several accuracies. An error is the greatest distance of any coordinate (of angles times how far their body
reaches) from a fine run, at any step, over the longest way of any coordinate; the fine run has a tenth of the fixed
step, or an accuracy of 1e-4. In space all runs of a config have the facets that it ships with. Of what moves as it is
told, at any step, the places say nothing; there the work of the medium stands for them, which is what such a run is
for. Times are processor time of the solve, the least of two rounds in turn; where a setting then seems to be off its
front, it and what is faster are run again in turn, as the clock of a machine may change. A setting lies on the front if
nothing takes less than 1 / 1.3 of its time and is as exact, to a tenth of the error.

A looser accuracy ought to cost no more than a tighter one where steps are shipped chosen: that is looked at in
iterations, which no clock changes.
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
ROUNDS, AGAIN, MOST = 2, 4, 2.0  # fixed steps that take MOST times as long as shipped are no longer of interest
NEAR, LIKE = 1.3, 1.1  # times the least time of a setting whose error is at most LIKE times as large
MORE = 1.1  # times the iterations of a tighter accuracy
LEAST = 1e-5  # of the way: errors below it are those of the fine run
QUICK = ("free_link", "c_leg", "chain")


@dataclass(frozen=True)
class Setting:
    """A way to choose steps, with its least time (s), what it counts and its error."""

    name: str
    seconds: float
    cost: Cost
    error: float


def scene_of(config: str, sets: tuple[str, ...]) -> Scene:
    """A config, with the method that suits it."""
    return build(load_scenario(CONFIGS / f"{config}.yaml", sets))


def with_facets_of(shipped: Scene, config: str, sets: tuple[str, ...]) -> Scene:
    """A config with overrides; in space with facets as exact as those of the shipped one, whatever its steps."""
    scene = scene_of(config, sets)
    return replace(scene, solver=scene.solver.model_copy(update={"named": shipped.solver.named}))


def solved(scene: Scene) -> tuple[Run, Cost, float]:
    """A run, what it cost, and the processor time of its solve (s)."""
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
    """Whether every joint follows a motion."""
    moved = {drive.joint for drive in scene.drives if drive.kind == "motion"}
    return {joint.name for joint in scene.joints if joint.kind != "weld"} <= moved


def fixed(step: float) -> tuple[str, str]:
    """Overrides for fixed steps (s)."""
    return "solver.accuracy=null", f"solver.step_s={step}"


def measured(config: str) -> tuple[list[Setting], str]:
    """Settings of a config, the shipped one and that of the rule first; how the rule chose."""
    scene = scene_of(config, ())
    of_config = partial(with_facets_of, scene, config)
    by_rule = of_config(OPEN)
    fine = fixed(FINER * scene.solver.step_s) if scene.solver.accuracy is None else (f"solver.accuracy={REFERENCE}",)
    reference, *_ = solved(of_config(fine))
    ways: dict[str, tuple[str, ...]] = {f"{1e3 * step:g} ms": fixed(step) for step in STEPS}
    ways |= {f"accuracy {accuracy:g}": (f"solver.accuracy={accuracy}",) for accuracy in ACCURACIES}
    every = {name: of_config(sets) for name, sets in ways.items()}
    alike = [_like(one, every) for one in (scene, by_rule)]
    found: dict[str, Setting] = {}

    def run(name: str) -> float:
        one, cost, seconds = solved(every[name])
        least = min(seconds, found[name].seconds) if name in found else seconds
        found[name] = Setting(name, least, cost, _error(one, reference))
        return seconds

    for _ in range(ROUNDS):
        longest, enough = 0.0, False
        for name in [*alike, *(name for name in every if name not in alike)]:
            if enough and name.endswith("ms"):
                continue
            seconds = run(name)
            longest = max(longest, seconds) if name in alike else longest
            enough = enough or seconds > MOST * longest
    for _ in range(AGAIN):
        for name in alike:
            best = fastest([*found.values()], found[name].error)
            if found[name].seconds > NEAR * best.seconds:
                run(name)
                run(best.name)
    return [*(found[name] for name in alike), *found.values()], by_rule.solver.why


def _like(scene: Scene, every: dict[str, Scene]) -> str:
    """Name of the setting with the steps of a scene, which is added where there is none."""

    def key(one: Scene) -> tuple[float | None, float]:
        return one.solver.accuracy, one.solver.step_s if one.solver.accuracy is None else 0.0

    for name, one in every.items():
        if key(one) == key(scene):
            every[name] = scene  # which may have another first step
            return name
    accuracy, step = key(scene)
    name = f"{1e3 * step:g} ms" if accuracy is None else f"accuracy {accuracy:g}"
    every[name] = scene
    return name


def _error(run: Run, reference: Run) -> float:
    return run.error(reference) / reference.way if run.ending in ("end_time", "rest") else float("inf")


def fastest(found: list[Setting], error: float) -> Setting:
    """The fastest one as exact as an error; errors below LEAST are alike."""
    return min((one for one in found if one.error <= max(LIKE * error, LEAST)), key=lambda one: one.seconds)


def row(config: str, found: list[Setting], why: str) -> tuple[list[str], float, float]:
    """Of the table; times of the shipped setting and of the rule's over the fastest ones as exact."""
    best = [fastest(found, one.error) for one in found[:2]]
    ratios = [one.seconds / other.seconds for one, other in zip(found, best, strict=False)]
    cells = [config]
    for one, other, ratio in zip(found, best, ratios, strict=False):
        cells += [one.name, f"{one.cost.steps}", f"{one.seconds:.3f}", f"{1e2 * one.error:.3f}"]
        cells += [other.name, f"{ratio:.2f}"]
    return [*cells, why.partition(": ")[2]], ratios[0], ratios[1]


def counts(config: str, found: list[Setting]) -> tuple[list[str], float]:
    """Steps, iterations and Jacobians by accuracy; the most iterations over those of a tighter one."""
    by_name = {one.name: one for one in found}
    chosen = [by_name[f"accuracy {accuracy:g}"] for accuracy in ACCURACIES]
    cells = [
        f"{one.cost.steps}, {one.cost.newton_iterations}, {one.cost.jacobians}" if math.isfinite(one.error) else "fails"
        for one in chosen
    ]
    ended = [one.cost.newton_iterations for one in chosen if math.isfinite(one.error)]
    return [config, *cells], max(one / min(ended[i:]) for i, one in enumerate(ended))


def study(quick: bool) -> Outcome:
    """All configs."""
    names = [
        path.stem for path in sorted(CONFIGS.glob("*.yaml")) if is_run(path) and not path.stem.startswith("impact")
    ]
    every = {name: measured(name) for name in (QUICK if quick else names)}
    found = {name: row(name, *one) for name, one in every.items()}
    counted = {name: counts(name, one) for name, (one, _) in every.items()}
    columns = ["steps", "CPU s", "error %", "fastest as exact", "times its time"]
    head = ["config", "shipped", *columns, "by the rule", *columns, "as"]
    off = [f"{name} {shipped:.2f}" for name, (_, shipped, _) in found.items() if shipped > NEAR]
    beside = [f"{name} {rule:.2f}" for name, (_, _, rule) in found.items() if rule > NEAR]
    choosing = [name for name, (one, _) in every.items() if one[0].name.startswith("accuracy")]
    most, where = max((counted[name][1], name) for name in choosing)
    table = markdown(["config", *(f"{one:g}" for one in ACCURACIES)], [cells for cells, _ in counted.values()])
    return Outcome(
        f"{markdown(head, [cells for cells, _, _ in found.values()])}\n\n"
        f"Steps, iterations and Jacobians by accuracy:\n\n{table}",
        (
            Claim("default_steps.shipped settings lie on the front", not off, _told(off, len(found))),
            Claim("default_steps.the rule's lie on the front", not beside, _told(beside, len(found))),
            Claim(
                "default_steps.a looser accuracy takes no more iterations",
                most <= MORE,
                f"at most {most:.2f} times those of a tighter one where steps are chosen ({where}; asked: {MORE:g})",
            ),
        ),
    )


def _told(off: list[str], number: int) -> str:
    return f"{number - len(off)} of {number} within {NEAR:g} times the fastest as exact" + (
        f"; not {', '.join(off)}" if off else ""
    )


if __name__ == "__main__":
    raise SystemExit(script(study))
