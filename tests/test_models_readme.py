"""What models/README.md shows runs, and does what it says."""

from __future__ import annotations

import re

import numpy as np
from support_runs import ROOT, simulate

TEXT = (ROOT / "models" / "README.md").read_text(encoding="utf-8")


def test_the_leg_is_let_down_drawn_up_and_stretched() -> None:
    (leg,) = re.findall(r"```yaml\n(.*?)```", TEXT, flags=re.S)
    run = simulate(leg)
    assert run.status.code == "end_time"
    # Let down: it starts in the sand, at rest.
    assert run["depth_m"][0] > 1e-3
    assert run["kinetic_J"][0] == 0.0
    # The knee follows 60 deg + 20 deg sin(2 pi t) but for its torque over 5 N m/rad, and for the error of its rate, of
    # some 0.2 rad/s, times 0.05 / 5 s: 0.1 deg; more in the first moments, in which it takes up speed.
    wanted = 60 + 20 * np.sin(2 * np.pi * run["time_s"])
    late = run["time_s"] > 0.05
    error = wanted - run["knee_angle_deg"]
    np.testing.assert_allclose(error[late], np.degrees(run["knee_torque_Nm"][late] / 5), atol=0.2)
    assert np.ptp(run["knee_angle_deg"]) > 30.0
    assert run.summary["energy"]["imbalance_relative"] < 1e-3
    assert run.summary["contacts"]["shank"]


def test_every_kind_of_joint_signal_and_drive_is_named() -> None:
    from granular_contact.config.schema.drives import DRIVES
    from granular_contact.config.schema.joints import JOINTS
    from granular_contact.config.schema.signals import SIGNALS

    for kind in (*JOINTS, *DRIVES, *(name for name in SIGNALS if name != "constant")):
        assert f"`{kind}`" in TEXT
