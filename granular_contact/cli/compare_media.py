"""The command `compare-media`: run a config in several media, and print a table."""

from __future__ import annotations

import argparse
from pathlib import Path

from granular_contact.cli.common import (
    add_comparison,
    columns_with_values,
    output_folder,
    print_numbers,
    running,
    say,
    worst,
)

HELP = "run a config in several media"
SHOWN = (
    ("stopping_time_s", "stop ms", 1e3, ".3f"),
    ("angle_at_stop_deg", "angle deg", 1.0, ".3f"),
    ("max_depth_m", "depth mm", 1e3, ".2f"),
    ("peak_force_N", "peak force N", 1.0, ".2f"),
    ("forward_speed_m_s", "speed m/s", 1.0, ".4f"),
    ("cost_of_transport", "cost", 1.0, ".3f"),
    ("granular_work_J", "dissipated J", -1.0, ".4f"),
    ("energy_imbalance_relative", "imbalance", 1.0, ".1e"),
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    text = "presets or YAML files of media, separated by commas; A+B for two media that act together"
    parser.add_argument("--media", metavar="A,B", type=_names, required=True, help=text)
    add_comparison(parser, "results/NAME_OF_CONFIG_media", "initial.impact_speed_rad_s=4")


def _names(text: str) -> tuple[str, ...]:
    """Names from the text of an option, separated by commas."""
    return tuple(part.strip() for part in text.split(",") if part.strip())


def execute(chosen: argparse.Namespace) -> int:
    """Run the command; returns the exit code."""
    from granular_contact.studies.compare_media import cells, compare_media, write

    folder = output_folder(chosen.out, f"{Path(chosen.config).stem}_media", "compare-media")
    with running(chosen) as progress:
        rows = compare_media(chosen.config, chosen.media, **progress)
    write(rows, folder, figures=not chosen.no_plots)
    if not chosen.quiet:
        table = [([row.name, row.results.status.code], cells(row)) for row in rows]
        print_numbers(["medium", "ended"], columns_with_values(SHOWN, [numbers for _, numbers in table]), table)
        for row in rows:
            for warning in row.results.warnings:
                say(f"{row.name}: {warning}")
        say(f"saved in {folder}")
    return worst(row.results for row in rows)
