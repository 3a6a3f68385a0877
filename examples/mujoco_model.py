"""A robot in a MuJoCo model falls onto sand: three lines make the sand, and one line in the loop applies its force."""

from __future__ import annotations

import mujoco
import numpy as np
from common import panels, save

from granular_contact import preset
from granular_contact.mujoco import MujocoBed

MODEL = """
<mujoco>
  <option timestep="0.002"/>
  <worldbody>
    <body name="robot" pos="0 0 0.08">
      <freejoint/>
      <geom name="trunk" type="box" size="0.08 0.05 0.02" density="800"/>
      <geom name="leg_left" type="capsule" fromto="0 0.06 0 0 0.06 -0.06" size="0.012"/>
      <geom name="leg_right" type="capsule" fromto="0 -0.06 0 0 -0.06 -0.06" size="0.012"/>
    </body>
  </worldbody>
</mujoco>"""

model = mujoco.MjModel.from_xml_string(MODEL)
data = mujoco.MjData(model)
bed = MujocoBed(model, preset("rft3d_sand"), surface=0.0)
bed.add_geoms("trunk|leg_.*")

rows = []
while data.time < 1.0:
    bed.apply(data)  # once a step, after the controls are set
    mujoco.mj_step(model, data)
    sand = bed.of(data)
    rows.append((data.time, sand.force[2], sand.depths["robot"], -sand.work))
time, force, depth, lost = np.array(rows).T
print(f"carried by {force[-1]:.2f} N, {1e3 * depth[-1]:.1f} mm deep, lost {lost[-1]:.3f} J")

figure, (left, right) = panels(2)
left.plot(time, force)
left.set(xlabel="time (s)", ylabel="force of the sand (N)")
right.plot(time, np.where(force > 0.0, 1e3 * depth, np.nan))  # above the sand it is a bound
right.set(xlabel="time (s)", ylabel="depth (mm)")
save(figure)
