"""Calls of compiled functions by the addresses in a record: arguments, results, and refused functions."""

from __future__ import annotations

import numpy as np
import pytest
from numba import from_dtype, njit, types
from numba.core.errors import TypingError

from granular_contact.jit.calls import OWN, address_of, caller

LAYOUT = np.dtype([("scaled", "i8"), ("both", "i8"), ("own", "f8", (2,))])
PAIR = np.dtype([("a", "f8"), ("b", "f8")])
NUMBER, ROW = types.float64, types.Array(types.float64, 1, "C")
SCALED = (NUMBER, OWN, ROW), types.none
BOTH = (from_dtype(LAYOUT), NUMBER), types.UniTuple(NUMBER, 2)
by_scaled, by_both = caller("scaled", *SCALED, LAYOUT), caller("both", *BOTH, LAYOUT)


def scaled(x, m, out):  # type: ignore[no-untyped-def]
    out[0] = m.a * x
    out[1] = m.b * x


def both(record, x):  # type: ignore[no-untyped-def]
    return x + record.own[0], x - record.own[1]


@njit
def asked(records, x, out):  # type: ignore[no-untyped-def]
    by_scaled(records[0], (x, out))
    return by_both(records[0], (x,))


def record() -> np.ndarray:
    made = np.zeros(1, LAYOUT)
    made["own"] = 2.0, 3.0
    made["scaled"] = address_of(scaled, *SCALED, PAIR)
    made["both"] = address_of(njit(both), *BOTH)
    return made


@pytest.mark.parametrize("x", [4, 4.0], ids=["a whole number, cast", "a number"])
def test_a_call_gives_what_the_function_gives(x: float) -> None:
    """The law's own record, two numbers, is read where the record has it; results come back as a tuple."""
    out = np.zeros(2)
    assert asked(record(), x, out) == (6.0, 1.0)
    assert out.tolist() == [8.0, 12.0]


def test_a_function_has_one_address() -> None:
    assert record() == record()


def test_a_record_of_another_type_has_no_addresses() -> None:
    with pytest.raises((TypeError, TypingError), match="allowed is a record of"):
        asked(np.zeros(1, PAIR), 1.0, np.zeros(2))
