"""The hexapod as the studies with MuJoCo have it."""

from __future__ import annotations

import pytest

from validation.peers.mujoco_hexapod import model_of, scene_of


def test_mujoco_model_is_the_robot_of_the_scene() -> None:
    scene = scene_of(0.1)
    model = model_of(scene, 1e-3)
    assert model.nbody == 1 + len(scene.rigid)
    assert model.nu == len(scene.drives)
    assert model.body_mass.sum() == pytest.approx(scene.mass, rel=1e-6)
    right = [model.geom(model.body(f"leg_{row}_right").geomadr[0]).dataid[0] for row in ("front", "middle", "rear")]
    assert len(set(right)) == 1
