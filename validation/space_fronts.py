"""What an error costs on robots in space: fixed steps, steps chosen by their error, and MuJoCo with the same sand.

    python validation/space_fronts.py [--quick]

The hexapod (its hips under PD control, as MuJoCo has no prescribed motions), the walker in space and the snake as
shipped, in minimal coordinates and in MuJoCo (implicitfast) through `MujocoBed`, whose forces come from the same
kernels, in a compiled loop without Python. An error is the largest distance of the tip from the path of a run with an
accuracy of 1e-4, over the length of the path. Times are processor time of the solve, the least of repeats in turn.
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
FIXED = (8e-3, 4e-3, 2e-3, 1e-3)  # s
STEPS = (4e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4)  # s, of MuJoCo
LEVELS = (1e-2, 3e-3, 1e-3)
OURS, NATIVE = "granular-contact", "MuJoCo, compiled"
MOST = {1e-2: 1.0, 1e-3: 1.0 / 3.0}  # times MuJoCo's
Found = tuple[str, str, float, float]  # way or tool, setting, error and least time (s)


@dataclass(frozen=True)
class Run:
    """Processor time (s), and the path of the tip: times (n,) s and places (n, 3) m."""

    seconds: float
    time: Vector
    tip: Vector


def scene_of(name: str, seconds: float, *overrides: str) -> Any:
    """The scene of a robot."""
    if name == "hexapod":
        return mujoco_hexapod.scene_of(seconds, *overrides)
    return build(load_scenario(CONFIGS / f"{name}.yaml", [f"solver.end_time_s={seconds}", *overrides]))


def chosen(accuracy: float) -> tuple[str, ...]:
    """Overrides for steps that are chosen."""
    return (f"solver.accuracy={accuracy}",)


def fixed(step: float) -> tuple[str, ...]:
    """Overrides for fixed steps (s)."""
    return "solver.accuracy=null", f"solver.step_s={step}"


def ours(name: str, seconds: float, *overrides: str) -> Run:
    """A run of ours."""
    return solved(scene_of(name, seconds, *overrides))


def solved(scene: Any) -> Run:
    """One solve of a scene."""
    begun = begin(scene)
    began = time.process_time()
    begun.solving.advance()
    spent = time.process_time() - began
    assert begun.system is not None
    return path(spent, begun.system, begun.solving.trajectory())


def path(spent: float, system: Any, t: Any) -> Run:
    """The run of a trajectory."""
    body, point = system.scene.tip
    q = t.q[:, system.coordinates.places(system.rigid[body].node)]
    return Run(spent, t.time, q[:, :3] + rotations.of_quaternion(q[:, 3:]) @ point)


def by_mujoco(scene: Any, step: float) -> Run:
    """A run of MuJoCo, without Python in its loop."""
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
    number, made = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, body), []
    for state in states:
        data.qpos[:] = state
        mujoco.mj_kinematics(model, data)
        made.append(data.xpos[number] + data.xmat[number].reshape(3, 3) @ point)
    return Run(spent, np.arange(count + 1) * step, np.array(made))


def model_of(scene: Any, step: float) -> Any:
    """Model of a tree of hinges on a body that flies free; the frames of bodies are those of the scene."""
    children: dict[str | None, list[Any]] = {}
    for joint in scene.joints:
        children.setdefault(joint.parent, []).append(joint)
    drives = "".join(_drive(drive) for drive in scene.drives)
    option = f'timestep="{step!r}" gravity="0 0 {-scene.gravity!r}" integrator="implicitfast"'
    return mujoco.MjModel.from_xml_string(
        f"<mujoco><compiler angle='radian' autolimits='true'/><option {option}><flag contact='disable'/></option>"
        f"<worldbody>{''.join(_body(scene, one, children) for one in children[None])}</worldbody>"
        f"<actuator>{drives}</actuator></mujoco>"
    )


def _body(scene: Any, joint: Any, children: dict[str | None, list[Any]]) -> str:
    """A body where it is with its hinge at 0, with all that hangs on it."""
    body, degrees = scene.body(joint.child), "<freejoint/>"
    place, turn = body.motion.position, body.motion.rotation
    if joint.kind == "hinge":
        turn = joint.parent_turn @ joint.child_turn.T
        place = joint.parent_point - turn @ joint.child_point
        at = f'pos="{_words(joint.child_point)}" axis="{_words(joint.child_turn[:, 2])}"'
        degrees = f'<joint name="{joint.name}" {at} damping="{float(joint.law.damping)!r}"/>'
    J = body.inertia
    inertia = _words([J[0, 0], J[1, 1], J[2, 2], J[0, 1], J[0, 2], J[1, 2]])
    inner = "".join(_body(scene, other, children) for other in children.get(body.name, []))
    return (
        f'<body name="{body.name}" pos="{_words(place)}" quat="{_words(rotations.quaternion_of(turn))}">{degrees}'
        f'<inertial pos="0 0 0" mass="{float(body.mass)!r}" fullinertia="{inertia}"/>{inner}</body>'
    )


def _words(numbers: Any) -> str:
    return " ".join(repr(float(one)) for one in numbers)


def _drive(drive: Any) -> str:
    limit = "" if math.isinf(drive.limit) else f' forcerange="{-drive.limit!r} {drive.limit!r}"'
    gains = f'gainprm="{drive.gain!r}" biastype="affine" biasprm="0 {-drive.gain!r} {-drive.rate_gain!r}"'
    return f'<general joint="{drive.joint}" {gains}{limit}/>'


def error(run: Run, reference: Run) -> float:
    """Largest distance from a reference, over the length of its path."""
    slopes = np.gradient(reference.tip, reference.time, axis=0)
    there = at_times(reference.time, reference.tip, slopes, run.time)
    way = np.linalg.norm(np.diff(reference.tip, axis=0), axis=1).sum()
    return float(np.linalg.norm(run.tip - there, axis=1).max() / way)


def front(name: str, seconds: float, quick: bool) -> list[Found]:
    """Each way to solve a robot."""
    reference, scene = ours(name, seconds, *chosen(REFERENCE)), scene_of(name, seconds)
    ways: dict[tuple[str, str], Callable[[], Run]] = {}
    for accuracy in ACCURACIES:
        ways[OURS, f"accuracy {accuracy:g}"] = partial(ours, name, seconds, *chosen(accuracy))
    sets = *chosen(0.1), "solver.tolerance=1e-2"
    ways[OURS, "accuracy 0.1, tolerance 1e-2"] = partial(ours, name, seconds, *sets)
    for step in FIXED:
        ways[OURS, f"steps of {1e3 * step:g} ms"] = partial(ours, name, seconds, *fixed(step))
    for step in STEPS[:-1] if quick else STEPS:
        ways[NATIVE, f"steps of {1e3 * step:g} ms"] = partial(by_mujoco, scene, step)
    return in_turn(ways, reference, 2 if quick else 3)


def in_turn(ways: dict[tuple[str, str], Callable[[], Run]], reference: Run, repeats: int) -> list[Found]:
    """What each way of solving leaves and takes, all in turn, so many times."""
    found: dict[tuple[str, str], tuple[float, float]] = {}
    for _ in range(repeats):
        for key, way in ways.items():
            one = way()
            found[key] = error(one, reference), min(one.seconds, found.get(key, (0.0, math.inf))[1])
    return [(*key, *value) for key, value in found.items()]


def study(quick: bool) -> Outcome:
    """Fronts of all robots, and the least times at given errors."""
    rows, claims, least = [], [], []
    for name, seconds in (SECONDS_QUICK if quick else SECONDS).items():
        runs = front(name, seconds, quick)
        rows += [[name, *one[:2], f"{one[2]:.2%}", f"{one[3]:.3f}"] for one in runs]
        for level in LEVELS:
            times = [
                min((one[3] for one in runs if one[0] == tool and one[2] <= level), default=math.inf)
                for tool in (OURS, NATIVE)
            ]
            least.append([name, f"{level:.1%}", *(f"{one:.3f}" for one in times)])
            if level in MOST:
                ratio = times[0] / times[1]
                detail = f"{ratio:.2f} times MuJoCo's time (asked: {MOST[level]:.2g}), in {times[0]:.3f} s"
                if times[1] == math.inf:
                    detail = f"in {times[0]:.3f} s; MuJoCo does not come to it with steps of {1e3 * STEPS[-1]:g} ms"
                claims.append(Claim(f"space_fronts.{name} at {level:.1%}", ratio <= MOST[level], detail))
    text = "\n\n".join(
        [
            "Least processor time (s) at an error of the tip's path.",
            markdown(["robot", "error at most", OURS, NATIVE], least),
            "All runs.",
            markdown(["robot", "tool", "setting", "error", "s"], rows),
        ]
    )
    return Outcome(text, tuple(claims))


if __name__ == "__main__":
    raise SystemExit(script(study))
