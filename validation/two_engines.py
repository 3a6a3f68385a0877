"""The same sand in MuJoCo and in Exudyn: shorter steps lead to the same motion, and what stands stands.

    python validation/two_engines.py [--quick]

A plate that is thrown into 3D-RFT sand in space, a chain of four links that strikes play sand, the hexapod of
models/hexapod that begins to walk, and the walker of configs/walker.yaml on poppy seeds, by `MujocoBed` at ever
shorter steps. Their errors are those against Exudyn's motion (of the chain: minimal coordinates) at a step or
tolerance where it has converged; the order is their slope. For standing the hexapod of examples/mujoco stands for 2 s
under its servos, and is watched for 3 s more.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

HERE = Path(__file__).parents[1]
sys.path[:0] = [str(HERE), str(HERE / "examples" / "mujoco")]

import hexapod
import mujoco
import numpy as np
from numpy.typing import NDArray

from granular_contact.config import load_scenario
from granular_contact.run import run
from granular_contact.scene import Scene, build
from validation.chains import chain
from validation.falling_box import FallingBox, order
from validation.peers import mujoco_hexapod
from validation.peers.mujoco_scene import bed_of, controls_of, model_of, start
from validation.study import Claim, Outcome, script
from validation.tables import markdown

Array = NDArray[np.float64]
PLATE = FallingBox((0.12, 0.08, 0.01), 0.03, (0.4, 0.1, -0.8, 1.0, 3.0, 0.5))
FALL, STRIKE, STRIDE, WALK = 0.12, 0.04, 1.0, 2.0  # s


def paths(scene: Scene, step: float, seconds: float, body: str, point: Array) -> Array:
    """Path (n, 2) m of a point of a body by MuJoCo, with the start."""
    model = model_of(scene, step)
    bed, data, number = (
        bed_of(scene, model),
        start(scene, model),
        mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, body),
    )
    controls = controls_of(scene, np.arange(round(seconds / step)) * step)
    made = []
    for control in controls:
        if model.nu:
            data.ctrl[:] = control
        bed.apply(data)
        made.append(_point(data, number, point))
        mujoco.mj_step(model, data)
    mujoco.mj_kinematics(model, data)
    return np.array([*made, _point(data, number, point)])


def _point(data: Any, number: int, point: Array) -> Array:
    turn, place = data.xmat[number].reshape(3, 3), data.xpos[number]
    return np.array(
        [
            place[0] + turn[0, 0] * point[0] + turn[0, 2] * point[1],
            place[2] + turn[2, 0] * point[0] + turn[2, 2] * point[1],
        ]
    )


def chain_errors(steps: list[float]) -> list[float]:
    """Greatest distance (mm) of the tip of the chain from its path in minimal coordinates."""
    scene = chain(4, end_time_s=STRIKE, method="minimal", accuracy=1e-5)
    there = run(scene)
    time, tip = there["time_s"], np.column_stack([there["tip_x_m"], there["tip_y_m"]])
    errors = []
    for step in steps:
        here = paths(scene, step, STRIKE, *scene.tip)
        at = np.column_stack([np.interp(np.arange(len(here)) * step, time, one) for one in tip.T])
        errors.append(1e3 * float(np.linalg.norm(here - at, axis=1).max()))
    return errors


def hexapod_errors(steps: list[float], step_there: float) -> tuple[list[float], float]:
    """Greatest distance (mm) of the hexapod's trunk from its path by Exudyn, and how far (mm) it walks."""
    scene = mujoco_hexapod.scene_of(STRIDE, "solver.accuracy=null", f"solver.step_s={step_there}")
    there = run(scene)
    time, trunk = there["time_s"], np.column_stack([there[f"trunk_{axis}_m"] for axis in "xyz"])
    errors = []
    for step in steps:
        here = mujoco_hexapod.path_of(scene, step, STRIDE)
        at = np.column_stack([np.interp(np.arange(len(here)) * step, time, one) for one in trunk.T])
        errors.append(1e3 * float(np.linalg.norm(here - at, axis=1).max()))
    return errors, 1e3 * float(trunk[-1, 0] - trunk[0, 0])


def walker_speeds(steps: list[float]) -> tuple[float, list[float]]:
    """Mean speed (m/s) of the walker's trunk in the second half, by Exudyn, and by MuJoCo at some steps."""
    path = HERE / "configs" / "walker.yaml"
    there = run(build(load_scenario(path, ["solver.accuracy=null", "solver.step_s=2.5e-4"])))
    x = np.interp([0.5 * WALK, WALK], there["time_s"], there["trunk_x_m"])
    scene = build(load_scenario(path))
    speeds = []
    for step in steps:
        here = paths(scene, step, WALK, "trunk", np.zeros(2))
        speeds.append(float(here[-1, 0] - here[len(here) // 2, 0]) / (0.5 * WALK))
    return float(x[1] - x[0]) / (0.5 * WALK), speeds


def drift(step: float) -> float:
    """How fast the hexapod sinks (um/s), after 2 s, by the mean of 3 s."""
    model, bed = hexapod.make(step)
    data = mujoco.MjData(model)
    heights = []
    for seconds in (2.0, 5.0):
        while data.time < seconds:
            bed.apply(data)
            mujoco.mj_step(model, data)
        heights.append(data.qpos[2])
    return 1e6 * (heights[0] - heights[1]) / 3.0


def study(quick: bool) -> Outcome:
    """Whether motions converge to Exudyn's, speeds agree and robots stand."""
    parts = [
        motions(quick),
        walking([1e-3, 5e-4] if quick else [2e-3, 1e-3, 5e-4, 2e-4, 1e-4]),
        standing([1e-3, 2e-3, 4e-3]),
    ]
    return Outcome("\n\n".join(part.text for part in parts), tuple(claim for part in parts for claim in part.claims))


def motions(quick: bool) -> Outcome:
    """Errors of plate, chain and hexapod by step; their orders are near one."""
    steps, strides = [4e-4, 2e-4, 1e-4], [2e-3, 1e-3, 5e-4, 2.5e-4]
    if not quick:
        strides += [1.25e-4, 6.25e-5]
    place = PLATE.by_exudyn(FALL, 600 if quick else 2400)
    plate = [1e3 * float(np.linalg.norm(PLATE.by_mujoco(FALL, step) - place)) for step in steps]
    links = chain_errors(steps)
    legs, far = hexapod_errors(strides, 5e-4 if quick else 1e-4)
    orders = order(steps, plate), order(steps, links), order(strides, legs)
    rows = [[f"{1e3 * s:g}", f"{a:.3f}", f"{b:.4f}"] for s, a, b in zip(steps, plate, links, strict=True)]
    rows.append(["order", *(f"{slope:.2f}" for slope in orders[:2])])
    small = markdown(["step ms", "plate, end mm", "chain, tip path mm"], rows)
    rows = [[f"{1e3 * s:g}", f"{error:.3f}"] for s, error in zip(strides, legs, strict=True)]
    robot = markdown(["step ms", "hexapod, trunk path mm"], [*rows, ["order", f"{orders[2]:.2f}"]])
    claims = [
        Claim(f"two_engines.order of {name}", 0.7 < slope < 1.4, f"{slope:.2f} (0.7 to 1.4)")
        for name, slope in zip(("plate", "chain", "hexapod"), orders, strict=True)
    ]
    return Outcome(f"{small}\n\nThe hexapod walks {far:.1f} mm by Exudyn.\n\n{robot}", tuple(claims))


def walking(steps: list[float]) -> Outcome:
    """The walker's speeds by step; at the shortest step the speed is Exudyn's within 2 %."""
    there, speeds = walker_speeds(steps)
    rows = [[f"{1e3 * s:g}", f"{v:.4f}", f"{100 * (v / there - 1):+.2f} %"] for s, v in zip(steps, speeds, strict=True)]
    off = abs(speeds[-1] / there - 1)
    claim = Claim("two_engines.speed of the walker", off < 0.02, f"{100 * off:.2f} % apart (below 2)")
    table = markdown(["step ms", "m/s by MuJoCo", "to Exudyn"], rows)
    return Outcome(f"Walker: {there:.4f} m/s in the second half by Exudyn.\n\n{table}", (claim,))


def standing(steps: list[float]) -> Outcome:
    """How fast the hexapod sinks while it stands: not at all."""
    rates = [drift(step) for step in steps]
    rows = [[f"{1e3 * s:g}", f"{rate:.2g}"] for s, rate in zip(steps, rates, strict=True)]
    most = max(abs(rate) for rate in rates)
    claim = Claim("two_engines.a hexapod stands", most < 0.1, f"it sinks by {most:.2g} um/s at most (below 0.1)")
    return Outcome(f"The hexapod stands.\n\n{markdown(['step ms', 'sinks um/s'], rows)}", (claim,))


if __name__ == "__main__":
    sys.exit(script(study))
