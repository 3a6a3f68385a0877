"""The keys `set`, `cases`, `vary` and `combine` of a sweep file -> named cases of overrides."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

from granular_contact.config import tree
from granular_contact.config.messages import got, unknown
from granular_contact.config.overrides import Override, split
from granular_contact.config.scalars import resolve
from granular_contact.config.sweep_range import read_range
from granular_contact.errors import Fault

KEYS = ("config", "set", "cases", "vary", "combine")
MOST_CASES = 100_000
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
    def label(self) -> str:
        """The name, with the values where the name tells nothing."""
        if not self.numbered:
            return self.name
        return f"{self.name}, " + ", ".join(f"{key} = {value}" for key, value in self.values.items())


def read_set(root: tree.Mapping, faults: list[Fault]) -> list[Override]:
    """What `set` replaces in every case."""
    node = root.nodes.get("set")
    return [] if node is None else list(_overrides(node, ("set",), faults))


def read_cases(root: tree.Mapping, faults: list[Fault]) -> list[Case]:
    """Cases of a sweep whose keys are checked here too, in the order of the file."""
    for key, at in root.keys.items():
        if key not in KEYS:
            faults.append(at.fault((key,), f"unknown key; {unknown(key, KEYS)}"))
    given = [key for key in ("cases", "vary") if key in root.nodes]
    if len(given) != 1:
        amount = "both" if given else "neither"
        faults.append(root.position.fault((), f"got {amount} of cases and vary; exactly one is allowed"))
        return []
    if given == ["vary"]:
        return _varied(root, faults)
    if "combine" in root.nodes:
        faults.append(root.keys["combine"].fault(("combine",), "unknown key; it tells how vary is combined, not cases"))
    return _named(root.nodes["cases"], faults)


def _overrides(node: tree.Node, path: tree.Path, faults: list[Fault]) -> Iterator[Override]:
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


def _named(node: tree.Node, faults: list[Fault]) -> list[Case]:
    """Cases that the file names one by one."""
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
            cases.append(Case(name, tuple(_overrides(held, path, faults))))
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


def _varied(root: tree.Mapping, faults: list[Fault]) -> list[Case]:
    """Cases that follow from the values of some keys."""
    node = root.nodes["vary"]
    combine = _combine(root, faults)
    keys = list(_overrides(node, ("vary",), faults))
    if isinstance(node, tree.Mapping) and not node.nodes:
        faults.append(node.position.fault(("vary",), "got an empty mapping; allowed is one dotted key or more"))
    levels = [_values(key, faults) for key in keys]
    if combine is None or not levels or any(level is None for level in levels):
        return []
    values = [level for level in levels if level is not None]
    sizes = [len(level) for level in values]
    if combine == "zip" and len(set(sizes)) > 1:
        lengths = ", ".join(f"{size} of {'.'.join(key.path)}" for key, size in zip(keys, sizes, strict=True))
        faults.append(node.position.fault(("vary",), f"got {lengths}; for combine: zip all must be equally many"))
        return []
    count = math.prod(sizes) if combine == "grid" else sizes[0]
    if count > MOST_CASES:
        parts = " x ".join(map(str, sizes)) if combine == "grid" else "zip"
        faults.append(node.position.fault(("vary",), f"got {count} cases ({parts}); at most {MOST_CASES} are allowed"))
        return []
    columns = [
        [Override(key.path, value, value.position) for value in level] for key, level in zip(keys, values, strict=True)
    ]
    rows = product(*columns) if combine == "grid" else zip(*columns, strict=True)
    width = len(str(count))
    return [Case(f"case_{i:0{width}d}", row, numbered=True) for i, row in enumerate(rows, 1)]


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
