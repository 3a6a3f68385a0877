"""Which run's medium gets the fitted coefficients, and in what else the media of the runs differ."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from numpy.typing import NDArray

from granular_contact.config import scenario_to_dict
from granular_contact.config.differences import MISSING, differences
from granular_contact.studies.fit.problem import Parameter, Problem

MEDIUM = "medium"
MOST_SHOWN = 6
# What a medium is called, and where its numbers are from: no property of the sand.
_ABOUT = {"name", "source", "provenance", "range", "standing"}


def fitted(problem: Problem) -> list[Parameter]:
    """The shared parameters that belong to a medium."""
    return [p for p in problem.parameters if p.key[0] == MEDIUM and p.shared]


def carrier(problem: Problem) -> int:
    """Index of the first run on which all the fitted coefficients act; if none has them all, most of them."""
    counts = [sum(i in p.runs for p in fitted(problem)) for i in range(len(problem.runs))]
    return counts.index(max(counts))


def words(problem: Problem, values: NDArray[Any]) -> Iterator[str]:
    """Notes for a reader of the medium, for parameters (p,): what it does not contain, in what other runs differ."""
    if not fitted(problem):
        return
    held = carrier(problem)
    name = problem.runs[held].name
    lacking = [p.label for p in fitted(problem) if held not in p.runs]
    if lacking:
        yield f"no run has all the coefficients: the medium written is that of {name}, without {', '.join(lacking)}"
    shared = {p.key[1:] for p in fitted(problem)}
    media = [_medium(problem, i, values) for i in range(len(problem.runs))]
    differing: dict[str, None] = {}
    for path, mine, other in (found for one in media for found in differences(media[held], one)):
        key = tuple(map(str, path))
        nothing = mine in (None, MISSING) and other in (None, MISSING)  # null is as good as left out
        if not nothing and key not in shared and not _ABOUT & set(key):
            differing[".".join(key) or "law"] = None  # or one has none, or several
    if differing:
        listed = ", ".join([*differing][:MOST_SHOWN]) + (", ..." if len(differing) > MOST_SHOWN else "")
        yield f"the media of the runs differ in {listed}, not fitted to all of them: the one written is that of {name}"


def _medium(problem: Problem, i: int, values: NDArray[Any]) -> Any:
    run = problem.runs[i]
    return scenario_to_dict(run.simulator.load([float(values[j]) for j in run.acting]).scenario)[MEDIUM]
