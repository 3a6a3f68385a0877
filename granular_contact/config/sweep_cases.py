"""What a case is, and the keys `set` and `cases` of a sweep file -> overrides, and named cases of them."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from granular_contact.config import tree
from granular_contact.config.messages import got
from granular_contact.config.overrides import Override, split
from granular_contact.errors import Fault
from granular_contact.values.scalars import resolve

MOST_CASES = 100_000
MOST_SAID = 6  # values of a case, where it is named
_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.+=-]{0,99}")
_NAME_RULE = "a letter or digit, then letters, digits, _ . + = and -, at most 100, and no number, are allowed"


@dataclass(frozen=True)
class Case:
    """One case: its name, which is that of its folder too, and what it replaces, in the order of the file."""

    name: str
    overrides: tuple[Override, ...]
    numbered: bool = False
    """Whether the name is a mere number, that tells nothing about the case."""

    @property
    def keys(self) -> list[str]:
        """What is replaced, dotted."""
        return [".".join(one.path) for one in self.overrides]

    @property
    def values(self) -> dict[str, Any]:
        """What is replaced and what stands there now, as plain data."""
        return {".".join(one.path): tree.plain(one.value) for one in self.overrides}

    @property
    def has_references(self) -> bool:
        """Whether it names a model or a medium, which is a file."""
        return any(one.is_reference for one in self.overrides)

    @property
    def label(self) -> str:
        """The name, with the values where the name tells nothing."""
        if not self.numbered:
            return self.name
        said = [f"{key} = {value}" for key, value in self.values.items()]
        more = [f"and {len(said) - MOST_SAID} more"] if len(said) > MOST_SAID else []
        return ", ".join((self.name, *said[:MOST_SAID], *more))


def read_set(root: tree.Mapping, faults: list[Fault]) -> list[Override]:
    """What `set` replaces in every case."""
    node = root.nodes.get("set")
    return [] if node is None else list(read_overrides(node, ("set",), faults))


def read_overrides(node: tree.Node, path: tree.Path, faults: list[Fault]) -> Iterator[Override]:
    """Overrides of a mapping from dotted keys to values."""
    if isinstance(node, tree.Mapping):
        read = [one for key in node.nodes if (one := _override(node, key, path, faults)) is not None]
        yield from _without_hidden(read, faults)
    elif not isinstance(node, tree.Broken):
        faults.append(node.position.fault(path, f"got {got(node)}; allowed is a mapping from dotted keys to values"))


def _override(node: tree.Mapping, key: str, path: tree.Path, faults: list[Fault]) -> Override | None:
    at = node.keys[key]
    parts = split(key, at, faults, form=f"dotted key: {'.'.join(map(str, path))} has {key!r}")
    return None if parts is None else Override(parts, node.nodes[key], at)


def _without_hidden(overrides: Sequence[Override], faults: list[Fault]) -> Iterator[Override]:
    """The overrides but for those, a fault each, that have no effect as a later one replaces all around them."""
    for i, one in enumerate(overrides):
        later = next((other for other in overrides[i + 1 :] if one.path[: len(other.path)] == other.path), None)
        if later is None:
            yield one
        else:
            key, line = ".".join(later.path), later.position.line
            faults.append(
                one.position.fault(one.path, f"has no effect, as {key} in line {line} replaces it; swap them")
            )


def read_named(node: tree.Node, faults: list[Fault]) -> list[Case]:
    """Cases that the file names one by one, in its order."""
    if isinstance(node, tree.Broken):
        return []
    if not isinstance(node, tree.Mapping | tree.Items) or not node.nodes:
        message = f"got {got(node)}; allowed is a mapping or a list of one case or more"
        faults.append(node.position.fault(("cases",), message))
        return []
    if len(node.nodes) > MOST_CASES:
        faults.append(node.position.fault(("cases",), f"got {len(node.nodes)} cases; at most {MOST_CASES} are allowed"))
        return []
    cases: list[Case] = []
    lines: dict[str, int | None] = {}
    for name, at, path, held in _entries(node, faults):
        if not _NAME.fullmatch(name) or not isinstance(resolve(name), str):
            faults.append(at.fault(path, f"got the name {name!r}; {_NAME_RULE}"))
        elif name.casefold() in lines:  # on some systems these are one folder
            message = f"got the name {name!r}, which line {lines[name.casefold()]} has; each case needs its own"
            faults.append(at.fault(path, message))
        else:
            lines[name.casefold()] = at.line
            cases.append(Case(name, tuple(read_overrides(held, path, faults))))
    return cases


def _entries(
    node: tree.Mapping | tree.Items, faults: list[Fault]
) -> Iterator[tuple[str, tree.Position, tree.Path, tree.Node]]:
    """Name, its place, path and content of each case, whichever way they are listed."""
    if isinstance(node, tree.Mapping):
        for name, held in node.nodes.items():
            yield name, node.keys[name], ("cases", name), held
        return
    for i, item in enumerate(node.nodes):
        path = ("cases", i)
        if not isinstance(item, tree.Mapping):
            if not isinstance(item, tree.Broken):
                faults.append(item.position.fault(path, f"got {got(item)}; allowed is a mapping with a name"))
            continue
        name_node = item.nodes.get("name")
        if name_node is None:
            faults.append(item.position.fault((*path, "name"), "is missing; allowed is text"))
        elif not isinstance(name_node, tree.Scalar) or not isinstance(name_node.value, str):
            if not isinstance(name_node, tree.Broken):
                faults.append(name_node.position.fault((*path, "name"), f"got {got(name_node)}; allowed is text"))
        else:
            yield name_node.value, name_node.position, path, tree.drop_key(item, "name")
