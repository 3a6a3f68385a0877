"""`{from: 1, to: 9, count: 5, scale: linear}` of a sweep file -> the values it stands for, or those of a fraction."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import isfinite
from typing import Any, overload

from granular_contact.config import tree
from granular_contact.config.messages import got, unknown
from granular_contact.errors import Fault

_KEYS = ("from", "to", "scale", "count")
_NEARLY_WHOLE = 1e-9

Fits = Callable[[Any], bool]


class Range(Sequence[tree.Scalar]):
    """`count` numbers evenly from `start` to `stop`, both included; on a log scale their ratios are equal.

    Between whole ends numbers are whole if they all come out so, since a count of elements must be.
    """

    def __init__(self, position: tree.Position, start: float, stop: float, count: int, logarithmic: bool) -> None:
        self.position, self._start, self._stop = position, start, stop
        self._count, self._logarithmic = count, logarithmic
        ends_whole = isinstance(start, int) and isinstance(stop, int)
        self._whole = ends_whole and all(_is_whole(self._number(i)) for i in range(count))

    def __len__(self) -> int:
        return self._count

    @overload
    def __getitem__(self, index: int) -> tree.Scalar: ...
    @overload
    def __getitem__(self, index: slice) -> Sequence[tree.Scalar]: ...
    def __getitem__(self, index: int | slice) -> tree.Scalar | Sequence[tree.Scalar]:
        if isinstance(index, slice):
            return [self[i] for i in range(*index.indices(self._count))]
        if not 0 <= index < self._count:
            raise IndexError(index)
        number = self._number(index)
        value = round(number) if self._whole else number
        return tree.Scalar(self.position, value, repr(value))

    def _number(self, index: int) -> float:
        if index in (0, self._count - 1):  # exact, whatever powers round to
            return self._stop if index else self._start
        return self.number(index / (self._count - 1))

    def number(self, fraction: float) -> float:
        """What lies at a fraction (0 to 1) of the way, on the scale of the range."""
        if self._logarithmic:
            return float(self._start * (self._stop / self._start) ** fraction)
        return float(self._start + (self._stop - self._start) * fraction)

    def plain(self) -> list[float] | dict[str, Any]:
        """The range in its shortest form, without the count."""
        if not self._logarithmic:
            return [self._start, self._stop]
        return {"from": self._start, "to": self._stop, "scale": "log"}


def _is_whole(number: float) -> bool:
    return abs(number - round(number)) <= _NEARLY_WHOLE * max(1.0, abs(number))


def read_range(
    node: tree.Mapping, path: tree.Path, most: int, faults: list[Fault], count: int | None = None
) -> Range | None:
    """The range that a mapping describes, of at most `most` values; None, with faults, if it describes none.

    count: how many values, where the mapping does not tell.
    """
    before = len(faults)
    known = _KEYS if count is None else _KEYS[:-1]
    for key, at in node.keys.items():
        if key in node.nodes and key not in known:
            faults.append(at.fault((*path, key), f"unknown key; {unknown(key, known)}"))
    start, stop = (_number(node, path, key, faults) for key in ("from", "to"))
    if count is None:
        count = read_value(node, path, "count", f"a whole number from 2 to {most}", whole(2, most), faults)
    scale = "linear"
    if "scale" in node.nodes:
        scale = read_value(node, path, "scale", "one of linear, log", lambda v: v in ("linear", "log"), faults)
    if start is not None and stop is not None:
        if start == stop:
            faults.append(node.keys["to"].fault((*path, "to"), f"got {stop:g}, the same as from; the two must differ"))
        elif scale == "log" and (start <= 0 or stop <= 0):
            message = f"got a range from {start:g} to {stop:g}; on a log scale both must be above 0"
            faults.append(node.position.fault(path, message))
    if len(faults) > before or start is None or stop is None or count is None or scale is None:
        return None
    return Range(node.position, start, stop, count, scale == "log")


def _number(node: tree.Mapping, path: tree.Path, key: str, faults: list[Fault]) -> Any:
    return read_value(node, path, key, "a finite number", is_number, faults)


def is_number(value: Any) -> bool:
    """Whether a value is a finite number, and neither true nor false."""
    return isinstance(value, int | float) and not isinstance(value, bool) and isfinite(value)


def whole(least: int, most: int) -> Fits:
    """Test for a whole number within bounds."""
    return lambda value: isinstance(value, int) and not isinstance(value, bool) and least <= value <= most


def read_value(node: tree.Mapping, path: tree.Path, key: str, allowed: str, fits: Fits, faults: list[Fault]) -> Any:
    """Value of a key that must be there and fit; None, with a fault, if not."""
    held = node.nodes.get(key)
    if isinstance(held, tree.Scalar) and fits(held.value):
        return held.value
    if held is None:
        faults.append(node.position.fault((*path, key), f"is missing; allowed is {allowed}"))
    elif not isinstance(held, tree.Broken):
        faults.append(held.position.fault((*path, key), f"got {got(held)}; allowed is {allowed}"))
    return None
