"""The examples in docstrings of what users import, run as they stand."""

from __future__ import annotations

import doctest
from importlib import import_module

import pytest
from support_runs import ROOT

MODULES = ("config.add_law", "config.load", "sand", "sand.space", "simulation")


@pytest.mark.parametrize("name", MODULES)
def test_examples_give_what_they_show(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)
    done = doctest.testmod(import_module(f"granular_contact.{name}"))
    assert done.failed == 0
    assert done.attempted > 0
