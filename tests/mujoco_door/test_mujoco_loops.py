"""Loops that users of MuJoCo have: a Menagerie robot's file, and a model that others step meanwhile.

Those of docs/tutorials/mujoco.md run with that page.
"""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support_mujoco import SAND, go, model_of, thrown

mujoco = pytest.importorskip("mujoco", reason="MuJoCo is not installed")
from granular_contact.mujoco import MujocoBed  # noqa: E402

LEG = """
<body name="{0}_thigh" pos="{1} {2} 0"><joint name="{0}_hip" class="joint"/>
  <geom class="visual" size="0.02 0.05" pos="0 0 -0.05"/><geom class="collision" size="0.012" fromto="0 0 0 0 0 -0.1"/>
  <body name="{0}_calf" pos="0 0 -0.1"><joint name="{0}_knee" class="joint"/>
    <geom class="collision" size="0.01" fromto="0 0 0 0 0 -0.1"/><geom class="foot" name="{0}" pos="0 0 -0.1"/>
  </body>
</body>"""
# As the Menagerie writes its robots: classes, pictures beside collisions, dry friction, servos, a key, elliptic cones.
ROBOT = """
<mujoco model="dog"><compiler angle="radian" autolimits="true"/><option cone="elliptic" impratio="100"/>
  <default>
    <default class="joint">
      <joint axis="0 1 0" range="-1.5 1.5" damping="0.1" armature="0.01" frictionloss="0.2"/>
    </default>
    <default class="visual"><geom type="capsule" contype="0" conaffinity="0" group="2"/></default>
    <default class="collision"><geom type="capsule" group="3" density="600"/></default>
    <default class="foot"><geom type="sphere" size="0.022" condim="6" friction="0.8 0.02 0.01" priority="1"/></default>
    <position kp="60" kv="1" forcerange="-24 24"/>
  </default>
  <worldbody><body name="trunk" pos="0 0 0.3"><freejoint/><geom type="box" size="0.15 0.06 0.04" mass="5"/>{}</body>
  </worldbody><actuator>{}</actuator>
  <keyframe><key name="home" qpos="0 0 0.27 1 0 0 0 {}" ctrl="{}"/></keyframe>
</mujoco>"""


@pytest.mark.slow
def test_a_robot_written_as_in_the_menagerie_stands_as_it_is(tmp_path: Path) -> None:
    from validation.menagerie import model_of as read
    from validation.menagerie import stand

    feet = {"FR": (0.13, -0.08), "FL": (0.13, 0.08), "RR": (-0.13, -0.08), "RL": (-0.13, 0.08)}
    legs = "".join(LEG.format(name, *place) for name, place in feet.items())
    servos = "".join(f'<position joint="{name}_{joint}"/>' for name in feet for joint in ("hip", "knee"))
    home = " ".join(["0.5 -1.0"] * 4)
    (tmp_path / "dog.xml").write_text(ROBOT.format(legs, servos, home, home), encoding="utf-8")
    (tmp_path / "scene.xml").write_text(
        '<mujoco><include file="dog.xml"/><worldbody><geom type="plane" size="1 1 1"/></worldbody></mujoco>'
    )
    stood = stand(read(tmp_path, 2e-3))
    assert stood.told == ()
    assert stood.tilt < 0.1
    assert stood.carried == pytest.approx(stood.weight, rel=1e-3)
    assert abs(stood.heights[0] - stood.heights[1]) < 1e-6


def test_others_step_the_same_model_without_sand_meanwhile() -> None:
    """A free body falls in other threads as it does alone, while one with a bed is stepped."""
    model = model_of()
    bed = MujocoBed(model, SAND)
    bed.add_geoms("box")

    def fall(_: int) -> Any:
        data = thrown(model)
        for _ in range(2000):
            mujoco.mj_step(model, data)
        return data.qpos.copy()

    def in_sand() -> Any:
        data = thrown(model)
        go(model, data, bed, 0.2)
        return data.qpos.copy()

    alone, sunk = fall(0), in_sand()
    with ThreadPoolExecutor(4) as pool:
        landing = pool.submit(in_sand)
        np.testing.assert_array_equal(list(pool.map(fall, range(12))), [alone] * 12)
        np.testing.assert_array_equal(landing.result(), sunk)
