"""The command `schema`: what a config, a model, a medium, or the file of many runs may hold, for editors."""

from __future__ import annotations

import argparse
import json

from granular_contact import config
from granular_contact.cli.common import FINE, Refusal
from granular_contact.config.export import SCHEMAS

HELP = "print the JSON Schema of a config, a model, a medium, or the file of a sweep, a fit or a search, for editors"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("kind", nargs="?", choices=SCHEMAS, help=argparse.SUPPRESS)  # as it was called once
    parser.add_argument("--of", choices=SCHEMAS, help="which of them (run)")


def act(chosen: argparse.Namespace) -> int:
    """Run the command; returns the exit code."""
    if chosen.kind and chosen.of:
        raise Refusal(f"schema: got {chosen.kind} and --of {chosen.of}; allowed is one of them")
    print(json.dumps(config.json_schema(chosen.of or chosen.kind or "run"), indent=2))
    return FINE
