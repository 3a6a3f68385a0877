"""What the package offers by name is there, and is what the name says, whatever was imported before."""

from __future__ import annotations

import re
import subprocess
import sys

import pytest
from support_runs import ROOT

import granular_contact

CODE = """
import granular_contact.run, granular_contact.scene.build, granular_contact.config.load
import granular_contact
for name in {names!r}:
    thing = getattr(granular_contact, name)
    assert callable(thing), (name, thing)
    assert thing.__doc__, name
"""


@pytest.mark.parametrize("step", [1, -1])
def test_every_name_is_a_thing_to_call_whatever_was_loaded_before_it(step: int) -> None:
    code = CODE.format(names=granular_contact.__all__[::step])
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True)
    assert done.stderr == ""


def test_another_name_is_refused() -> None:
    with pytest.raises(AttributeError, match="no attribute 'sand'"):
        granular_contact.sand  # noqa: B018


def test_a_run_without_files() -> None:
    scenario = granular_contact.load(ROOT / "configs" / "pendulum_rigid.yaml").scenario
    results = granular_contact.simulate(granular_contact.build(scenario), scenario)
    assert results.status.code == "rest"


def test_what_is_public_is_told_by_help() -> None:
    """The first page of `help(granular_contact)` names all of it; completion offers it and nothing else."""
    assert dir(granular_contact) == granular_contact.__all__
    words = set(re.findall(r"\w+", granular_contact.__doc__ or ""))
    assert set(granular_contact.__all__) - words == {"RftCoefficients", "VerticalResistance"}  # parts of their laws


def test_media_and_simulations_are_shown_in_a_line() -> None:
    medium = granular_contact.preset("hill_cylinders", density_kg_m3=1500)
    assert repr(medium).startswith("Hill(density=1500.0, ")
    assert len(repr(medium)) < 200
    assert "<td>law</td><td>hill</td>" in medium._repr_html_()
    loaded = granular_contact.load("pendulum_rigid", solver={"end_time_s": 0.01})
    assert loaded._repr_html_() == loaded.scenario._repr_html_()
    simulation = granular_contact.Simulation(loaded)
    assert repr(simulation) == "<simulation of pendulum_rigid: 0 of 0.01 s, controls: none>"
    assert repr(simulation.state()) == "<state of pendulum_rigid at 0 s>"
