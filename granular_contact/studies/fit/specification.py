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

from collections.abc import Callable, Iterator
from dataclasses import replace
from os import PathLike
from pathlib import Path
from typing import Any

from granular_contact.config import tree
from granular_contact.config.load import by_place
from granular_contact.config.messages import got, kind_of
from granular_contact.config.sweep_cases import read_set
from granular_contact.config.sweep_range import whole
from granular_contact.config.yaml_source import read_file
from granular_contact.errors import ConfigError, Fault
from granular_contact.studies.fit import sections
from granular_contact.studies.fit.wanted import RunWanted, Specification

KEYS = ("runs", "parameters", "set", "columns", "time_offset_s", "noise", "loss", "starts", "seed")
RUN_KEYS = ("name", "config", "data", "set", "columns", "time_offset_s", "parameters")
LOSSES = ("soft_l1", "linear")
MOST_RUNS, MOST_STARTS = 1000, 1024
DEFAULT_STARTS = 8


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
            words = f"is no fit file: it holds {kind_of(root)}; allowed is a mapping with the keys {', '.join(KEYS)}"
            faults.append(root.position.fault((), words))
        raise ConfigError(sorted(faults, key=by_place))
    reader = _Reader(root, path, faults)
    sections.refuse_unknown(root, (), KEYS, faults)
    found = Specification(
        name=path.stem,
        runs=tuple(reader.runs()),
        parameters=tuple(sections.parameters(root, (), faults)),
        common=tuple(read_set(root, faults)),
        noise=dict(sections.noise(root, faults)),
        loss=sections.value(root, (), "loss", "one of soft_l1, linear", lambda v: v in LOSSES, faults, "soft_l1"),
        starts=sections.value(
            root,
            (),
            "starts",
            f"a whole number from 1 to {MOST_STARTS}",
            whole(1, MOST_STARTS),
            faults,
            DEFAULT_STARTS,
        ),
        seed=sections.value(root, (), "seed", "a whole number from 0 to 999999", whole(0, 999_999), faults, 0),
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
        sections.refuse_unknown(node, path, RUN_KEYS, faults)
        config = sections.value(node, path, "config", "the path of a config", sections.is_text, faults)
        data = sections.value(node, path, "data", "the path of a CSV file", sections.is_text, faults)
        name = sections.value(node, path, "name", "text", sections.is_text, faults, data and Path(data).stem)
        overrides = tuple(read_set(node, faults))
        columns = self._own_or_common(node, path, "columns", sections.columns)
        offset = self._own_or_common(node, path, "time_offset_s", sections.offset)
        parameters = tuple(sections.parameters(node, path, faults))
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
