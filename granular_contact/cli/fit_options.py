"""What the command line says of a fit, as the tree of a fit file, so that both are read and checked the same way."""

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
    """Specification of the files and options chosen; ConfigError with all that is wrong with them."""
    from granular_contact.studies.fit import load_specification, specification

    first = Path(chosen.files[0])
    if len(chosen.files) == 1 and (is_fit(first) or not first.exists()):
        given = [f"--{name.replace('_', '-')}" for name in _INSTEAD if getattr(chosen, name)]
        if given:
            words = "says that itself; allowed with a fit file are --workers, --out, --no-plots and --quiet"
            raise ConfigError([Fault(option, None, "", f"{first} {words}") for option in given])
        return load_specification(first)
    faults: list[Fault] = []
    nodes = _nodes(chosen, faults)
    positions = {key: node.position for key, node in nodes.items()}
    return specification(tree.Mapping(_HERE, nodes, positions), Path(f"{first.stem}.yaml"), faults)


def _nodes(chosen: argparse.Namespace, faults: list[Fault]) -> dict[str, tree.Node]:
    """The keys of the fit file."""
    nodes = {"runs": _runs(chosen.files, faults)}
    if chosen.parameters:
        nodes["parameters"] = _parameters(chosen, faults)
    else:
        words = "is missing; allowed are dotted keys, as medium.eta_h,medium.eta_d"
        faults.append(Fault("--parameters", None, "", words))
    columns = [text for text in (chosen.columns or "").split(",") if text.strip()]
    for key, texts in (("columns", columns), ("noise", chosen.noise), ("set", chosen.set)):
        if texts:
            pairs = [_pair(f"--{key}", text, faults) for text in texts]
            found = {name: value for name, value in pairs if name}
            if key != "set":  # of which a later one replaces an earlier one in every command
                _refuse_repeats(f"--{key}", [name for name, _ in pairs if name], faults)
            nodes[key] = _mapping(f"--{key}", found, faults, read=key != "columns")
    options = {"time_offset_s": "time_offset", "loss": "loss", "starts": "starts", "seed": "seed"}
    for key, option in options.items():
        text = getattr(chosen, option)
        if text is not None:
            nodes[key] = read_text(text, f"--{option.replace('_', '-')}", faults, (), numbered=False)
    return nodes


_INSTEAD = ("parameters", "bounds", "columns", "time_offset", "noise", "loss", "starts", "seed", "set")


def _runs(files: Sequence[str], faults: list[Fault]) -> tree.Node:
    """Configs, and the CSV files behind each."""
    config: str | None = None
    runs: list[tree.Node] = []
    without: str | None = None
    for name in files:
        at = tree.Position(name, None)
        if name.endswith((".yaml", ".yml")):
            if without is not None:
                faults.append(
                    Fault(without, None, "", "has no CSV file behind it; allowed are CONFIG DATA.csv [DATA.csv ...]")
                )
            config = without = name
        elif config is None:
            faults.append(Fault(name, None, "", "stands before any config; allowed are CONFIG DATA.csv [DATA.csv ...]"))
        else:
            without = None
            held = {key: tree.Scalar(at, value, value) for key, value in (("config", config), ("data", name))}
            runs.append(tree.Mapping(at, dict(held), dict.fromkeys(held, at)))
    if without is not None:
        faults.append(Fault(without, None, "", "has no CSV file behind it; allowed are CONFIG DATA.csv [DATA.csv ...]"))
    return tree.Items(_HERE, tuple(runs)) if runs else tree.Broken(_HERE)


def _parameters(chosen: argparse.Namespace, faults: list[Fault]) -> tree.Node:
    names = [name.strip() for name in chosen.parameters.split(",") if name.strip()]
    nodes: dict[str, tree.Node] = {name: tree.Scalar(tree.Position("--parameters", None), None, "") for name in names}
    named = [text.partition("=")[0].strip() for text in chosen.bounds]
    _refuse_repeats("--bounds", named, faults)
    for text in chosen.bounds:
        key, value = _pair("--bounds", text, faults)
        low, colon, high = value.partition(":")
        at = tree.Position(f"--bounds {text}", None)
        if key and key not in nodes:
            faults.append(Fault(f"--bounds {text}", None, key, "is none of the --parameters"))
        elif key and not colon:
            faults.append(Fault(f"--bounds {text}", None, key, f"got {value!r}; allowed is LOW:HIGH, as 1:40"))
        elif key:
            sides = {"from": low, "to": high}
            held = {side: read_text(t, at.file, faults, (key,), numbered=False) for side, t in sides.items()}
            nodes[key] = tree.Mapping(at, held, dict.fromkeys(held, at))
    at = tree.Position("--parameters", None)
    return tree.Mapping(at, nodes, {name: node.position for name, node in nodes.items()})


def _refuse_repeats(option: str, names: Sequence[str], faults: list[Fault]) -> None:
    twice = [name for name in dict.fromkeys(names) if names.count(name) > 1]
    faults += [Fault(option, None, name, "is given twice; once is allowed") for name in twice]


def _pair(option: str, text: str, faults: list[Fault]) -> tuple[str, str]:
    name, equals, value = (part.strip() for part in text.partition("="))
    if not name or not equals or not value:
        faults.append(Fault(f"{option} {text}", None, "", "is no NAME=VALUE"))
        return "", ""
    return name, value


def _mapping(option: str, pairs: dict[str, str], faults: list[Fault], read: bool) -> tree.Mapping:
    """Names and values of an option; values are read as YAML, or are texts."""
    nodes: dict[str, tree.Node] = {}
    for name, value in pairs.items():
        at = tree.Position(f"{option} {name}={value}", None)
        nodes[name] = (
            read_text(value, at.file, faults, (name,), numbered=False) if read else tree.Scalar(at, value, value)
        )
    at = tree.Position(option, None)
    return tree.Mapping(at, nodes, {n: tree.Position(f"{option} {n}={pairs[n]}", None) for n in nodes})
