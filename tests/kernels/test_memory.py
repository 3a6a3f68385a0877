"""Views and small arrays in compiled code: each is what its body in Python says."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numba import njit

from granular_contact.jit import memory
from granular_contact.jit.compiled import options
from granular_contact.jit.records import record_dtype

A = np.arange(60.0).reshape(5, 4, 3)
STATIONS = np.array([(1.0, 2), (3.0, 4), (5.0, 6)], [("x", "f8"), ("k", "i8")])
VIEWS: dict[str, tuple[Callable[..., Any], tuple[Any, ...]]] = {
    "rows of one axis": (lambda a: memory.rows(a, 1, 2), (A[0, 0].copy(),)),
    "rows of three": (lambda a: memory.rows(a, 2, 2), (A,)),
    "rows of records": (lambda a: memory.rows(a, 1, 2), (STATIONS,)),
    "piece of three": (lambda a: memory.piece(a, 4, 3), (A,)),
    "piece from within": (lambda a: memory.piece(a, 4, 2, 1), (A,)),
    "flat": (lambda a: memory.flat(a), (A,)),
}


@pytest.mark.parametrize("name", VIEWS)
def test_a_view_is_the_slice(name: str) -> None:
    """Its entries, and that what is written to it is written to the array."""
    function, given = VIEWS[name]
    compiled = njit(function)(*given)
    np.testing.assert_array_equal(compiled, function(*given))

    other = njit(lambda a: memory.clear(function_of(a)))
    function_of = njit(function)
    left, right = given[0].copy(), given[0].copy()
    if left.dtype.names is None:
        other(left)
        memory.clear(function(right))
        np.testing.assert_array_equal(left, right)


def test_rooms_are_apart_and_live_as_long_as_the_call() -> None:
    @njit
    def sums(n):  # type: ignore[no-untyped-def]
        total = 0.0
        for i in range(n):  # one room for all turns, or the stack would grow with n
            a, b, c = memory.room1(4), memory.room2(3, 2), memory.room3(2, 2, 2)
            memory.clear(b)
            memory.clear(c)
            for k in range(4):
                a[k] = i
            b[2, 1], c[1, 1, 1] = 1.0, 2.0
            total += a.sum() + b.sum() + c.sum()
        return total

    n = 1_000_000
    assert sums(n) == 4.0 * n * (n - 1) / 2.0 + 3.0 * n


def test_copies_are_of_all_entries() -> None:
    to = np.zeros_like(A)
    njit(lambda to, given: memory.copy(to, given))(to, A)
    np.testing.assert_array_equal(to, A)


def test_references_to_arrays_are_not_counted() -> None:
    counted, uncounted = (
        njit(**options(allocates))(lambda a: memory.rows(a, 1, 2)[0, 0, 0]) for allocates in (True, False)
    )
    assert counted(A) == uncounted(A) == A[1, 0, 0]
    texts = ["\n".join(function.inspect_llvm().values()) for function in (counted, uncounted)]
    assert ["NRT_decref" in text for text in texts] == [True, False]


PAIR = record_dtype([("x", "f8", (2,)), ("k", "f8")])


def test_rows_of_numbers_are_seen_as_records_and_changed_through_them() -> None:
    pairs = memory.as_records(PAIR)

    @njit(**options())
    def double(numbers):  # type: ignore[no-untyped-def]
        seen = pairs(numbers)
        for i in range(seen.shape[0]):
            seen[i].x[1] *= 2.0
            seen[i].k *= 2.0

    numbers = np.arange(6.0).reshape(2, 3)
    double(numbers)
    np.testing.assert_array_equal(numbers, [[0.0, 2.0, 4.0], [3.0, 8.0, 10.0]])


def test_rooms_of_records_are_apart_and_live_as_long_as_the_call() -> None:
    room = memory.record_room(PAIR)

    @njit(**options())
    def total(n):  # type: ignore[no-untyped-def]
        result = 0.0
        for i in range(n):  # one room for all turns, or the stack would grow with n
            a, b = room(), room()
            a.k, b.k, a.x[0], b.x[0] = 1.0, 2.0, i, -i
            result += a.k + b.k + a.x[0] + b.x[0]
        return result

    assert total(3_000_000) == 9e6
