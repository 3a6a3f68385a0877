"""Whatever happens to the text of a config: it loads, or it is refused with faults, and nothing else happens."""

from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from support_config import GOOD

from granular_contact.config import load
from granular_contact.errors import ConfigError, Fault

ROOT = Path(__file__).parents[2]
SHIPPED = [
    *ROOT.glob("configs/*.yaml"),
    *ROOT.glob("models/*.yaml"),
    ROOT / "granular_contact/media/presets/play_sand.yaml",
]
# A whole config in one text is drawn as often as all shipped ones, so that mutations reach every part of the schema.
TEXTS = [path.read_text() for path in sorted(SHIPPED)]
DRAWN = TEXTS + [GOOD] * len(TEXTS)
PIECES = [
    *"{}[]:,&*!|>'\"%@#-?~\n\t ",
    "<<",
    "null",
    "true",
    "1e400",
    ".nan",
    "-1",
    "from: ",
    "{}",
    "[[",
    "*a",
    "&a ",
    "\0",
    "é",
]
MUTATION = st.tuples(
    st.floats(0, 1), st.integers(0, 12), st.one_of(st.sampled_from(PIECES), st.text(max_size=4)), st.booleans()
)


def mutate(text: str, where: float, length: int, piece: str, by_line: bool) -> str:
    """`text` with a stretch of characters, or one line, replaced by `piece`."""
    if by_line:
        lines = text.splitlines(keepends=True)
        at = int(where * (len(lines) - 1))
        return "".join([*lines[:at], piece, *lines[at + 1 :]])
    at = int(where * len(text))
    return text[:at] + piece + text[at + length :]


def faults_in(path: Path) -> list[Fault]:
    """Faults of a config; none if it loads."""
    try:
        load(path)
    except ConfigError as error:
        return error.faults or pytest.fail("refused without a fault")
    return []


@settings(max_examples=200, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.sampled_from(DRAWN), st.lists(MUTATION, min_size=1, max_size=4))
def test_nothing_but_faults(tmp_path, text, mutations):
    for mutation in mutations:
        text = mutate(text, *mutation)
    path = tmp_path / "run.yaml"
    path.write_text(text, encoding="utf-8", errors="surrogatepass")
    found = faults_in(path)
    assert all(fault.message and str(fault).isprintable() for fault in found)


@pytest.mark.parametrize("text", TEXTS)
def test_every_line_left_out(tmp_path, text):
    """Each line of each file removed in turn: what remains is fine, or refused with a line that the file has."""
    lines = text.splitlines(keepends=True)
    path = tmp_path / "run.yaml"
    for i in range(len(lines)):
        path.write_text("".join(lines[:i] + lines[i + 1 :]))
        assert all(f.line is None or 1 <= f.line <= len(lines) for f in faults_in(path) if f.file == str(path))
