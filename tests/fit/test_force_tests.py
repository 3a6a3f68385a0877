"""Coefficients fitted to forces over depth or speed by the law alone, zeros of the sensors, faults of such tables."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import yaml
from support_force import DRAGGED, PLATE, WIDTH, estimates_of, fitted, forces, problem, table
from support_refusals import faults_of
from support_runs import CONFIGS, simulate

from granular_contact import cli
from granular_contact.config import load_scenario
from granular_contact.errors import ConfigError
from granular_contact.laws.rft import GENERIC
from granular_contact.sand.steady import SteadyBody
from granular_contact.scene import build
from granular_contact.studies.fit import fit
from granular_contact.studies.fit.measurements import FORCE_TEST_COLUMNS, plain, recognise

RFT = "medium={law: rft, zeta: 0.9}"
DEPTH = np.linspace(0.5e-3, 0.04, 40)
START = "set: {medium: {law: rft, zeta: 0.3}}\n"


# ---- headers ----


@pytest.mark.parametrize(
    ("header", "name"),
    [
        ("Depth (mm)", "depth_mm"),
        (" Vertical force [kN] ", "vertical_force_kN"),
        ("Speed (m/s)", "speed_m_s"),
        ("Torque (N m)", "torque_Nm"),
        ("depth_mm", "depth_mm"),
        ("(mm)", "(mm)"),
    ],
)
def test_units_may_stand_in_brackets(header: str, name: str) -> None:
    assert plain(header) == name
    assert recognise(header, FORCE_TEST_COLUMNS) == recognise(name, FORCE_TEST_COLUMNS)


def test_unknown_columns_of_a_force_test_are_refused_with_known_names(tmp_path: Path) -> None:
    (tmp_path / "test.csv").write_text("Depth (mm),Load (N)\n1,2\n", encoding="utf-8")
    with pytest.raises(ConfigError, match=r"Load \(N\): unknown column; .*but force_N, torque_Nm or pressure_Pa"):
        problem(tmp_path, f"{START}parameters: [medium.zeta]\nruns:\n  - config: {PLATE}\n    data: test.csv\n")


# ---- the law alone ----


def test_a_plate_pressed_in_has_the_force_of_the_theory() -> None:
    # alpha_z(0, 90 deg) of the generic set is that of its own sum, times zeta, depth and area.
    alpha = 1e6 * (GENERIC.A00 + GENERIC.A10 + GENERIC.B11 + GENERIC.B01 + GENERIC.B_11)
    got = forces(PLATE, [RFT], DEPTH)
    np.testing.assert_allclose(got["force_N"], 0.9 * alpha * DEPTH * 0.0532**2, rtol=1e-12)
    np.testing.assert_allclose(got["vertical_force_N"], got["force_N"], rtol=1e-12)
    assert np.abs(got["horizontal_force_N"]).max() < 1e-12


def test_forces_of_the_law_equal_those_of_a_run_after_mobilisation() -> None:
    results = simulate("dragged_plate", "solver.end_time_s=0.05")
    alone = forces(DRAGGED, [], np.array([0.08]), 0.1, 0.0)
    # Bristles yield after 10 um, 0.1 ms of the run; what is left of their damping is a share of exp(-t / 1 ms).
    assert -results["plate_granular_x_N"][-1] == pytest.approx(alone["force_N"][0], rel=1e-6)
    assert results["plate_granular_y_N"][-1] == pytest.approx(alone["vertical_force_N"][0], rel=1e-6)


def test_depth_is_that_of_the_lowest_point_of_any_shape() -> None:
    wheel = SteadyBody(build(load_scenario(CONFIGS / "penetrometer.yaml", [RFT, WHEEL])))
    assert wheel.lowest == pytest.approx(-0.06, abs=1e-12)
    tilted = WHEEL.replace("child: plate", "child: plate, home_deg: 3.1")
    turned = SteadyBody(build(load_scenario(CONFIGS / "penetrometer.yaml", [RFT, tilted])))
    assert turned.lowest == pytest.approx(-0.06, abs=1e-12)  # between two corners of its outline


WHEEL = (
    "model={name: wheel, bodies: {plate: {type: rigid, density_kg_m3: 1000, shapes: [{type: disc, diameter_m: 0.12, "
    "thickness_m: 0.05}]}}, joints: {rail: {type: slider, parent: ground, child: plate, axis: [0, -1]}}}"
)


def test_torque_resists_the_turning_and_a_wheel_that_spins_pulls() -> None:
    body = SteadyBody(build(load_scenario(PLATE, [RFT, WHEEL])))
    depth, still = np.array([0.02, 0.02]), np.zeros((2, 2))
    force = body.force(depth, still, np.array([-1.0, 1.0]))
    # Clockwise (negative, counter-clockwise) the rim goes back at the bottom, so that the sand pushes the wheel on.
    assert force[0, 0] > 0.0 > force[1, 0]
    assert force[0, 2] > 0.0 > force[1, 2]
    np.testing.assert_allclose(np.abs(force[0]), np.abs(force[1]), rtol=0.02)  # 48 chords, one direction of each


def test_steady_force_is_the_mean_of_scatter_with_all_shear_mobilised() -> None:
    sand = "law: pressure_sinkage, k_phi_Pa: 2e+4, exponent: 1, friction_angle_deg: 29"
    plain = forces(PLATE, [f"medium={{{sand}}}"], DEPTH, 0.01, 30.0)
    other = f"{sand}, shear_deformation_modulus_m: 0.02, scatter: {{relative: 0.3, length_m: 0.003}}"
    for name, values in forces(PLATE, [f"medium={{{other}}}"], DEPTH, 0.01, 30.0).items():
        np.testing.assert_array_equal(values, plain[name])
    assert plain["horizontal_force_N"][-1] < -0.5  # the shear


# ---- what a fit finds ----


@pytest.mark.slow
def test_three_plates_and_one_command(tmp_path: Path) -> None:
    files = [
        table(tmp_path / f"{i}.csv", "z,F", 1e3 * DEPTH, forces(PLATE, [RFT], DEPTH)["force_N"], noise=0.3, seed=i)
        for i in range(3)
    ]
    arguments = ["fit", str(PLATE), *map(str, files), "--parameters", "medium.zeta", "--set", "medium=rft_generic"]
    arguments += ["--columns", "depth_mm=z,force_N=F", "--force-test", "speed_m_s=0.02", "--starts", "2"]
    out = tmp_path / "out"
    assert cli.main([*arguments, "--workers", "1", "--out", str(out), "--quiet"]) == 0
    record = json.loads((out / "fit.json").read_text(encoding="utf-8"))
    low, high = record["parameters"]["medium.zeta"]["interval_95"]
    assert low < 0.9 < high
    assert high - low < 0.01
    assert record["status"] == "fits"
    medium = yaml.safe_load((out / "medium.yaml").read_text(encoding="utf-8"))
    assert "3 force tests" in medium["source"]
    assert medium["range"] == {"speed_m_s": [0.02, 0.02], "depth_m": [0.0, 0.04], "size_m": [0.0532, 0.0532]}
    assert (out / "figures" / "run_01.png").stat().st_size > 10_000
    head, first = (out / "residuals.csv").read_text(encoding="utf-8").splitlines()[:2]
    assert head == "run,column,time_s,data,model,residual_over_noise,speed_m_s,rate_rad_s,depth_m"
    assert first.startswith("0,force_N,,")


def test_drag_at_several_speeds_separates_inertia_from_friction(tmp_path: Path) -> None:
    medium = "{law: drft, density_kg_m3: 900, lambda: 1.1, zeta: 0.8}"
    depth, speed = np.full(24, 0.06), np.repeat([0.05, 0.2, 0.4, 0.6], 6)
    drag = forces(DRAGGED, [f"medium={medium}"], depth, speed, 0.0)["force_N"]
    table(tmp_path / "drag.csv", "speed_cm_s,force_mN", 100 * speed, 1e3 * drag, noise=30.0)
    text = "parameters: [medium.zeta, medium.lambda]\nset: {medium: {law: drft, density_kg_m3: 900, lambda: 2}}\n"
    text += "force_test: {direction: right, depth_m: 0.06}\n"
    values = estimates_of(fitted(tmp_path, f"{text}runs: [{{config: {DRAGGED}, data: drag.csv}}]"))
    for key, true in (("medium.zeta", 0.8), ("medium.lambda", 1.1)):
        value, error = values[key]
        assert abs(value - true) < 4.0 * error
        assert error < 0.05 * true


def test_density_and_friction_from_pressures_of_one_table_with_two_plates(tmp_path: Path) -> None:
    sand = "medium={law: rft3d, density_kg_m3: 1500, mu_int: 0.5, mu_surf: 0.3}"
    force = forces(PLATE, [sand], DEPTH)["force_N"]
    columns = [np.repeat([60.0, 80.0], 40), np.tile(1e3 * DEPTH, 2), np.tile(1e-3 * force / 0.0532**2, 2)]
    table(tmp_path / "both.csv", "diameter_mm,depth_mm,pressure_kPa", *columns, noise=0.01)
    text = "parameters: [medium.mu_int]\nset: {medium: {law: rft3d, density_kg_m3: 1500, mu_int: 1, mu_surf: 0.3}}\n"
    text += "force_test: {area_m2: 0.00283024}\nruns:\n"
    for size in (60, 80):
        text += f"  - {{config: {PLATE}, data: both.csv, name: plate_{size}, rows: {{diameter_mm: {size}}}}}\n"
    problem_of_both = problem(tmp_path, text)
    assert [len(run.measured.time) for run in problem_of_both.runs] == [40, 40]
    value, error = estimates_of(fit(problem_of_both))["medium.mu_int"]
    assert abs(value - 0.5) < 4.0 * error < 0.01


def test_geometry_and_two_media_can_be_fitted_too(tmp_path: Path) -> None:
    table(tmp_path / "a.csv", "depth_m,force_N", DEPTH, forces(PLATE, [RFT], DEPTH)["force_N"], noise=0.05)
    text = f"parameters: {{{WIDTH}: {{from: 0.03, to: 0.1, start: 0.07}}}}\nset: {{medium: {{law: rft, zeta: 0.9}}}}\n"
    value, error = estimates_of(fitted(tmp_path, f"{text}runs: [{{config: {PLATE}, data: a.csv}}]"))[WIDTH]
    assert abs(value - 0.0532) < 4.0 * error
    text = "parameters: {medium.1.zeta: {from: 0.1, to: 2}}\n"
    text += "set: {medium: [{law: rft, zeta: 0.2}, {law: rft, zeta: 0.5}]}\n"
    value, error = estimates_of(fitted(tmp_path, f"{text}runs: [{{config: {PLATE}, data: a.csv}}]"))["medium.1.zeta"]
    assert abs(value - 0.7) < 4.0 * error


def test_zeros_of_depth_and_force_are_resolved_or_merged(tmp_path: Path) -> None:
    force = forces(PLATE, [RFT], DEPTH)["force_N"]
    shift, zero = 1.5e-3, 4.0
    table(tmp_path / "a.csv", "depth_mm,force_N", 1e3 * (DEPTH + shift), force, noise=0.1)
    table(tmp_path / "b.csv", "depth_mm,force_N", 1e3 * DEPTH, force + zero, noise=0.1)
    run = "runs: [{{config: {}, data: {}.csv, force_test: {{{}}}}}]"
    for name, key, true in (("a", "depth_offset_m", shift), ("b", "force_offset_N", zero)):
        values = estimates_of(
            fitted(tmp_path, f"parameters: [medium.zeta]\n{START}" + run.format(PLATE, name, f"{key}: fit"))
        )
        assert abs(values["medium.zeta"][0] - 0.9) < 4.0 * values["medium.zeta"][1]
        value, error = values[f"{key} @ {name}"]
        assert abs(value - true) < 4.0 * error < 0.2 * true
    both = "depth_offset_m: fit, force_offset_N: fit"
    result = fitted(tmp_path, f"parameters: [medium.zeta]\n{START}" + run.format(PLATE, "a", both))
    assert any(
        "depth_offset_m @ a and force_offset_N @ a can't be distinguished" in warning for warning in result.warnings
    )


def test_forces_of_a_run_over_time_are_fitted_where_the_columns_say_so(tmp_path: Path) -> None:
    short = ("solver.end_time_s=0.02", "solver.step_s=1e-3", "medium.zeta=1.3")
    results = simulate("dragged_plate", *short)
    table(tmp_path / "a.csv", "t,F", results["time_s"], results["rail_force_N"], noise=0.01)
    text = "parameters: [medium.zeta]\nset: {solver.end_time_s: 0.02, solver.step_s: 1e-3}\n"
    text += f"runs: [{{config: {DRAGGED}, data: a.csv, "
    value, error = estimates_of(fitted(tmp_path, text + "columns: {time_s: t, rail_force_N: F}}]"))["medium.zeta"]
    assert abs(value - 1.3) < 4.0 * error < 0.05


# ---- what tables may have wrong ----


def rows(depth: object, force: object, head: str = "depth_mm,force_N") -> list[str]:
    return [head, *(f"{z:.6g},{f:.6g}" for z, f in zip(np.asarray(depth), np.asarray(force), strict=True))]


Z = np.arange(1.0, 41.0)  # mm
F = 2.5 * Z  # N
BACK = np.concatenate([Z, Z[-2:20:-1]])
NOISE = np.random.default_rng(3).standard_normal(40)
FAULTY: dict[str, tuple[Callable[[], list[str]], int, str, str]] = {
    "above the surface": (lambda: rows(Z - 3.0, F), 2, "depth_m", "got -2 mm, which is above the surface"),
    "unloading": (lambda: rows(BACK, 2.5 * BACK), 42, "depth_m", "to line 59 the depth goes back from 40 to 22 mm"),
    "noise alone": (lambda: rows(Z, 1e-3 * NOISE), 2, "force_N", "contains only noise"),
    "sign": (lambda: rows(Z, -F), 41, "force_N", "got -100, but the law gives +34"),
    "depth in mm that says m": (lambda: rows(Z, F, "depth_m,force_N"), 41, "depth_m", "got 40 m, but the body is"),
    "no depth": (lambda: rows(Z, F, "path_length_mm,force_N"), 1, "", "has no column of depths"),
    "misspelt": (lambda: rows(Z, F, "depth_mm,forces_N"), 1, "", "has no column of times"),
    "two units of one": (lambda: [f"{line},1" for line in rows(Z, F, "depth_mm,force_N,force_kN")][:0]
                         or ["depth_mm,force_N,force_kN", *(f"{z},{2 * z},{z}" for z in Z)], 1, "force_N",
                         "is measured by two columns"),
    "pressure without an area": (lambda: rows(Z, F, "depth_mm,pressure_kPa"), 1, "pressure_Pa", "needs an area"),
    "hole": (lambda: [*rows(Z, F)[:5], "5,", *rows(Z, F)[6:]], 6, "force_N", "is empty"),
    "few": (lambda: rows(Z[:3], F[:3]), 1, "", "got 3 rows; allowed are 4 or more"),
}  # fmt: skip


@pytest.mark.parametrize("name", FAULTY)
def test_faulty_tables(tmp_path: Path, name: str) -> None:
    lines, line, key, message = FAULTY[name]
    (tmp_path / "data.csv").write_text("\n".join(lines()) + "\n", encoding="utf-8")
    text = f"parameters: [medium.zeta]\n{START}runs: [{{config: {PLATE}, data: data.csv}}]"
    first = faults_of(ConfigError, problem, tmp_path, text)[0]
    assert (Path(first.file).name, first.line, first.key) == ("data.csv", line, key)
    assert message in first.message


def test_rows_of_unloading_can_be_left_out_and_that_is_reported(tmp_path: Path) -> None:
    law = forces(PLATE, [RFT], 1e-3 * Z)["force_N"]
    forth_and_back = np.concatenate([law, 0.1 * law[-2:20:-1]])
    jitter = BACK + 0.01 * np.random.default_rng(0).standard_normal(len(BACK))  # a tenth of a per cent is no way back
    table(tmp_path / "data.csv", "depth_mm,force_N", jitter, forth_and_back, noise=0.2)
    text = f"parameters: [medium.zeta]\n{START}force_test: {{unloading: leave_out}}\n"
    result = fitted(tmp_path, f"{text}runs: [{{config: {PLATE}, data: data.csv}}]")
    assert abs(estimates_of(result)["medium.zeta"][0] - 0.9) < 4.0 * estimates_of(result)["medium.zeta"][1]
    assert any(
        "lines 42 to 59 are left out, because the body moves back in them" in warning for warning in result.warnings
    )


def test_tests_in_units_that_do_not_belong_together_are_reported(tmp_path: Path) -> None:
    for name, factor in (("a", 1.0), ("b", 1.1), ("c", 1e-3)):
        table(tmp_path / f"{name}.csv", "depth_mm,force_N", Z, factor * F, noise=1e-2 * factor)
    runs = ", ".join(f"{{config: {PLATE}, data: {name}.csv}}" for name in "abc")
    (fault,) = faults_of(ConfigError, problem, tmp_path, f"parameters: [medium.zeta]\n{START}runs: [{runs}]")
    assert Path(fault.file).name == "c.csv"
    assert "differ by a factor 1.1e+03" in fault.message


@pytest.mark.parametrize(
    ("more", "key", "message"),
    [
        ("force_test: {direction: sideways}", "force_test.direction", "down, up, right, left, or an angle"),
        ("force_test: {body: plough}", "", "there is no rigid body 'plough' that meets the medium; there are plate"),
        ("time_offset_s: fit", "time_offset_s", "a force test has no clock"),
        ("rows: {size_mm: 60}", "rows.size_mm", "has no such column"),
        ("rows: {depth_mm: 60}", "rows.depth_mm", "no row of"),
        ("columns: {depth_mm: z, force_N: F}", "columns.depth_mm", "got 'z', but"),
        ("set: {bed: {slope_deg: 5}}", "", "a steady motion needs a medium with a level surface"),
    ],
)
def test_faulty_requests(tmp_path: Path, more: str, key: str, message: str) -> None:
    (tmp_path / "data.csv").write_text("\n".join(rows(Z, F)) + "\n", encoding="utf-8")
    with pytest.raises(ConfigError) as caught:
        problem(
            tmp_path, f"parameters: [medium.zeta]\n{START}runs:\n  - config: {PLATE}\n    data: data.csv\n    {more}"
        )
    assert any(message in fault.message and fault.key.endswith(key) for fault in caught.value.faults)
    assert all(fault.file for fault in caught.value.faults)
