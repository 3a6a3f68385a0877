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
            # Of --set a later one replaces an earlier one, as in every command.
            pairs = _pairs(option, texts, faults, once=key != "set")
            found = {
                name: read_text(value, here, faults, (name,), numbered=False)
                if key != "columns"
                else tree.from_plain(value, tree.Position(here, None))
                for name, (value, here) in pairs.items()
            }
            nodes[key] = tree.mapping(found, tree.Position(option, None))
    options = {"time_offset_s": "time_offset", "loss": "loss", "starts": "starts", "seed": "seed"}
    for key, option in options.items():
        text = getattr(chosen, option)
        if text is not None:
            nodes[key] = read_text(text, f"--{option.replace('_', '-')}", faults, (), numbered=False)
    if chosen.scatter:
        nodes["scatter"] = tree.from_plain(True, tree.Position("--scatter", None))
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
    return tree.Items(_HERE, tuple(tree.from_plain({"config": c, "data": d}, tree.Position(d, None)) for c, d in runs))


def _parameters(chosen: argparse.Namespace, faults: list[Fault]) -> tree.Node:
    at = tree.Position("--parameters", None)
    names = [name.strip() for name in chosen.parameters.split(",") if name.strip()]
    nodes: dict[str, tree.Node] = {name: tree.Scalar(at, None, "") for name in names}
    for key, (value, here) in _pairs("--bounds", chosen.bounds, faults).items():
        low, colon, high = value.partition(":")
        if key not in nodes:
            faults.append(Fault(here, None, key, "is none of the --parameters"))
        elif not colon:
            faults.append(Fault(here, None, key, f"got {value!r}; allowed is LOW:HIGH, as 1:40"))
        else:
            sides = {"from": low, "to": high}
            read = {side: read_text(text, here, faults, (key,), numbered=False) for side, text in sides.items()}
            nodes[key] = tree.mapping(read, tree.Position(here, None))
    return tree.mapping(nodes, at)


def _pairs(option: str, texts: Sequence[str], faults: list[Fault], once: bool = True) -> dict[str, tuple[str, str]]:
    """Values by name of an option that is NAME=VALUE, and how messages call their place."""
    found: dict[str, tuple[str, str]] = {}
    for text in texts:
        name, equals, value = (part.strip() for part in text.partition("="))
        if not (name and equals and value):
            faults.append(Fault(f"{option} {text}", None, "", "is not NAME=VALUE"))
            continue
        if once and name in found:
            faults.append(Fault(option, None, name, "is given twice; once is allowed"))
        found[name] = value, f"{option} {name}={value}"
    return found
