"""Error and run time on mechanisms: fixed steps, adaptive steps, and MuJoCo with the same sand.

    python validation/mechanism_fronts.py [--quick]

The runner, the walker, the stepping leg, the chain and the C-leg run as shipped, with several fixed steps, with several
accuracies, and in MuJoCo (implicitfast) through `MujocoBed`, whose forces come from the same kernels. In MuJoCo the bed
is called once a step from Python, or from a compiled loop without Python. A prescribed motion is a stiff servo in
MuJoCo; the stepping leg has the dry friction and the stops of this package's joints, which are also called from Python.
The error is the larger of two: the largest distance of the tip from the path of a run with an accuracy of 1e-4, and the
difference of the distance that the tip covers, both over the length of the path. Run times are processor times of the
solve, the least of repeats in turn.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

HERE = Path(__file__).parents[1]
sys.path.insert(0, str(HERE))

import mujoco
import numpy as np
from numpy.typing import NDArray

from granular_contact.config import load_scenario
from granular_contact.results import Cost
from granular_contact.scene import Scene, build
from validation.mechanism_cost import CONFIGS, FIXED, REFERENCE, SHIPPED, Run, run
from validation.peers import mujoco_native
from validation.peers.mujoco_scene import Laws, bed_of, controls_of, model_of, start
from validation.study import Claim, Outcome, script
from validation.tables import markdown

Vector = NDArray[np.float64]
FIGURE = Path(__file__).parent / "figures" / "mechanism_fronts.png"
TIMES_FIXED, TIMES_QUICK = (64.0, 32.0, 16.0, 8.0, 4.0), (32.0, 4.0)
ACCURACIES, ACCURACIES_QUICK = (1e-1, 5e-2, 3e-2, 1e-2, 1e-3), (1e-1, 1e-2, 1e-3)
# Steps (s) of MuJoCo, from the longest one at which it is stable.
THEIRS = {
    "runner": (4e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4),
    "walker": (4e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4),
    "c_leg": (2e-3, 1e-3, 5e-4, 2e-4, 1e-4),
    "stepping_leg": (2e-3, 1e-3, 5e-4, 2e-4, 1e-4),
    "chain": (4e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4, 5e-5),
}
COMPILED = ("runner", "walker", "c_leg", "chain")  # mechanisms whose joints need no call into Python
LEVELS = (1e-2, 3e-3, 1e-3, 3e-4)  # error over the length of the path
ASKED = ("runner", "walker", "chain")
NEAR, BEHIND = 1.3, 1.5  # run time allowed, relative to the front and to MuJoCo at equal error
OURS, MUJOCO, NATIVE = "granular-contact", "MuJoCo", "MuJoCo, compiled"


@dataclass(frozen=True)
class Setting:
    """A setting of a tool with its run.

    path, end: errors of the tip's path and of its end, over the length of the path.
    """

    tool: str
    name: str
    one: Run
    path: float
    end: float

    @property
    def error(self) -> float:
        """The larger error."""
        return max(self.path, self.end)


def by_mujoco(scene: Scene, step: float, compiled: bool = False) -> Run:
    """Solve a scene in MuJoCo; compiled: without Python in the loop."""
    model, seconds = model_of(scene, step), scene.solver.end_time_s
    bed, data = bed_of(scene, model), start(scene, model)
    steps = round(seconds / step)
    controls, states = controls_of(scene, np.arange(steps) * step), np.empty((steps + 1, model.nq))
    spent = (mujoco_native.run if compiled else _from_python)(bed, model, data, controls, states, Laws(scene, model))
    tip = _tips(model, states, mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, scene.tip[0]), scene.tip[1])
    return Run(_counted(steps), spent, np.arange(steps + 1) * step, tip)


def _from_python(bed: Any, model: Any, data: Any, controls: Vector, states: Vector, laws: Laws) -> float:
    """Same as `mujoco_native.run`, with the loop over the steps in Python."""
    steps = len(controls)
    began = time.process_time()
    for i in range(steps):
        states[i] = data.qpos
        if model.nu:
            data.ctrl[:] = controls[i]
        laws.apply(data)
        bed.apply(data)
        mujoco.mj_step(model, data)
    spent = time.process_time() - began
    states[steps] = data.qpos
    return spent


def _tips(model: Any, states: Vector, number: int, point: Vector) -> Vector:
    """Path (n, 2) m of a point of a body."""
    data, tips = mujoco.MjData(model), []
    for state in states:
        data.qpos[:] = state
        mujoco.mj_kinematics(model, data)
        turn, place = data.xmat[number].reshape(3, 3), data.xpos[number]
        tips.append(place[[0, 2]] + turn[[0, 2]][:, [0, 2]] @ point)
    return np.array(tips)


def _counted(steps: int) -> Cost:
    return Cost(0.0, steps, 0, 0, steps, 0, 0, 0)


def ways(name: str, quick: bool) -> dict[tuple[str, str], Callable[[], Run]]:
    """Functions that solve a mechanism, by tool and setting."""
    fixed, solvers = FIXED[name], dict[tuple[str, str], Callable[[], Run]]()
    for factor in TIMES_QUICK if quick else TIMES_FIXED:
        step = factor * fixed
        sets = "solver.accuracy=null", f"solver.step_s={step}"
        solvers[OURS, f"steps of {1e3 * step:g} ms"] = lambda sets=sets: run(name, *sets)
    for accuracy in ACCURACIES_QUICK if quick else ACCURACIES:
        key = f"solver.accuracy={accuracy}"
        solvers[OURS, f"accuracy {accuracy:g}"] = lambda key=key: run(name, key)
    solvers[OURS, SHIPPED] = lambda: run(name)
    scene = build(load_scenario(CONFIGS / f"{name}.yaml"))
    for step in THEIRS.get(name, ())[: 3 if quick else None]:
        solvers[MUJOCO, f"steps of {1e3 * step:g} ms"] = lambda step=step: by_mujoco(scene, step)
        if name in COMPILED:
            solvers[NATIVE, f"steps of {1e3 * step:g} ms"] = lambda step=step: by_mujoco(scene, step, True)
    return solvers


def measured(name: str, quick: bool) -> list[Setting]:
    """Run all settings of a mechanism; each has its least time, and infinite errors if it did not reach the end."""
    reference, solvers = run(name, f"solver.accuracy={REFERENCE}"), ways(name, quick)
    runs: dict[tuple[str, str], Run] = {}
    for _ in range(2):
        for key, solver in solvers.items():
            latest = solver()
            before = runs.get(key)
            runs[key] = latest if before is None else replace(before, seconds=min(before.seconds, latest.seconds))
    settings = []
    for (tool, setting), result in runs.items():
        whole = np.isfinite(result.tip).all() and result.time[-1] > 0.99 * reference.time[-1]
        path, end = (result.error(reference) / reference.way, _apart(result, reference)) if whole else (np.inf, np.inf)
        settings.append(Setting(tool, setting, result, path, end))
    return settings


def _apart(result: Run, other: Run) -> float:
    """Distance of the tip's ends in two runs along the ground, over the path length of the second."""
    return float(abs(result.tip[-1, 0] - other.tip[-1, 0])) / other.way


def fastest(settings: list[Setting], tool: str, error: float) -> Setting | None:
    """Fastest setting of a tool with at most this error; None if there is none."""
    return min((s for s in settings if s.tool == tool and s.error <= error), key=_seconds, default=None)


def _seconds(setting: Setting) -> float:
    return setting.one.seconds


def study(quick: bool) -> Outcome:
    """Run all mechanisms."""
    rows, levels, near, behind = [], [], [], []
    every = {}
    for name in FIXED:
        every[name] = settings = measured(name, quick)
        rows += [_row(name, setting) for setting in settings]
        shipped = next(setting for setting in settings if setting.name == SHIPPED)
        best = fastest(settings, OURS, shipped.error)
        assert best is not None  # at least the shipped setting
        near.append((_seconds(shipped) / _seconds(best), name, best.name))
        for level in LEVELS if name in THEIRS else ():
            package, peer, native = (fastest(settings, tool, level) for tool in (OURS, MUJOCO, NATIVE))
            ratios = (
                _ratio(package, peer),
                _time_and_name(native) if name in COMPILED else "",
                _ratio(package, native),
            )
            levels.append([name, f"{1e2 * level:g}", _time_and_name(package), _time_and_name(peer), *ratios])
            if package is not None and peer is not None and name in ASKED:
                behind.append((_seconds(package) / _seconds(peer), name, level))
    if not quick:
        draw(every)
    head = ["mechanism", "tool", "setting", "steps", "CPU s", "error of path %", "error of the end point %"]
    short = ["mechanism", "error at most %", "granular-contact, CPU s", "MuJoCo, CPU s", "ratio"]
    short += ["MuJoCo compiled, CPU s", "ratio"]
    text = f"{markdown(head, rows)}\n\nThe fastest setting within a given error:\n\n{markdown(short, levels)}"
    return Outcome(text, _claims(near, behind))


def _claims(near: list[tuple[float, str, str]], behind: list[tuple[float, str, float]]) -> tuple[Claim, ...]:
    ratio, name, best = max(near)
    most, where, level = max(behind)
    return (
        Claim(
            "mechanism_fronts.shipped settings lie on the front",
            ratio <= NEAR,
            f"at most {ratio:.2f} times the time of the fastest setting of equal accuracy ({name}: {best}; "
            f"required: {NEAR:g})",
        ),
        Claim(
            "mechanism_fronts.not slower than MuJoCo at equal error",
            most <= BEHIND,
            f"at most {most:.2f} times MuJoCo's time at equal error ({where}, {1e2 * level:g} %; required: {BEHIND:g})",
        ),
    )


def _row(name: str, setting: Setting) -> list[str]:
    errors = [f"{1e2 * error:.3f}" if np.isfinite(error) else "fails" for error in (setting.path, setting.end)]
    return [name, setting.tool, setting.name, f"{setting.one.cost.steps}", f"{_seconds(setting):.3f}", *errors]


def _time_and_name(setting: Setting | None) -> str:
    return "not reached" if setting is None else f"{_seconds(setting):.3f} ({setting.name})"


def _ratio(package: Setting | None, peer: Setting | None) -> str:
    return "" if package is None or peer is None else f"{_seconds(package) / _seconds(peer):.2f}"


def draw(every: dict[str, list[Setting]]) -> None:
    """Draw error against run time, one panel for each mechanism."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(1, len(every), figsize=(3.0 * len(every), 3.2), sharey=True, layout="constrained")
    kinds = {"fixed steps": (OURS, "steps", "o-"), "accuracy": (OURS, "accuracy", "s-"), MUJOCO: (MUJOCO, "", "^--")}
    kinds[NATIVE] = NATIVE, "", "v:"
    for panel, (name, settings) in zip(axes, every.items(), strict=True):
        for label, (tool, begins, style) in kinds.items():
            curve = [
                setting
                for setting in settings
                if setting.tool == tool and setting.name.startswith(begins) and setting.name != SHIPPED
            ]
            curve = [setting for setting in curve if np.isfinite(setting.error)]
            panel.loglog(
                [_seconds(setting) for setting in curve],
                [1e2 * setting.error for setting in curve],
                style,
                ms=4,
                label=label,
            )
        shipped = next(setting for setting in settings if setting.name == SHIPPED)
        panel.loglog([_seconds(shipped)], [1e2 * shipped.error], "k*", ms=10, label=SHIPPED)
        panel.set(title=name.replace("_", " "), xlabel="CPU s", xlim=(0.001, 2.0))
    axes[0].set_ylabel("error, % of the path")
    axes[-1].legend(fontsize=7)
    figure.savefig(FIGURE, dpi=110)


if __name__ == "__main__":
    raise SystemExit(script(study))
