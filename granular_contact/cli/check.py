"""The command `check`: faults of configs and sweeps, without a run."""

from __future__ import annotations

import argparse

from granular_contact import config
from granular_contact.cli.common import FAULTY_INPUT, FINE, complain, read
from granular_contact.errors import ConfigError, SceneError

HELP = "read configs and sweeps, and their geometry, without a run"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("configs", metavar="FILE", nargs="+")


def act(chosen: argparse.Namespace) -> int:
    """Run the command; returns the exit code."""
    fine = [_is_fine(path) for path in chosen.configs]
    return FINE if all(fine) else FAULTY_INPUT


def _is_fine(path: str) -> bool:
    from granular_contact import scene

    try:
        if config.is_sweep(path):
            config.load_sweep(path, probe=scene.build)
        else:
            read(path)
    except (ConfigError, SceneError) as error:
        complain(str(error))
        return False
    print(f"{path}: ok")
    return True
