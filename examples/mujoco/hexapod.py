"""A hexapod walks on sand: alternating tripod, slow while legs are on the ground, fast through the air.

python examples/mujoco/hexapod.py [--video hexapod.gif] [--step 0.001] [--seconds 4]
"""

from __future__ import annotations

import math
from pathlib import Path

import mujoco
import numpy as np
from common import run

from granular_contact import preset
from granular_contact.mujoco import MujocoBed

MODEL = Path(__file__).with_name("hexapod.xml")
FACET = 0.025  # m, 770 facets in all
FREQUENCY = 1.2  # strides a second
SWEEP, DUTY = 1.2, 0.55  # rad on the ground, share of a stride
TRIPOD = np.array([0.0, 0.5, 0.0, 0.5, 0.0, 0.5])  # of a stride, by actuator
STAND = 0.6  # s before it walks


def angles(t: float) -> np.ndarray:
    """Angles (rad) of the six hips at t (s), by Buehler's clock."""
    stride = FREQUENCY * max(0.0, t - STAND) + TRIPOD * min(1.0, t / STAND)
    share = np.mod(stride + 0.5 * DUTY, 1.0)
    ground = (share / DUTY - 0.5) * SWEEP
    air = 0.5 * SWEEP + (share - DUTY) / (1.0 - DUTY) * (2.0 * math.pi - SWEEP)
    return np.where(share < DUTY, ground, air) + 2.0 * math.pi * np.floor(stride + 0.5 * DUTY)


def make(step: float = 1e-3) -> tuple[mujoco.MjModel, MujocoBed]:
    """The model and its bed."""
    model = mujoco.MjModel.from_xml_path(str(MODEL))
    model.opt.timestep = step
    bed = MujocoBed(model, preset("rft3d_sand"), surface=0.0)
    bed.add_geoms("leg_.*", facet_size=FACET)
    bed.add_geoms("trunk", facet_size=0.15)
    return model, bed


def main() -> None:
    """Walk, and print how far."""
    model, bed = make()

    def control(data: mujoco.MjData) -> None:
        data.ctrl[:] = angles(data.time)

    data = run(model, bed, control, seconds=4.0)
    print(f"{data.qpos[0]:.3f} m in {data.time:.1f} s, the sand took up {-bed.of(data).work:.2f} J")


if __name__ == "__main__":
    main()
