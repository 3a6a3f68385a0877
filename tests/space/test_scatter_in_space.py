"""Scatter in space: how much a plate of facets scatters, what shares it, what does not scatter, and who is refused."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from support_space import Array, load_on, state

from granular_contact import Drft, Hill, Plate, VerticalResistance
from granular_contact.config import load
from granular_contact.errors import ConfigError
from granular_contact.laws.scatter import Scatter

PLAIN = Drft(density=1500.0, lam=1.1, surface_drop=0.0)
SIZE, GRAIN, SHARE = 0.06, 0.01, 0.4


def pushed(seed: int, facet: float = 0.01, steps: int = 30) -> Array:
    """Terms (steps, terms, 6) on a level plate that is pressed in, 1 mm a step; seed 0: without scatter."""
    medium = PLAIN.model_copy(update={"scatter": Scatter(SHARE, GRAIN, seed)}) if seed else PLAIN
    load = load_on(medium, Plate((SIZE, SIZE)), facet)
    down = np.array([0.0, 0.0, -0.1])
    q = [state(np.array([0.0, 0.0, -1e-3 * (i + 5)]), Rotation.identity(), down, 0.0 * down) for i in range(steps)]
    load.start(q[0][0])
    for i, at in enumerate(q):
        load.accept(1e-2 * i, *at)
    history = load.history
    assert (history.power <= 0.0).all()
    found: Array = history.terms
    return found


def test_a_plate_scatters_as_its_cubes_do() -> None:
    plain = pushed(0)
    runs = [pushed(seed, steps=3) for seed in range(1, 41)]
    at = np.array([run[2, 0, 2] for run in runs]) / plain[2, 0, 2]
    # 36 cubes of the size of a grain lie on the plate; of 40 draws a deviation is known to 11 %.
    assert np.std(at) == pytest.approx(SHARE * GRAIN / SIZE, rel=0.4)
    assert np.mean(at) == pytest.approx(1.0, abs=4 * SHARE * GRAIN / SIZE / np.sqrt(40))


def test_it_changes_with_the_way_and_only_what_is_static() -> None:
    plain, one, again, other = (pushed(seed) for seed in (0, 5, 5, 6))
    np.testing.assert_array_equal(one, again)
    np.testing.assert_array_equal(one[:, 1], plain[:, 1])
    assert np.abs(plain[:, 1]).max() > 0.0
    ratio = one[:, 0, 2] / plain[:, 0, 2]
    assert np.ptp(ratio) > 0.02  # over three grains of way
    assert np.abs(np.diff(ratio)).max() < 0.5 * np.ptp(ratio)  # in steps of a tenth of a grain
    assert np.abs(other - one).max() > 0.01 * np.abs(plain).max()


def test_none_at_all_is_none_bit_by_bit() -> None:
    nothing = PLAIN.model_copy(update={"scatter": Scatter(0.0, GRAIN, 3)})
    at = state(np.array([0.0, 0.0, -0.01]), Rotation.identity(), np.array([0.0, 0.0, -0.1]), np.zeros(3))
    found = []
    for medium in (PLAIN, nothing):
        load = load_on(medium, Plate((SIZE, SIZE)))
        load.start(at[0])
        load.accept(0.0, *at)
        found.append(load.history.terms)
    np.testing.assert_array_equal(*found)


def test_laws_of_bars_and_balls_are_refused_in_a_line() -> None:
    scatter = {"relative": 0.2, "length_m": 0.003}
    with pytest.raises(ConfigError, match=r"medium.scatter: is in space for laws of surfaces, and hill is none"):
        load("dropped", medium={"from": "hill_cylinders", "scatter": scatter})
    hill = Hill(1600.0, VerticalResistance(10.0, 1.4), VerticalResistance(0.5, 1.7), scatter=Scatter(0.2, 0.003))
    with pytest.raises(ValueError, match="has scatter, which in space is for laws of surfaces; allowed is none"):
        load_on(hill, Plate((0.1, 0.1)))
    mujoco = pytest.importorskip("mujoco", reason="MuJoCo is not installed")
    from granular_contact.mujoco import MujocoBed

    model = mujoco.MjModel.from_xml_string("<mujoco><worldbody/></mujoco>")
    with pytest.raises(ValueError, match="in space is for runs in Exudyn"):
        MujocoBed(model, PLAIN.model_copy(update={"scatter": Scatter(0.2, 0.003)}))
