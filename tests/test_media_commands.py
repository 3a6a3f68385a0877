"""The commands media and compare-media, and the presets that they show."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest
from support_runs import CONFIGS

from granular_contact import preset
from granular_contact.cli import main
from granular_contact.config import load_medium, medium_names
from granular_contact.errors import SceneError
from granular_contact.laws.catalogue import LAWS, laws_for
from granular_contact.laws.probe import force, panels, upright_bar

NAMES = medium_names()


@pytest.mark.parametrize("name", NAMES)
def test_presets_say_where_their_numbers_come_from(name: str) -> None:
    spec = load_medium(name)
    assert spec.name == name
    assert spec.source
    assert spec.standing
    assert spec.provenance == ("fitted" if name == "cmu_dry_sand_plate" else "published")


def test_presets_that_lack_a_number_say_so_and_take_it() -> None:
    lacking = {name: lacking for name in NAMES if (lacking := load_medium(name).lacking)}
    assert lacking == {"hill_cylinders": ["density_kg_m3"]}
    with pytest.raises(SceneError, match="density_kg_m3: the source of hill_cylinders does not state it"):
        preset("hill_cylinders")
    assert preset("hill_cylinders", density_kg_m3=2500.0).density == 2500.0


def test_every_law_has_a_shape() -> None:
    assert all(law.takes for law in LAWS.values())
    assert set(laws_for("ball")) & set(laws_for("round")) == set()
    assert set(laws_for("outline")) == {"rft", "drft", "rft3d", "pressure_sinkage", "reece", "table"}


def test_a_probe_gives_the_resultant() -> None:
    # eta_h g rho z^2 d of play sand; round-off.
    got = force(preset("play_sand"), upright_bar(0.1, 0.01), np.array([1e-3, 0.0]))[1]
    np.testing.assert_allclose(got, [-8 * 9.81 * 2500 * 0.1**2 * 0.01, 0.0], rtol=1e-12)


def test_curves_of_a_law_start_at_nothing_and_grow_with_depth() -> None:
    for name in ("play_sand", "rft3d_sand"):
        by_depth, by_speed, by_angle = panels(preset(name))
        plunging = by_depth.curves[0].y
        assert (np.diff(plunging) > 0).all()
        assert plunging[0] < 0.01 * plunging[-1]
        assert len(by_speed.curves) == 3
        assert by_angle.curves[1].y[-1] > 0 > by_angle.curves[1].y[0]  # upward while it moves down, and the reverse


def test_media_lists_all_presets(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["media"]) == 0
    shown = capsys.readouterr().out
    assert all(name in shown for name in NAMES)


@pytest.mark.slow
def test_media_shows_one_with_its_figure(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["media", "rft3d_sand", "--out", str(tmp_path / "shown")]) == 0
    shown = capsys.readouterr().out
    for phrase in (
        "xi_n [alpha_n + min(mu_surf |alpha_n| / |alpha_t|, 1) alpha_t] z",
        "1617",
        "one source",
        "not stated",
        "surfaces (links, and all shapes but bar)",
    ):
        assert phrase in shown
    assert (tmp_path / "shown" / "law.png").stat().st_size > 20_000
    assert main(["media", "hill_cylinders", "--out", str(tmp_path / "none")]) == 0
    assert "not stated by the source" in capsys.readouterr().out
    assert not (tmp_path / "none").exists()
    assert main(["media", "quicksand"]) == 2
    assert capsys.readouterr().err.startswith("medium: got 'quicksand', but")


@pytest.mark.slow
def test_compare_media(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    config, out = str(CONFIGS / "pendulum_rigid.yaml"), tmp_path / "out"
    media = "play_sand,poppy_seeds_close,rft_generic"
    assert main(["compare-media", config, "--media", media, "--out", str(out)]) == 0
    shown = capsys.readouterr().out
    with (out / "compare-media.csv").open(encoding="utf-8") as file:
        rows = {row["medium"]: row for row in csv.DictReader(file)}
    assert list(rows) == ["play_sand", "poppy_seeds_close", "rft_generic"]
    # The source's rigid pendulum, as everywhere.
    assert float(rows["play_sand"]["stopping_time_s"]) == pytest.approx(0.0255, abs=5e-5)
    assert float(rows["poppy_seeds_close"]["max_depth_m"]) > 2 * float(rows["play_sand"]["max_depth_m"])
    assert all(name in shown for name in rows)
    assert {"joints.png", "forces.png", "energy.png"} <= {path.name for path in (out / "figures").iterdir()}


def test_compare_media_names_what_does_not_fit(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    config = str(CONFIGS / "pendulum_rigid.yaml")
    assert main(["compare-media", config, "--media", "play_sand,hill_cylinders", "--out", str(tmp_path / "out")]) == 2
    assert "medium.density_kg_m3" in capsys.readouterr().err
    assert main(["compare-media", config, "--media", "play_sand,mud", "--out", str(tmp_path / "out")]) == 2
    assert main(["compare-media", config, "--media", ",", "--out", str(tmp_path / "out")]) == 2
    assert not (tmp_path / "out").exists()


def test_compare_media_refuses_overrides_of_what_it_compares(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    config, out = str(CONFIGS / "pendulum_rigid.yaml"), tmp_path / "out"
    for text in ("medium.eta_h=80", "medium=play_sand"):
        assert main(["compare-media", config, "--media", "play_sand", "--set", text, "--out", str(out)]) == 2
        assert "{from: play_sand, eta_h: 80}" in capsys.readouterr().err
    assert not out.exists()
    with pytest.raises(SystemExit):
        main(["compare-media", "--help"])
    assert "medium.eta_h" not in capsys.readouterr().out
