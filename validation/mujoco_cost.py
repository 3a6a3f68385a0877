"""CPU time of the bed in MuJoCo models: a step of a walking hexapod, and a run of the walker in the plane.

    python validation/mujoco_cost.py

The hexapod of examples/mujoco walks at steps of 1 ms. Its CPU time is the least of forty stretches of 200 steps from
the same state, after a warm-up; all in one run. "By hand" is the simplest implementation: a Python loop over all
triangles, which loads each leading triangle below the surface by this package's compiled law of 3D-RFT, without
bristles, and calls `mj_applyFT` once a body; with it the hexapod does not stand. The walker of configs/walker.yaml runs
2 s at steps of 0.2 ms, with lines in the plane.

Bounds: 60 us for the bed in a step of the hexapod, ten times real time, 1 s for the walker.
"""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

HERE = Path(__file__).parents[1]
sys.path[:0] = [str(HERE), str(HERE / "examples" / "mujoco")]

import hexapod
import mujoco
import numpy as np

from granular_contact.config import load_scenario
from granular_contact.config.load import preset
from granular_contact.laws.rft3d import Rft3d
from granular_contact.mujoco import MujocoBed
from granular_contact.scene import build
from validation.peers.mujoco_scene import bed_of, controls_of, model_of, start
from validation.tables import machine, markdown

STRETCH, REPEATS, BEGIN = 200, 40, 1.0  # steps, stretches, s of walking before the first stretch
BED, REAL_TIME, WALKER = 60.0, 10.0, 1.0  # us, times, s


def least(model: Any, data: Any, once: Callable[[int], object], back: Callable[[], None] | None = None) -> float:
    """CPU time (us) of a step: least over stretches, which all start at the present state of `data`.

    once: does the step with a number; back: called before each stretch to reset further state.
    """
    whole = mujoco.mjtState.mjSTATE_INTEGRATION
    begin = np.zeros(mujoco.mj_stateSize(model, whole))
    mujoco.mj_getState(model, data, begin, whole)
    times = []
    for _ in range(REPEATS + 1):
        mujoco.mj_setState(model, data, begin, whole)
        if back is not None:
            back()
        started = time.process_time()
        for i in range(STRETCH):
            once(i)
        times.append((time.process_time() - started) / STRETCH)
    mujoco.mj_setState(model, data, begin, whole)
    return 1e6 * min(times[1:])


class Naive:
    """Forces of the sand by a Python loop over triangles."""

    def __init__(self, bed: MujocoBed, medium: Rft3d) -> None:
        self.law = SimpleNamespace(xi_n=medium.stiffness(9.81), mu_surf=medium.mu_surf)
        self.medium, self.bodies = medium, {}
        for line in bed.load.lines:
            number = bed.model.body(line.body.name).id
            self.bodies.setdefault(number, []).extend(line.rows[:, [0, 1, 2, 4, 5, 6, 7]].tolist())

    def apply(self, model: Any, data: Any) -> None:
        """Sum the forces on the triangles of each body and apply them."""
        data.qfrc_applied[:] = 0.0
        twist = np.zeros(6)
        for number, rows in self.bodies.items():
            mujoco.mj_objectVelocity(model, data, mujoco.mjtObj.mjOBJ_XBODY, number, twist, 0)
            R, z, (wx, wy, wz, vx, vy, vz) = (
                data.xmat[number].tolist(),
                float(data.xpos[number, 2]),
                twist.tolist(),
            )
            force, moment = [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]
            for bx, by, bz, nx, ny, nz, area in rows:
                rz = R[6] * bx + R[7] * by + R[8] * bz
                depth = -(z + rz)
                if depth <= 0.0:
                    continue
                rx, ry = R[0] * bx + R[1] * by + R[2] * bz, R[3] * bx + R[4] * by + R[5] * bz
                ux, uy, uz = vx + wy * rz - wz * ry, vy + wz * rx - wx * rz, vz + wx * ry - wy * rx
                speed = math.sqrt(ux * ux + uy * uy + uz * uz)
                mx, my, mz = (R[i] * nx + R[i + 1] * ny + R[i + 2] * nz for i in (0, 3, 6))
                if speed == 0.0 or mx * ux + my * uy + mz * uz <= 0.0:
                    continue
                s = self.medium.facet_stress((mx, my, mz), (ux / speed, uy / speed, uz / speed), self.law)
                k = area * depth * math.tanh(speed / 1e-3)
                fx, fy, fz = k * s[0], k * s[1], k * s[2]
                force = [force[0] + fx, force[1] + fy, force[2] + fz]
                moment = [moment[0] + ry * fz - rz * fy, moment[1] + rz * fx - rx * fz, moment[2] + rx * fy - ry * fx]
            mujoco.mj_applyFT(
                model, data, np.array(force), np.array(moment), data.xpos[number], number, data.qfrc_applied
            )


def hexapod_rows() -> tuple[list[tuple[str, float]], int]:
    """CPU time (us) of a step with and without the bed and by hand, and the number of facets."""
    model, bed = hexapod.make(1e-3)
    data = mujoco.MjData(model)
    while data.time < BEGIN:
        data.ctrl[:] = hexapod.angles(data.time)
        bed.apply(data)
        mujoco.mj_step(model, data)
    state, controls = bed.of(data).state, [hexapod.angles(BEGIN + 1e-3 * i) for i in range(STRETCH)]
    naive = Naive(bed, preset("rft3d_sand"))

    def alone(i: int) -> None:
        data.ctrl[:] = controls[i]
        mujoco.mj_step(model, data)

    def with_bed(i: int) -> None:
        data.ctrl[:] = controls[i]
        bed.apply(data)
        mujoco.mj_step(model, data)

    def by_hand(i: int) -> None:
        data.ctrl[:] = controls[i]
        naive.apply(model, data)
        mujoco.mj_step(model, data)

    times = {
        "MuJoCo's step alone": least(model, data, alone),
        "with the bed": least(model, data, with_bed, lambda: bed.restore(data, state)),
    }
    data.xfrc_applied[:] = 0.0
    times["with a Python loop over triangles"] = least(model, data, by_hand)
    return list(times.items()), sum(len(line.rows) for line in bed.load.lines)


def walker_seconds() -> float:
    """CPU time (s) of 2 s of the walker at steps of 0.2 ms."""
    scene, step = build(load_scenario(HERE / "configs" / "walker.yaml")), 2e-4
    model = model_of(scene, step)
    bed, data = bed_of(scene, model), start(scene, model)
    controls = controls_of(scene, np.arange(10_000) * step)
    bed.of(data)
    started = time.process_time()
    for control in controls:
        data.ctrl[:] = control
        bed.apply(data)
        mujoco.mj_step(model, data)
    return time.process_time() - started


def main() -> int:
    """Print the tables; return 0 if the bounds are kept, else 1."""
    rows, facets = hexapod_rows()
    alone, whole = rows[0][1], rows[1][1]
    print(f"{machine('mujoco', 'numba')}; hexapod of {facets} facets, steps of 1 ms\n")
    table = [[case, f"{us:.1f}", f"{us - alone:.1f}", f"{us / alone:.1f}", f"{1e3 / us:.1f}"] for case, us in rows]
    print(
        markdown(["", "CPU us per step", "more than MuJoCo alone", "ratio to MuJoCo alone", "times real time"], table)
    )
    walker = min(walker_seconds() for _ in range(4))
    print(f"\nThe walker in the plane, 2 s at steps of 0.2 ms: {walker:.2f} s CPU")
    return 0 if whole - alone <= BED and 1e3 / whole >= REAL_TIME and walker <= WALKER else 1


if __name__ == "__main__":
    sys.exit(main())
