"""The command `validate`: the studies of a checkout. They are no part of the installed package."""

from __future__ import annotations

import argparse
import importlib
import sys
from pathlib import Path

from granular_contact.cli import FAULTY_INPUT, complain


def run(chosen: argparse.Namespace) -> int:
    """Run the command; returns the exit code."""
    places = [Path.cwd(), Path(__file__).parents[1]]
    root = next((place for place in places if (place / "validation" / "run_all.py").is_file()), None)
    if root is None:
        complain(f"validate: there is no validation/run_all.py in {places[0]}; run it in a checkout of the project")
        return FAULTY_INPUT
    sys.path.insert(0, str(root))
    code: int = importlib.import_module("validation.run_all").main(chosen.quick, chosen.record)
    return code
