"""What the package offers by name is there, and is what the name says, whatever was imported before."""

from __future__ import annotations

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
