"""Faults of YAML texts, and the meaning of plain scalars."""

import math
from pathlib import Path

import pytest
from support_config import GOOD, changed
from support_refusals import faults_of

from granular_contact.config import load
from granular_contact.config.yaml_source import MAX_BYTES
from granular_contact.errors import ConfigError
from granular_contact.values.scalars import resolve

BOMB = "a: &a [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]\n" + "".join(
    f"{b}: &{b} [{', '.join([f'*{a}'] * 10)}]\n" for a, b in zip("abcdef", "bcdefg", strict=True)
)
CHAIN = "a0: &a0 [1]\n" + "".join(f"a{i + 1}: &a{i + 1} [*a{i}]\n" for i in range(90))
# text, line, key, words
UNREADABLE = {
    "empty": ("", 1, "", "empty"),
    "only a comment": ("# nothing\n", 1, "", "empty"),
    "a list": ("- a\n- b\n", 1, "", "a list of 2 items; allowed is a mapping"),
    "a word": ("\nhello\n", 2, "", "is not a config: it holds a text; allowed is a mapping"),
    "null": ("---\nnull\n", 2, "", "is not a config: it holds nothing"),
    "two documents": (GOOD + "---\nname: second\n", 41, "", "a second document"),
    "tab": (changed("  eta_d: 6.5", "\teta_d: 6.5"), 25, "", "spaces"),
    "open list": (changed("end_m: [0.02, 0]}", "end_m: [0.02, 0}"), 10, "", "a list opened with ["),
    "open mapping": (GOOD + "x: {a: 1\n", 42, "", "a mapping opened with {"),
    "colon": (changed("name: strike", "name: strike: hard"), 1, "", "a ':' where no key can stand"),
    "open quote": (GOOD + "x: 'abc\n", 42, "", "a quoted text is not closed"),
    "no colon": (changed("gravity_m_s2: 9.81", "gravity_m_s2"), 29, "", "not valid YAML"),
    "indentation": (changed("  eta_h: 8", "   eta_h: 8"), 26, "", "not valid YAML"),
    "directive": ("%FOO\n" + GOOD, 1, "", "not valid YAML"),
    "control character": (changed("strike", "str\x07ike"), 1, "", "printable"),
    "NUL": (changed("eta_d: 6.5", "eta_d: \0"), 25, "", "printable"),
    "latin-1": (changed("strike", "Stoß").encode("latin-1"), 1, "", "UTF-8"),
    "binary": (b"a: 1\n\x89PNG\r\n\x1a\n", 2, "", "UTF-8"),
    "utf-16": (GOOD.encode("utf-16"), 1, "", "UTF-8"),
    "python tag": (
        changed("name: strike", "name: !!python/object/apply:os.system [echo]"),
        1,
        "name",
        "python/object/apply:os.system'; tags are not used",
    ),
    "own tag": (changed("eta_d: 6.5", "eta_d: !sand 6.5"), 25, "medium.eta_d", "'!sand'"),
    "standard tag": (changed("eta_d: 6.5", "eta_d: !!float 6.5"), 25, "medium.eta_d", "tags are not used"),
    "duplicate": (changed("eta_h: 8", "eta_h: 8\n  eta_d: 8"), 27, "medium.eta_d", "in lines 25 and 27"),
    "number as key": (changed("eta_h: 8", "eta_h: 8\n  1: 2"), 27, "medium", "the key 1;"),
    "null as key": (changed("eta_h: 8", "eta_h: 8\n  ~: 2"), 27, "medium", "the key ~"),
    "list as key": (changed("eta_h: 8", "eta_h: 8\n  ? [a, b]\n  : 2"), 27, "medium", "a list or mapping as key"),
    "merge key": (changed("eta_h: 8", "eta_h: 8\n  <<: {eta_q: 1}"), 27, "medium", "merge key"),
    "unknown alias": (changed("eta_h: 8", "eta_h: *eight"), 26, "medium.eta_h", "no anchor &eight"),
    "alias in itself": (changed("plunging: {", "plunging: &p {a: *p, "), 27, "medium.plunging.a", "that contains it"),
    "alias bomb": (BOMB, 4, "d.7", "expand to more than 10000"),
    "deep": ("a: " + "[" * 100_000, 1, "", "64 levels"),
    "deep blocks": ("\n".join("  " * i + "a:" for i in range(200)), 65, "", "64 levels"),
    "deep aliases": (CHAIN, 63, "", "64 levels"),
    "too large": (GOOD + "#" * MAX_BYTES, None, "", "larger than 1000000"),
}


@pytest.mark.parametrize("case", UNREADABLE)
def test_unreadable(faults, case):
    text, line, key, message = UNREADABLE[case]
    reported = faults(text)
    assert len(reported) == 1
    assert (reported[0].file, reported[0].line, reported[0].key) == ("run.yaml", line, key)
    assert message in reported[0].message


@pytest.mark.parametrize(
    ("place", "message"),
    [("no.yaml", "no such file"), (".", "is a folder"), ("run.yaml/x", "can't be read"), ("a\0b", "can't be read")],
)
def test_no_file(tmp_path: Path, place, message):
    (tmp_path / "run.yaml").write_text(GOOD)
    [fault] = faults_of(ConfigError, load, f"{tmp_path}/{place}")
    assert fault.line is None
    assert message in fault.message


def test_ordinary_text_is_kept_as_it_is(tmp_path: Path):
    """Byte order mark, Windows line ends, a document mark, anchors and a comment are all YAML."""
    text = GOOD.replace("density_kg_m3: 7700\n      shapes", "density_kg_m3: &steel 7700 # kg\n      shapes")
    text = text.replace("density_kg_m3: 7700\n", "density_kg_m3: *steel\n")
    (tmp_path / "run.yaml").write_bytes(("\ufeff---\n" + text + "...\n").replace("\n", "\r\n").encode())
    (tmp_path / "plain.yaml").write_text(GOOD)
    assert load(tmp_path / "run.yaml").scenario == load(tmp_path / "plain.yaml").scenario


@pytest.mark.parametrize(
    ("text", "value"),
    [("1e-3", 1e-3), ("3e5", 3e5), ("1E6", 1e6), ("+.5", 0.5), ("-2.", -2.0), ("12", 12), ("-0", 0), ("0.10", 0.1)],
)
def test_plain_scalars_that_are_numbers(text, value):
    assert resolve(text) == value
    assert type(resolve(text)) is type(value)


@pytest.mark.parametrize(
    "text", ["1_000", "010", "00.5", "1:30", "0x1F", "0o17", "yes", "on", "2024-01-02", "1e", "١٢"]
)
def test_plain_scalars_that_are_texts(text):
    assert resolve(text) == text


def test_constants():
    assert [resolve(text) for text in ("true", "False", "null", "~", "")] == [True, False, None, None, None]
    assert resolve("-.inf") == -math.inf
    assert math.isnan(resolve(".NaN"))
