"""A fit file, or what the command line says in its place -> Specification: names, bounds and options.

parameters:                                   # shared by all runs
  medium.eta_d: {from: 1, to: 40}             # start: what the config has; scale: log or linear
  medium.eta_h:                               # bounds follow from the start
set: {method.reduced.modes: 0}                # for all runs, as columns and time_offset_s may be
runs:
  - {config: slow.yaml, data: slow.csv}
  - config: fast.yaml
    data: fast.csv
    columns: {time_ms: t, tip_x_mm: X, tip_y_mm: Y}
    time_offset_s: fit                        # or a number, or {from: -0.01, to: 0.01}
    parameters: {initial.impact_speed_rad_s: {from: 8, to: 9}}
noise: {tip_x_mm: 0.1}                        # estimated where it is not given
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import isfinite
from os import PathLike
from pathlib import Path
from typing import Any

from granular_contact.config import tree
from granular_contact.config.load import by_place
from granular_contact.config.messages import got, unknown
from granular_contact.config.overrides import Override, split
from granular_contact.config.sweep_cases import read_set
from granular_contact.config.tree import Position
from granular_contact.config.yaml_source import read_file
from granular_contact.errors import ConfigError, Fault
from granular_contact.fit.problem import Loss

KEYS = ("runs", "parameters", "set", "columns", "time_offset_s", "noise", "loss", "starts", "seed")
RUN_KEYS = ("name", "config", "data", "set", "columns", "time_offset_s", "parameters")
PARAMETER_KEYS = ("from", "to", "start", "scale")
LOSSES = ("soft_l1", "linear")
MOST_RUNS, MOST_STARTS = 1000, 1024
DEFAULT_STARTS = 8
OFFSET_RANGE = (-0.02, 0.02)  # s, of a clock of which nothing is said


@dataclass(frozen=True)
class Wanted:
    """A parameter as asked for; None where nothing was said."""

    key: tuple[str, ...]
    position: Position
    low: float | None = None
    high: float | None = None
    start: float | None = None
    scale: str | None = None

    @property
    def name(self) -> str:
        """The dotted key."""
        return ".".join(self.key)

    @property
    def bounds(self) -> tuple[float, float, float]:
        """Lower and upper bound and start, of one that has all three."""
        if self.low is None or self.high is None or self.start is None:
            raise ValueError(f"{self.name} has no bounds")
        return self.low, self.high, self.start


@dataclass(frozen=True)
class RunWanted:
    """One run as asked for. columns: measured name -> header and place; offset: a number (s), or bounds for one."""

    name: str
    config: Path
    data: Path
    at_config: Position
    at_data: Position
    overrides: tuple[Override, ...] = ()
    columns: Mapping[str, tuple[str, Position]] = field(default_factory=dict)
    offset: float | Wanted = 0.0
    parameters: tuple[Wanted, ...] = ()


@dataclass(frozen=True)
class Specification:
    """A fit as asked for. noise: measured name -> value and place."""

    name: str
    runs: tuple[RunWanted, ...]
    parameters: tuple[Wanted, ...]
    common: tuple[Override, ...]
    noise: Mapping[str, tuple[float, Position]]
    loss: Loss
    starts: int
    seed: int


def is_fit(path: str | PathLike[str]) -> bool:
    """Whether the file at `path` means to be a fit file; False for one that can't be read."""
    root = read_file(Path(path), [])
    return isinstance(root, tree.Mapping) and "runs" in root.nodes


def load_specification(path: str | PathLike[str]) -> Specification:
    """Specification of a fit file; raises ConfigError with every fault of it."""
    path = Path(path)
    faults: list[Fault] = []
    return specification(read_file(path, faults), path, faults)


def specification(root: tree.Node, path: Path, faults: list[Fault]) -> Specification:
    """Specification of the tree of a fit file in `path`, whose folder files are looked for in.

    Raises
    ------
    ConfigError
        With `faults` and every other one.
    """
    if not isinstance(root, tree.Mapping):
        if not isinstance(root, tree.Broken):
            words = f"got {got(root)}; allowed is a mapping with the keys {', '.join(KEYS)}"
            faults.append(root.position.fault((), words))
        raise ConfigError(sorted(faults, key=by_place))
    reader = _Reader(root, path, faults)
    _refuse_unknown(root, (), KEYS, faults)
    found = Specification(
        name=path.stem,
        runs=tuple(reader.runs()),
        parameters=tuple(_parameters(root, (), faults)),
        common=tuple(read_set(root, faults)),
        noise=dict(_noise(root, faults)),
        loss=_value(root, (), "loss", "one of soft_l1, linear", lambda v: v in LOSSES, faults, "soft_l1"),
        starts=_value(
            root,
            (),
            "starts",
            f"a whole number from 1 to {MOST_STARTS}",
            _count(1, MOST_STARTS),
            faults,
            DEFAULT_STARTS,
        ),
        seed=_value(root, (), "seed", "a whole number from 0 to 999999", _count(0, 999_999), faults, 0),
    )
    if not found.parameters and not any(run.parameters for run in found.runs) and not faults:
        at = root.keys.get("parameters", root.position)
        faults.append(at.fault(("parameters",), "names none; allowed are dotted keys of the config, as medium.eta_h"))
    if faults:
        raise ConfigError(sorted(dict.fromkeys(faults), key=by_place))
    return found


class _Reader:
    """Reads the runs; what they leave open stands at the top of the file."""

    def __init__(self, root: tree.Mapping, path: Path, faults: list[Fault]) -> None:
        self._root, self._folder, self._faults = root, path.parent, faults

    def runs(self) -> Iterator[RunWanted]:
        node = self._root.nodes.get("runs")
        if node is None:
            self._faults.append(
                self._root.position.fault(("runs",), "is missing; allowed is a list of one run or more")
            )
        elif not isinstance(node, tree.Items) or not 0 < len(node.nodes) <= MOST_RUNS:
            if not isinstance(node, tree.Broken):
                words = f"got {got(node)}; allowed is a list of one run or more, to {MOST_RUNS}"
                self._faults.append(node.position.fault(("runs",), words))
        else:
            names: set[str] = set()
            for i, item in enumerate(node.nodes):
                run = self._run(item, i)
                if run is not None:
                    yield self._named(run, names)

    def _run(self, node: tree.Node, index: int) -> RunWanted | None:
        path, faults = ("runs", index), self._faults
        if not isinstance(node, tree.Mapping):
            if not isinstance(node, tree.Broken):
                words = f"got {got(node)}; allowed is a mapping with the keys {', '.join(RUN_KEYS)}"
                faults.append(node.position.fault(path, words))
            return None
        _refuse_unknown(node, path, RUN_KEYS, faults)
        config = _value(node, path, "config", "the path of a config", _is_text, faults)
        data = _value(node, path, "data", "the path of a CSV file", _is_text, faults)
        name = _value(node, path, "name", "text", _is_text, faults, data and Path(data).stem)
        overrides = tuple(read_set(node, faults))
        columns = self._own_or_common(node, path, "columns", _columns)
        offset = self._own_or_common(node, path, "time_offset_s", _offset)
        parameters = tuple(_parameters(node, path, faults))
        if config is None or data is None or name is None:
            return None
        return RunWanted(
            name,
            self._folder / config,
            self._folder / data,
            node.nodes["config"].position,
            node.nodes["data"].position,
            overrides,
            {} if columns is None else columns,
            0.0 if offset is None else offset,
            parameters,
        )

    def _own_or_common(self, node: tree.Mapping, path: tree.Path, key: str, read: Callable[..., Any]) -> Any:
        if key in node.nodes:
            return read(node, path, self._faults)
        return read(self._root, (), self._faults) if key in self._root.nodes else None

    def _named(self, run: RunWanted, names: set[str]) -> RunWanted:
        """The run under a name that no other has: two files of one name get a number."""
        name, count = run.name, 2
        while name.casefold() in names:
            name, count = f"{run.name}_{count}", count + 1
        names.add(name.casefold())
        return replace(run, name=name)


Entry = tuple[str, Position, tree.Node | None]


def _parameters(holder: tree.Mapping, path: tree.Path, faults: list[Fault]) -> Iterator[Wanted]:
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
    _refuse_unknown(node, path, PARAMETER_KEYS, faults)
    low, high, start = (_value(node, path, k, "a finite number", _is_number, faults, None) for k in PARAMETER_KEYS[:3])
    scale = _value(node, path, "scale", "one of log, linear", lambda v: v in ("log", "linear"), faults, None)
    if low is not None and high is not None and low >= high:
        faults.append(at.fault(path, f"got bounds from {low:g} to {high:g}; the first must be below the second"))
    elif start is not None and ((low is not None and start < low) or (high is not None and start > high)):
        bounds = f"from {'-inf' if low is None else f'{low:g}'} to {'inf' if high is None else f'{high:g}'}"
        faults.append(at.fault((*path, "start"), f"got {start:g}, which is not within the bounds {bounds}"))
    elif scale == "log" and any(value is not None and value <= 0.0 for value in (low, high, start)):
        faults.append(at.fault((*path, "scale"), "got log, for which bounds and start must be above 0"))
    return Wanted(key, at, low, high, start, scale)


def _columns(holder: tree.Mapping, path: tree.Path, faults: list[Fault]) -> dict[str, tuple[str, Position]]:
    node, path = holder.nodes["columns"], (*path, "columns")
    if isinstance(node, tree.Mapping) and node.nodes and all(_is_text_node(held) for held in node.nodes.values()):
        return {name: (str(tree.plain(held)), node.keys[name]) for name, held in node.nodes.items()}
    if not isinstance(node, tree.Broken):
        words = "allowed is a mapping from time_s, pivot_angle_deg and the like to names in the CSV file"
        faults.append(node.position.fault(path, f"got {got(node)}; {words}"))
    return {}


def _offset(holder: tree.Mapping, path: tree.Path, faults: list[Fault]) -> float | Wanted:
    """A known offset (s), or the bounds of one to be found."""
    node, path = holder.nodes["time_offset_s"], (*path, "time_offset_s")
    if isinstance(node, tree.Scalar) and _is_number(node.value):
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


def _noise(root: tree.Mapping, faults: list[Fault]) -> Iterator[tuple[str, tuple[float, Position]]]:
    node = root.nodes.get("noise")
    if node is None or isinstance(node, tree.Broken):
        return
    if not isinstance(node, tree.Mapping):
        words = f"got {got(node)}; allowed is a mapping from columns to their noise, as tip_x_mm: 0.1"
        faults.append(node.position.fault(("noise",), words))
        return
    for name, held in node.nodes.items():
        value = tree.plain(held)
        if _is_number(value) and value > 0:
            yield name, (float(value), node.keys[name])
        elif not isinstance(held, tree.Broken):
            faults.append(held.position.fault(("noise", name), f"got {got(held)}; allowed is a number above 0"))


def _refuse_unknown(node: tree.Mapping, path: tree.Path, known: Sequence[str], faults: list[Fault]) -> None:
    for key, at in node.keys.items():
        if key not in known:
            faults.append(at.fault((*path, key), f"unknown key; {unknown(key, known)}"))


_NEEDED = object()


def _value(
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


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and isfinite(value)


def _is_text(value: Any) -> bool:
    return isinstance(value, str) and bool(value.strip())


def _is_text_node(node: tree.Node) -> bool:
    return isinstance(node, tree.Scalar) and _is_text(node.value)


def _count(least: int, most: int) -> Callable[[Any], bool]:
    return lambda value: isinstance(value, int) and not isinstance(value, bool) and least <= value <= most
