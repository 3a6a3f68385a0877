"""The tutorials and how-to pages do what they show, each in a folder of its own; kernels are shared by all of them."""

from __future__ import annotations

import csv
import json
import re
from concurrent.futures import Executor, ThreadPoolExecutor
from pathlib import Path

import pytest
import yaml
from support_blocks import ROOT, Page, assert_told, blocks, forget, run
from support_figures import sketched

from granular_contact.studies.sweep import WorkerPool

pytestmark = pytest.mark.slow

DOCS = ROOT / "docs"
NEEDS = {"howto/gym.md": "gymnasium", "howto/optimise.md": "cma", "tutorials/robot.md": "trimesh"}
OWN = ("tutorials/fit.md", "tutorials/sweep.md")  # those with more to be asked of
PAGES = sorted(
    name
    for path in DOCS.rglob("*.md")
    if blocks(path) and (name := path.relative_to(DOCS).as_posix()) not in (*OWN, "architecture.md", "_site/pypi.md")
)


def at(name: str, folder: Path, monkeypatch: pytest.MonkeyPatch) -> Page:
    """A page that was run in a folder."""
    if name in NEEDS:
        pytest.importorskip(NEEDS[name])
    monkeypatch.chdir(folder)
    monkeypatch.setenv("MPLBACKEND", "agg")
    monkeypatch.setattr("granular_contact.results.frames.MOST", 4)  # pictures of a film
    # Processes of workers begin with seconds of imports: those of their own tests are enough.
    monkeypatch.setattr(WorkerPool, "executor", in_a_thread)
    monkeypatch.setattr("granular_contact.studies.processes.cores", lambda: 1)
    with sketched():
        return run(DOCS / name)


def in_a_thread(pool: WorkerPool) -> Executor:
    """The executor of a pool, one thread of this process."""
    pool._executor = pool._executor or ThreadPoolExecutor(1)
    return pool._executor


@pytest.mark.parametrize("name", PAGES)
def test_blocks_of_a_page_give_the_output_shown(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert at(name, tmp_path, monkeypatch).blocks > 0
    if name == "howto/law.md":
        forget("power")
        forget("winkler")


def test_the_fit_finds_the_sand_that_made_the_data(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    at("tutorials/fit.md", tmp_path, monkeypatch)
    results = tmp_path / "results"
    saved = json.loads((results / "fit" / "fit.json").read_text(encoding="utf-8"))
    assert saved["status"] == "fits"
    for key, true in (("medium.eta_d", 5.0), ("medium.plunging.eta_v", 30.0)):
        parameter = saved["parameters"][key]
        # Four standard errors: once in 16 000 draws of the noise, and the draw is fixed.
        assert abs(parameter["value"] - true) < 4 * parameter["standard_error"] < 0.05 * true
    assert json.loads((results / "in_fitted_sand" / "summary.json").read_text(encoding="utf-8"))["status"] == "rest"


def test_sensitivity_is_to_speed_and_not_to_drag(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    page = at("tutorials/sweep.md", tmp_path, monkeypatch)
    assert "Sobol indices of stopping_time_s" in page.printed
    named = re.findall(r"`(results/\S+)`", (DOCS / "tutorials/sweep.md").read_text(encoding="utf-8"))
    assert [name for name in named if not (tmp_path / name).exists()] == []
    assert len(named) > 2
    with (tmp_path / "results" / "sensitivity" / "sensitivity.csv").open(encoding="utf-8") as file:
        total = {row["input"]: float(row["total"]) for row in csv.DictReader(file)}
    # validation/sensitivity.py: drag has less than a hundredth of the variance, speed and eta_v nearly all.
    assert total["medium.eta_d"] < 0.02
    assert total["initial.impact_speed_rad_s"] > 0.3
    assert total["medium.plunging.eta_v"] > 0.3


def test_files_that_pages_show_are_the_shipped_ones() -> None:
    for page, name in (("howto/optimise.md", "optimise_speed_close"), ("tutorials/sweep.md", "sensitivity")):
        shipped = yaml.safe_load((ROOT / "configs" / f"{name}.yaml").read_text(encoding="utf-8"))
        shown = [yaml.safe_load(block["code"]) for block in blocks(DOCS / page) if block["kind"] == "yaml"]
        assert shipped in shown


def test_a_page_with_another_number_or_word_is_detected() -> None:
    printed = "a 1.234 m\nb 5 s, rest\n"
    assert_told("a 1.23 m\nb 5 s, rest\n", printed)
    for other in ("a 1.26 m\n", "b 6 s, rest\n", "b 5 s, end\n", "b 5 s, rest\na 1.23 m\n"):
        with pytest.raises(AssertionError):
            assert_told(other, printed)
