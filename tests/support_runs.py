"""Short ways from a config, or from the text of one, to a scene and to results."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from granular_contact import config
from granular_contact.results import Results
from granular_contact.run import run
from granular_contact.scene import Scene, build

ROOT = Path(__file__).parents[1]
CONFIGS = ROOT / "configs"

# The paper's pendulum, of models/compound_pendulum.yaml. Inertia about the pivot and moment of gravity of the level
# rigid pendulum are sums over its three cylinders, by hand: the hub on the pivot J_1 = m_1 d_1^2 / 8, the stub and the
# link J = m (l^2 / 12 + d^2 / 16 + s^2) with s from the pivot to their middles, and g sum(m s), with g 9.81 m/s2.
INERTIA, GRAVITY_MOMENT = 1.4955e-3, 0.08593  # kg m2, N m
L_RB, LENGTH, DIAMETER, DENSITY = 0.024765, 0.23876, 0.00635, 7700.0
STIFFNESS = 15.1642  # N m2
LINE_MASS = DENSITY * np.pi / 4 * DIAMETER**2  # kg/m


# The crank a turns the rocker d by the coupler between them, which the closure c joins to it.
FOUR_BAR = """
model:
  name: four_bar
  bodies:
    crank: {type: link, length_m: 0.1, diameter_m: 0.01, density_kg_m3: 7700}
    coupler: {type: link, length_m: 0.3, diameter_m: 0.01, density_kg_m3: 7700}
    rocker: {type: link, length_m: 0.3, diameter_m: 0.01, density_kg_m3: 7700}
  joints:
    a: {type: hinge, parent: ground, child: crank, home_deg: -90}
    b: {type: hinge, parent: crank, child: coupler, parent_point_m: [0.1, 0], home_deg: 90}
    d: {type: hinge, parent: ground, child: rocker, parent_point_m: [0.3, -0.2], home_deg: -90}
  closures:
    c: {type: hinge, parent: coupler, child: rocker, parent_point_m: [0.3, 0], child_point_m: [0.3, 0]}
"""


def scenario_of(text_or_name: str, *overrides: str) -> config.Scenario:
    """Scenario of a file in configs/, or of a whole config as text."""
    if "\n" not in text_or_name:
        return config.load(CONFIGS / f"{text_or_name}.yaml", overrides).scenario
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "case.yaml"
        path.write_text(text_or_name, encoding="utf-8")
        return config.load(path, overrides).scenario


def scene_of(text_or_name: str, *overrides: str) -> Scene:
    return build(scenario_of(text_or_name, *overrides))


def simulate(text_or_name: str, *overrides: str) -> Results:
    """Results of a config, kept for those who ask again; by the method under test where none is asked for."""
    methods = chosen
    if chosen == ["method=auto"] and _is_for_the_engine(text_or_name, *overrides):
        methods = ["method=engine"]  # the run that the test by the engine has made already
    return _simulated(text_or_name, *methods, *overrides)


@cache
def _is_for_the_engine(text_or_name: str, *overrides: str) -> bool:
    """Whether the method `auto` is that of the engine."""
    return scene_of(text_or_name, "method=auto", *overrides).method is None


chosen: list[str] = []  # overrides that name the method under test


@contextmanager
def by(method: str) -> Iterator[None]:
    """What is simulated meanwhile is so by this method."""
    chosen.append(f"method={method}")
    try:
        yield
    finally:
        chosen.pop()


@cache
def _simulated(text_or_name: str, *overrides: str) -> Results:
    scenario = scenario_of(text_or_name, *overrides)
    return run(build(scenario), scenario)


def tip(results: Results, times: NDArray[np.float64]) -> NDArray[np.float64]:
    """Tip position (n, 2) m at times that are steps of the run (or between two of them, then on the chord)."""
    return np.column_stack([np.interp(times, results["time_s"], results[c]) for c in ("tip_x_m", "tip_y_m")])


def tip_error(results: Results, reference: Results, times: NDArray[np.float64]) -> float:
    """Greatest distance (m) between two tips at the same times."""
    return float(np.linalg.norm(tip(results, times) - tip(reference, times), axis=1).max())


def order(steps: list[float], errors: list[float]) -> float:
    """Slope of log error over log step."""
    return float(np.polyfit(np.log(steps), np.log(errors), 1)[0])
