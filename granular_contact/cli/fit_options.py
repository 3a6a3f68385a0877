"""Options of the command `fit` as the tree of a fit file, so that both are checked in the same way."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from granular_contact import examples
from granular_contact.config import is_fit, tree
from granular_contact.config.yaml_source import read_text
from granular_contact.errors import ConfigError, Fault

if TYPE_CHECKING:
    from granular_contact.studies.fit import Specification

_COMMAND = tree.Position("fit", None)  # position of faults of the whole command


def requested_fit(chosen: argparse.Namespace) -> Specification:
    """Specification of the fit from the files and options of the command; raises ConfigError with all their faults."""
    from granular_contact.studies.fit import load_specification, specification

    first = Path(chosen.files[0])
    if len(chosen.files) == 1 and (is_fit(first) or not first.exists()):
        options = [f"--{name.replace('_', '-')}" for name in _IN_FIT_FILE if getattr(chosen, name)]
        if options:
            message = "says that itself; allowed with a fit file are --workers, --out, --no-plots and --quiet"
            raise ConfigError([Fault(option, None, "", f"{first} {message}") for option in options])
        return load_specification(first)
    faults: list[Fault] = []
    root = tree.mapping(_nodes(chosen, faults), _COMMAND)
    return specification(root, Path(f"{first.stem}.yaml"), faults)


def _nodes(chosen: argparse.Namespace, faults: list[Fault]) -> dict[str, tree.Node]:
    """Nodes of the fit file by key."""
    nodes = {"runs": _runs(chosen.files, faults)}
    if chosen.parameters:
        nodes["parameters"] = _parameters(chosen, faults)
    else:
        message = "is missing; allowed are dotted keys, as medium.eta_h,medium.eta_d"
        faults.append(Fault("--parameters", None, "", message))
    columns = [text for text in (chosen.columns or "").split(",") if text.strip()]
    mappings = (("columns", columns), ("noise", chosen.noise), ("set", chosen.set), ("force_test", chosen.force_test))
    for key, texts in mappings:
        if texts:
            option = f"--{key.replace('_', '-')}"
            # As in every command, a later --set replaces an earlier one of the same key.
            pairs = _pairs(option, texts, faults, once=key != "set")
            entries = {
                name: read_text(value, place, faults, (name,), numbered=False)
                if key != "columns"
                else tree.from_plain(value, tree.Position(place, None))
                for name, (value, place) in pairs.items()
            }
            nodes[key] = tree.mapping(entries, tree.Position(option, None))
    options = {"time_offset_s": "time_offset", "loss": "loss", "starts": "starts", "seed": "seed"}
    for key, option in options.items():
        text = getattr(chosen, option)
        if text is not None:
            nodes[key] = read_text(text, f"--{option.replace('_', '-')}", faults, (), numbered=False)
    if chosen.scatter:
        nodes["scatter"] = tree.from_plain(True, tree.Position("--scatter", None))
    return nodes


# Options whose content a fit file has itself.
_IN_FIT_FILE = (
    *("parameters", "bounds", "columns", "time_offset", "noise", "force_test", "set"),
    *("scatter", "loss", "starts", "seed"),
)


def _runs(files: Sequence[str], faults: list[Fault]) -> tree.Node:
    """The list of runs: each CSV file belongs to the config before it."""
    form = "allowed are CONFIG DATA.csv [DATA.csv ...]"
    groups: list[tuple[str, list[str]]] = []
    for name in files:
        if _is_config(name):
            groups.append((name, []))
        elif groups:
            groups[-1][1].append(name)
        else:
            faults.append(Fault(name, None, "", f"stands before any config; {form}"))
    faults += [Fault(config, None, "", f"has no CSV file behind it; {form}") for config, data in groups if not data]
    runs = [(config, name) for config, data in groups for name in data]
    if not runs:
        return tree.Broken(_COMMAND)
    return tree.Items(
        _COMMAND, tuple(tree.from_plain({"config": c, "data": d}, tree.Position(d, None)) for c, d in runs)
    )


def _is_config(name: str) -> bool:
    """Return whether a file of the command line is a config: a YAML file, or the name of a shipped config."""
    return name.endswith((".yaml", ".yml")) or (not Path(name).exists() and examples.config(name) is not None)


def _parameters(chosen: argparse.Namespace, faults: list[Fault]) -> tree.Node:
    """The mapping of parameters to their bounds, from --parameters and --bounds."""
    at = tree.Position("--parameters", None)
    names = [name.strip() for name in chosen.parameters.split(",") if name.strip()]
    nodes: dict[str, tree.Node] = {name: tree.Scalar(at, None, "") for name in names}
    for key, (value, place) in _pairs("--bounds", chosen.bounds, faults).items():
        low, colon, high = value.partition(":")
        if key not in nodes:
            faults.append(Fault(place, None, key, "is none of the --parameters"))
        elif not colon:
            faults.append(Fault(place, None, key, f"got {value!r}; allowed is LOW:HIGH, as 1:40"))
        else:
            ends = {"from": low, "to": high}
            bounds = {end: read_text(text, place, faults, (key,), numbered=False) for end, text in ends.items()}
            nodes[key] = tree.mapping(bounds, tree.Position(place, None))
    return tree.mapping(nodes, at)


def _pairs(option: str, texts: Sequence[str], faults: list[Fault], once: bool = True) -> dict[str, tuple[str, str]]:
    """Values of a repeatable option NAME=VALUE by name, each with its place in messages.

    once: whether a name may be given only once.
    """
    pairs: dict[str, tuple[str, str]] = {}
    for text in texts:
        name, equals, value = (part.strip() for part in text.partition("="))
        if not (name and equals and value):
            faults.append(Fault(f"{option} {text}", None, "", "is not NAME=VALUE"))
            continue
        if once and name in pairs:
            faults.append(Fault(option, None, name, "is given twice; once is allowed"))
        pairs[name] = value, f"{option} {name}={value}"
    return pairs
