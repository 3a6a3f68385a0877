"""Cases of a sweep: named ones, and those from values of some keys, made when they are needed."""

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
