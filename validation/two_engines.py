"""The same sand in MuJoCo and in Exudyn: motions converge with the step, and standing robots do not sink.

    python validation/two_engines.py [--quick]

The cases are a plate thrown into 3D-RFT sand in space, a chain of four links that strikes play sand, the hexapod of
models/hexapod that begins to walk, and the walker of configs/walker.yaml on poppy seeds. They run in MuJoCo with
`MujocoBed` at decreasing steps. The reference is Exudyn's converged motion (for the chain: that in minimal
coordinates); the order is the slope of the errors over the steps. For the test of standing, the hexapod of
examples/mujoco stands under its servos for 2 s, and its sinking is measured over 3 s more.
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
    """Path (n, 2) m of a point of a body by MuJoCo, from the start on."""
    model = model_of(scene, step)
    bed, data, number = (
        bed_of(scene, model),
        start(scene, model),
        mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, body),
    )
    controls = controls_of(scene, np.arange(round(seconds / step)) * step)
    positions = []
    for control in controls:
        if model.nu:
            data.ctrl[:] = control
        bed.apply(data)
        positions.append(_point(data, number, point))
        mujoco.mj_step(model, data)
    mujoco.mj_kinematics(model, data)
    return np.array([*positions, _point(data, number, point)])


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
    reference = run(scene)
    time, tip = reference["time_s"], np.column_stack([reference["tip_x_m"], reference["tip_y_m"]])
    errors = []
    for step in steps:
        path = paths(scene, step, STRIKE, *scene.tip)
        expected = np.column_stack([np.interp(np.arange(len(path)) * step, time, axis) for axis in tip.T])
        errors.append(1e3 * float(np.linalg.norm(path - expected, axis=1).max()))
    return errors


def hexapod_errors(steps: list[float], step_there: float) -> tuple[list[float], float]:
    """Greatest distance (mm) of the hexapod's trunk from its path by Exudyn, and the distance (mm) that it walks.

    steps: of MuJoCo, s; step_there: of Exudyn, s.
    """
    scene = mujoco_hexapod.scene_of(STRIDE, "solver.accuracy=null", f"solver.step_s={step_there}")
    reference = run(scene)
    time, trunk = reference["time_s"], np.column_stack([reference[f"trunk_{axis}_m"] for axis in "xyz"])
    errors = []
    for step in steps:
        path = mujoco_hexapod.path_of(scene, step, STRIDE)
        expected = np.column_stack([np.interp(np.arange(len(path)) * step, time, column) for column in trunk.T])
        errors.append(1e3 * float(np.linalg.norm(path - expected, axis=1).max()))
    return errors, 1e3 * float(trunk[-1, 0] - trunk[0, 0])


def walker_speeds(steps: list[float]) -> tuple[float, list[float]]:
    """Mean speed (m/s) of the walker's trunk in the second half of the run, by Exudyn, and by MuJoCo for each step."""
    path = HERE / "configs" / "walker.yaml"
    reference = run(build(load_scenario(path, ["solver.accuracy=null", "solver.step_s=2.5e-4"])))
    x = np.interp([0.5 * WALK, WALK], reference["time_s"], reference["trunk_x_m"])
    scene = build(load_scenario(path))
    speeds = []
    for step in steps:
        trunk = paths(scene, step, WALK, "trunk", np.zeros(2))
        speeds.append(float(trunk[-1, 0] - trunk[len(trunk) // 2, 0]) / (0.5 * WALK))
    return float(x[1] - x[0]) / (0.5 * WALK), speeds


def drift(step: float) -> float:
    """Mean speed (um/s) at which the hexapod sinks between 2 and 5 s."""
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
    """Test that motions converge to Exudyn's, that speeds agree and that robots stand."""
    parts = [
        motions(quick),
        walking([1e-3, 5e-4] if quick else [2e-3, 1e-3, 5e-4, 2e-4, 1e-4]),
        standing([1e-3, 2e-3, 4e-3]),
    ]
    return Outcome("\n\n".join(part.text for part in parts), tuple(claim for part in parts for claim in part.claims))


def motions(quick: bool) -> Outcome:
    """Errors of plate, chain and hexapod by step, with the claim that their orders are near one."""
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
    return Outcome(f"{small}\n\nThe hexapod walks {far:.1f} mm in Exudyn.\n\n{robot}", tuple(claims))


def walking(steps: list[float]) -> Outcome:
    """Speeds of the walker by step, with the claim that the speed at the shortest step is Exudyn's within 2 %."""
    reference, speeds = walker_speeds(steps)
    rows = [
        [f"{1e3 * s:g}", f"{v:.4f}", f"{100 * (v / reference - 1):+.2f} %"] for s, v in zip(steps, speeds, strict=True)
    ]
    off = abs(speeds[-1] / reference - 1)
    claim = Claim("two_engines.speed of the walker", off < 0.02, f"{100 * off:.2f} % apart (below 2)")
    table = markdown(["step ms", "m/s by MuJoCo", "ratio to Exudyn"], rows)
    return Outcome(f"Walker: {reference:.4f} m/s in the second half in Exudyn.\n\n{table}", (claim,))


def standing(steps: list[float]) -> Outcome:
    """Speeds at which the standing hexapod sinks, with the claim that it does not."""
    rates = [drift(step) for step in steps]
    rows = [[f"{1e3 * s:g}", f"{rate:.2g}"] for s, rate in zip(steps, rates, strict=True)]
    most = max(abs(rate) for rate in rates)
    claim = Claim("two_engines.a hexapod stands still", most < 0.1, f"it sinks by {most:.2g} um/s at most (below 0.1)")
    return Outcome(f"The hexapod stands still.\n\n{markdown(['step ms', 'sinks um/s'], rows)}", (claim,))


if __name__ == "__main__":
    sys.exit(script(study))
