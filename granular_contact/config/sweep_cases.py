"""Cases of a sweep: named cases, combinations of values of keys, and samples from ranges. They are made on demand.

`schema.sweep.Sample` describes the sampling methods.
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
    """One case of a sweep.

    name: name of the case and of its folder; overrides: values that it replaces, in the order of the file; numbered:
    whether the name only contains the number of the case.
    """

    name: str
    overrides: tuple[Override, ...]
    numbered: bool = False

    @property
    def keys(self) -> list[str]:
        """Dotted keys of the replaced values."""
        return [".".join(override.path) for override in self.overrides]

    @property
    def values(self) -> dict[str, Any]:
        """New values by dotted key, as plain data."""
        return {".".join(override.path): tree.plain(override.value) for override in self.overrides}

    @property
    def has_references(self) -> bool:
        """Whether the case names a model or a medium, which is a file."""
        return any(override.is_reference for override in self.overrides)

    @property
    def label(self) -> str:
        """The name, with the values if the name is only a number."""
        values = [f"{key} = {value}" for key, value in self.values.items()] if self.numbered else []
        return ", ".join((self.name, listed(values))) if values else self.name


def read_overrides(node: tree.Node | None, path: tree.Path, faults: list[Fault]) -> list[Override]:
    """Overrides of a mapping from dotted keys to values at `path`; none for another node, which the schema reports."""
    if not isinstance(node, tree.Mapping):
        return []
    overrides = []
    for key, value in node.nodes.items():
        at = node.keys[key]
        parts = split(key, at, faults, form=f"dotted key: {tree.dotted(path)} has {key!r}")
        if parts is not None:
            overrides.append(Override(parts, value, at))
    return list(_without_hidden(overrides, faults))


def _without_hidden(overrides: Sequence[Override], faults: list[Fault]) -> Iterator[Override]:
    """The overrides without those whose value a later one replaces as a whole; these are faults."""
    for i, override in enumerate(overrides):
        path = override.path
        later = next((other for other in overrides[i + 1 :] if path[: len(other.path)] == other.path), None)
        if later is None:
            yield override
        else:
            key, line = ".".join(later.path), later.position.line
            message = f"has no effect, as {key} in line {line} replaces it; swap them"
            faults.append(override.position.fault(path, message))


def named_cases(node: tree.Node, faults: list[Fault]) -> list[Case]:
    """Cases under `cases`, in the order of the file, without those that are no mapping, which the schema reports."""
    cases: list[Case] = []
    lines: dict[str, int | None] = {}
    for name, at, path, content in _entries(node):
        if not _NAME.fullmatch(name) or not isinstance(resolve(name), str):
            faults.append(at.fault(path, f"got the name {name!r}; {_NAME_RULE}"))
        elif name.casefold() in lines:  # some file systems do not distinguish upper and lower case
            message = f"got the name {name!r}, which line {lines[name.casefold()]} has; each case needs its own"
            faults.append(at.fault(path, message))
        else:
            lines[name.casefold()] = at.line
            cases.append(Case(name, tuple(read_overrides(content, path, faults))))
    return cases


def _entries(node: tree.Node) -> Iterator[tuple[str, tree.Position, tree.Path, tree.Node]]:
    """Name, position, path and content of each case, from a mapping or a list."""
    if isinstance(node, tree.Mapping):
        for name, content in node.nodes.items():
            yield name, node.keys[name], ("cases", name), content
    for i, item in enumerate(node.nodes) if isinstance(node, tree.Items) else ():
        name_node = tree.child(item, "name")
        if isinstance(item, tree.Mapping) and isinstance(name_node, tree.Scalar) and isinstance(name_node.value, str):
            yield name_node.value, name_node.position, ("cases", i), tree.drop_key(item, "name")


class Numbered(Sequence[Case]):
    """Cases with the names case_1 and so on, made on demand.

    overrides: gives the overrides of the case with an index, from 0. sample: the sample that the cases come from, or
    None.
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


def varied_cases(node: tree.Node, file: SweepFile, faults: list[Fault]) -> Sequence[Case]:
    """Cases of `vary`: all combinations (the values of the last key change fastest), or pairs of values (zip)."""
    keys = read_overrides(node, ("vary",), faults)
    if len(keys) < len(file.vary):
        return []
    columns = [_levels(key, levels) for key, levels in zip(keys, file.vary.values(), strict=True)]
    if file.combine == "zip":
        return Numbered(min(map(len, columns)), lambda index: tuple(column[index] for column in columns))

    def combination(index: int) -> tuple[Override, ...]:
        overrides: list[Override] = []
        for column in reversed(columns):
            index, i = divmod(index, len(column))
            overrides.append(column[i])
        return tuple(reversed(overrides))

    return Numbered(math.prod(map(len, columns)), combination)


def _levels(key: Override, levels: list[Any] | CountedRange) -> list[Override]:
    """An override for each value of a key of `vary`."""
    if not isinstance(levels, CountedRange):
        assert isinstance(key.value, tree.Items)
        return [Override(key.path, value, value.position) for value in key.value.nodes]
    at = key.value.position
    return [Override(key.path, tree.from_plain(number, at), at) for number in levels.numbers(levels.count)]


def with_long_ranges(root: tree.Mapping, path: tuple[str, ...]) -> tree.Mapping:
    """The tree of a file in which each range `[from, to]` under the mapping at `path` is a mapping with these keys."""
    below = root.nodes.get(path[0])
    if not isinstance(below, tree.Mapping):
        return root
    if len(path) > 1:
        return tree.set_key(root, path[0], with_long_ranges(below, path[1:]), root.keys[path[0]])
    ranges = below
    for key, node in below.nodes.items():
        if isinstance(node, tree.Items) and len(node.nodes) == 2:
            ends = dict(zip(("from", "to"), node.nodes, strict=True))
            long_range = tree.Mapping(node.position, ends, dict.fromkeys(ends, node.position))
            ranges = tree.set_key(ranges, key, long_range, ranges.keys[key])
    return tree.set_key(root, path[0], ranges, root.keys[path[0]])


def sampled_cases(node: tree.Node, sample: Sample, faults: list[Fault]) -> Sequence[Case]:
    """Cases of a sample; node: its tree."""
    keys = read_overrides(tree.find(node, ["ranges"])[0], ("sample", "ranges"), faults)
    if len(keys) < len(sample.ranges):
        return []
    values = draw(sample)

    def overrides(index: int) -> tuple[Override, ...]:
        numbers = zip(keys, values[index].tolist(), strict=True)
        return tuple(_override(key, value) for key, value in numbers if not math.isnan(value))

    return Numbered(len(values), overrides, sample)


def _override(key: Override, value: float) -> Override:
    """Override of a key with a number. A whole number becomes an integer, since some keys allow integers alone."""
    at = key.value.position
    number = int(value) if value.is_integer() and abs(value) < 2**53 else value
    return Override(key.path, tree.Scalar(at, number, repr(value)), at)


def draw(sample: Sample) -> Any:
    """Sampled values (cases, keys); NaN if a case keeps the value of the config."""
    import numpy as np

    ranges = list(sample.ranges.values())
    if sample.method == "one_at_a_time":
        values = np.full((sample.size, len(ranges)), np.nan)
        for i, interval in enumerate(ranges):
            start = 1 + i * sample.count
            values[start : start + sample.count, i] = interval.numbers(sample.count)
        return values
    pairs = zip(ranges, _fractions(sample).T.tolist(), strict=True)
    columns = [[interval.number(fraction) for fraction in column] for interval, column in pairs]
    return np.array(columns).T


def _fractions(sample: Sample) -> Any:
    """Sampled points (cases, keys) in the unit cube."""
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
