"""The command `validate`: run the studies of a checkout. They are not part of the installed package."""

from __future__ import annotations

import argparse
import importlib
import sys
from pathlib import Path

from granular_contact.cli.common import Refusal

HELP = "run the studies of a checkout and report which claims hold"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("--quick", action="store_true", help="fewer cases for the same claims")
    parser.add_argument("--only", action="append", default=[], metavar="NAME", help="run this study only; repeatable")
    parser.add_argument("--list", action="store_true", help="list the studies, their durations and records; run none")
    parser.add_argument("--record", action="store_true", help="write tables and claims into the pages of the studies")


def execute(chosen: argparse.Namespace) -> int:
    """Run the command; returns the exit code."""
    places = [Path.cwd(), Path(__file__).parents[2]]
    root = next((place for place in places if (place / "validation" / "run_all.py").is_file()), None)
    if root is None:
        hint = "run it in a checkout of the project"
        raise Refusal(f"validate: there is no validation/run_all.py in {places[0]}; {hint}")
    sys.path.insert(0, str(root))
    run_all = importlib.import_module("validation.run_all")
    names = [entry.name for entry in run_all.STUDIES]
    for name in chosen.only:
        if name not in names:
            raise Refusal(f"validate: there is no study {name!r}; there are {', '.join(names)}")
    if chosen.list:
        print(run_all.table())
        return 0
    code: int = run_all.main(chosen.quick, chosen.record, chosen.only)
    return code
