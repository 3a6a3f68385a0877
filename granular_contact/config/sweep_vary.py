"""The keys `vary` and `combine` of a sweep file -> cases of a grid or a zip, each made when it is asked for."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import overload

from granular_contact.config import tree
from granular_contact.config.messages import got
from granular_contact.config.overrides import Override
from granular_contact.config.sweep_cases import MOST_CASES, Case, read_overrides
from granular_contact.config.sweep_range import read_range
from granular_contact.errors import Fault

READABLE = 10  # digits of a number that is told in full
MOST_LISTED = 6


class Numbered(Sequence[Case]):
    """Cases that differ in numbers or values only, called case_1 and so on; a subclass gives their overrides."""

    def __len__(self) -> int:
        raise NotImplementedError

    def overrides(self, index: int) -> tuple[Override, ...]:
        """What the case of this index, from 0, replaces."""
        raise NotImplementedError

    @overload
    def __getitem__(self, index: int) -> Case: ...
    @overload
    def __getitem__(self, index: slice) -> Sequence[Case]: ...
    def __getitem__(self, index: int | slice) -> Case | Sequence[Case]:
        if isinstance(index, slice):
            return [self[i] for i in range(*index.indices(len(self)))]
        if index < 0:
            index += len(self)
        if not 0 <= index < len(self):
            raise IndexError(index)
        return Case(f"case_{index + 1:0{len(str(len(self)))}d}", self.overrides(index), numbered=True)


class Varied(Numbered):
    """Columns of overrides of one key each, combined to all combinations (the last runs fastest), or side by side."""

    def __init__(self, columns: Sequence[Sequence[Override]], grid: bool) -> None:
        self._columns, self._grid = columns, grid

    def __len__(self) -> int:
        return math.prod(map(len, self._columns)) if self._grid else len(self._columns[0])

    def overrides(self, index: int) -> tuple[Override, ...]:
        """As of the base class."""
        if not self._grid:
            return tuple(column[index] for column in self._columns)
        found: list[Override] = []
        for column in reversed(self._columns):
            index, i = divmod(index, len(column))
            found.append(column[i])
        return tuple(reversed(found))


def read_vary(root: tree.Mapping, faults: list[Fault]) -> Sequence[Case]:
    """Cases that follow from the values of some keys."""
    node = root.nodes["vary"]
    combine = _combine(root, faults)
    if isinstance(node, tree.Mapping) and "combine" in node.nodes:
        words = "stands in vary, whose keys are those of a config; it belongs beside vary, at the same indentation"
        faults.append(node.keys["combine"].fault(("vary", "combine"), words))
        node = tree.drop_key(node, "combine")
    keys = list(read_overrides(node, ("vary",), faults))
    if isinstance(node, tree.Mapping) and not node.nodes:
        faults.append(node.position.fault(("vary",), "got an empty mapping; allowed is one dotted key or more"))
    levels = [_values(key, faults) for key in keys]
    if combine is None or not levels or any(level is None for level in levels):
        return []
    values = [level for level in levels if level is not None]
    sizes = [len(level) for level in values]
    if combine == "zip" and len(set(sizes)) > 1:
        lengths = listed([f"{size} of {'.'.join(key.path)}" for key, size in zip(keys, sizes, strict=True)], ", ")
        faults.append(node.position.fault(("vary",), f"got {lengths}; for combine: zip all must be equally many"))
        return []
    count = math.prod(sizes) if combine == "grid" else sizes[0]
    if count > MOST_CASES:
        digits = sum(map(math.log10, sizes))
        told = count if digits < READABLE else f"about 1e{digits:.0f}"
        parts = listed(list(map(str, sizes)), " x ") if combine == "grid" else "zip"
        faults.append(node.position.fault(("vary",), f"got {told} cases ({parts}); at most {MOST_CASES} are allowed"))
        return []
    columns = [
        [Override(key.path, value, value.position) for value in level] for key, level in zip(keys, values, strict=True)
    ]
    return Varied(columns, grid=combine == "grid")


def listed(words: Sequence[str], between: str) -> str:
    """Words in a row; of a great many the first few, and how many more there are."""
    if len(words) <= MOST_LISTED:
        return between.join(words)
    return f"{between.join(words[:MOST_LISTED])}{between}... and {len(words) - MOST_LISTED} more"


def _combine(root: tree.Mapping, faults: list[Fault]) -> str | None:
    node = root.nodes.get("combine")
    if node is None:
        return "grid"
    if isinstance(node, tree.Scalar) and node.value in ("grid", "zip"):
        return str(node.value)
    if not isinstance(node, tree.Broken):
        faults.append(node.position.fault(("combine",), f"got {got(node)}; allowed is one of grid, zip"))
    return None


def _values(key: Override, faults: list[Fault]) -> Sequence[tree.Node] | None:
    """Values of one key of `vary`; None, with a fault, if there are none."""
    path = ("vary", ".".join(key.path))
    node = key.value
    if isinstance(node, tree.Items) and node.nodes:
        return node.nodes
    if isinstance(node, tree.Mapping) and node.nodes:
        return read_range(node, path, MOST_CASES, faults)
    if not isinstance(node, tree.Broken):
        message = f"got {got(node)}; allowed is a list of values, or a mapping with from, to, count and scale"
        faults.append(key.position.fault(path, message))
    return None
