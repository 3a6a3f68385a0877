"""Load a file of an optimisation as a study: a config, and the cases for values of its parameters.

The schema of such a file is `schema.optimise`; configs/optimise_speed_close.yaml is an example.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from functools import cached_property
from os import PathLike
from pathlib import Path

from granular_contact import examples
from granular_contact.config import tree
from granular_contact.config.export import scenario_to_dict, value_at
from granular_contact.config.messages import by_place, root_of_kind, validated
from granular_contact.config.overrides import Override, split
from granular_contact.config.schema.optimise import OptimiseFile, Parameter
from granular_contact.config.sweep import Probe, Sweep, base_of, case_faults, first_of_each_key
from granular_contact.config.sweep_cases import Case, read_overrides, with_long_ranges
from granular_contact.config.yaml_source import read_file
from granular_contact.errors import ConfigError, Fault
from granular_contact.values.strict import did_you_mean


@dataclass(frozen=True)
class Study:
    """A valid optimisation.

    sweep: the config, as a sweep without cases; file: content of the file; keys: overrides, with a number as
    placeholder, of the keys that each parameter sets; root: tree of the file, for the lines of faults that only a run
    shows.
    """

    sweep: Sweep
    file: OptimiseFile
    keys: dict[str, tuple[Override, ...]]
    root: tree.Mapping

    @property
    def name(self) -> str:
        """Name of the study, from its file."""
        return self.sweep.name

    def case(self, index: int, numbers: dict[str, float]) -> Case:
        """The case of one run of the study.

        Parameters
        ----------
        index : int
            Number of the run, from 0.
        numbers : dict of float
            Values of parameters by name, in the units of their keys. A parameter without a value stays as in the
            config.

        Returns
        -------
        Case
            It sets each value for all keys of its parameter.

        Raises
        ------
        KeyError
            The study has no parameter of a name.
        """
        overrides = (
            Override(key.path, tree.from_plain(number, key.position), key.position)
            for name, number in numbers.items()
            for key in self.keys[name]
        )
        return Case(self.case_name(index), tuple(overrides), numbered=True)

    def case_name(self, index: int) -> str:
        """Name of the case of one run: `run_` and the number of the run, with as many digits as the last run has.

        Parameters
        ----------
        index : int
            Number of the run, from 0.

        Returns
        -------
        str
        """
        return f"run_{index:0{len(str(self.file.evaluations - 1))}d}"

    def numbers(self, fractions: Sequence[float]) -> dict[str, float]:
        """Values of the parameters at fractions of their ranges, rounded to six digits for readers.

        Parameters
        ----------
        fractions : sequence of float
            A fraction (0 to 1) for each parameter, in the order of the file, on the scale of its range (linear or log).

        Returns
        -------
        dict of float
            Values by the names of the parameters, in the units of their keys; never outside the ranges.

        Raises
        ------
        ValueError
            There are more or fewer fractions than parameters.
        """
        numbers = {}
        for (name, parameter), fraction in zip(self.file.parameters.items(), fractions, strict=True):
            low, high = sorted((float(parameter.start), float(parameter.stop)))
            numbers[name] = min(max(float(f"{parameter.number(float(fraction)):.6g}"), low), high)
        return numbers

    @cached_property
    def start(self) -> dict[str, float | None]:
        """Values of the parameters in the config; None if it has no number there, or its keys have different ones."""
        plain = scenario_to_dict(self.sweep.base)
        return {name: _number(plain, keys) for name, keys in self.keys.items()}

    def start_fractions(self) -> list[float]:
        """Fractions (0 to 1) of the ranges at which the config is; 0 or 1 if it is outside, 0.5 if it has no value."""
        return [
            0.5
            if self.start[name] is None
            else _fraction(float(self.start[name] or 0.0), parameter.start, parameter.stop, parameter.scale)
            for name, parameter in self.file.parameters.items()
        ]

    def fault(self, path: tree.Path, message: str) -> ConfigError:
        """Error about a key of the file, at its line; the caller raises it.

        Parameters
        ----------
        path : tuple of str or int
            Keys and list indices from the top of the file to the key.
        message : str
            What was got, and what is allowed.

        Returns
        -------
        ConfigError
            With one fault. Its line is that of the key, or of the nearest enclosing key.
        """
        return ConfigError([tree.key_position(self.root, path).fault(path, message)])


def _number(plain: object, keys: Sequence[Override]) -> float | None:
    """The number that all keys have in plain data; None if it is no number, or they differ."""
    values = {value_at(plain, key.path) for key in keys if not isinstance(value_at(plain, key.path), dict | list)}
    (first, *others) = values or {None}
    is_known = isinstance(first, int | float) and not isinstance(first, bool) and not others
    return float(first) if is_known else None


def _fraction(value: float, start: float, stop: float, scale: str) -> float:
    """Fraction (0 to 1) of a range at which a value is, on the scale of the range."""
    if scale == "log":
        if value <= 0.0:
            return 0.0 if start < stop else 1.0
        value, start, stop = math.log(value), math.log(start), math.log(stop)
    return min(1.0, max(0.0, (value - start) / (stop - start)))


def load_optimise(path: str | PathLike[str], probe: Probe | None = None) -> Study:
    """Read a file of an optimisation and check it, with each parameter at both ends of its range.

    Parameters
    ----------
    path : str or path
        YAML file, or the name of a shipped one. The config that it names is searched in the folder of this file, then
        among the shipped configs.
    probe : callable, optional
        Called with the scenarios. A SceneError that it raises is a fault of the parameter.

    Returns
    -------
    Study

    Raises
    ------
    ConfigError
        With every fault, sorted by file and line.
    """
    path = examples.named(Path(path))
    faults: list[Fault] = []
    root = root_of_kind(read_file(path, faults), OptimiseFile, "no search", faults)
    return study_of(root, path, faults, probe)


def study_of(root: tree.Mapping, path: Path, faults: list[Fault], probe: Probe | None = None) -> Study:
    """The study from the tree of the file `path`; as `load_optimise`, with the `faults` found so far."""
    root = with_long_ranges(root, ("parameters",))
    file = validated(OptimiseFile, root, faults)
    common = read_overrides(root.nodes.get("set"), ("set",), faults)
    base = base_of(root, path, common, faults)
    if base is not None:
        template, scenario = base
        checked_file = _valid_parameters(root) if file is None else file
        keys = _keys(root, checked_file, faults)
        dotted_keys = tuple(".".join(key.path) for overrides in keys.values() for key in overrides)
        sweep = Sweep(path.stem, scenario, dotted_keys, (), template, tuple(common))
        study = Study(sweep, checked_file, keys, root)
        unknown = _unknown(study)
        faults += [*unknown.values(), *first_of_each_key(case_faults(sweep, _cases_at_ends(study, unknown), probe))]
        if not faults:
            return study
    raise ConfigError(sorted(dict.fromkeys(faults), key=by_place))


def _valid_parameters(root: tree.Mapping) -> OptimiseFile:
    """The valid parameters of a faulty file, so that faults of their keys are reported at once too."""
    parameters = root.nodes.get("parameters")
    nodes = parameters.nodes if isinstance(parameters, tree.Mapping) else {}
    checked = ((name, validated(Parameter, node, [])) for name, node in nodes.items())
    valid = {name: parameter for name, parameter in checked if parameter is not None}
    return OptimiseFile.model_construct(parameters=valid, evaluations=1)


def _keys(root: tree.Mapping, file: OptimiseFile, faults: list[Fault]) -> dict[str, tuple[Override, ...]]:
    """Overrides of the keys that each parameter sets, at the line of the parameter. The same key twice is a fault."""
    keys_by_parameter: dict[str, tuple[Override, ...]] = {}
    owners: dict[tuple[str, ...], str] = {}
    for name in file.parameters:
        at = tree.key_position(root, ("parameters", name))
        overrides: list[Override] = []
        for key in file.keys(name):
            parts = split(key, at, faults, form=f"dotted key: parameters has {key!r}")
            if parts is None:
                continue
            if parts in owners:
                faults.append(at.fault(("parameters", name), f"sets {key}, which {owners[parts]} sets too"))
            owners[parts] = name
            overrides.append(Override(parts, tree.from_plain(0.0, at), at))
        keys_by_parameter[name] = tuple(overrides)
    return keys_by_parameter


def _unknown(study: Study) -> dict[str, Fault]:
    """Faults of parameters with a key that is below no mapping of the config, by the name of the parameter."""
    plain = scenario_to_dict(study.sweep.base)
    faults: dict[str, Fault] = {}
    for name, keys in study.keys.items():
        for key in keys:
            for depth in range(1, len(key.path)):
                holder = value_at(plain, key.path[:depth], missing=_MISSING)
                below = value_at(plain, key.path[: depth + 1], missing=_MISSING)
                if below is _MISSING and isinstance(holder, dict) and depth + 1 < len(key.path):
                    faults[name] = key.position.fault(key.path, _no_key(key.path, depth, list(holder)))
                    break
    return faults


_MISSING = object()


def _no_key(path: tuple[str, ...], depth: int, known: list[str]) -> str:
    """Message: the config lacks the key at this depth of a path; known: the keys beside it."""
    above, key = ".".join(path[:depth]), path[depth]
    hint = did_you_mean(key, known) or f"there are {', '.join(known) or 'none'}"
    return f"the config has no {key!r} in {above}; {hint}"


def _cases_at_ends(study: Study, unknown: Collection[str]) -> list[Case]:
    """Cases with one parameter at an end of its range, all others as in the config; without the unknown parameters."""
    cases = []
    for name in (name for name in study.keys if name not in unknown):
        parameter = study.file.parameters[name]
        for end in (parameter.start, parameter.stop):
            overrides = study.case(0, {name: end}).overrides
            cases.append(Case(f"{name} = {end:g}", overrides))
    return cases
