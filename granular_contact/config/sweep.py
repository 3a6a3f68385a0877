"""Load a sweep file: cases, each of which is a config with some values replaced.

    config: pendulum.yaml                      # config of one run; or the config itself
    set: {solver.end_time_s: 0.2}              # for all cases
    cases:                                     # by name
      slow: {initial.impact_speed_rad_s: 1}
      fast: {initial.impact_speed_rad_s: 9}

`vary` in place of `cases` has a list or a range for each key; `combine` makes a grid or pairs (zip) of them. `sample`
in place of `cases` samples cases from ranges, see `sweep_cases`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from os import PathLike
from pathlib import Path
from typing import Any

from granular_contact import examples
from granular_contact.config import tree
from granular_contact.config.columns import KEYS as COLUMN_KEYS
from granular_contact.config.differences import differences
from granular_contact.config.export import scenario_to_dict, value_at
from granular_contact.config.messages import by_place, root_of_kind, validated
from granular_contact.config.overrides import Override, effective
from granular_contact.config.references import readable_path
from granular_contact.config.schema import Scenario
from granular_contact.config.schema.sweep import Sample, SweepFile
from granular_contact.config.sweep_cases import (
    Case,
    Numbered,
    named_cases,
    read_overrides,
    sampled_cases,
    varied_cases,
    with_long_ranges,
)
from granular_contact.config.template import Loaded, Template
from granular_contact.config.yaml_source import read_file
from granular_contact.errors import ConfigError, Fault, SceneError
from granular_contact.values.strict import did_you_mean

MOST_FAULTS = 200
Probe = Callable[[Scenario], object]  # raises SceneError for a scenario that can't be run


@dataclass(frozen=True)
class Sweep:
    """Valid cases of one config. Scenarios are made on demand, since there may be very many.

    base: the config with the values of `set`. keys: dotted keys that the cases replace, in the order of the file.
    template: makes the scenarios. common: the overrides of `set`.
    """

    name: str
    base: Scenario
    keys: tuple[str, ...]
    cases: Sequence[Case]
    template: Template
    common: tuple[Override, ...]

    @property
    def sample(self) -> Sample | None:
        """The sample from which the cases come; None if they are not sampled."""
        return self.cases.sample if isinstance(self.cases, Numbered) else None

    def scenario(self, case: Case) -> Scenario:
        """Scenario of a case, as `load` gives it for the same overrides.

        Parameters
        ----------
        case : Case
            A case of this sweep.

        Returns
        -------
        Scenario

        Raises
        ------
        ConfigError
            The case is not valid.
        """
        return self.load(case).scenario

    def load(self, case: Case) -> Loaded:
        """Scenario of a case with the files and lines of its keys.

        Parameters
        ----------
        case : Case
            A case of this sweep.

        Returns
        -------
        Loaded

        Raises
        ------
        ConfigError
            The case is not valid; with all its faults.
        """
        return self.template.make(effective([*self.common, *case.overrides]))

    def needs_files(self, case: Case) -> bool:
        """Whether the scenario of a case can be made only on a machine with the files that it or the config names.

        Parameters
        ----------
        case : Case
            A case of this sweep.

        Returns
        -------
        bool
            True if the case sets a model, a medium, or the whole bed or its layers, which may name files; or if the
            config, `set` or the case has drives or signals, which may name CSV files.
        """
        return (
            case.has_references
            or self._names_columns
            or any(override.path[0] in COLUMN_KEYS for override in case.overrides)
        )

    def without_cases(self) -> Sweep:
        """The sweep without its cases, with the model and the medium of the config read; for other processes."""
        self.template.make(effective(self.common))
        return replace(self, cases=())

    def values(self, case: Case, scenario: Scenario) -> dict[str, Any]:
        """Values of the keys of the sweep in a case.

        Parameters
        ----------
        case : Case
            A case of this sweep.
        scenario : Scenario
            The scenario of this case.

        Returns
        -------
        dict
            A value for each of `keys`, as plain data in the unit of the key: as the case writes it, else as the
            scenario has it. None if the scenario has no such key.
        """
        written = case.values
        if len(written) == len(self.keys):
            return {key: written[key] for key in self.keys}
        resolved = scenario_to_dict(scenario)
        return {key: written[key] if key in written else value_at(resolved, key.split(".")) for key in self.keys}

    def changes(self, case: Case) -> dict[str, Any]:
        """Values that make the case from `base` without reading any file.

        Parameters
        ----------
        case : Case
            A case of this sweep.

        Returns
        -------
        dict
            Plain data by dotted key. For a case that names a model or a medium, these are the differences of its
            scenario from `base`: the files are read here.

        Raises
        ------
        ConfigError
            A case that names a model or a medium is not valid.
        """
        if not case.has_references:
            return {".".join(override.path): tree.plain(override.value) for override in effective(case.overrides)}
        changed = differences(self._resolved_base, scenario_to_dict(self.scenario(case)), whole=True)
        return {tree.dotted(path): value for path, _, value in changed}

    @cached_property
    def _names_columns(self) -> bool:
        """Whether the config or `set` may name CSV files of signals."""
        return self.template.names_columns or any(override.path[0] in COLUMN_KEYS for override in self.common)

    @cached_property
    def _resolved_base(self) -> dict[str, Any]:
        """The base as plain data."""
        return scenario_to_dict(self.base)


Check = Callable[[Sweep, Sequence[Case], Probe | None], list[Fault]]


def case_faults(sweep: Sweep, cases: Sequence[Case], probe: Probe | None) -> list[Fault]:
    """Faults of some cases. A fault of a key that the case does not replace names the case."""
    return [fault for case in cases for fault in _faults(sweep, case, probe)]


def load_sweep(path: str | PathLike[str], probe: Probe | None = None, check: Check = case_faults) -> Sweep:
    """Read a sweep file and check all its cases.

    Parameters
    ----------
    path
        YAML file, or the name of a shipped one. The config that it names is searched in the folder of this file, then
        among the shipped configs.
    probe
        Called with the scenario of each case. A SceneError that it raises is a fault of the case.
    check
        Gives the faults of cases; a caller with several processes may distribute the cases to `case_faults`.

    Raises
    ------
    ConfigError
        With every fault, sorted by file and line; with more than 200 faults the first 200.
    """
    path = examples.named(Path(path))
    faults: list[Fault] = []
    root = root_of_kind(read_file(path, faults), SweepFile, "not a sweep", faults, also=("model",))
    if "model" in root.nodes and "config" not in root.nodes:
        raise ConfigError([root.position.fault((), "is the config of one run; a sweep has its name under config")])
    return sweep_of(root, path, faults, probe, check)


def sweep_of(
    root: tree.Mapping, path: Path, faults: list[Fault], probe: Probe | None = None, check: Check = case_faults
) -> Sweep:
    """The sweep from the tree of the file `path`; as `load_sweep`, with the `faults` found so far."""
    root = with_long_ranges(root, ("sample", "ranges"))
    file = validated(SweepFile, root, faults)
    common = read_overrides(root.nodes.get("set"), ("set",), faults)
    cases = _cases(root, file, faults)
    loaded = base_of(root, path, common, faults)
    if loaded is not None:
        keys = tuple(dict.fromkeys(key for case in cases for key in case.keys))
        sweep = Sweep(path.stem, loaded[1], keys, cases, loaded[0], tuple(common))
        all_case_faults = check(sweep, cases, probe)
        faults += all_case_faults if sweep.sample is None else first_of_each_key(all_case_faults)
    if faults or loaded is None:
        raise ConfigError(_listed(faults))
    return sweep


def _cases(root: tree.Mapping, file: SweepFile | None, faults: list[Fault]) -> Sequence[Case]:
    """Cases of a sweep in the order of the file; of a faulty file (None) only the cases under `cases`."""
    if "cases" in root.nodes:
        return named_cases(root.nodes["cases"], faults)
    if file is None:
        return []
    if file.sample is None:
        return varied_cases(root.nodes["vary"], file, faults)
    return sampled_cases(root.nodes["sample"], file.sample, faults)


def base_of(
    root: tree.Mapping, path: Path, common: Sequence[Override], faults: list[Fault]
) -> tuple[Template, Scenario] | None:
    """Template and scenario of the config of a sweep, with the values of `set`; None, with faults, if it is faulty."""
    config = root.nodes.get("config")
    if isinstance(config, tree.Scalar) and isinstance(config.value, str):
        path = examples.named(Path(config.value), path.parent)
        if not path.exists() or path.is_dir():
            near = did_you_mean(path.stem, examples.config_names())
            message = f"got {config.value!r}, but there is no file {readable_path(path)}{f'; {near}' if near else ''}"
            faults.append(config.position.fault(("config",), message))
            return None
        path = readable_path(path)
        config = read_file(path, faults)
    elif not isinstance(config, tree.Mapping):  # the schema reports this fault
        return None
    if isinstance(config, tree.Broken):
        return None
    try:
        template = Template(config, path, [])
        return template, template.make(effective(common)).scenario
    except ConfigError as error:
        faults += error.faults
        return None


def _faults(sweep: Sweep, case: Case, probe: Probe | None) -> Iterator[Fault]:
    """Faults of one case."""
    faults: Iterable[Fault] = ()
    try:
        loaded = sweep.load(case)
        if probe is not None:
            probe(loaded.scenario)
    except ConfigError as error:
        faults = error.faults
    except SceneError as error:
        faults = loaded.sources.place(error.faults)
    for fault in faults:
        if any(_overlap(fault.key, key) for key in case.keys):
            yield fault
        else:
            yield replace(fault, message=f"{fault.message} (in case {case.label})")


def first_of_each_key(faults: Iterable[Fault]) -> list[Fault]:
    """The first fault of each key in each line: hundreds of values of a range may be faulty for the same reason."""
    first: dict[tuple[str, int | None, str], Fault] = {}
    for fault in faults:
        first.setdefault((fault.file, fault.line, fault.key), fault)
    return list(first.values())


def _overlap(first: str, second: str) -> bool:
    """Whether two dotted keys are equal, or one contains the other."""
    return f"{first}.".startswith(f"{second}.") or f"{second}.".startswith(f"{first}.")


def _listed(faults: Iterable[Fault]) -> list[Fault]:
    """The faults without duplicates, sorted by file and line; at most MOST_FAULTS, and one that counts the others."""
    ordered = sorted(dict.fromkeys(faults), key=by_place)
    if len(ordered) <= MOST_FAULTS:
        return ordered
    rest = len(ordered) - MOST_FAULTS
    return [*ordered[:MOST_FAULTS], Fault(ordered[-1].file, None, "", f"has {rest} more faults, not shown here")]
