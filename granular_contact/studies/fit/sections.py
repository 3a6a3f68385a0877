"""Keys of a fit file, one by one: parameters, columns, clocks, noise; each fault at its line."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any

from granular_contact.config import tree
from granular_contact.config.messages import got, unknown
from granular_contact.config.overrides import split
from granular_contact.config.sweep_range import is_number
from granular_contact.config.tree import Position
from granular_contact.errors import Fault
from granular_contact.studies.fit.wanted import Wanted

PARAMETER_KEYS = ("from", "to", "start", "scale")
OFFSET_RANGE = (-0.02, 0.02)  # s, of a clock of which nothing is said

Entry = tuple[str, Position, tree.Node | None]


def parameters(holder: tree.Mapping, path: tree.Path, faults: list[Fault]) -> Iterator[Wanted]:
    """Parameters as a list of dotted keys, or a mapping from them to bounds."""
    node, path = holder.nodes.get("parameters"), (*path, "parameters")
    if node is None or isinstance(node, tree.Broken):
        return
    if isinstance(node, tree.Mapping) and node.nodes:
        entries: list[Entry] = [(key, node.keys[key], held) for key, held in node.nodes.items()]
    elif isinstance(node, tree.Items) and node.nodes and all(_is_text_node(item) for item in node.nodes):
        entries = [(str(tree.plain(item)), item.position, None) for item in node.nodes]
    else:
        words = f"got {got(node)}; allowed is a list of dotted keys, or a mapping from them to their bounds"
        faults.append(node.position.fault(path, words))
        return
    seen: set[str] = set()
    for name, at, held in entries:
        parts = split(name, at, faults, form=f"dotted key: {'.'.join(map(str, path))} has {name!r}")
        if parts is None:
            continue
        if name in seen:
            faults.append(at.fault(path, f"names {name} twice; once is allowed"))
        seen.add(name)
        yield _wanted(parts, at, held, (*path, name), faults)


def _wanted(key: tuple[str, ...], at: Position, node: tree.Node | None, path: tree.Path, faults: list[Fault]) -> Wanted:
    if node is None or (isinstance(node, tree.Scalar) and node.value is None) or isinstance(node, tree.Broken):
        return Wanted(key, at)
    if not isinstance(node, tree.Mapping):
        words = f"got {got(node)}; allowed is a mapping with {', '.join(PARAMETER_KEYS)}, or nothing"
        faults.append(node.position.fault(path, words))
        return Wanted(key, at)
    refuse_unknown(node, path, PARAMETER_KEYS, faults)
    low, high, start = (value(node, path, k, "a finite number", is_number, faults, None) for k in PARAMETER_KEYS[:3])
    scale = value(node, path, "scale", "one of log, linear", lambda v: v in ("log", "linear"), faults, None)
    if low is not None and high is not None and low >= high:
        faults.append(at.fault(path, f"got bounds from {low:g} to {high:g}; the first must be below the second"))
    elif start is not None and ((low is not None and start < low) or (high is not None and start > high)):
        bounds = f"from {'-inf' if low is None else f'{low:g}'} to {'inf' if high is None else f'{high:g}'}"
        faults.append(at.fault((*path, "start"), f"got {start:g}, which is not within the bounds {bounds}"))
    elif scale == "log" and any(one is not None and one <= 0.0 for one in (low, high, start)):
        faults.append(at.fault((*path, "scale"), "got log, for which bounds and start must be above 0"))
    return Wanted(key, at, low, high, start, scale)


def columns(holder: tree.Mapping, path: tree.Path, faults: list[Fault]) -> dict[str, tuple[str, Position]]:
    """Names in the CSV file, each with its place, by what they hold."""
    node, path = holder.nodes["columns"], (*path, "columns")
    if isinstance(node, tree.Mapping) and node.nodes and all(_is_text_node(held) for held in node.nodes.values()):
        return {name: (str(tree.plain(held)), node.keys[name]) for name, held in node.nodes.items()}
    if not isinstance(node, tree.Broken):
        words = "allowed is a mapping from time_s, pivot_angle_deg and the like to names in the CSV file"
        faults.append(node.position.fault(path, f"got {got(node)}; {words}"))
    return {}


def offset(holder: tree.Mapping, path: tree.Path, faults: list[Fault]) -> float | Wanted:
    """A known offset (s), or the bounds of one to be found."""
    node, path = holder.nodes["time_offset_s"], (*path, "time_offset_s")
    if isinstance(node, tree.Scalar) and is_number(node.value):
        return float(tree.plain(node))
    if isinstance(node, tree.Scalar) and node.value == "fit":
        return Wanted(("time_offset_s",), node.position, *OFFSET_RANGE, 0.0, "linear")
    if isinstance(node, tree.Mapping):
        found = _wanted(("time_offset_s",), node.position, node, path, faults)
        if found.low is not None and found.high is not None:
            start = found.start if found.start is not None else min(max(0.0, found.low), found.high)
            return Wanted(found.key, found.position, found.low, found.high, start, "linear")
        faults.append(node.position.fault(path, "needs both from and to"))
    elif not isinstance(node, tree.Broken):
        words = f"got {got(node)}; allowed are fit, a number, and a mapping with from and to"
        faults.append(node.position.fault(path, words))
    return 0.0


def noise(root: tree.Mapping, faults: list[Fault]) -> Iterator[tuple[str, tuple[float, Position]]]:
    """Measured columns and their noise, each with its place."""
    node = root.nodes.get("noise")
    if node is None or isinstance(node, tree.Broken):
        return
    if not isinstance(node, tree.Mapping):
        words = f"got {got(node)}; allowed is a mapping from columns to their noise, as tip_x_mm: 0.1"
        faults.append(node.position.fault(("noise",), words))
        return
    for name, held in node.nodes.items():
        size = tree.plain(held)
        if is_number(size) and size > 0:
            yield name, (float(size), node.keys[name])
        elif not isinstance(held, tree.Broken):
            faults.append(held.position.fault(("noise", name), f"got {got(held)}; allowed is a number above 0"))


def refuse_unknown(node: tree.Mapping, path: tree.Path, known: Sequence[str], faults: list[Fault]) -> None:
    """A fault for each key that is none of the `known`."""
    for key, at in node.keys.items():
        if key not in known:
            faults.append(at.fault((*path, key), f"unknown key; {unknown(key, known)}"))


_NEEDED = object()


def value(
    node: tree.Mapping,
    path: tree.Path,
    key: str,
    allowed: str,
    fits: Callable[[Any], bool],
    faults: list[Fault],
    default: Any = _NEEDED,
) -> Any:
    """Value of a key; its default, or None with a fault, where there is none that fits."""
    held = node.nodes.get(key)
    if held is None:
        if default is _NEEDED:
            faults.append(node.position.fault((*path, key), f"is missing; allowed is {allowed}"))
            return None
        return default
    if isinstance(held, tree.Scalar) and fits(held.value):
        return held.value
    if not isinstance(held, tree.Broken):
        faults.append(held.position.fault((*path, key), f"got {got(held)}; allowed is {allowed}"))
    return None


def is_text(value: Any) -> bool:
    """Whether a value is text that says something."""
    return isinstance(value, str) and bool(value.strip())


def _is_text_node(node: tree.Node) -> bool:
    return isinstance(node, tree.Scalar) and is_text(node.value)
