"""The command `compare-media`: one config in several media, their table and figure."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from granular_contact.cli.common import (
    add_output,
    add_set,
    complain,
    number,
    output_folder,
    print_table,
    telling,
    worst,
)

if TYPE_CHECKING:
    from collections.abc import Iterator

    from granular_contact.studies.compare_media import Row

HELP = "run a config in several media"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("config", metavar="CONFIG", help="YAML file of the run")
    words = "presets or YAML files of media; a+b for media that act together"
    parser.add_argument("--media", metavar="A,B", type=_names, required=True, help=words)
    add_set(parser, example="initial.impact_speed_rad_s=4")
    parser.add_argument("--no-plots", action="store_true", help="draw no figure")
    add_output(parser, "results/NAME_OF_CONFIG_media")


def _names(text: str) -> tuple[str, ...]:
    return tuple(part.strip() for part in text.split(",") if part.strip())


def act(chosen: argparse.Namespace) -> int:
    """Run the command; returns the exit code."""
    from granular_contact.studies.compare_media import compare_media, write

    folder = output_folder(chosen.out, f"{Path(chosen.config).stem}_media", "compare-media")
    with telling(sys.stderr.isatty() and not chosen.quiet) as progress:
        compiling = None if chosen.quiet else complain
        rows = compare_media(chosen.config, chosen.media, overrides=chosen.set, progress=progress, compiling=compiling)
    write(rows, folder, figures=not chosen.no_plots)
    if not chosen.quiet:
        print_table("medium", HEADS, ([row.name, *_cells(row)] for row in rows))
        for row in rows:
            for warning in row.results.warnings:
                print(f"{row.name}: {warning}")
        print(f"saved in {folder}")
    return worst(row.results.status.code for row in rows)


HEADS = ("ended", "stop ms", "angle deg", "depth mm", "peak force N", "taken J", "imbalance")


def _cells(row: Row) -> Iterator[str]:
    summary = row.results.summary
    yield summary["status"]
    yield number(summary["stopping_time_s"], 1e3, ".3f")
    yield number(summary["angle_at_stop_deg"], 1.0, ".3f")
    yield number(summary["max_depth_m"], 1e3, ".2f")
    yield number(row.peak_force, 1.0, ".2f")
    yield number(-summary["energy"]["granular_work_J"], 1.0, ".4f")
    yield number(summary["energy"]["imbalance_relative"], 1.0, ".1e")
