"""The command `schema`: what a config, or the file of a sweep, a fit or a search, may hold, for editors."""

from __future__ import annotations

import argparse
import json

from granular_contact import config
from granular_contact.cli.common import FINE

HELP = "print the JSON Schema of a config, or of the file of a sweep, a fit or a search"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument(
        "kind", nargs="?", choices=("run", "sweep", "fit", "optimise"), default="run", help="which of them (run)"
    )


def act(chosen: argparse.Namespace) -> int:
    """Run the command; returns the exit code."""
    print(json.dumps(config.json_schema(chosen.kind), indent=2))
    return FINE
