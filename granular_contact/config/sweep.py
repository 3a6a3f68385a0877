"""A sweep file -> the cases it asks for, each of them a config with some values replaced.

    config: pendulum.yaml                      # of one run; or the config itself
    set: {solver.end_time_s: 0.2}              # for all cases
    cases:                                     # by name
      slow: {initial.impact_speed_rad_s: 1}
      fast: {initial.impact_speed_rad_s: 9}

or, in the place of `cases`, `vary` with a list or a range for each key; `combine` makes them a grid, or a zip.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from os import PathLike
from pathlib import Path
from typing import Any

from granular_contact.config import tree
from granular_contact.config.export import scenario_to_dict
from granular_contact.config.load import Loaded, Template, by_place
from granular_contact.config.messages import got
from granular_contact.config.overrides import Override, effective
from granular_contact.config.references import shown
from granular_contact.config.schema import Scenario
from granular_contact.config.sweep_cases import KEYS, Case, read_cases, read_set
from granular_contact.config.yaml_source import read_file
from granular_contact.errors import ConfigError, Fault, SceneError

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
    cases: tuple[Case, ...]
    template: Template
    common: tuple[Override, ...]

    def scenario(self, case: Case) -> Scenario:
        """Scenario of a case, as `load` gives it for the same overrides."""
        return self.load(case).scenario

    def load(self, case: Case) -> Loaded:
        """Scenario of a case with the places of its keys; raises ConfigError for a case that was not checked."""
        return self.template.make(effective([*self.common, *case.overrides]))

    def values(self, case: Case, scenario: Scenario) -> dict[str, Any]:
        """What the case, of this scenario, has under each of `keys`: as written, else as resolved."""
        given = case.values
        if len(given) == len(self.keys):
            return {key: given[key] for key in self.keys}
        resolved = scenario_to_dict(scenario)
        return {key: given[key] if key in given else _at(resolved, key) for key in self.keys}

    def changes(self, case: Case) -> dict[str, Any]:
        """The same case as dotted keys on `base`, complete without any other file."""
        if not any(one.is_reference for one in case.overrides):
            return {".".join(one.path): tree.plain(one.value) for one in effective(case.overrides)}
        return dict(_difference(self._resolved_base, scenario_to_dict(self.scenario(case))))

    @cached_property
    def _resolved_base(self) -> dict[str, Any]:
        return scenario_to_dict(self.base)


def is_sweep(path: str | PathLike[str]) -> bool:
    """Whether the file at `path` means to be a sweep; False for one that can't be read."""
    root = read_file(Path(path), [])
    return isinstance(root, tree.Mapping) and bool({"config", "cases", "vary"} & set(root.nodes))


def load_sweep(path: str | PathLike[str], probe: Probe | None = None) -> Sweep:
    """Read a sweep file and check every case of it.

    Parameters
    ----------
    path
        YAML file; the config that it names is looked for beside it.
    probe
        Called with the scenario of each case; a SceneError that it raises is a fault of the case.

    Raises
    ------
    ConfigError
        With every fault found, sorted by file and line; of a great many the first 200.
    """
    path = Path(path)
    faults: list[Fault] = []
    root = read_file(path, faults)
    if not isinstance(root, tree.Mapping):
        if not isinstance(root, tree.Broken):
            allowed = f"a mapping with the keys {', '.join(KEYS)}"
            faults.append(root.position.fault((), f"got {got(root)}; allowed is {allowed}"))
        raise ConfigError(faults)
    if "model" in root.nodes and "config" not in root.nodes:
        raise ConfigError([root.position.fault((), "is the config of one run; a sweep has its name under config")])
    common = read_set(root, faults)
    cases = read_cases(root, faults)
    loaded = _base(root, path, common, faults)
    if loaded is not None:
        keys = tuple(dict.fromkeys(key for case in cases for key in case.keys))
        sweep = Sweep(path.stem, loaded[1], keys, tuple(cases), loaded[0], tuple(common))
        faults += _case_faults(sweep, probe)
    if faults or loaded is None:
        raise ConfigError(_listed(faults))
    return sweep


def _base(
    root: tree.Mapping, path: Path, common: Sequence[Override], faults: list[Fault]
) -> tuple[Template, Scenario] | None:
    """The config that all cases start from, with `set` in it; None, with faults, if there is none."""
    node = root.nodes.get("config")
    if node is None:
        faults.append(root.position.fault(("config",), "is missing; allowed is the path of a config, or a config"))
    found: tree.Node | None = node
    if isinstance(node, tree.Scalar) and isinstance(node.value, str):
        path = path.parent / node.value
        if not path.exists():
            message = f"got {node.value!r}, but there is no file {shown(path)}"
            faults.append(node.position.fault(("config",), message))
            return None
        path = shown(path)
        found = read_file(path, faults)
    elif isinstance(node, tree.Scalar | tree.Items):
        message = f"got {got(node)}; allowed is the path of a config, or a config"
        faults.append(node.position.fault(("config",), message))
        return None
    if found is None or isinstance(found, tree.Broken):
        return None
    try:
        template = Template(found, path, [])
        return template, template.make(effective(common)).scenario
    except ConfigError as error:
        faults += error.faults
        return None


def _case_faults(sweep: Sweep, probe: Probe | None) -> Iterator[Fault]:
    """Faults of each case; those of a key that the case leaves alone say which case it is."""
    for case in sweep.cases:
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


def _at(resolved: Any, key: str) -> Any:
    """Value under a dotted key; None where the scenario has none."""
    for part in key.split("."):
        if isinstance(resolved, list) and part.isdecimal() and int(part) < len(resolved):
            resolved = resolved[int(part)]
        elif isinstance(resolved, dict):
            resolved = resolved.get(part)
        else:
            return None
    return resolved


def _difference(base: Any, other: Any, path: tuple[str, ...] = ()) -> Iterator[tuple[str, Any]]:
    """Dotted keys under which `other` differs from `base`; a mapping with other keys is replaced as a whole."""
    if isinstance(base, dict) and isinstance(other, dict) and set(base) == set(other):
        for key in other:
            yield from _difference(base[key], other[key], (*path, key))
    elif base != other:
        yield ".".join(path), other
