"""Cases of a sweep: named ones, those from values of some keys, and those drawn from ranges, made when they are needed.

What each method of the key `sample` draws stands at `schema.sweep.Sample`.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, overload

from granular_contact.config import tree
from granular_contact.config.overrides import Override, split
from granular_contact.config.schema.sweep import CountedRange, Sample, SweepFile
from granular_contact.errors import Fault
from granular_contact.values.scalars import resolve
from granular_contact.values.strict import listed

_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.+=-]{0,99}")
_NAME_RULE = "a letter or digit, then letters, digits, _ . + = and -, at most 100, and no number, are allowed"


@dataclass(frozen=True)
class Case:
    """One case: its name, which is that of its folder too, and what it replaces, in the order of the file."""

    name: str
    overrides: tuple[Override, ...]
    numbered: bool = False
    """Whether the name is a mere number, which says nothing about the case."""

    @property
    def keys(self) -> list[str]:
        """What is replaced, dotted."""
        return [".".join(one.path) for one in self.overrides]

    @property
    def values(self) -> dict[str, Any]:
        """The replaced keys and their new values, as plain data."""
        return {".".join(one.path): tree.plain(one.value) for one in self.overrides}

    @property
    def has_references(self) -> bool:
        """Whether it names a model or a medium, which is a file."""
        return any(one.is_reference for one in self.overrides)

    @property
    def label(self) -> str:
        """The name, with the values if it is only a number."""
        values = [f"{key} = {value}" for key, value in self.values.items()] if self.numbered else []
        return ", ".join((self.name, listed(values))) if values else self.name


def read_overrides(node: tree.Node | None, path: tree.Path, faults: list[Fault]) -> list[Override]:
    """Overrides of a mapping from dotted keys to values; none if it is not a mapping, which the schema reports."""
    if not isinstance(node, tree.Mapping):
        return []
    read = []
    for key, value in node.nodes.items():
        at = node.keys[key]
        parts = split(key, at, faults, form=f"dotted key: {tree.dotted(path)} has {key!r}")
        if parts is not None:
            read.append(Override(parts, value, at))
    return list(_without_hidden(read, faults))


def _without_hidden(overrides: Sequence[Override], faults: list[Fault]) -> Iterator[Override]:
    """The overrides without those that a later one replaces as a whole, which are faults."""
    for i, one in enumerate(overrides):
        later = next((other for other in overrides[i + 1 :] if one.path[: len(other.path)] == other.path), None)
        if later is None:
            yield one
        else:
            key, line = ".".join(later.path), later.position.line
            faults.append(
                one.position.fault(one.path, f"has no effect, as {key} in line {line} replaces it; swap them")
            )


def named(node: tree.Node, faults: list[Fault]) -> list[Case]:
    """Cases that the file names, in its order, without those that are not mappings, which the schema reports."""
    cases: list[Case] = []
    lines: dict[str, int | None] = {}
    for name, at, path, held in _entries(node):
        if not _NAME.fullmatch(name) or not isinstance(resolve(name), str):
            faults.append(at.fault(path, f"got the name {name!r}; {_NAME_RULE}"))
        elif name.casefold() in lines:  # on some systems these are one folder
            message = f"got the name {name!r}, which line {lines[name.casefold()]} has; each case needs its own"
            faults.append(at.fault(path, message))
        else:
            lines[name.casefold()] = at.line
            cases.append(Case(name, tuple(read_overrides(held, path, faults))))
    return cases


def _entries(node: tree.Node) -> Iterator[tuple[str, tree.Position, tree.Path, tree.Node]]:
    """Name, position, path and content of each case, of a mapping or a list."""
    if isinstance(node, tree.Mapping):
        for name, held in node.nodes.items():
            yield name, node.keys[name], ("cases", name), held
    for i, item in enumerate(node.nodes) if isinstance(node, tree.Items) else ():
        name_node = tree.child(item, "name")
        if isinstance(item, tree.Mapping) and isinstance(name_node, tree.Scalar) and isinstance(name_node.value, str):
            yield name_node.value, name_node.position, ("cases", i), tree.drop_key(item, "name")


class Numbered(Sequence[Case]):
    """Cases that differ in numbers or values only, called case_1 and so on.

    overrides: what the case of an index, from 0, replaces. sample: how they were drawn, if they were.
    """

    def __init__(
        self, count: int, overrides: Callable[[int], tuple[Override, ...]], sample: Sample | None = None
    ) -> None:
        self._count, self._overrides, self.sample = count, overrides, sample

    def __len__(self) -> int:
        return self._count

    @overload
    def __getitem__(self, index: int) -> Case: ...
    @overload
    def __getitem__(self, index: slice) -> Sequence[Case]: ...
    def __getitem__(self, index: int | slice) -> Case | Sequence[Case]:
        if isinstance(index, slice):
            return [self[i] for i in range(self._count)[index]]
        index = range(self._count)[index]
        return Case(f"case_{index + 1:0{len(str(self._count))}d}", self._overrides(index), numbered=True)


def varied(node: tree.Node, file: SweepFile, faults: list[Fault]) -> Sequence[Case]:
    """Cases of `vary`: all combinations (the last key runs fastest), or the values of all keys side by side."""
    keys = read_overrides(node, ("vary",), faults)
    if len(keys) < len(file.vary):
        return []
    columns = [_levels(*one) for one in zip(keys, file.vary.values(), strict=True)]
    if file.combine == "zip":
        return Numbered(min(map(len, columns)), lambda index: tuple(column[index] for column in columns))

    def combination(index: int) -> tuple[Override, ...]:
        found: list[Override] = []
        for column in reversed(columns):
            index, i = divmod(index, len(column))
            found.append(column[i])
        return tuple(reversed(found))

    return Numbered(math.prod(map(len, columns)), combination)


def _levels(key: Override, levels: list[Any] | CountedRange) -> list[Override]:
    """An override for each value of a key of `vary`."""
    if not isinstance(levels, CountedRange):
        assert isinstance(key.value, tree.Items)
        return [Override(key.path, value, value.position) for value in key.value.nodes]
    at = key.value.position
    return [Override(key.path, tree.made(number, at), at) for number in levels.numbers(levels.count)]


def with_long(root: tree.Mapping, path: tuple[str, ...]) -> tree.Mapping:
    """The tree of a file in which each `[from, to]` under the mapping at `path` has the long form."""
    held = root.nodes.get(path[0])
    if not isinstance(held, tree.Mapping):
        return root
    if len(path) > 1:
        return tree.set_key(root, path[0], with_long(held, path[1:]), root.keys[path[0]])
    ranges = held
    for key, node in held.nodes.items():
        if isinstance(node, tree.Items) and len(node.nodes) == 2:
            ends = dict(zip(("from", "to"), node.nodes, strict=True))
            long = tree.Mapping(node.position, ends, dict.fromkeys(ends, node.position))
            ranges = tree.set_key(ranges, key, long, ranges.keys[key])
    return tree.set_key(root, path[0], ranges, root.keys[path[0]])


def sampled(node: tree.Node, sample: Sample, faults: list[Fault]) -> Sequence[Case]:
    """Cases of a sample, whose tree is `node`."""
    keys = read_overrides(tree.find(node, ["ranges"])[0], ("sample", "ranges"), faults)
    if len(keys) < len(sample.ranges):
        return []
    values = draw(sample)

    def row(index: int) -> tuple[Override, ...]:
        numbers = zip(keys, values[index].tolist(), strict=True)
        return tuple(_override(key, value) for key, value in numbers if value == value)

    return Numbered(len(values), row, sample)


def _override(key: Override, value: float) -> Override:
    """A number of a key; a whole one as such, since some keys allow nothing else."""
    at = key.value.position
    tidy = int(value) if value.is_integer() and abs(value) < 2**53 else value
    return Override(key.path, tree.Scalar(at, tidy, repr(value)), at)


def draw(sample: Sample) -> Any:
    """Values (cases, keys) of a sample; NaN where a case leaves a key as the config has it."""
    import numpy as np

    ranges = list(sample.ranges.values())
    if sample.method == "one_at_a_time":
        values = np.full((sample.size, len(ranges)), np.nan)
        for i, held in enumerate(ranges):
            start = 1 + i * sample.count
            values[start : start + sample.count, i] = held.numbers(sample.count)
        return values
    fractions = _fractions(sample)
    columns = [[held.number(f) for f in column] for held, column in zip(ranges, fractions.T.tolist(), strict=True)]
    return np.array(columns).T


def _fractions(sample: Sample) -> Any:
    """Points of the unit cube, (cases, keys)."""
    import numpy as np
    from scipy.stats import qmc

    keys, rng = len(sample.ranges), np.random.default_rng(sample.seed)
    if sample.method == "latin_hypercube":
        return qmc.LatinHypercube(keys, rng=rng).random(sample.count)
    if sample.method == "sobol":
        return qmc.Sobol(keys, rng=rng).random(sample.count)
    # One sequence of twice as many dimensions gives A and B (Saltelli et al. 2010, section 5).
    both = qmc.Sobol(2 * keys, rng=rng).random(sample.count)
    a, b = both[:, :keys], both[:, keys:]
    mixed = np.tile(a, (keys, 1, 1))
    for i in range(keys):
        mixed[i, :, i] = b[:, i]
    return np.concatenate([a, b, *mixed])
