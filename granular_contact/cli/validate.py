"""The command `validate`: the studies of a checkout. They are no part of the installed package."""

from __future__ import annotations

import argparse
import importlib
import sys
from pathlib import Path

from granular_contact.cli.common import Refusal

HELP = "run the studies of a checkout and say which claims hold"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("--quick", action="store_true", help="fewer cases, same claims")
    parser.add_argument("--record", action="store_true", help="record the results of the studies")


def execute(chosen: argparse.Namespace) -> int:
    """Run the command; returns the exit code."""
    places = [Path.cwd(), Path(__file__).parents[2]]
    root = next((place for place in places if (place / "validation" / "run_all.py").is_file()), None)
    if root is None:
        words = "run it in a checkout of the project"
        raise Refusal(f"validate: there is no validation/run_all.py in {places[0]}; {words}")
    sys.path.insert(0, str(root))
    code: int = importlib.import_module("validation.run_all").main(chosen.quick, chosen.record)
    return code
