"""A wheel under a load is driven with a given slip, as on a single-wheel test bed: drawbar pull, torque and sinkage.

python examples/mujoco/wheel.py [--slip 0.3] [--video wheel.gif] [--step 0.001] [--seconds 3]
"""

from __future__ import annotations

import sys

import mujoco
import numpy as np
from common import run

from granular_contact import preset
from granular_contact.mujoco import MujocoBed

RADIUS, WIDTH, LOAD, SPEED = 0.1, 0.08, 40.0, 0.05  # m, m, N on the axle with the wheel's weight, m/s of its rim
MODEL = f"""
<mujoco model="wheel">
  <option timestep="0.001" integrator="implicitfast"/>
  <visual><global offwidth="960" offheight="540"/></visual>
  <worldbody>
    <light pos="0 -1 3" dir="0 0.3 -1"/>
    <geom name="surface" type="plane" size="2 1 0.1" rgba="0.84 0.76 0.6 0.6" contype="0" conaffinity="0"/>
    <camera name="side" pos="0.1 -0.9 0.25" xyaxes="1 0 0 0 0.2 1"/>
    <body name="carriage" pos="0 0 {RADIUS}">
      <joint name="rail" type="slide" axis="1 0 0"/>
      <joint name="lift" type="slide" axis="0 0 1"/>
      <inertial pos="0 0 0" mass="{LOAD / 9.81 - 1.0}" diaginertia="0.01 0.01 0.01"/>
      <body name="wheel">
        <joint name="axle" type="hinge" axis="0 1 0"/>
        <geom name="rim" type="cylinder" size="{RADIUS} {0.5 * WIDTH}" euler="90 0 0" mass="1" rgba="0.3 0.3 0.35 1"/>
      </body>
    </body>
  </worldbody>
  <actuator>
    <velocity name="pull" joint="rail" kv="2000"/>
    <velocity name="drive" joint="axle" kv="20"/>
  </actuator>
</mujoco>"""


def make(step: float = 1e-3) -> tuple[mujoco.MjModel, MujocoBed]:
    """The model and its bed."""
    model = mujoco.MjModel.from_xml_string(MODEL)
    model.opt.timestep = step
    bed = MujocoBed(model, preset("rft3d_sand"))
    bed.add_geoms("rim", facet_size=0.03)
    return model, bed


def main() -> None:
    """Drive the wheel, and print means over the last third of the time."""
    slip = 0.3
    if "--slip" in sys.argv:
        place = sys.argv.index("--slip")
        slip = float(sys.argv[place + 1])
        del sys.argv[place : place + 2]
    model, bed = make()
    seen: list[tuple[float, ...]] = []

    def control(data: mujoco.MjData) -> None:
        """Stand for half a second, then drive; what the drives bear is what the sand does, but for inertia."""
        moves = 0.0 if data.time < 0.5 else 1.0
        data.ctrl[:] = moves * SPEED * (1.0 - slip), moves * SPEED / RADIUS
        seen.append((data.time, -data.actuator_force[0], data.actuator_force[1], -data.joint("lift").qpos[0]))

    data = run(model, bed, control, seconds=3.0)
    rows = np.array(seen)
    _, pull, torque, sinkage = rows[rows[:, 0] > 2.0 / 3.0 * data.time].mean(axis=0)
    print(f"slip {slip:g}: drawbar pull {pull:.1f} N, torque {torque:.2f} N m, sinkage {1e3 * sinkage:.1f} mm")


if __name__ == "__main__":
    main()
