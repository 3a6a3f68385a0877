"""A law given as a table in a CSV file: read, interpolated, and refused with file and line."""

from __future__ import annotations

from itertools import product
from pathlib import Path

import numpy as np
import pytest
from support_refusals import faults_of
from support_runs import scenario_of

from granular_contact.config import load, scenario_to_dict
from granular_contact.errors import ConfigError
from granular_contact.laws.probe import force, plate
from granular_contact.laws.rft import GENERIC, Rft
from granular_contact.laws.table import StressTable

DEPTH, ANGLES = (0.02, 0.1), np.arange(-90.0, 91.0, 10.0)


def rows() -> list[tuple[float, float, float, float, float]]:
    """The generic set of resistive force theory, on a grid."""
    table = []
    for z, b, g in product(DEPTH, ANGLES, ANGLES):
        beta, gamma = np.radians([b, g])
        c = GENERIC
        x = c.C11 * np.cos(2 * beta + gamma) + c.C01 * np.cos(gamma) + c.C_11 * np.cos(-2 * beta + gamma)
        x += c.D10 * np.sin(2 * beta)
        up = c.A00 + c.A10 * np.cos(2 * beta) + c.B11 * np.sin(2 * beta + gamma) + c.B01 * np.sin(gamma)
        up += c.B_11 * np.sin(-2 * beta + gamma)
        table.append((z, b, g, 1e6 * z * x, 1e6 * z * up))
    return table


def written(folder: Path, lines: list[str], name: str = "sand.csv") -> Path:
    (folder / name).write_text("depth_m,beta_deg,gamma_deg,stress_x_Pa,stress_z_Pa\n" + "\n".join(lines), "utf-8")
    config = folder / "case.yaml"
    text = "model: dragged_plate\nmedium: {law: table, file: " + name + "}\nsurface_height_m: -0.025\n"
    config.write_text(text + "drives: {rail: {type: motion, position_m: 0}}\ninitial: {joints: {}}\n", "utf-8")
    return config


def text(row: tuple[float, ...]) -> str:
    return ",".join(map(repr, map(float, row)))


def test_a_table_of_a_law_is_that_law_between_its_rows_too(tmp_path: Path) -> None:
    given = rows()
    order = np.random.default_rng(1).permutation(len(given))
    scenario = load(written(tmp_path, [text(given[i]) for i in order])).scenario
    medium = scenario.media[0]
    assert isinstance(medium, StressTable)
    reloaded = type(medium).model_validate(scenario_to_dict(scenario)["medium"])  # needs no file any more
    for depth, beta, gamma in ((0.02, 20.0, 40.0), (0.1, -60.0, -10.0), (0.05, 33.0, 71.0), (0.2, -15.0, 200.0)):
        g = np.radians(gamma)
        body, v = plate(depth, beta, 0.01), 0.1 * np.array([np.cos(g), -np.sin(g)])
        want = force(Rft(GENERIC), body, v)
        # Linear between angles 10 degrees apart, of waves of 2 beta: (20 deg in rad)^2 / 8 = 1.5 %.
        np.testing.assert_allclose(force(medium, body, v), want, atol=0.02 * np.abs(want).max())
        np.testing.assert_array_equal(force(reloaded, body, v), force(medium, body, v))


def faults_in(config: Path) -> list[str]:
    return [str(fault) for fault in faults_of(ConfigError, load, config)]


def test_faults_are_reported_with_file_and_line(tmp_path: Path) -> None:
    lines = [text(row) for row in rows()]
    push = list(rows()[5])
    push[3:] = [-2000.0 * np.cos(np.radians(push[2])), -2000.0 * np.sin(np.radians(push[2]))]
    changed = [*lines[:5], text(tuple(push)), *lines[6:40], "0.02,-60,x,1,2", *lines[41:], lines[0]]
    reported = faults_in(written(tmp_path, changed))
    file = str(tmp_path / "sand.csv")
    assert any(
        fault.startswith(f"{file}:7: pushes an element at beta -90 deg that moves at gamma -40 deg")
        for fault in reported
    )
    assert any(fault.startswith(f"{file}:42: gamma_deg: got no finite number") for fault in reported)
    assert any(
        fault.startswith(f"{file}:{len(changed) + 1}: has the depth and angles of line 2 once more")
        for fault in reported
    )
    hole = faults_in(written(tmp_path, [*lines[:9], *lines[10:]]))
    assert hole == [
        f"{file}:1: has no row for depth 0.02 m, beta -90 deg, gamma 0 deg, though others have each of these"
    ]
    narrow = faults_in(written(tmp_path, [line for line in lines if ",90.0," not in line]))
    assert any("beta_deg: goes from -90 to 80; allowed is from -90 to 90" in fault for fault in narrow)
    assert any("gamma_deg: goes from -90 to 80" in fault for fault in narrow)
    (tmp_path / "sand.csv").unlink()
    config = tmp_path / "case.yaml"
    assert any(f"{config}:2: medium.file: got 'sand.csv', but" in fault for fault in faults_in(config))


def test_stress_tables_that_give_energy_are_refused_in_a_config() -> None:
    table = "medium={law: table, depth_m: [0.1], beta_deg: [-90, 90], gamma_deg: [-90, 90], "
    with pytest.raises(ConfigError, match="pushes an element at beta -90 deg that moves at gamma -90 deg"):
        scenario_of("dragged_plate", table + "stress_x_Pa: [0, 0, 0, 0], stress_z_Pa: [100, 900, 100, 900]}")
    with pytest.raises(ConfigError, match="got 3 stresses for 4 rows"):
        scenario_of("dragged_plate", table + "stress_x_Pa: [0, 0, 0], stress_z_Pa: [-100, 900, -100, 900]}")
