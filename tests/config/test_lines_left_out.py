"""Each line of each shipped file left out in turn: what remains is fine, or refused with a line that the file has.

What random damage does is tested in tests/fuzz.
"""

from pathlib import Path

import pytest
from support_config import GOOD
from support_runs import ROOT

from granular_contact.config import load
from granular_contact.errors import ConfigError, Fault

SHIPPED = [
    *ROOT.glob("configs/*.yaml"),
    *ROOT.glob("models/*.yaml"),
    ROOT / "granular_contact/laws/presets/play_sand.yaml",
]
TEXTS = [GOOD, *(path.read_text() for path in sorted(SHIPPED))]


def faults_in(path: Path) -> list[Fault]:
    """Faults of a config; none if it loads."""
    try:
        load(path)
    except ConfigError as error:
        return error.faults or pytest.fail("refused without a fault")
    return []


@pytest.mark.parametrize("text", TEXTS)
def test_every_line_left_out(tmp_path, text):
    lines = text.splitlines(keepends=True)
    path = tmp_path / "run.yaml"
    for i in range(len(lines)):
        path.write_text("".join(lines[:i] + lines[i + 1 :]))
        assert all(f.line is None or 1 <= f.line <= len(lines) for f in faults_in(path) if f.file == str(path))
