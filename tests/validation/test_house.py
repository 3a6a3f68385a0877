"""The script that measures the package counts lines, readers and functions as it says."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path

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


def test_readers_are_those_that_import_a_module() -> None:
    found = house.readers(house.files())
    assert house.PACKAGE / "simulation.py" in found[house.PACKAGE / "run.py"]
    assert not found[house.PACKAGE / "__main__.py"]


def test_lines_entered_are_those_of_functions_that_were_called() -> None:
    lines = {str(f.path): f.code for f in house.files()}

    def action() -> None:
        with suppress(AttributeError):  # it fails after it is entered
            build(None)  # type: ignore[arg-type]

    found = house.entered(action)
    assert "build" in {code.co_name for code in found}
    assert all(Path(code.co_filename).is_relative_to(house.PACKAGE) for code in found)
    assert 5 < house.lines_of(found, lines) < 200
