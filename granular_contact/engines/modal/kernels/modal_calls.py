"""Functions of the modal pendulum that are called by their addresses in its record, as laws are called in `law`.

Reason: Numba optimises a function together with all that it calls, again for each caller. These functions have many
callers, and a scene without the true sign never needs two of the three.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
from numba import from_dtype, types

from granular_contact.engines.modal.kernels.modal import MODAL_STATION
from granular_contact.engines.modal.kernels.modal_load import PendulumArrays
from granular_contact.engines.modal.kernels.pendulum import PENDULUM
from granular_contact.jit.calls import address_of, caller
from granular_contact.jit.compiled import part
from granular_contact.sand.kernels.law import LAW, LINE

_ROW, _ROWS = (types.Array(types.float64, n, "C") for n in (1, 2))
_RECORDS = {name: types.Array(from_dtype(dtype), 1, "C") for name, dtype in zip(
    ("pendulum", "geometry", "lines", "medium"), (PENDULUM, MODAL_STATION, LINE, LAW), strict=True
)}  # fmt: skip
_STARTS = types.Array(types.int64, 1, "C")
_ROOM = types.Array(types.float64, 3, "C")
_KINDS = {**_RECORDS, "starts": _STARTS, "profile": _ROWS, "anchors": _ROWS, "room": _ROOM}
_ARRAYS = types.NamedTuple([_KINDS[name] for name in PendulumArrays._fields], PendulumArrays)
_ARGUMENTS: dict[str, tuple[Any, ...]] = {
    "rates": (_ROW, _ROW, _ARRAYS, _ROW, _ROWS, _ROW),
    "margins": (_ROW, _ROW, _ARRAYS, _ROW),
    "hold": (_ROW, _ROW, _ROW, _ROW, _ARRAYS, _ROW),
}
_rates, _margins, _hold = (caller(name, _ARGUMENTS[name], types.none, PENDULUM) for name in _ARGUMENTS)


def provide(pendulum: np.ndarray, functions: dict[str, Any]) -> None:
    """Write the addresses of functions, by their names in this module, into a record (1,) of PENDULUM; compile them."""
    for name, function in functions.items():
        pendulum[name] = _address(function, name)


@cache
def _address(function: Any, name: str) -> int:
    return address_of(function, _ARGUMENTS[name], types.none)


@part
def rates(y, s, w, sigma, totals, dy):
    """Call `modal_motion.rates`."""
    _rates(w.pendulum[0], (y, s, w, sigma, totals, dy))


@part
def margins(y, s, w, margin):
    """Call `modal_motion.margins`."""
    _margins(w.pendulum[0], (y, s, w, margin))


@part
def hold(q, v, h, s, w, sigma):
    """Call `slip.hold` or `slip.hold_rigid`."""
    _hold(w.pendulum[0], (q, v, h, s, w, sigma))
