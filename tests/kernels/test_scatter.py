"""The random function of scatter, and the scatter of forces that it gives."""

from __future__ import annotations

import numpy as np
from numba import njit
from support_laws import LEE_MARGHITU, LOOSE

from granular_contact.laws.drft import Drft
from granular_contact.laws.law import Law
from granular_contact.laws.scatter import MOST, Scatter
from granular_contact.sand.contact_lines import Body, polyline
from granular_contact.sand.kernels import scatter
from granular_contact.sand.load import GranularLoad


@njit(cache=True)
def table(seed, ways, places):
    factors = np.empty((len(ways), len(places)))
    for i in range(len(ways)):
        for j in range(len(places)):
            factors[i, j] = scatter.xi(seed, ways[i], places[j])
    return factors


def test_scatter_has_mean_0_variance_1_and_bounds() -> None:
    many = np.array([table(seed, np.array([0.3, 7.5, 900.2]), np.array([0.1, 4.5])) for seed in range(4000)])
    # 4000 draws: the standard error of the mean is 0.016, of the standard deviation at most that.
    assert np.abs(many.mean(axis=0)).max() < 0.07
    assert np.abs(many.std(axis=0) - 1.0).max() < 0.05
    assert np.abs(many).max() <= 2.0
    assert MOST * 2.0 <= 1.0
    assert MOST == scatter.MOST
    far = np.corrcoef(many.reshape(4000, 6).T) - np.eye(6)
    assert np.abs(far).max() < 0.08  # cells apart are independent


def test_scatter_is_smooth_and_correlated_between_neighbours() -> None:
    ways = np.linspace(0.0, 5.0, 5001)
    factors = table(3, ways, np.array([2.2, 2.3, 40.2]))
    # Weights turn by q' / (q^2 + (1 - q)^2) <= 3 a grain, around 2 at most: a slope of 6; and no kink between cells.
    assert np.abs(np.diff(factors, axis=0)).max() < 6e-3
    assert np.abs(np.diff(factors, 2, axis=0)).max() < 5e-5
    assert np.corrcoef(factors[:, 0], factors[:, 1])[0, 1] > 0.9
    assert np.abs(factors[:, 0] - factors[:, 2]).max() > 1.0


def pushed(medium: Law, seed: int, strips: int = 16, steps: int = 120) -> np.ndarray:
    """Terms (steps, terms, 3) of a plate or bar that is driven down at a slant, twice through each depth."""
    if seed:
        medium = medium.model_copy(update={"scatter": Scatter(0.5, 0.004, seed)})
    load = GranularLoad(medium, 0.0)
    size = {"width": 0.02} if "flat" in medium.takes else {"diameter": 0.02}
    load.add(polyline(Body("part", [0, 1, 2]), [[0.0, 0.0], [0.06, -0.03]], strips=strips, **size))
    load.start(np.array([0.0, 0.03, 0.0]))
    for i in range(steps):
        way = min(i, 80 - 0.5 * i if i > 60 else i)
        v = np.array([0.1, -0.3 if i <= 60 else 0.15, 0.0])
        load.accept(1e-3 * i, np.array([1e-4 * i, 0.03 - 5e-4 * way, 0.0]), v)
    terms: np.ndarray = load.history.terms
    assert (load.history.power <= 0.0).all()
    return terms


def test_static_terms_scatter_and_those_of_the_speed_do_not() -> None:
    for medium in (Drft(LOOSE, 1500.0, 1.1), LEE_MARGHITU):
        plain, seeded, same, other = (pushed(medium, seed) for seed in (0, 5, 5, 6))
        moving = [i for i, term in enumerate(medium.terms) if term in medium.dynamic]
        static = [i for i, term in enumerate(medium.terms) if term not in medium.dynamic]
        assert len(moving) == 1
        np.testing.assert_array_equal(seeded, same)
        np.testing.assert_array_equal(seeded[:, moving], plain[:, moving])
        up, scattered = plain[:, static, 1].sum(axis=1), seeded[:, static, 1].sum(axis=1)
        deep = np.abs(up) > 0.1 * np.abs(up).max()
        ratio = scattered[deep] / up[deep]
        # 16 strips of a length that counts as its square root: 0.5 / sqrt(16) for the whole, give or take.
        assert 0.02 < np.std(ratio) < 0.3
        assert np.abs(seeded - other).max() > 0.02 * np.abs(plain).max()


def test_finer_strips_scatter_as_much_as_a_whole() -> None:
    # A body of 17 grains: however it is divided, its forces scatter by s / sqrt(17), see `sand.kernels.scatter`.
    medium = Drft(LOOSE, 1500.0, 1.1)
    plain = [pushed(medium, 0, strips, 51)[50, 0, 1] for strips in (4, 64)]
    ratios = [
        [pushed(medium, seed, n, 51)[50, 0, 1] / plain[i] for seed in range(1, 101)] for i, n in enumerate((4, 64))
    ]
    spread = np.std(ratios, axis=1)
    assert 0.75 < spread[0] / spread[1] < 1.33  # of 100 draws each is known to 7 %
