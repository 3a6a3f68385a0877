"""The written medium is that of a run with the fitted coefficients; differences between media are reported."""

from __future__ import annotations

from pathlib import Path

import pytest
from support_fit import CONFIG, RIGID, fitted, measure, problem

from granular_contact.studies.fit.fitting import media_warnings, reference_run
from granular_contact.studies.fit.writing import media, summary

ALBERT = "medium: {law: albert, density_kg_m3: 2500, eta_h: 8}"


def two(folder: Path, first: str, second: str = "", keys: str = "medium.plunging.eta_v") -> str:
    """A fit of two runs with settings of their own, which the data of both do not have."""
    lines = [f"parameters: [{keys}]", "runs:"]
    for i, more in enumerate((first, second)):
        measure(folder / f"{i}.csv", RIGID, seed=i)
        lines.append(f"  - {{config: {CONFIG}, data: {i}.csv, name: run_{i}, set: {{{more}}}}}")
    return "\n".join(lines)


def test_written_medium_is_that_of_a_run_with_the_coefficient(tmp_path: Path) -> None:
    result = fitted(tmp_path, two(tmp_path, ALBERT))
    (medium,) = media(result).values()
    assert medium["law"] == "lee_marghitu"
    assert medium["plunging"]["eta_v"] == result.values[0]
    assert "to 1 run (" in medium["source"]
    assert any("differ in law, " in warning and warning.endswith("that of run_1") for warning in result.warnings)
    assert summary(result)["parameters"]["medium.plunging.eta_v"]["runs"] == ["run_1"]


def test_numbers_missing_in_the_run_of_the_medium_are_reported(tmp_path: Path) -> None:
    other = "medium: {law: rft}"
    made = problem(tmp_path, two(tmp_path, "", other, "medium.plunging.eta_v, medium.zeta"))
    warnings = list(media_warnings(made, made.values(made.start)))
    assert warnings[0].endswith("the written medium is that of run_0, without medium.zeta")
    assert reference_run(made) == 0


@pytest.mark.parametrize("more", ["medium.eta_h: 9", "medium: null"])
def test_unfitted_keys_that_differ_are_reported(tmp_path: Path, more: str) -> None:
    result = fitted(tmp_path, two(tmp_path, "", more))
    key = "law" if more == "medium: null" else "eta_h"
    assert any(f"differ in {key}" in warning and warning.endswith("that of run_0") for warning in result.warnings)


def test_equal_media_of_several_runs_give_no_warning(tmp_path: Path) -> None:
    result = fitted(
        tmp_path,
        two(tmp_path, "medium.plunging.eta_v: 20", "medium.name: mine", "medium.plunging.eta_v").replace(
            "[medium.plunging.eta_v]", "{medium.plunging.eta_v: {start: 20}}"
        ),
    )
    assert result.warnings == ()
