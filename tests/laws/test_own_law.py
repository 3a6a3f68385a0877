"""A user's law: one class and one registration, after which it runs from YAML as a law of the package does."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Literal

import numpy as np
import pytest
from support_power import Power
from support_refusals import faults_of

from granular_contact import build, load, simulate
from granular_contact.config import allowed
from granular_contact.config.add_law import add_law
from granular_contact.config.schema import Bed, BedLayer, Scenario
from granular_contact.errors import ConfigError
from granular_contact.laws.catalogue import LAWS
from granular_contact.laws.law import Law
from granular_contact.laws.probe import ball, force
from granular_contact.laws.tsimring_volfson import TsimringVolfson


@pytest.fixture
def removed() -> Iterator[None]:
    yield
    del LAWS["power"]
    for part in (BedLayer, Bed, Scenario):
        part.model_rebuild(force=True)
    allowed.clear_cache()


@pytest.fixture
def added(removed: None) -> None:  # noqa: ARG001
    add_law(Power)


BALL = """
model:
  name: ball
  bodies:
    ball: {type: rigid, density_kg_m3: 7700, shapes: [{type: sphere, diameter_m: 0.02, center_m: [0, 0]}]}
  joints:
    free: {type: free, parent: ground, child: ball}
medium: MEDIUM
surface_height_m: -0.01
initial: {joints: {free: {x_m: 0, y_m: 0, angle_deg: 0, vx_m_s: 0.3, vy_m_s: -0.5}}}
solver: {end_time_s: 0.02, step_s: 2.0e-4}
"""


def test_python_needs_the_class_alone() -> None:
    users, same = Power(400.0, 1.6), TsimringVolfson(0.0, 400.0, 1.6)
    for v in np.array([[0.2, -0.3], [0.0, 0.4]]):
        np.testing.assert_allclose(force(users, ball(0.01, 0.02), v), force(same, ball(0.01, 0.02), v)[:1], rtol=1e-12)
    with pytest.raises(ValueError, match=r"Power.exponent: got 0, allowed is a number above 0"):
        Power(1.0, 0)


@pytest.mark.usefixtures("added")
def test_own_law_runs_from_yaml(tmp_path: Path) -> None:
    tables = []
    for law in ("power, stiffness_N: 400", "tsimring_volfson, drag_kg_m: 0, friction_N: 400"):
        config = tmp_path / "config.yaml"
        config.write_text(BALL.replace("MEDIUM", f"{{law: {law}, exponent: 1.6}}"), encoding="utf-8")
        results = simulate(build(load(config).scenario))
        tables.append(np.column_stack([results[name] for name in ("time_s", "depth_m")]))
    users, same = tables
    assert len(users) > 50
    np.testing.assert_allclose(users, same, rtol=1e-9, atol=1e-12)


@pytest.mark.usefixtures("removed")
def test_own_laws_are_registered_in_python_and_not_named_in_yaml(tmp_path: Path) -> None:
    config = tmp_path / "own.yaml"
    config.write_text(BALL.replace("MEDIUM", "{law: support_power:Power, stiffness_N: 1}"), encoding="utf-8")
    with pytest.raises(ConfigError, match=r"own.yaml:8: medium.law: .*a config never loads code; in Python load"):
        load(config)
    config.write_text(BALL.replace("MEDIUM", "{law: power, stiffness_N: 4, exponent: 1.6}"), encoding="utf-8")
    with pytest.raises(ConfigError, match=r"medium.law: got the text 'power'; "):
        load(config)
    assert load(config, laws=[Power]).scenario.media == (Power(4.0, 1.6),)


@pytest.mark.usefixtures("added")
def test_keys_of_own_laws_are_checked(tmp_path: Path) -> None:
    config = tmp_path / "own.yaml"
    config.write_text(BALL.replace("MEDIUM", "{law: power, stiffness_N: -1, exponents: 1.6}"), encoding="utf-8")
    assert {str(fault) for fault in faults_of(ConfigError, load, config)} >= {
        f"{config}:8: medium.stiffness_N: got the number -1; allowed is a finite number of at least 0",
        f"{config}:8: medium.exponents: unknown key; did you mean exponent?",
    }


@pytest.mark.usefixtures("added")
def test_a_tag_is_taken_once() -> None:
    add_law(Power)

    class Other(Power):
        """Another."""

    with pytest.raises(ValueError, match="got the tag 'power' for Other, which another law has"):
        add_law(Other)

    class Bare(Law):
        """Says nothing."""

        law: Literal["bare"]

    with pytest.raises(TypeError, match="Bare has no equation, terms, takes, constants"):
        add_law(Bare)
