"""Arguments of another type than a public function takes: one line that names the argument, and what is allowed."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

import granular_contact as gc

RODS = "pendulum_rigid"
VALUES = {"solver.end_time_s": [0.01]}
# The argument that the line begins with, and the call.
CALLS: list[tuple[str, Callable[[Any], object]]] = [
    ("scenario", lambda _: gc.simulate("tail", "solver.end_time_s=1")),  # type: ignore[arg-type]
    ("scenario", lambda _: gc.simulate(RODS, {"solver.end_time_s": 1})),  # type: ignore[arg-type]
    ("scene", lambda _: gc.simulate(5)),  # type: ignore[arg-type]
    ("scene", lambda _: gc.simulate([RODS])),  # type: ignore[arg-type]
    ("progress", lambda s: gc.simulate(s, None, 5)),  # type: ignore[arg-type]
    ("control", lambda s: gc.simulate(s, control="up")),  # type: ignore[arg-type]
    ("inspect", lambda s: gc.simulate(s, inspect=5)),  # type: ignore[arg-type]
    ("compiling", lambda s: gc.simulate(s, compiling=5)),  # type: ignore[arg-type]
    ("most_frames", lambda s: gc.simulate(s, most_frames="all")),  # type: ignore[arg-type]
    ("most_frames", lambda s: gc.simulate(s, most_frames=True)),
    ("most_frames", lambda s: gc.simulate(s, most_frames=-1)),
    ("source", lambda _: gc.load(None)),  # type: ignore[arg-type]
    ("source", lambda s: gc.load(s)),
    ("overrides", lambda _: gc.load(RODS, "solver.end_time_s=1")),
    ("overrides", lambda _: gc.load(RODS, 5)),  # type: ignore[arg-type]
    ("overrides", lambda _: gc.load(RODS, [5])),  # type: ignore[list-item]
    ("laws", lambda _: gc.load(RODS, laws=gc.Rft)),  # type: ignore[arg-type]
    ("laws", lambda _: gc.load(RODS, laws=["rft"])),  # type: ignore[list-item]
    ("values", lambda s: s.replace("solver.end_time_s=1")),
    ("values", lambda s: s.scenario.replace(5)),
    ("source", lambda _: gc.build(5)),  # type: ignore[arg-type]
    ("source", lambda _: gc.Simulation([RODS])),  # type: ignore[arg-type]
    ("source", lambda s: gc.sweep(gc.build(s), VALUES)),  # type: ignore[arg-type]
    ("workers", lambda s: gc.sweep(s, VALUES, workers="two")),  # type: ignore[arg-type]
    ("workers", lambda s: gc.sweep(s, VALUES, workers=0)),
    ("source", lambda _: gc.ensemble(None, 2)),  # type: ignore[arg-type]
    ("count", lambda s: gc.ensemble(s, 2.5)),  # type: ignore[arg-type]
    ("source", lambda _: gc.optimise(5, {}, maximise="depth_m")),  # type: ignore[arg-type]
    ("name", lambda _: gc.preset(5)),  # type: ignore[arg-type]
    ("law", lambda _: gc.add_law("rft")),  # type: ignore[arg-type]
]


@pytest.mark.parametrize(("argument", "call"), CALLS, ids=[f"{i}-{name}" for i, (name, _) in enumerate(CALLS)])
def test_wrong_types_are_refused_in_one_line(argument: str, call: Callable[[Any], object]) -> None:
    with pytest.raises((TypeError, ValueError), match=rf"^{argument}: got .*; allowed is .+$"):
        call(gc.load(RODS))


def test_a_scenario_may_be_given_as_it_was_loaded() -> None:
    loaded = gc.load(RODS, solver={"end_time_s": 1e-3})
    assert gc.simulate(gc.build(loaded), loaded).status.code == "end_time"
