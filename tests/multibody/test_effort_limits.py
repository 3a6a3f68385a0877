"""Drives beyond the effort or rate limit of their joint: reported with need and limit, in plane and space."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from granular_contact import simulate

ARM = 2700 * 3.141592653589793 / 4 * 0.02**2 * 0.3  # kg
NEEDED = ARM * 9.81 * 0.15  # N m, that holds the arm level


def lift(in_space: bool, limit: Any, drive: dict[str, Any], kind: str = "hinge") -> dict[str, Any]:
    """An arm that a hinge holds level, or a slider upright, in vacuum; fixed steps and a short time."""
    link = {"type": "link", "length_m": 0.3, "diameter_m": 0.02, "density_kg_m3": 2700}
    joint: dict[str, Any] = {"type": kind, "parent": "ground", "child": "arm"}
    joint |= {"axis": [0, 1, 0] if kind == "hinge" else [0, 0, 1]} if in_space else {}
    joint |= {"axis": [0, 1]} if kind == "slider" and not in_space else {}
    joint |= {"effort_limit_Nm" if kind == "hinge" else "effort_limit_N": limit}
    model = {"name": "lift", "bodies": {"arm": link}, "joints": {"lift": joint}, "in_space": in_space}
    return {"model": model, "medium": None, "drives": {"lift": drive}, "solver": {"end_time_s": 0.02}}


def limit_warnings(run: dict[str, Any]) -> list[str]:
    return [sentence for sentence in simulate(run).warnings if "effort limit" in sentence]


@pytest.mark.parametrize("in_space", [False, True])
@pytest.mark.parametrize("method", ["auto", "engine"])
def test_a_prescribed_motion_beyond_the_effort_limit_is_reported(in_space: bool, method: str) -> None:
    hold = {"type": "motion", "angle_deg": 0}
    (sentence,) = limit_warnings(lift(in_space, 0.3, hold) | {"method": method})
    assert f"the drive of lift needs a torque of up to {NEEDED:.4g} N m" in sentence
    assert "more than the effort limit of this joint, 0.3 N m" in sentence
    assert not limit_warnings(lift(in_space, 1.01 * NEEDED, hold) | {"method": method})
    assert not limit_warnings(lift(in_space, None, hold) | {"method": method})


@pytest.mark.parametrize("in_space", [False, True])
def test_forces_of_sliders_and_of_controllers_are_reported_too(in_space: bool) -> None:
    (sentence,) = limit_warnings(lift(in_space, 2, {"type": "motion", "position_m": 0}, "slider"))
    assert f"a force of up to {ARM * 9.81:.4g} N, more than the effort limit of this joint, 2 N" in sentence
    stiff = {"type": "pd", "angle_deg": 10, "gain_Nm_per_rad": 50}
    assert limit_warnings(lift(in_space, 0.3, stiff))
    assert not limit_warnings(lift(in_space, 0.3, stiff | {"limit_Nm": 0.3}))


@pytest.mark.parametrize("in_space", [False, True])
@pytest.mark.parametrize("kind", ["hinge", "slider"])
def test_a_drive_beyond_the_rate_limit_is_reported(in_space: bool, kind: str) -> None:
    """The greatest rate of a ramp, a polynomial of degree 5, is 15/8 of its mean: of 10 degrees or 0.1 m in 0.02 s."""
    key, unit, rate = ("angle_deg", "rad/s", 16.36) if kind == "hinge" else ("position_m", "m/s", 9.375)
    ramp = {"type": "ramp", "from": 0, "to": 10 if kind == "hinge" else 0.1, "duration_s": 0.02}
    run = lift(in_space, None, {"type": "motion", key: ramp}, kind)
    limit = "rate_limit_rad_s" if kind == "hinge" else "speed_limit_m_s"
    joint = run["model"]["joints"]["lift"]
    for share, warned in ((0.9, True), (1.01, False)):
        joint[limit] = share * rate
        warnings = [sentence for sentence in simulate(run).warnings if "limit of this joint" in sentence]
        assert len(warnings) == warned
        assert all(f"of up to {rate:.4g} {unit}, more than the" in sentence for sentence in warnings)


def test_the_effort_limit_of_a_robot_file_is_one(tmp_path: Path) -> None:
    inertial = '<mass value="1"/><inertia ixx="1e-3" iyy="1e-3" izz="1e-3" ixy="0" ixz="0" iyz="0"/>'
    (tmp_path / "lift.urdf").write_text(
        f"""<robot name="lift"><link name="world"/>
        <link name="arm"><inertial><origin xyz="0.2 0 0"/>{inertial}</inertial></link>
        <joint name="lift" type="revolute"><parent link="world"/><child link="arm"/><axis xyz="0 1 0"/>
        <limit lower="-1" upper="1" effort="1.5" velocity="3"/></joint></robot>"""
    )
    model: dict[str, Any] = {"urdf": str(tmp_path / "lift.urdf")}
    run: dict[str, Any] = {"medium": None, "drives": {"lift": {"type": "motion", "angle_deg": 0}}}
    run |= {"model": model, "solver": {"end_time_s": 0.02}}
    (sentence,) = limit_warnings(run)
    assert "up to 1.962 N m, more than the effort limit of this joint, 1.5 N m" in sentence
    assert not limit_warnings(run | {"model": model | {"joints": {"lift": {"effort_limit_Nm": 2}}}})
    turn = {"type": "motion", "angle_deg": {"type": "ramp", "from": 0, "to": 10, "duration_s": 0.02}}
    fast = simulate(run | {"drives": {"lift": turn}}).warnings
    assert any("a rate of up to 16.36 rad/s, more than the rate limit of this joint, 3 rad/s" in text for text in fast)
