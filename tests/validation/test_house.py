"""The script that measures the package counts lines, readers and functions as it says."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path

import pytest

from granular_contact.scene import build
from validation import house

SOURCE = '''"""Docstring
of two lines."""

# a comment
import os  # with words


def f(a, b, c, d, e, f, g, h, i, j, k):
    """One."""
    return """a text
    is code"""
'''


def test_lines_of_code_are_neither_blank_nor_comment_nor_docstring() -> None:
    assert house.code_lines(SOURCE) == {5, 8, 10, 11}


def test_functions_of_more_than_ten_arguments_are_found() -> None:
    assert list(house.many_arguments(SOURCE)) == [("f", 11)]
    assert list(house.many_arguments(SOURCE.replace(", k", ""))) == []


def test_readers_are_those_that_import_a_module(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    package = tmp_path / "sand"
    (package / "room").mkdir(parents=True)
    (package / "room" / "__init__.py").touch()
    (package / "__main__.py").touch()
    (package / "room" / "two.py").write_text("from ..one import f\n", encoding="utf-8")
    (package / "one.py").write_text("from sand.room import two\n", encoding="utf-8")
    monkeypatch.setattr(house, "ROOT", tmp_path)
    monkeypatch.setattr(house, "PACKAGE", package)
    readers = house.readers(house.files())
    assert readers[package / "room" / "two.py"] == {package / "one.py"}
    assert readers[package / "one.py"] == {package / "room" / "two.py"}
    assert readers[package / "room" / "__init__.py"] == {package / "one.py"}
    assert not readers[package / "__main__.py"]
    assert {file.room for file in house.files()} == {".", "room"}


def test_lines_entered_are_those_of_functions_that_were_called() -> None:
    file = Path(build.__code__.co_filename)
    lines = {str(file): house.code_lines(file.read_text(encoding="utf-8"))}

    def action() -> None:
        with suppress(TypeError):  # it refuses its argument after it is entered
            build(None)  # type: ignore[arg-type]

    entered_lines = house.entered(action)
    assert "build" in {code.co_name for code in entered_lines}
    assert all(Path(code.co_filename).is_relative_to(house.PACKAGE) for code in entered_lines)
    assert 5 < house.lines_of(entered_lines, lines) < 200
