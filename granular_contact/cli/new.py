"""The command `new`: write a commented config that contains its mechanism, as a starting point."""

from __future__ import annotations

import argparse
import os
import shlex
from pathlib import Path

from granular_contact.cli.common import FINE, Refusal

HELP = "write a commented config that contains its mechanism, as a starting point"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    text = "shipped model or config to copy, as runner; without it all are listed"
    parser.add_argument("model", metavar="MODEL", nargs="?", help=text)
    parser.add_argument("--out", metavar="FILE", type=os.path.expanduser, help="file to write (my_MODEL.yaml)")


def execute(chosen: argparse.Namespace) -> int:
    """Run the command; returns the exit code."""
    from granular_contact import starter

    if chosen.model is None:
        print("granular-contact new MODEL writes my_MODEL.yaml; MODEL is one of:")
        for name, config in sorted(starter.names().items()):
            print(f"  {name:18} {starter.about(config)}")
        return FINE
    path = Path(chosen.out or f"my_{chosen.model.removesuffix('.yaml')}.yaml")
    try:
        text = starter.text(chosen.model, path.name)
    except KeyError:
        raise Refusal(starter.no_such(chosen.model)) from None
    try:
        with path.open("x", encoding="utf-8") as file:
            file.write(text)
    except FileExistsError:
        raise Refusal(f"{path} is there already; give another file with --out") from None
    except OSError as error:
        raise Refusal(f"{path} can't be written: {error.strerror}") from None
    print(f"{path} holds the mechanism and its run; change it, and then:")
    print(f"  granular-contact check {shlex.quote(str(path))}")
    print(f"  granular-contact run {shlex.quote(str(path))} --animate")
    return FINE
