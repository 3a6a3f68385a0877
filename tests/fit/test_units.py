"""Columns whose unit or sign differs from that of their name are detected by the size of the forces and depths."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from support_fit import CONFIG, RIGID, measure
from support_force import DRAGGED, PLATE, fitted, forces, problem, table
from support_refusals import faults_of, message_of

from granular_contact.errors import ConfigError
from granular_contact.studies.fit import load_specification, prepare
from granular_contact.studies.fit.fitting import published

DEPTH = np.linspace(0.5e-3, 0.04, 40)
ZETA = 0.8
ASKED = "is a column of the data in another unit than its name says?"


@pytest.fixture(scope="module")
def force() -> np.ndarray:
    return forces(PLATE, [f"medium={{law: rft, zeta: {ZETA}}}"], DEPTH)["force_N"]


def warnings(folder: Path, head: str, factors: tuple[float, float], force: np.ndarray, more: str) -> list[str]:
    """Warnings about units of a fit to depths (m) and forces (N), times these factors."""
    columns = factors[0] * DEPTH, factors[1] * force
    table(folder / "test.csv", head, *columns, noise=0.02 * columns[1].max())
    result = fitted(folder, f"{more}\nruns: [{{config: {PLATE}, data: test.csv}}]")
    return [sentence for sentence in result.warnings if sentence.endswith(ASKED)]


FREE = "set: {medium: {law: rft, zeta: 1}}\nparameters: {medium.zeta: {from: 1.e-5, to: 1.e+5}}"
BOUND = "set: {medium: {law: rft, zeta: 1}}\nparameters: [medium.zeta]"


@pytest.mark.parametrize(
    ("head", "factors", "size"),
    [
        ("depth_mm,force_N", (1e2, 1.0), 10.0),  # cm
        ("depth_mm,force_N", (1e3, 1e3), 1e3),  # mN
        ("depth_mm,force_mN", (1e3, 1.0), 1e-3),  # N
        ("depth_mm,force_kN", (1e3, 1.0), 1e3),  # N
    ],
)
def test_a_coefficient_that_no_sand_has_is_reported(
    tmp_path: Path, force: np.ndarray, head: str, factors: tuple[float, float], size: float
) -> None:
    low, high = min(published()["zeta"]), max(published()["zeta"])
    (sentence,) = warnings(tmp_path, head, factors, force, FREE)
    beyond = (
        f"{size * ZETA / high:.2g} times the greatest" if size > 1.0 else f"1/{low / (size * ZETA):.2g} of the least"
    )
    assert sentence.startswith("medium.zeta, ")
    assert beyond in sentence


@pytest.mark.parametrize(("head", "size"), [("depth_mm,force_N", 1e3), ("depth_mm,force_mN", 1.0)])
def test_forces_out_of_reach_of_the_law_are_reported(tmp_path: Path, force: np.ndarray, head: str, size: float) -> None:
    sentences = warnings(tmp_path, head, (1e3, size), force, BOUND)
    assert any("force_N is " in sentence and "times what the fitted law gives" in sentence for sentence in sentences)


def test_right_units_give_no_warning(tmp_path: Path, force: np.ndarray) -> None:
    for factor in (0.2, 1.0, 4.0):  # zeta of 0.16 to 3.2, within those published
        assert warnings(tmp_path, "depth_mm,force_N", (1e3, factor), force, FREE) == []


# ---- signs ----


def refused(folder: Path, depth: np.ndarray, force: np.ndarray, more: str = "", config: Path = PLATE) -> str:
    table(folder / "test.csv", "depth_mm,force_N", 1e3 * depth, force)
    return message_of(ConfigError, problem, folder, f"{BOUND}\n{more}\nruns: [{{config: {config}, data: test.csv}}]")


TURN = "depths are positive below the surface: change the sign of the column"


@pytest.mark.parametrize(
    "more",
    ["", "force_test: {depth_offset_m: fit}", "force_test: {unloading: leave_out}", "force_test: {direction: 60}"],
)
def test_heights_given_as_depths_are_reported(tmp_path: Path, force: np.ndarray, more: str) -> None:
    assert TURN in refused(tmp_path, -DEPTH, force, more)


def test_depths_of_drag_and_withdrawal_with_wrong_sign_are_refused(tmp_path: Path, force: np.ndarray) -> None:
    level = np.full(len(DEPTH), -0.03)
    assert TURN in refused(tmp_path, level, force, "force_test: {direction: right}", DRAGGED)
    assert TURN in refused(tmp_path, -DEPTH[::-1], force, "force_test: {direction: up}")


def test_depths_above_the_surface_get_no_hint_to_turn_the_sign(tmp_path: Path, force: np.ndarray) -> None:
    message = refused(tmp_path, DEPTH - 0.03, force)
    assert "above the surface" in message
    assert TURN not in message


# ---- nothing in the place of a medium ----


def test_a_null_medium_is_reported_at_its_key(tmp_path: Path, force: np.ndarray) -> None:
    table(tmp_path / "test.csv", "depth_mm,force_N", 1e3 * DEPTH, force)
    text = f"parameters: [medium.zeta]\nset: {{medium: null}}\nruns: [{{config: {PLATE}, data: test.csv}}]"
    (fault,) = faults_of(ConfigError, problem, tmp_path, text)
    assert (Path(fault.file).name, fault.line, fault.key) == ("fit.yaml", 3, "medium")
    assert fault.message == "this config can't be used for a force test: a steady motion needs a medium; got none"


def test_a_parameter_below_a_null_medium_is_refused(tmp_path: Path) -> None:
    measure(tmp_path / "data.csv", RIGID)
    (tmp_path / "fit.yaml").write_text(
        f"parameters: [medium.eta_d]\nset: {{medium: null}}\nruns: [{{config: {CONFIG}, data: data.csv}}]", "utf-8"
    )
    with pytest.raises(ConfigError, match=r"fit.yaml:1: medium.eta_d: is below medium, which is null"):
        prepare(load_specification(tmp_path / "fit.yaml"))
