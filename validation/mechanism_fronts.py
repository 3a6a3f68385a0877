"""What an error costs on mechanisms: fixed steps, steps chosen by their error, and MuJoCo with the same sand.

    python validation/mechanism_fronts.py [--quick]

The runner, the walker, the stepping leg, the chain and the C-leg as shipped, with fixed steps of several lengths, with
several accuracies, and in MuJoCo (implicitfast) through `MujocoBed`, whose forces come from the same kernels: by one
call from Python a step, and by a compiled loop without Python. There a prescribed motion is a stiff servo, and the dry
friction and the stops of the stepping leg are those of our joints, which Python calls too. An error is the largest
distance of the tip from the path of a run with an accuracy of 1e-4, over the length of the path, or how far the tip
comes, over the same length. Times are processor time of the solve, the least of repeats in turn.
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
# Steps (s) of MuJoCo, from the longest at which it runs.
THEIRS = {
    "runner": (4e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4),
    "walker": (4e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4),
    "c_leg": (2e-3, 1e-3, 5e-4, 2e-4, 1e-4),
    "stepping_leg": (2e-3, 1e-3, 5e-4, 2e-4, 1e-4),
    "chain": (4e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4, 5e-5),
}
COMPILED = ("runner", "walker", "c_leg", "chain")  # without joints that Python is asked for
LEVELS = (1e-2, 3e-3, 1e-3, 3e-4)  # of the path
ASKED = ("runner", "walker", "chain")
NEAR, BEHIND = 1.3, 1.5  # times the best of the front; times MuJoCo's best
OURS, MUJOCO, NATIVE = "granular-contact", "MuJoCo", "MuJoCo, compiled"


@dataclass(frozen=True)
class Setting:
    """A way to solve a mechanism, with its run and its errors (of the path): of the tip's path, of where it ends."""

    tool: str
    name: str
    one: Run
    path: float
    end: float

    @property
    def error(self) -> float:
        """The greater one."""
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
    """As `mujoco_native.run`."""
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
    data, made = mujoco.MjData(model), []
    for state in states:
        data.qpos[:] = state
        mujoco.mj_kinematics(model, data)
        turn, place = data.xmat[number].reshape(3, 3), data.xpos[number]
        made.append(place[[0, 2]] + turn[[0, 2]][:, [0, 2]] @ point)
    return np.array(made)


def _counted(steps: int) -> Cost:
    return Cost(0.0, steps, 0, 0, steps, 0, 0, 0)


def ways(name: str, quick: bool) -> dict[tuple[str, str], Callable[[], Run]]:
    """How each mechanism is solved, by tool and setting."""
    fixed, made = FIXED[name], dict[tuple[str, str], Callable[[], Run]]()
    for factor in TIMES_QUICK if quick else TIMES_FIXED:
        step = factor * fixed
        sets = "solver.accuracy=null", f"solver.step_s={step}"
        made[OURS, f"steps of {1e3 * step:g} ms"] = lambda sets=sets: run(name, *sets)
    for accuracy in ACCURACIES_QUICK if quick else ACCURACIES:
        key = f"solver.accuracy={accuracy}"
        made[OURS, f"accuracy {accuracy:g}"] = lambda key=key: run(name, key)
    made[OURS, SHIPPED] = lambda: run(name)
    scene = build(load_scenario(CONFIGS / f"{name}.yaml"))
    for step in THEIRS.get(name, ())[: 3 if quick else None]:
        made[MUJOCO, f"steps of {1e3 * step:g} ms"] = lambda step=step: by_mujoco(scene, step)
        if name in COMPILED:
            made[NATIVE, f"steps of {1e3 * step:g} ms"] = lambda step=step: by_mujoco(scene, step, True)
    return made


def measured(name: str, quick: bool) -> list[Setting]:
    """All settings of a mechanism that come to its end, with their least times."""
    reference, there = run(name, f"solver.accuracy={REFERENCE}"), ways(name, quick)
    runs: dict[tuple[str, str], Run] = {}
    for _ in range(2):
        for key, way in there.items():
            again = way()
            before = runs.get(key)
            runs[key] = again if before is None else replace(before, seconds=min(before.seconds, again.seconds))
    found = []
    for (tool, setting), one in runs.items():
        whole = np.isfinite(one.tip).all() and one.time[-1] > 0.99 * reference.time[-1]
        path, end = (one.error(reference) / reference.way, _apart(one, reference)) if whole else (np.inf, np.inf)
        found.append(Setting(tool, setting, one, path, end))
    return found


def _apart(one: Run, other: Run) -> float:
    """How far two ends of the tip are apart along the ground, of the path."""
    return float(abs(one.tip[-1, 0] - other.tip[-1, 0])) / other.way


def fastest(found: list[Setting], tool: str, error: float) -> Setting | None:
    """Of a tool within an error."""
    return min((one for one in found if one.tool == tool and one.error <= error), key=_seconds, default=None)


def _seconds(one: Setting) -> float:
    return one.one.seconds


def study(quick: bool) -> Outcome:
    """All mechanisms."""
    rows, levels, near, behind = [], [], [], []
    every = {}
    for name in FIXED:
        every[name] = found = measured(name, quick)
        rows += [_row(name, one) for one in found]
        shipped = next(one for one in found if one.name == SHIPPED)
        best = fastest(found, OURS, shipped.error)
        assert best is not None  # the shipped one at the least
        near.append((_seconds(shipped) / _seconds(best), name, best.name))
        for level in LEVELS if name in THEIRS else ():
            ours, theirs, native = (fastest(found, tool, level) for tool in (OURS, MUJOCO, NATIVE))
            ratios = _ratio(ours, theirs), _told(native) if name in COMPILED else "", _ratio(ours, native)
            levels.append([name, f"{1e2 * level:g}", _told(ours), _told(theirs), *ratios])
            if ours is not None and theirs is not None and name in ASKED:
                behind.append((_seconds(ours) / _seconds(theirs), name, level))
    if not quick:
        draw(every)
    head = ["mechanism", "tool", "setting", "steps", "CPU s", "error of path %", "of the end %"]
    short = ["mechanism", "error at most %", "granular-contact, CPU s", "MuJoCo, CPU s", "ratio"]
    short += ["MuJoCo compiled, CPU s", "ratio"]
    text = f"{markdown(head, rows)}\n\nThe fastest within an error:\n\n{markdown(short, levels)}"
    return Outcome(text, _claims(near, behind))


def _claims(near: list[tuple[float, str, str]], behind: list[tuple[float, str, float]]) -> tuple[Claim, ...]:
    ratio, name, best = max(near)
    most, where, level = max(behind)
    return (
        Claim(
            "mechanism_fronts.shipped settings lie on the front",
            ratio <= NEAR,
            f"at most {ratio:.2f} times the time of the fastest as exact ({name}: {best}; asked: {NEAR:g})",
        ),
        Claim(
            "mechanism_fronts.not behind MuJoCo",
            most <= BEHIND,
            f"at most {most:.2f} times MuJoCo's time at equal error ({where}, {1e2 * level:g} %; asked: {BEHIND:g})",
        ),
    )


def _row(name: str, one: Setting) -> list[str]:
    errors = [f"{1e2 * error:.3f}" if np.isfinite(error) else "fails" for error in (one.path, one.end)]
    return [name, one.tool, one.name, f"{one.one.cost.steps}", f"{_seconds(one):.3f}", *errors]


def _told(one: Setting | None) -> str:
    return "not reached" if one is None else f"{_seconds(one):.3f} ({one.name})"


def _ratio(ours: Setting | None, theirs: Setting | None) -> str:
    return "" if ours is None or theirs is None else f"{_seconds(ours) / _seconds(theirs):.2f}"


def draw(every: dict[str, list[Setting]]) -> None:
    """Error against run time, a panel for each mechanism."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(1, len(every), figsize=(3.0 * len(every), 3.2), sharey=True, layout="constrained")
    kinds = {"fixed steps": (OURS, "steps", "o-"), "accuracy": (OURS, "accuracy", "s-"), MUJOCO: (MUJOCO, "", "^--")}
    kinds[NATIVE] = NATIVE, "", "v:"
    for panel, (name, found) in zip(axes, every.items(), strict=True):
        for label, (tool, begins, style) in kinds.items():
            some = [one for one in found if one.tool == tool and one.name.startswith(begins) and one.name != SHIPPED]
            some = [one for one in some if np.isfinite(one.error)]
            panel.loglog([_seconds(one) for one in some], [1e2 * one.error for one in some], style, ms=4, label=label)
        shipped = next(one for one in found if one.name == SHIPPED)
        panel.loglog([_seconds(shipped)], [1e2 * shipped.error], "k*", ms=10, label=SHIPPED)
        panel.set(title=name.replace("_", " "), xlabel="CPU s", xlim=(0.001, 2.0))
    axes[0].set_ylabel("error, % of the path")
    axes[-1].legend(fontsize=7)
    figure.savefig(FIGURE, dpi=110)


if __name__ == "__main__":
    raise SystemExit(script(study))
