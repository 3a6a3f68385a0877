"""Every script of examples/ runs, prints what its page shows, and draws its picture."""

from __future__ import annotations

import re
import runpy
import sys
from pathlib import Path

import pytest
from support_blocks import ROOT, assert_told, forget

pytestmark = pytest.mark.slow

EXAMPLES = ROOT / "examples"
PAGE = (EXAMPLES / "README.md").read_text(encoding="utf-8")
SCRIPTS = sorted(path.stem for path in EXAMPLES.glob("*.py") if path.stem not in ("common", "make_gallery"))
NEEDS = {"custom_environment": "gymnasium", "mujoco_model": "mujoco", "train_runner": "gymnasium"}
# What chooses the better of two runs may choose another one on another processor: only its words are compared.
CHOOSES = {"train_runner"}
LAWS = {"law_of_balls": "example_power", "law_of_bars": "example_viscous", "law_of_surfaces": "example_winkler"}


def shown(name: str) -> str:
    """What the page says that a script prints."""
    block = re.search(rf"```sh\npython examples/{name}\.py\n```\n\n```text\n(.*?)```", PAGE, re.S)
    assert block is not None, name
    return block[1]


@pytest.mark.parametrize("name", SCRIPTS)
def test_a_script_prints_and_draws_what_its_page_shows(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    if name in NEEDS:
        pytest.importorskip(NEEDS[name])
    monkeypatch.syspath_prepend(str(EXAMPLES))
    monkeypatch.delitem(sys.modules, "common", raising=False)
    monkeypatch.setattr(sys, "argv", [f"{name}.py", "--out", str(tmp_path)])
    try:
        runpy.run_path(str(EXAMPLES / f"{name}.py"), run_name="__main__")
    finally:
        sys.modules.pop("common", None)
        if name in LAWS:
            forget(LAWS[name])
    printed = capsys.readouterr().out
    if name in CHOOSES:
        number = r"\d+(\.\d+)?"
        assert re.sub(number, "#", printed).strip() == re.sub(number, "#", shown(name)).strip()
    else:
        assert_told(shown(name), printed)
    assert (tmp_path / f"{name}.png").stat().st_size > 5000
    assert (EXAMPLES / "pictures" / f"{name}.png").exists()
