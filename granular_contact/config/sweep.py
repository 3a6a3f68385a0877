"""A sweep file -> the cases it asks for, each of them a config with some values replaced.

    config: pendulum.yaml                      # of one run; or the config itself
    set: {solver.end_time_s: 0.2}              # for all cases
    cases:                                     # by name
      slow: {initial.impact_speed_rad_s: 1}
      fast: {initial.impact_speed_rad_s: 9}

or, in the place of `cases`, `vary` with a list or a range for each key; `combine` makes them a grid, or a zip. Or
`sample`, which draws cases from ranges (sweep_sample).
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
from granular_contact.config.messages import by_place, of_file, validated
from granular_contact.config.overrides import Override, effective
from granular_contact.config.references import shown
from granular_contact.config.schema import Scenario
from granular_contact.config.schema.sweep import Sample, SweepFile
from granular_contact.config.sweep_cases import Case, Numbered, named, read_overrides, sampled, varied, with_long
from granular_contact.config.template import Loaded, Template
from granular_contact.config.yaml_source import read_file
from granular_contact.errors import ConfigError, Fault, SceneError
from granular_contact.values.strict import did_you_mean

MOST_FAULTS = 200
Probe = Callable[[Scenario], object]


@dataclass(frozen=True)
class Sweep:
    """Cases on one config, all of them valid; a scenario is made when asked for, as there may be very many.

    base: the config with `set`. keys: what the cases replace, dotted, in the order of the file.
    """

    name: str
    base: Scenario
    keys: tuple[str, ...]
    cases: Sequence[Case]
    template: Template
    common: tuple[Override, ...]

    @property
    def sample(self) -> Sample | None:
        """How the cases were drawn; None if they were not."""
        return self.cases.sample if isinstance(self.cases, Numbered) else None

    def scenario(self, case: Case) -> Scenario:
        """Scenario of a case, as `load` gives it for the same overrides."""
        return self.load(case).scenario

    def load(self, case: Case) -> Loaded:
        """Scenario of a case with the places of its keys; raises ConfigError for a case that was not checked."""
        return self.template.make(effective([*self.common, *case.overrides]))

    def needs_files(self, case: Case) -> bool:
        """Whether the scenario of a case can be made only where the files are that it, or the config, names."""
        return case.has_references or self._names_columns or any(one.path[0] in COLUMN_KEYS for one in case.overrides)

    def without_cases(self) -> Sweep:
        """The sweep as it is sent away: the model and the medium of the config are read in."""
        self.template.make(effective(self.common))
        return replace(self, cases=())

    def values(self, case: Case, scenario: Scenario) -> dict[str, Any]:
        """What the case, of this scenario, has under each of `keys`: as written, else as resolved."""
        given = case.values
        if len(given) == len(self.keys):
            return {key: given[key] for key in self.keys}
        resolved = scenario_to_dict(scenario)
        return {key: given[key] if key in given else value_at(resolved, key.split(".")) for key in self.keys}

    def changes(self, case: Case) -> dict[str, Any]:
        """The same case as dotted keys on `base`, complete without any other file."""
        if not case.has_references:
            return {".".join(one.path): tree.plain(one.value) for one in effective(case.overrides)}
        found = differences(self._resolved_base, scenario_to_dict(self.scenario(case)), whole=True)
        return {tree.dotted(path): value for path, _, value in found}

    @cached_property
    def _names_columns(self) -> bool:
        return self.template.names_columns or any(one.path[0] in COLUMN_KEYS for one in self.common)

    @cached_property
    def _resolved_base(self) -> dict[str, Any]:
        return scenario_to_dict(self.base)


Check = Callable[[Sweep, Sequence[Case], Probe | None], list[Fault]]


def case_faults(sweep: Sweep, cases: Sequence[Case], probe: Probe | None) -> list[Fault]:
    """Faults of some cases; those of a key that the case leaves alone say which case it is."""
    return [fault for case in cases for fault in _faults(sweep, case, probe)]


def load_sweep(path: str | PathLike[str], probe: Probe | None = None, check: Check = case_faults) -> Sweep:
    """Read a sweep file and check every case of it.

    Parameters
    ----------
    path
        YAML file, or the name of a shipped one; the config that it names is looked for beside it, then among those
        that are shipped.
    probe
        Called with the scenario of each case; a SceneError that it raises is a fault of the case.
    check
        Gives the faults of cases; a caller with several cores may share them out to `case_faults`.

    Raises
    ------
    ConfigError
        With every fault found, sorted by file and line; of a great many the first 200.
    """
    path = examples.named(Path(path))
    faults: list[Fault] = []
    root = of_file(read_file(path, faults), SweepFile, "not a sweep", faults, also=("model",))
    if "model" in root.nodes and "config" not in root.nodes:
        raise ConfigError([root.position.fault((), "is the config of one run; a sweep has its name under config")])
    return sweep_of(root, path, faults, probe, check)


def sweep_of(
    root: tree.Mapping, path: Path, faults: list[Fault], probe: Probe | None = None, check: Check = case_faults
) -> Sweep:
    """The sweep of the tree of a file `path`; as `load_sweep`, with the `faults` found so far."""
    root = with_long(root, ("sample", "ranges"))
    file = validated(SweepFile, root, faults)
    common = read_overrides(root.nodes.get("set"), ("set",), faults)
    cases = _cases(root, file, faults)
    loaded = base_of(root, path, common, faults)
    if loaded is not None:
        keys = tuple(dict.fromkeys(key for case in cases for key in case.keys))
        sweep = Sweep(path.stem, loaded[1], keys, cases, loaded[0], tuple(common))
        found = check(sweep, cases, probe)
        faults += found if sweep.sample is None else one_a_place(found)
    if faults or loaded is None:
        raise ConfigError(_listed(faults))
    return sweep


def _cases(root: tree.Mapping, file: SweepFile | None, faults: list[Fault]) -> Sequence[Case]:
    """Cases of a sweep in the order of the file; of a file at fault those that it names one by one."""
    if "cases" in root.nodes:
        return named(root.nodes["cases"], faults)
    if file is None:
        return []
    if file.sample is None:
        return varied(root.nodes["vary"], file, faults)
    return sampled(root.nodes["sample"], file.sample, faults)


def base_of(
    root: tree.Mapping, path: Path, common: Sequence[Override], faults: list[Fault]
) -> tuple[Template, Scenario] | None:
    """The config that all cases start from, with `set` in it; None, with faults, if there is none."""
    found = root.nodes.get("config")
    if isinstance(found, tree.Scalar) and isinstance(found.value, str):
        path = examples.named(Path(found.value), path.parent)
        if not path.exists():
            near = did_you_mean(path.stem, examples.config_names())
            message = f"got {found.value!r}, but there is no file {shown(path)}{f'; {near}' if near else ''}"
            faults.append(found.position.fault(("config",), message))
            return None
        path = shown(path)
        found = read_file(path, faults)
    elif not isinstance(found, tree.Mapping):  # a fault of the schema
        return None
    if isinstance(found, tree.Broken):
        return None
    try:
        template = Template(found, path, [])
        return template, template.make(effective(common)).scenario
    except ConfigError as error:
        faults += error.faults
        return None


def _faults(sweep: Sweep, case: Case, probe: Probe | None) -> Iterator[Fault]:
    found: Iterable[Fault] = ()
    try:
        loaded = sweep.load(case)
        if probe is not None:
            probe(loaded.scenario)
    except ConfigError as error:
        found = error.faults
    except SceneError as error:
        found = loaded.sources.place(error.faults)
    for fault in found:
        if any(_overlap(fault.key, key) for key in case.keys):
            yield fault
        else:
            yield replace(fault, message=f"{fault.message} (in case {case.label})")


def one_a_place(faults: Iterable[Fault]) -> list[Fault]:
    """The first fault of each key in each line: of a range, hundreds of values may be at fault for one reason."""
    first: dict[tuple[str, int | None, str], Fault] = {}
    for fault in faults:
        first.setdefault((fault.file, fault.line, fault.key), fault)
    return list(first.values())


def _overlap(one: str, other: str) -> bool:
    """Whether one dotted key is the other, or holds it."""
    return f"{one}.".startswith(f"{other}.") or f"{other}.".startswith(f"{one}.")


def _listed(faults: Iterable[Fault]) -> list[Fault]:
    """The faults, each of them once, in order of place; of too many the first ones."""
    ordered = sorted(dict.fromkeys(faults), key=by_place)
    if len(ordered) <= MOST_FAULTS:
        return ordered
    rest = len(ordered) - MOST_FAULTS
    return [*ordered[:MOST_FAULTS], Fault(ordered[-1].file, None, "", f"has {rest} more faults, not shown here")]
