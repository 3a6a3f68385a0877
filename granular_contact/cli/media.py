"""The command `media`: list the presets, or print one with its law, its numbers and their source, and draw it."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from granular_contact.cli.common import FINE, add_output, output_folder, print_wide

if TYPE_CHECKING:
    from granular_contact.laws.law import Law

HELP = "list the media, or show one with its equation, source, range and forces"
ABOUT = ("law", "name", "source", "standing", "provenance", "range")  # keys of a medium that have rows of their own
QUANTITIES = (("speed_m_s", "m/s"), ("depth_m", "m"), ("size_m", "m"))  # keys of the range, and their units


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    text = "preset, or YAML file of a medium; without it all presets are listed"
    parser.add_argument("name", metavar="NAME", nargs="?", help=text)
    add_output(parser, "results/media_NAME")


def execute(chosen: argparse.Namespace) -> int:
    """Run the command; returns the exit code."""
    if chosen.name is None:
        _list()
        return FINE
    from granular_contact.config import load_medium

    spec = load_medium(chosen.name)
    folder = output_folder(chosen.out, f"media_{Path(chosen.name).stem}", "media")
    if not chosen.quiet:
        _show(spec)
    return _draw(spec, folder, chosen.quiet)


def _list() -> None:
    """Print a table of all presets."""
    from rich.table import Table

    from granular_contact.config import load_medium, medium_names

    table = Table(box=None, pad_edge=False)
    for head in ("name", "law", "takes", "range", "standing", "source"):
        table.add_column(head, overflow="fold", no_wrap=head in ("name", "law"))
    for name in medium_names():
        spec = load_medium(name)
        takes = ", ".join(sorted(spec.takes))
        table.add_row(name, spec.law, takes, _range(spec), spec.standing or "-", spec.source or "-")
    print_wide(table)


def _range(spec: Law) -> str:
    """Measured ranges of speed, depth and size of a medium, in words."""
    ranges = spec.validity.model_dump(by_alias=True)
    stated = ((key, unit, *ranges[key]) for key, unit in QUANTITIES if ranges[key] is not None)
    return ", ".join(f"{key.split('_')[0]} {a:g} to {b:g} {unit}" for key, unit, a, b in stated) or "not stated"


def _show(spec: Law) -> None:
    """Print a table of one medium."""
    from rich.table import Table
    from rich.text import Text

    from granular_contact.laws.gravity import key_of, scalings
    from granular_contact.laws.kinds import ELEMENT_NAMES, SHAPE_NAMES
    from granular_contact.sand.kernels.space_joining import kinds_of

    table = Table(box=None, pad_edge=False, show_header=False)
    table.add_column(style="bold")
    table.add_column(overflow="fold")
    table.add_row("law", spec.law)
    table.add_row("equation", Text(spec.equation))
    table.add_row("takes in the plane", ", ".join(words for kind, words in SHAPE_NAMES.items() if kind in spec.takes))
    kinds_in_space = kinds_of(type(spec))
    in_space = ", ".join(words for kind, words in ELEMENT_NAMES.items() if kind in kinds_in_space)
    table.add_row("in space", in_space or "nothing")
    for key, value in spec.model_dump(mode="json", by_alias=True).items():
        if key not in ABOUT:
            table.add_row(key, "not stated by the source: give it in the run" if key in spec.lacking else _value(value))
    table.add_row("range", _range(spec))
    gravity = (f"{key_of(type(spec), name)} {scaling}" for name, scaling in scalings(type(spec)).items())
    table.add_row("with gravity g", "\n".join(gravity))
    for key in ("standing", "provenance", "source"):
        table.add_row(key, getattr(spec, key) or "not stated")
    print_wide(table, 100)


def _value(value: Any) -> str:
    """A value of a medium in a cell."""
    if isinstance(value, dict):
        return ", ".join(f"{key} {_value(part)}" for key, part in value.items())
    if isinstance(value, list):
        return "\n".join(map(_value, value)) or "none"
    if isinstance(value, str):
        return value
    return "-" if value is None else f"{value:g}"


def _draw(spec: Law, folder: Path, quiet: bool) -> int:
    """Draw the forces of a medium into a folder, if all numbers are stated; return the exit code."""
    if spec.lacking:
        if not quiet:
            print("no figure: the forces need what the source does not state")
        return FINE
    from granular_contact.laws.probe import panels
    from granular_contact.report import LAW, whole_folder
    from granular_contact.report.figures.laws import draw_law

    with whole_folder(folder, "media") as making:
        draw_law(f"{spec.name}: {spec.equation}", panels(spec), making / LAW)
    if not quiet:
        print(f"saved in {folder}")
    return FINE
