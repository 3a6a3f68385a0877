"""Specification of a fit: runs, parameters and options, as written in a fit file or on the command line.

The keys of a fit file are in `config.schema.fit`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from os import PathLike
from pathlib import Path

from granular_contact import examples
from granular_contact.config import tree
from granular_contact.config.messages import by_place, root_of_kind, validated
from granular_contact.config.overrides import Override, split
from granular_contact.config.schema.fit import OFFSET_RANGE, Bounds, ClockBounds, FitFile, FitRun, ForceTest
from granular_contact.config.sweep_cases import read_overrides
from granular_contact.config.tree import Position
from granular_contact.config.yaml_source import read_file
from granular_contact.errors import ConfigError, Fault


def search_range(zero: str | float | ClockBounds | None, reach: float) -> tuple[float, float, float] | None:
    """Lower bound, upper bound and start of a fitted zero (of a clock, a depth or a force); None if the zero is given.

    reach: half width of the search if the file only says `fit`.
    """
    if isinstance(zero, str):
        return -reach, reach, 0.0
    if isinstance(zero, ClockBounds):
        return zero.low, zero.high, min(max(0.0, zero.low), zero.high) if zero.start is None else zero.start
    return None


@dataclass(frozen=True)
class ParameterRequest:
    """A requested parameter: its key, the position of its request in the file, and its bounds."""

    key: tuple[str, ...]
    position: Position
    bounds: Bounds = field(default_factory=Bounds)

    @property
    def name(self) -> str:
        """The dotted key."""
        return ".".join(self.key)


@dataclass(frozen=True)
class RunRequest:
    """A requested run.

    columns: measured name -> header and position in the file; rows: header -> number and position. offset: by which the
    clock of the data is ahead (s), or lower bound, upper bound and start if it is fitted. force_test: prescribed motion
    of the body; None if the columns decide whether the data are a force test.
    """

    name: str
    config: Path
    data: Path
    at_config: Position
    at_data: Position
    overrides: tuple[Override, ...] = ()
    columns: Mapping[str, tuple[str, Position]] = field(default_factory=dict)
    offset: float | tuple[float, float, float] = 0.0
    parameters: tuple[ParameterRequest, ...] = ()
    rows: Mapping[str, tuple[float, Position]] = field(default_factory=dict)
    force_test: ForceTest | None = None


@dataclass(frozen=True)
class Specification:
    """A requested fit. noise: measured name -> value and position in the file; file: with the options of the solver."""

    name: str
    file: FitFile
    runs: tuple[RunRequest, ...]
    parameters: tuple[ParameterRequest, ...]
    common: tuple[Override, ...]
    noise: Mapping[str, tuple[float, Position]]


def load_specification(path: str | PathLike[str]) -> Specification:
    """Read a fit file.

    Parameters
    ----------
    path : str or path
        YAML file, or the name of a shipped one.

    Returns
    -------
    Specification
        The requested fit. Its data and configs are not read yet, see `prepare`.

    Raises
    ------
    ConfigError
        With all faults of the file.
    """
    path = examples.named(Path(path))
    faults: list[Fault] = []
    return specification(read_file(path, faults), path, faults)


def specification(root: tree.Node, path: Path, faults: list[Fault]) -> Specification:
    """Make the specification from the tree of a fit file.

    Parameters
    ----------
    root : tree.Node
        Tree of the file.
    path : Path
        The file: paths in it are relative to its folder, and its stem is the name of the fit.
    faults : list of Fault
        Faults found so far; further ones are appended.

    Returns
    -------
    Specification

    Raises
    ------
    ConfigError
        With `faults` and all further ones, sorted by file and line.
    """
    root = root_of_kind(root, FitFile, "not a fit file", faults)
    file = validated(FitFile, root, faults)
    if file is None:
        raise ConfigError(sorted(faults, key=by_place))
    request = Specification(
        name=path.stem,
        file=file,
        runs=tuple(_named(_runs(root, file, path.parent, faults))),
        parameters=_parameters(root, (), file.parameters, faults),
        common=tuple(read_overrides(root.nodes.get("set"), ("set",), faults)),
        noise={name: (size, _at(root, "noise", name)) for name, size in file.noise.items()},
    )
    if not request.parameters and not any(run.parameters for run in request.runs) and not faults:
        at = root.keys.get("parameters", root.position)
        faults.append(at.fault(("parameters",), "names none; allowed are dotted keys of the config, as medium.eta_h"))
    if faults:
        raise ConfigError(sorted(dict.fromkeys(faults), key=by_place))
    return request


def _at(node: tree.Node, *path: str | int) -> tree.Position:
    """Position in the file of the last key of a path."""
    return tree.key_position(node, path)


def _runs(root: tree.Mapping, file: FitFile, folder: Path, faults: list[Fault]) -> Iterator[RunRequest]:
    for i, run in enumerate(file.runs):
        node, path = tree.find(root, ("runs", i))[0], ("runs", i)
        clock = file.time_offset_s if run.time_offset_s is None else run.time_offset_s
        yield RunRequest(
            run.name or Path(run.data).stem,
            examples.named(Path(run.config), folder),
            folder / run.data,
            _at(node, "config"),
            _at(node, "data"),
            tuple(read_overrides(tree.child(node, "set"), (*path, "set"), faults)),
            _columns(root, file) if run.columns is None else _columns(node, run),
            search_range(clock, OFFSET_RANGE[1]) or (clock if isinstance(clock, float) else 0.0),
            _parameters(node, path, run.parameters, faults),
            {header: (value, _at(node, "rows", header)) for header, value in (run.rows or {}).items()},
            file.force_test if run.force_test is None else run.force_test,
        )


def _named(runs: Iterator[RunRequest]) -> Iterator[RunRequest]:
    """Give the runs unique names: a repeated name gets a number."""
    names: set[str] = set()
    for run in runs:
        name, count = run.name, 2
        while name.casefold() in names:
            name, count = f"{run.name}_{count}", count + 1
        names.add(name.casefold())
        yield replace(run, name=name)


def _columns(node: tree.Node, holder: FitFile | FitRun) -> dict[str, tuple[str, tree.Position]]:
    return {name: (header, _at(node, "columns", name)) for name, header in (holder.columns or {}).items()}


def _parameters(
    node: tree.Node,
    path: tree.Path,
    given: tuple[str, ...] | Mapping[str, Bounds | None] | None,
    faults: list[Fault],
) -> tuple[ParameterRequest, ...]:
    """Requested parameters of one run, or of all runs, in the order of the file."""
    path = (*path, "parameters")
    bounds = given if isinstance(given, Mapping) else dict.fromkeys(given or ())
    requests = []
    for i, (name, limits) in enumerate(bounds.items()):
        at = _at(node, "parameters", name if isinstance(given, Mapping) else i)
        parts = split(name, at, faults, form=f"dotted key: {tree.dotted(path)} has {name!r}")
        if parts is not None:
            requests.append(ParameterRequest(parts, at, limits or Bounds()))
    return tuple(requests)
