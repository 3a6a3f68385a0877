"""Every law and every engine run with NUMBA_DISABLE_JIT=1, to the numbers of compiled kernels."""

from __future__ import annotations

import json
import math
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import support_short_scenes
from support_short_scenes import numbers

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def python_alone() -> Any:
    """Numbers of all short scenes, and a walk of one, in a process where Python runs all kernels."""
    folders = (ROOT, ROOT / "tests", ROOT / "tests" / "laws")
    environment = dict(os.environ, NUMBA_DISABLE_JIT="1", PYTHONPATH=os.pathsep.join(map(str, folders)))
    script = str(Path(support_short_scenes.__file__))
    done = subprocess.run([sys.executable, script], env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


@pytest.fixture(scope="module")
def interpreted(python_alone: Any) -> dict[str, dict[str, float]]:
    numbers: dict[str, dict[str, float]] = python_alone["numbers"]
    return numbers


def differing(compiled: dict[str, float], interpreted: dict[str, float]) -> Iterator[str]:
    """Numbers that differ by more than CLOSE of themselves, and by more than round-off of the largest of their kind."""
    assert compiled.keys() == interpreted.keys()
    for name, value in compiled.items():
        expected = interpreted[name]
        if math.isnan(value) and math.isnan(expected):
            continue
        if not math.isclose(value, expected, rel_tol=CLOSE, abs_tol=SMALL):
            yield f"{name}: {value} and {expected}"


# The same operations in the same order, but for sums that compilers contract (a b + c in one rounding): round-off of
# 1e-16, which tangents by differences (steps of 1e-8) make 1e-8 of a change that Newton's method takes to 1e-6 or less.
CLOSE, SMALL = 1e-9, 1e-12


def test_interpreted_runs_give_the_numbers_of_compiled_runs(interpreted: dict[str, dict[str, float]]) -> None:
    compiled = numbers()
    assert interpreted.keys() == compiled.keys()
    wrong = {name: list(differing(compiled[name], interpreted[name])) for name in compiled}
    assert {name: faults for name, faults in wrong.items() if faults} == {}


def test_every_scene_is_in_sand(interpreted: dict[str, dict[str, float]]) -> None:
    for name, values in interpreted.items():
        assert values["depth_m"] > 1e-3, name
        assert any(abs(value) > 1e-7 for key, value in values.items() if "work" in key), name


def test_the_walk_in_the_docs_is_the_one_that_is_taken(python_alone: Any) -> None:
    page = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
    section = page.split("## Follow a pose")[1].split("\n## ")[0]
    documented = [" ".join(row) for row in re.findall(r"^\| `([^`]+)` \| `([^`]+)` \|", section, re.M)]
    taken = [row for row in python_alone["walk"] if row != "jit/calls.py call"]
    assert documented == taken
    assert len(python_alone["walk"]) - len(taken) == 3  # calls by address
