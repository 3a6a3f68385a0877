"""The command `compare`: run a config with several models of its flexible link, and print a table and a verdict."""

from __future__ import annotations

import argparse
from pathlib import Path

from granular_contact.cli.common import add_comparison, output_folder, print_numbers, running, say, worst

HELP = "run a config with several models and say which is accurate enough"
SHOWN = (
    ("stopping_time_s", "stop ms", 1e3, ".3f"),
    ("angle_at_stop_deg", "angle deg", 1.0, ".4f"),
    ("max_deflection_m", "peak um", 1e6, ".1f"),
    ("stopping_time_relative", "stop %", 1e2, "+.3f"),
    ("travel_relative", "travel %", 1e2, "+.3f"),
    ("motion_relative", "motion %", 1e2, ".3f"),
    ("deflection_relative", "peak %", 1e2, "+.2f"),
    ("angle_rms_deg", "rms mdeg", 1e3, ".2f"),
    ("deflection_rms_m", "rms um", 1e6, ".2f"),
    ("motion_m", "apart um", 1e6, ".1f"),
    ("solve_s", "run ms", 1e3, ".2f"),
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    text = "numbers of modes of the modal models (0,1,2,5); '' for none, where a mechanism has no modes"
    parser.add_argument("--modes", metavar="N,N", type=_counts, default=(0, 1, 2, 5), help=text)
    text = "numbers of elements of the beam models (4,8,16,32)"
    parser.add_argument("--elements", metavar="N,N", type=_counts, default=(4, 8, 16, 32), help=text)
    text = "relative difference from the reference that is accurate enough (0.01)"
    parser.add_argument("--tolerance", metavar="X", type=_tolerance, default=0.01, help=text)
    add_comparison(parser, "results/NAME_OF_CONFIG_compare")


def _counts(text: str) -> tuple[int, ...]:
    """Whole numbers from the text of an option, separated by commas."""
    parts = [part.strip() for part in text.split(",") if part.strip()]
    if not all(part.lstrip("-").isdecimal() for part in parts):
        raise argparse.ArgumentTypeError(f"got {text!r}; allowed are whole numbers with commas, as 0,1,5")
    return tuple(int(part) for part in parts)


def _tolerance(text: str) -> float:
    """A number between 0 and 1 from the text of an option."""
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    if not 0.0 < value < 1.0:
        raise argparse.ArgumentTypeError(f"got {text!r}; allowed is a number between 0 and 1")
    return value


def execute(chosen: argparse.Namespace) -> int:
    """Run the command; returns the exit code."""
    from granular_contact.studies.compare import cells, compare, write

    folder = output_folder(chosen.out, f"{Path(chosen.config).stem}_compare", "compare")
    with running(chosen) as progress:
        comparison = compare(chosen.config, chosen.modes, chosen.elements, tolerance=chosen.tolerance, **progress)
    write(comparison, folder, figures=not chosen.no_plots)
    if not chosen.quiet:
        rows = [cells(row) for row in comparison.rows]
        shown = [column for column in SHOWN if column[0] in rows[0]]
        print_numbers(["model"], shown, (([str(row["model"])], row) for row in rows))
        say(comparison.verdict)
        say(f"saved in {folder}")
    return worst(row.results for row in comparison.rows)
