"""Which run's medium gets the fitted coefficients, and in what else the media of the runs differ."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from numpy.typing import NDArray

from granular_contact.config import scenario_to_dict
from granular_contact.studies.fit.problem import Parameter, Problem

MEDIUM = "medium"
MOST_SHOWN = 6
# What a medium is called, and where its numbers are from: no property of the sand.
_ABOUT = (("name",), ("source",), ("provenance",), ("range",), ("standing",))


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
    media = [_entries(_medium(problem, i, values)) for i in range(len(problem.runs))]
    differing: dict[str, None] = {}
    for other in media:
        keys = dict.fromkeys([*media[held], *other])
        own = [key for key in keys if media[held].get(key) != other.get(key)]  # null is as good as left out
        differing.update(dict.fromkeys(".".join(key) for key in own if key not in shared and key[-1:] not in _ABOUT))
    if differing:
        listed = ", ".join([*differing][:MOST_SHOWN]) + (", ..." if len(differing) > MOST_SHOWN else "")
        yield f"the media of the runs differ in {listed}, not fitted to all of them: the one written is that of {name}"


def _medium(problem: Problem, i: int, values: NDArray[Any]) -> Any:
    run = problem.runs[i]
    return scenario_to_dict(run.simulator.load([float(values[j]) for j in run.acting]).scenario)[MEDIUM]


def _entries(plain: Any, path: tuple[str, ...] = ()) -> dict[tuple[str, ...], Any]:
    """Values of a nested medium by their keys; where there is none, it has no law."""
    if plain is None and not path:
        return {("law",): None}
    if isinstance(plain, dict) and path[-1:] not in _ABOUT:
        pairs = [(str(key), value) for key, value in plain.items()]
    elif isinstance(plain, list):
        pairs = [(str(i), value) for i, value in enumerate(plain)]
    else:
        return {path: plain}
    found: dict[tuple[str, ...], Any] = {}
    for key, value in pairs:
        found |= _entries(value, (*path, key))
    return found
