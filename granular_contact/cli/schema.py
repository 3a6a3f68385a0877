"""The command `schema`: what a config may hold, for editors."""

from __future__ import annotations

import argparse
import json

from granular_contact import config
from granular_contact.cli.common import FINE

HELP = "print the JSON Schema of a config"


def add_arguments(_: argparse.ArgumentParser) -> None:
    """The command takes none."""


def act(_: argparse.Namespace) -> int:
    """Run the command; returns the exit code."""
    print(json.dumps(config.json_schema(), indent=2))
    return FINE
