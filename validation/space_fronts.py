"""Error and run time on robots in space: fixed steps, adaptive steps, and MuJoCo with the same sand.

    python validation/space_fronts.py [--quick]

The robots are the hexapod (its hips under PD control, as MuJoCo has no prescribed motions), and the walker in space and
the snake as shipped. They run in minimal coordinates, and in MuJoCo (implicitfast) through `MujocoBed`, whose forces
come from the same kernels, in a compiled loop without Python. The error is the largest distance of the tip from the
path of a run with an accuracy of 1e-4, over the length of the path. Run times are processor times of the solve, the
least of repeats in turn.
"""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[1]))

import mujoco
import numpy as np
from numpy.typing import NDArray

from granular_contact.config import load_scenario
from granular_contact.geometry import rotations
from granular_contact.mujoco import MujocoBed
from granular_contact.results.interpolation import at_times
from granular_contact.run import begin
from granular_contact.sand.space.from_scene import add_part
from granular_contact.scene import build
from validation.peers import mujoco_hexapod, mujoco_native
from validation.peers.mujoco_scene import Laws, controls_of
from validation.study import Claim, Outcome, script
from validation.tables import markdown

Vector = NDArray[np.float64]
CONFIGS = Path(__file__).parents[1] / "configs"
SECONDS = {"hexapod": 2.0, "walker_in_space": 1.5, "snake": 1.5}
SECONDS_QUICK = {"hexapod": 1.0, "walker_in_space": 0.75}
ACCURACIES, REFERENCE = (1e-1, 1e-2, 3e-3, 1e-3), 1e-4
TOLERANCES = (1e-2, 2e-2, 3e-2)  # of Newton's method, with the coarsest accuracy; its own is 2e-3
FIXED = (8e-3, 4e-3, 2e-3, 1e-3)  # s
STEPS = (4e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4)  # s, of MuJoCo
LEVELS = (1e-2, 3e-3, 1e-3)
OURS, NATIVE = "granular-contact", "MuJoCo, compiled"
MOST = {1e-2: 1.0, 1e-3: 1.0 / 3.0}  # run time allowed by error, relative to MuJoCo
Found = tuple[str, str, float, float]  # method or tool, setting, error and least time (s)


@dataclass(frozen=True)
class Run:
    """Processor time (s), and the path of the tip: times (n,) s and positions (n, 3) m."""

    seconds: float
    time: Vector
    tip: Vector


def scene_of(name: str, seconds: float, *overrides: str) -> Any:
    """Build the scene of a robot with an end time (s) and overrides."""
    if name == "hexapod":
        return mujoco_hexapod.scene_of(seconds, *overrides)
    return build(load_scenario(CONFIGS / f"{name}.yaml", [f"solver.end_time_s={seconds}", *overrides]))


def chosen(accuracy: float) -> tuple[str, ...]:
    """Overrides for adaptive steps."""
    return (f"solver.accuracy={accuracy}",)


def fixed(step: float) -> tuple[str, ...]:
    """Overrides for fixed steps (s)."""
    return "solver.accuracy=null", f"solver.step_s={step}"


def ours(name: str, seconds: float, *overrides: str) -> Run:
    """Solve a robot with this package."""
    return solved(scene_of(name, seconds, *overrides))


def solved(scene: Any) -> Run:
    """Solve a scene once."""
    begun = begin(scene)
    began = time.process_time()
    begun.solving.advance()
    spent = time.process_time() - began
    assert begun.system is not None
    return path(spent, begun.system, begun.solving.trajectory())


def path(spent: float, system: Any, t: Any) -> Run:
    """Run with the tip's path of trajectory `t`; spent: processor time, s."""
    body, point = system.scene.tip
    q = t.q[:, system.coordinates.places(system.rigid[body].node)]
    return Run(spent, t.time, q[:, :3] + rotations.of_quaternion(q[:, 3:]) @ point)


def by_mujoco(scene: Any, step: float) -> Run:
    """Solve a scene in MuJoCo, without Python in the loop over steps."""
    model, seconds = model_of(scene, step), scene.solver.end_time_s
    bed = MujocoBed(model, scene.bed.layers, scene.bed.origin, static=scene.static)
    for body in scene.rigid:
        for part in (part for part in body.parts if part.in_sand):
            add_part(bed.load, bed.body(body.name), part, scene, body.mass)
    data, count = mujoco.MjData(model), round(seconds / step)
    for joint in scene.joints:
        if joint.kind == "free":
            motion = scene.body(joint.child).motion
            data.qvel[:6] = [*motion.velocity, *(motion.rotation.T @ motion.rate)]
        else:
            data.joint(joint.name).qpos, data.joint(joint.name).qvel = joint.start, joint.rate
    controls, states = controls_of(scene, np.arange(count) * step), np.empty((count + 1, model.nq))
    spent = mujoco_native.run(bed, model, data, controls, states, Laws(scene, model))
    body, point = scene.tip
    number, tips = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, body), []
    for state in states:
        data.qpos[:] = state
        mujoco.mj_kinematics(model, data)
        tips.append(data.xpos[number] + data.xmat[number].reshape(3, 3) @ point)
    return Run(spent, np.arange(count + 1) * step, np.array(tips))


def model_of(scene: Any, step: float) -> Any:
    """MuJoCo model of a tree of hinges on a floating body; bodies have the frames of the scene."""
    children: dict[str | None, list[Any]] = {}
    for joint in scene.joints:
        children.setdefault(joint.parent, []).append(joint)
    drives = "".join(_drive(drive) for drive in scene.drives)
    option = f'timestep="{step!r}" gravity="0 0 {-scene.gravity!r}" integrator="implicitfast"'
    return mujoco.MjModel.from_xml_string(
        f"<mujoco><compiler angle='radian' autolimits='true'/><option {option}><flag contact='disable'/></option>"
        f"<worldbody>{''.join(_body(scene, root, children) for root in children[None])}</worldbody>"
        f"<actuator>{drives}</actuator></mujoco>"
    )


def _body(scene: Any, joint: Any, children: dict[str | None, list[Any]]) -> str:
    """XML of a body and its descendants, in the pose with all hinges at 0."""
    body, degrees = scene.body(joint.child), "<freejoint/>"
    place, turn = body.motion.position, body.motion.rotation
    if joint.kind == "hinge":
        turn = joint.parent_turn @ joint.child_turn.T
        place = joint.parent_point - turn @ joint.child_point
        at = f'pos="{_numbers(joint.child_point)}" axis="{_numbers(joint.child_turn[:, 2])}"'
        degrees = f'<joint name="{joint.name}" {at} damping="{float(joint.law.damping)!r}"/>'
    J = body.inertia
    inertia = _numbers([J[0, 0], J[1, 1], J[2, 2], J[0, 1], J[0, 2], J[1, 2]])
    inner = "".join(_body(scene, child, children) for child in children.get(body.name, []))
    return (
        f'<body name="{body.name}" pos="{_numbers(place)}" quat="{_numbers(rotations.quaternion_of(turn))}">{degrees}'
        f'<inertial pos="0 0 0" mass="{float(body.mass)!r}" fullinertia="{inertia}"/>{inner}</body>'
    )


def _numbers(numbers: Any) -> str:
    return " ".join(repr(float(number)) for number in numbers)


def _drive(drive: Any) -> str:
    limit = "" if math.isinf(drive.limit) else f' forcerange="{-drive.limit!r} {drive.limit!r}"'
    gains = f'gainprm="{drive.gain!r}" biastype="affine" biasprm="0 {-drive.gain!r} {-drive.rate_gain!r}"'
    return f'<general joint="{drive.joint}" {gains}{limit}/>'


def error(run: Run, reference: Run) -> float:
    """Largest distance of the tip from a reference run, over the length of the reference's path."""
    slopes = np.gradient(reference.tip, reference.time, axis=0)
    expected = at_times(reference.time, reference.tip, slopes, run.time)
    length = np.linalg.norm(np.diff(reference.tip, axis=0), axis=1).sum()
    return float(np.linalg.norm(run.tip - expected, axis=1).max() / length)


def front(name: str, seconds: float, quick: bool) -> list[Found]:
    """Run all settings of a robot."""
    reference, scene = ours(name, seconds, *chosen(REFERENCE)), scene_of(name, seconds)
    solvers: dict[tuple[str, str], Callable[[], Run]] = {}
    for accuracy in ACCURACIES:
        solvers[OURS, f"accuracy {accuracy:g}"] = partial(ours, name, seconds, *chosen(accuracy))
    for tolerance in TOLERANCES:
        sets = *chosen(ACCURACIES[0]), f"solver.tolerance={tolerance!r}"
        solvers[OURS, f"accuracy {ACCURACIES[0]:g}, tolerance {tolerance:g}"] = partial(ours, name, seconds, *sets)
    for step in FIXED:
        solvers[OURS, f"steps of {1e3 * step:g} ms"] = partial(ours, name, seconds, *fixed(step))
    for step in STEPS[:-1] if quick else STEPS:
        solvers[NATIVE, f"steps of {1e3 * step:g} ms"] = partial(by_mujoco, scene, step)
    return in_turn(solvers, reference, 2 if quick else 3)


def in_turn(solvers: dict[tuple[str, str], Callable[[], Run]], reference: Run, repeats: int) -> list[Found]:
    """Run the solvers in turn, `repeats` times; return the error and the least time of each."""
    measured: dict[tuple[str, str], tuple[float, float]] = {}
    for _ in range(repeats):
        for key, solver in solvers.items():
            latest = solver()
            measured[key] = error(latest, reference), min(latest.seconds, measured.get(key, (0.0, math.inf))[1])
    return [(*key, *value) for key, value in measured.items()]


def study(quick: bool) -> Outcome:
    """Run all robots; tables of all runs and of the least times at given errors."""
    rows, claims, least = [], [], []
    for name, seconds in (SECONDS_QUICK if quick else SECONDS).items():
        runs = front(name, seconds, quick)
        rows += [[name, *entry[:2], f"{entry[2]:.2%}", f"{entry[3]:.3f}"] for entry in runs]
        for level in LEVELS:
            times = [
                min((entry[3] for entry in runs if entry[0] == tool and entry[2] <= level), default=math.inf)
                for tool in (OURS, NATIVE)
            ]
            least.append([name, f"{level:.1%}", *(f"{spent:.3f}" for spent in times)])
            if level in MOST:
                ratio = times[0] / times[1]
                detail = f"{ratio:.2f} times MuJoCo's time (required: {MOST[level]:.2g}), in {times[0]:.3f} s"
                if times[1] == math.inf:
                    detail = (
                        f"in {times[0]:.3f} s; MuJoCo does not reach this error with steps of {1e3 * STEPS[-1]:g} ms"
                    )
                claims.append(Claim(f"space_fronts.{name} at {level:.1%}", ratio <= MOST[level], detail))
    text = "\n\n".join(
        [
            "Smallest processor time (s) within a given error of the tip's path.",
            markdown(["robot", "error at most", OURS, NATIVE], least),
            "All runs.",
            markdown(["robot", "tool", "setting", "error", "s"], rows),
        ]
    )
    return Outcome(text, tuple(claims))


if __name__ == "__main__":
    raise SystemExit(script(study))
