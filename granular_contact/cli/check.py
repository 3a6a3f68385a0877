"""The command `check`: faults of configs, sweeps, searches and fit files, without fitting or saving anything."""

from __future__ import annotations

import argparse

from granular_contact import config
from granular_contact.cli.common import FAULTY_INPUT, FINE, complain, read
from granular_contact.errors import ConfigError, SceneError

HELP = "read configs, sweeps, searches and fit files, with their geometry and data"


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
        elif config.is_optimise(path):
            config.load_optimise(path, probe=scene.build)
        elif config.is_fit(path):
            from granular_contact.studies.fit import load_specification, prepare

            prepare(load_specification(path))
        else:
            read(path)
    except (ConfigError, SceneError) as error:
        complain(str(error))
        return False
    print(f"{path}: ok")
    return True
