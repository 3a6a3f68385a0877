"""Arrays that kernels find by their names are those of Python, with the layout that each was given."""

from __future__ import annotations

import numpy as np
import pytest
from numba import njit

from granular_contact.jit.layout import PER_ARRAY, Layout
from granular_contact.jit.records import record_dtype

PAIR = record_dtype([("number", "i8"), ("size", "f8")])
LAYOUT = Layout("of a test", x=(float, 1), A=(float, 2), T=(float, 3), marks=(np.bool_, 1), pairs=(PAIR, 1))
view = LAYOUT.view


@njit(cache=True)
def sums(addresses):
    """Of all numbers of each array, by its sizes and strides."""
    w = view(addresses)
    flat, deep = 0.0, 0.0
    for i in range(w.A.shape[0]):
        for j in range(w.A.shape[1]):
            flat += (i + 1) * (j + 1) * w.A[i, j]
            for k in range(w.T.shape[2]):
                deep += (i + 1) * (j + 2) * (k + 3) * w.T[i, j, k]
    return w.x.sum(), flat, deep, w.marks.sum(), w.pairs[1].number, w.pairs[1].size, w.T.size


@njit(cache=True)
def change(addresses):
    """Write into arrays and records."""
    w = view(addresses)
    w.x[-1] = 7.0
    w.A[1] = w.A[0]
    w.T[0, 1, :] = 2.0
    w.marks[0] = True
    w.pairs[0].size = 0.5


@pytest.fixture
def arrays() -> dict[str, np.ndarray]:
    rng = np.random.default_rng(1)
    pairs = np.zeros(2, PAIR)
    pairs["number"], pairs["size"] = [3, 4], [0.1, 0.2]
    numbers = {"x": rng.normal(size=5), "A": rng.normal(size=(3, 4)), "T": rng.normal(size=(3, 4, 2))}
    return numbers | {"marks": np.array([False, True, True]), "pairs": pairs}


def test_a_kernel_reads_the_arrays(arrays: dict[str, np.ndarray]) -> None:
    i, j, k = (np.arange(n) for n in arrays["T"].shape)
    weights = (i + 1)[:, None] * (j + 1)
    deep = ((i + 1)[:, None, None] * (j + 2)[:, None] * (k + 3) * arrays["T"]).sum()
    expected = arrays["x"].sum(), (weights * arrays["A"]).sum(), deep, 2, 4, 0.2, 24
    np.testing.assert_allclose(sums(LAYOUT.addresses(arrays)), expected, rtol=1e-13)


def test_a_kernel_writes_into_the_arrays(arrays: dict[str, np.ndarray]) -> None:
    change(LAYOUT.addresses(arrays))
    assert arrays["x"][-1] == 7.0
    np.testing.assert_array_equal(arrays["A"][1], arrays["A"][0])
    assert (arrays["T"][0, 1] == 2.0).all()
    assert arrays["marks"][0]
    assert arrays["pairs"]["size"].tolist() == [0.5, 0.2]


def test_an_array_that_is_not_given_has_no_address(arrays: dict[str, np.ndarray]) -> None:
    arrays.pop("A")
    assert not LAYOUT.addresses(arrays)[PER_ARRAY : 2 * PER_ARRAY].any()


def test_other_arrays_are_refused(arrays: dict[str, np.ndarray]) -> None:
    with pytest.raises(TypeError, match="x: got 1 axes of float32, allowed are 1 of float64"):
        LAYOUT.addresses(arrays | {"x": arrays["x"].astype(np.float32)})
    with pytest.raises(TypeError, match="A: got 1 axes"):
        LAYOUT.addresses(arrays | {"A": arrays["x"]})
    with pytest.raises(ValueError, match="A: allowed are contiguous arrays"):
        LAYOUT.addresses(arrays | {"A": arrays["A"].T})


def test_a_name_that_is_not_there_is_refused(arrays: dict[str, np.ndarray]) -> None:
    @njit
    def wrong(addresses):
        return view(addresses).y

    with pytest.raises(Exception, match="y"):
        wrong(LAYOUT.addresses(arrays))
