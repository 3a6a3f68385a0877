"""A file of a search -> a study: a config that can be run with any numbers of its parameters.

What stands in such a file is said by its schema (`schema.optimise`) and shown in configs/optimise_speed_close.yaml.
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
from granular_contact.config.messages import by_place, of_file, validated
from granular_contact.config.overrides import Override, split
from granular_contact.config.schema.optimise import OptimiseFile, Parameter
from granular_contact.config.sweep import Probe, Sweep, base_of, case_faults, one_a_place
from granular_contact.config.sweep_cases import Case, read_overrides, with_long
from granular_contact.config.yaml_source import read_file
from granular_contact.errors import ConfigError, Fault
from granular_contact.values.strict import did_you_mean


@dataclass(frozen=True)
class Study:
    """A search, valid: its config as a sweep without cases, what it asks for, and the keys that each parameter sets.

    root: the tree of its file, for the lines of what can be seen only when something has run.
    """

    sweep: Sweep
    file: OptimiseFile
    keys: dict[str, tuple[Override, ...]]
    root: tree.Mapping

    @property
    def name(self) -> str:
        """That of its file."""
        return self.sweep.name

    def case(self, index: int, numbers: dict[str, float]) -> Case:
        """The case of an index with numbers for the parameters; of none, the config as it is."""
        found = (
            Override(key.path, tree.made(number, key.position), key.position)
            for name, number in numbers.items()
            for key in self.keys[name]
        )
        return Case(self.case_name(index), tuple(found), numbered=True)

    def case_name(self, index: int) -> str:
        """Name of the case of an index, from 0."""
        return f"run_{index:0{len(str(self.file.evaluations - 1))}d}"

    def numbers(self, fractions: Sequence[float]) -> dict[str, float]:
        """The parameters at fractions (0 to 1) of their ranges, to six digits, as people read and write them."""
        found = {}
        for (name, one), fraction in zip(self.file.parameters.items(), fractions, strict=True):
            ends = sorted((float(one.start), float(one.stop)))
            found[name] = min(max(float(f"{one.number(float(fraction)):.6g}"), ends[0]), ends[1])
        return found

    @cached_property
    def start(self) -> dict[str, float | None]:
        """The parameters as the config has them; None where it has no number, or several."""
        plain = scenario_to_dict(self.sweep.base)
        return {name: _number(plain, keys) for name, keys in self.keys.items()}

    def start_fractions(self) -> list[float]:
        """Where in the ranges the config stands: at an end if it is outside, in the middle if that is not known."""
        return [
            0.5
            if self.start[name] is None
            else _fraction(float(self.start[name] or 0.0), one.start, one.stop, one.scale)
            for name, one in self.file.parameters.items()
        ]

    def fault(self, path: tree.Path, message: str) -> ConfigError:
        """An error about a key of the file, at its line."""
        return ConfigError([tree.key_position(self.root, path).fault(path, message)])


def _number(plain: object, keys: Sequence[Override]) -> float | None:
    found = {value_at(plain, key.path) for key in keys if not isinstance(value_at(plain, key.path), dict | list)}
    (one, *others) = found or {None}
    known = isinstance(one, int | float) and not isinstance(one, bool) and not others
    return float(one) if known else None


def _fraction(value: float, start: float, stop: float, scale: str) -> float:
    if scale == "log":
        if value <= 0.0:
            return 0.0 if start < stop else 1.0
        value, start, stop = math.log(value), math.log(start), math.log(stop)
    return min(1.0, max(0.0, (value - start) / (stop - start)))


def load_optimise(path: str | PathLike[str], probe: Probe | None = None) -> Study:
    """Read a file of a search and check it, with each parameter at both ends of its range.

    Parameters
    ----------
    path : str or path
        YAML file, or the name of a shipped one; the config that it names is looked for beside it, then among those
        that are shipped.
    probe : callable, optional
        Called with the scenarios; a SceneError that it raises is a fault of the parameter.

    Returns
    -------
    Study

    Raises
    ------
    ConfigError
        With every fault found, sorted by file and line.
    """
    path = examples.named(Path(path))
    faults: list[Fault] = []
    root = of_file(read_file(path, faults), OptimiseFile, "no search", faults)
    return study_of(root, path, faults, probe)


def study_of(root: tree.Mapping, path: Path, faults: list[Fault], probe: Probe | None = None) -> Study:
    """The study of the tree of a file `path`; as `load_optimise`, with the `faults` found so far."""
    root = with_long(root, ("parameters",))
    file = validated(OptimiseFile, root, faults)
    common = read_overrides(root.nodes.get("set"), ("set",), faults)
    base = base_of(root, path, common, faults)
    if base is not None:
        checked = _without_faults(root) if file is None else file
        keys = _keys(root, checked, faults)
        dotted = tuple(".".join(key.path) for held in keys.values() for key in held)
        study = Study(Sweep(path.stem, base[1], dotted, (), base[0], tuple(common)), checked, keys, root)
        unknown = _unknown(study)
        faults += [*unknown.values(), *one_a_place(case_faults(study.sweep, _ends(study, unknown), probe))]
        if not faults:
            return study
    raise ConfigError(sorted(dict.fromkeys(faults), key=by_place))


def _without_faults(root: tree.Mapping) -> OptimiseFile:
    """What is valid of the parameters of a file that is not, so that all that is wrong with it is reported at once."""
    held = root.nodes.get("parameters")
    nodes = held.nodes if isinstance(held, tree.Mapping) else {}
    valid = {name: one for name, node in nodes.items() if (one := validated(Parameter, node, [])) is not None}
    return OptimiseFile.model_construct(parameters=valid, evaluations=1)


def _keys(root: tree.Mapping, file: OptimiseFile, faults: list[Fault]) -> dict[str, tuple[Override, ...]]:
    """Keys that each parameter sets, at the line of the parameter; the same key twice is a fault."""
    found: dict[str, tuple[Override, ...]] = {}
    seen: dict[tuple[str, ...], str] = {}
    for name in file.parameters:
        at = tree.key_position(root, ("parameters", name))
        made: list[Override] = []
        for key in file.keys(name):
            parts = split(key, at, faults, form=f"dotted key: parameters has {key!r}")
            if parts is None:
                continue
            if parts in seen:
                faults.append(at.fault(("parameters", name), f"sets {key}, which {seen[parts]} sets too"))
            seen[parts] = name
            made.append(Override(parts, tree.made(0.0, at), at))
        found[name] = tuple(made)
    return found


def _unknown(study: Study) -> dict[str, Fault]:
    """Faults of parameters whose keys lead to nothing in the config, by their names."""
    plain = scenario_to_dict(study.sweep.base)
    faults: dict[str, Fault] = {}
    for name, keys in study.keys.items():
        for key in keys:
            for depth in range(1, len(key.path)):
                held = value_at(plain, key.path[:depth], missing=_NOTHING)
                below = value_at(plain, key.path[: depth + 1], missing=_NOTHING)
                if held is not None and below is _NOTHING and isinstance(held, dict) and depth + 1 < len(key.path):
                    faults[name] = key.position.fault(key.path, _no_key(key.path, depth, list(held)))
                    break
    return faults


_NOTHING = object()


def _no_key(path: tuple[str, ...], depth: int, there: list[str]) -> str:
    above, word = ".".join(path[:depth]), path[depth]
    hint = did_you_mean(word, there) or f"there are {', '.join(there) or 'none'}"
    return f"the config has no {word!r} in {above}; {hint}"


def _ends(study: Study, unknown: Collection[str]) -> list[Case]:
    """Cases with one parameter, of those that are known, at an end of its range, the others as the config has them."""
    cases = []
    for name in (name for name in study.keys if name not in unknown):
        one = study.file.parameters[name]
        for end in (one.start, one.stop):
            numbers = study.case(0, {name: end}).overrides
            cases.append(Case(f"{name} = {end:g}", numbers))
    return cases
