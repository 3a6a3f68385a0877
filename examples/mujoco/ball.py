"""A ball is dropped into glass beads, by a law of balls: linear in depth, and quadratic in speed.

python examples/mujoco/ball.py [--video ball.gif] [--step 0.001] [--seconds 0.5]
"""

from __future__ import annotations

import mujoco
from common import run

from granular_contact import Poncelet
from granular_contact.mujoco import MujocoBed

HEIGHT, DIAMETER = 0.2, 0.05  # m, above the surface
MODEL = f"""
<mujoco model="ball">
  <option timestep="0.001"/>
  <visual><global offwidth="960" offheight="540"/></visual>
  <worldbody>
    <light pos="0 -1 3" dir="0 0.3 -1"/>
    <geom name="surface" type="plane" size="0.5 0.5 0.1" rgba="0.84 0.76 0.6 0.6" contype="0" conaffinity="0"/>
    <camera name="side" pos="0 -0.7 0.2" xyaxes="1 0 0 0 0.2 1"/>
    <body name="ball" pos="0 0 {HEIGHT + 0.5 * DIAMETER}">
      <freejoint/>
      <geom name="ball" type="sphere" size="{0.5 * DIAMETER}" density="2500" rgba="0.3 0.4 0.7 1"/>
    </body>
  </worldbody>
</mujoco>"""


def make(step: float = 1e-3) -> tuple[mujoco.MjModel, MujocoBed]:
    """The model and its bed."""
    model = mujoco.MjModel.from_xml_string(MODEL)
    model.opt.timestep = step
    # The numbers are chosen for this example, not measured.
    bed = MujocoBed(model, Poncelet(4.0, 1.5))
    bed.add_geoms("ball")
    return model, bed


def main() -> None:
    """Drop the ball, and print how deep it sank."""
    model, bed = make()
    data = run(model, bed, lambda data: None, seconds=0.5)
    kept = bed.of(data)
    print(f"at rest {1e3 * kept.depth:.1f} mm deep, the sand took up {-kept.work:.3f} J")


if __name__ == "__main__":
    main()
