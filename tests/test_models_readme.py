"""The commands in models/README.md run and give what it says."""

from __future__ import annotations

import re

import numpy as np
from support_runs import ROOT, simulate

from granular_contact.config import load
from granular_contact.scene import build

TEXT = (ROOT / "models" / "README.md").read_text(encoding="utf-8")


def test_the_leg_is_let_down_drawn_up_and_stretched() -> None:
    leg, *_ = re.findall(r"```yaml\n(.*?)```", TEXT, flags=re.S)
    run = simulate(leg)
    assert run.status.code == "end_time"
    # Let down: it starts in the sand, at rest.
    assert run["depth_m"][0] > 1e-3
    assert run["kinetic_J"][0] == 0.0
    # The knee follows 60 deg + 20 deg sin(2 pi t) as far as 5 N m/rad and 0.05 N m s/rad bring it; round-off.
    phase = 2 * np.pi * run["time_s"]
    error = np.radians(60 + 20 * np.sin(phase) - run["knee_angle_deg"])
    rate_error = np.radians(20) * 2 * np.pi * np.cos(phase) - run["knee_rate_rad_s"]
    np.testing.assert_allclose(5 * error + 0.05 * rate_error, run["knee_torque_Nm"], atol=1e-12)
    assert np.ptp(run["knee_angle_deg"]) > 30.0
    assert run.summary["energy"]["imbalance_relative"] < 1e-3
    assert run.summary["contacts"]["shank"]


def test_the_loop_is_closed_and_the_homes_found_are_reported(tmp_path) -> None:
    _, bars, *_ = re.findall(r"```yaml\n(.*?)```", TEXT, flags=re.S)
    file = tmp_path / "bars.yaml"
    file.write_text(bars, encoding="utf-8")
    scene = build(load(file))
    assert [note.key.split(".")[2] for note in scene.notes] == ["axle", "elbow", "pivot"]
    (knee,) = (joint for joint in scene.joints if joint.closes)
    coupler, rocker = (scene.body(name).motion for name in ("coupler", "rocker"))
    # Both are 0.3 m long, and their frames are half way.
    np.testing.assert_allclose(coupler.world(np.array([0.15, 0.0])), rocker.world(np.array([0.15, 0.0])), atol=1e-12)
    assert knee.name == "knee"


def test_the_flail_swings_in_space_into_the_sand_and_slows_down() -> None:
    *_, flail, _ = re.findall(r"```yaml\n(.*?)```", TEXT, flags=re.S)
    run = simulate(flail)
    assert run.status.code == "end_time"
    assert run["depth_m"].max() > 5e-3
    assert run.summary["energy"]["granular_work_J"] < -0.01
    assert run.summary["energy"]["imbalance_relative"] < 1e-3
    assert np.ptp(run["head_y_m"]) > 5e-3


def test_the_paddle_bends_about_both_axes_and_twists_in_the_sand() -> None:
    *_, paddle = re.findall(r"```yaml\n(.*?)```", TEXT, flags=re.S)
    run = simulate(paddle)
    assert run.status.code == "end_time"
    for name, least in (("strip_deflection_y_m", 1e-5), ("strip_deflection_z_m", 2e-3), ("strip_twist_deg", 0.05)):
        assert np.ptp(run[name]) > least
    assert run.summary["energy"]["imbalance_relative"] < 1e-3
    assert run.summary["contacts"]["ball"]


def test_every_kind_of_joint_signal_and_drive_is_named() -> None:
    from granular_contact.config.schema.drives import DRIVES
    from granular_contact.config.schema.joints import JOINTS
    from granular_contact.config.schema.signals import SIGNALS

    for kind in (*JOINTS, *DRIVES, *(name for name in SIGNALS if name != "constant")):
        assert f"`{kind}`" in TEXT
