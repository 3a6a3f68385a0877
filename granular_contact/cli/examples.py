"""The command `examples`: write the models and configs of the package, and their schemas, into a folder."""

from __future__ import annotations

import argparse
import shlex
from pathlib import Path

from granular_contact.cli import schema
from granular_contact.cli.common import FINE, Refusal

HELP = "write the models and configs that come with the package into a folder"
FIRST = "configs/pendulum.yaml"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("directory", metavar="DIR", help="folder to write into; nothing in it is overwritten")


def execute(chosen: argparse.Namespace) -> int:
    """Run the command; returns the exit code."""
    from granular_contact import examples

    folder = Path(chosen.directory)
    try:
        # The schemas are made now, so that they contain the laws that are registered now.
        written = examples.write(folder, {f"schemas/{name}": content for name, content in schema.files().items()})
    except OSError as error:
        # `examples.write` raises whole sentences, the operating system an error number with a short reason.
        message = f"{folder} cannot be written: {error.strerror}" if error.strerror else error
        raise Refusal(f"examples: {message}") from None
    kinds = [name.split("/")[0] for name in written if name.endswith(".yaml")]
    configs, models = kinds.count("configs"), kinds.count("models")
    print(f"{configs} configs and {models} models are in {folder}; the next step, for example:")
    print(f"  cd {shlex.quote(str(folder))}")
    print(f"  granular-contact run {FIRST} --animate")
    return FINE
