"""Options of the command line as the tree of a fit file, so that both are read and checked the same way."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from granular_contact.config import is_fit, tree
from granular_contact.config.yaml_source import read_text
from granular_contact.errors import ConfigError, Fault

if TYPE_CHECKING:
    from granular_contact.studies.fit import Specification

_HERE = tree.Position("fit", None)


def requested_fit(chosen: argparse.Namespace) -> Specification:
    """Specification by the chosen files and options; raises ConfigError with every fault of them."""
    from granular_contact.studies.fit import load_specification, specification

    first = Path(chosen.files[0])
    if len(chosen.files) == 1 and (is_fit(first) or not first.exists()):
        given = [f"--{name.replace('_', '-')}" for name in _INSTEAD if getattr(chosen, name)]
        if given:
            words = "says that itself; allowed with a fit file are --workers, --out, --no-plots and --quiet"
            raise ConfigError([Fault(option, None, "", f"{first} {words}") for option in given])
        return load_specification(first)
    faults: list[Fault] = []
    root = tree.mapping(_nodes(chosen, faults), _HERE)
    return specification(root, Path(f"{first.stem}.yaml"), faults)


def _nodes(chosen: argparse.Namespace, faults: list[Fault]) -> dict[str, tree.Node]:
    """The keys of the fit file."""
    nodes = {"runs": _runs(chosen.files, faults)}
    if chosen.parameters:
        nodes["parameters"] = _parameters(chosen, faults)
    else:
        words = "is missing; allowed are dotted keys, as medium.eta_h,medium.eta_d"
        faults.append(Fault("--parameters", None, "", words))
    columns = [text for text in (chosen.columns or "").split(",") if text.strip()]
    tests = (("columns", columns), ("noise", chosen.noise), ("set", chosen.set), ("force_test", chosen.force_test))
    for key, texts in tests:
        if texts:
            option = f"--{key.replace('_', '-')}"
            pairs = [_pair(option, text, faults) for text in texts]
            found = {name: value for name, value in pairs if name}
            if key != "set":  # of which a later one replaces an earlier one in every command
                _refuse_repeats(option, [name for name, _ in pairs if name], faults)
            nodes[key] = _mapping(option, found, faults, read=key != "columns")
    options = {"time_offset_s": "time_offset", "loss": "loss", "starts": "starts", "seed": "seed"}
    for key, option in options.items():
        text = getattr(chosen, option)
        if text is not None:
            nodes[key] = read_text(text, f"--{option.replace('_', '-')}", faults, (), numbered=False)
    if chosen.scatter:
        nodes["scatter"] = tree.made(True, tree.Position("--scatter", None))
    return nodes


_DATA = ("parameters", "bounds", "columns", "time_offset", "noise", "force_test", "set")
_INSTEAD = (*_DATA, "scatter", "loss", "starts", "seed")


def _runs(files: Sequence[str], faults: list[Fault]) -> tree.Node:
    """Configs, and the CSV files behind each."""
    form = "allowed are CONFIG DATA.csv [DATA.csv ...]"
    groups: list[tuple[str, list[str]]] = []
    for name in files:
        if name.endswith((".yaml", ".yml")):
            groups.append((name, []))
        elif groups:
            groups[-1][1].append(name)
        else:
            faults.append(Fault(name, None, "", f"stands before any config; {form}"))
    faults += [Fault(config, None, "", f"has no CSV file behind it; {form}") for config, data in groups if not data]
    runs = [(config, name) for config, data in groups for name in data]
    if not runs:
        return tree.Broken(_HERE)
    return tree.Items(_HERE, tuple(tree.made({"config": c, "data": d}, tree.Position(d, None)) for c, d in runs))


def _parameters(chosen: argparse.Namespace, faults: list[Fault]) -> tree.Node:
    at = tree.Position("--parameters", None)
    names = [name.strip() for name in chosen.parameters.split(",") if name.strip()]
    nodes: dict[str, tree.Node] = {name: tree.Scalar(at, None, "") for name in names}
    _refuse_repeats("--bounds", [text.partition("=")[0].strip() for text in chosen.bounds], faults)
    for text in chosen.bounds:
        key, value = _pair("--bounds", text, faults)
        low, colon, high = value.partition(":")
        here = f"--bounds {text}"
        if key and key not in nodes:
            faults.append(Fault(here, None, key, "is none of the --parameters"))
        elif key and not colon:
            faults.append(Fault(here, None, key, f"got {value!r}; allowed is LOW:HIGH, as 1:40"))
        elif key:
            sides = {side: _read(here, key, number, faults) for side, number in (("from", low), ("to", high))}
            nodes[key] = tree.mapping(sides, tree.Position(here, None))
    return tree.mapping(nodes, at)


def _read(option: str, key: str, text: str, faults: list[Fault]) -> tree.Node:
    """The value of a key that an option gives, as YAML."""
    return read_text(text, option, faults, (key,), numbered=False)


def _refuse_repeats(option: str, names: Sequence[str], faults: list[Fault]) -> None:
    twice = [name for name in dict.fromkeys(names) if names.count(name) > 1]
    faults += [Fault(option, None, name, "is given twice; once is allowed") for name in twice]


def _pair(option: str, text: str, faults: list[Fault]) -> tuple[str, str]:
    name, equals, value = (part.strip() for part in text.partition("="))
    if not name or not equals or not value:
        faults.append(Fault(f"{option} {text}", None, "", "is not NAME=VALUE"))
        return "", ""
    return name, value


def _mapping(option: str, pairs: dict[str, str], faults: list[Fault], read: bool) -> tree.Mapping:
    """Names and values of an option; values are read as YAML, or are texts."""
    nodes: dict[str, tree.Node] = {}
    for name, value in pairs.items():
        here = f"{option} {name}={value}"
        nodes[name] = _read(here, name, value, faults) if read else tree.made(value, tree.Position(here, None))
    return tree.mapping(nodes, tree.Position(option, None))
