"""The command `schema`: print or write the JSON Schemas of all kinds of files, for editors."""

from __future__ import annotations

import argparse
import json
from pathlib import Path

from granular_contact.cli.common import FINE, Refusal, reason

HELP = "print the JSON Schema of a config, a model, a medium, or the file of a sweep, a fit or a search, for editors"
SCHEMAS = ("run", "model", "medium", "sweep", "fit", "optimise")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("--of", choices=SCHEMAS, default="run", help="kind of file (%(default)s)")
    text = "write the schemas of all kinds into a folder, with the names that the first lines of the shipped files use"
    parser.add_argument("--write", metavar="DIR", help=text)


def execute(chosen: argparse.Namespace) -> int:
    """Run the command; returns the exit code."""
    if chosen.write:
        return _written(Path(chosen.write))
    from granular_contact.config import json_schema

    print(json.dumps(json_schema(chosen.of), indent=2))
    return FINE


def files() -> dict[str, bytes]:
    """Schemas of all kinds of files as JSON, by the name of the schema file, for example `run.json`."""
    from granular_contact.config import json_schema

    texts = {kind: json.dumps(json_schema(kind), ensure_ascii=False, separators=(",", ":")) for kind in SCHEMAS}
    return {f"{kind}.json": f"{text}\n".encode() for kind, text in texts.items()}


def _written(folder: Path) -> int:
    """Write the schemas of all kinds of files; return the exit code."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for name, content in files().items():
            (folder / name).write_bytes(content)
    except OSError as error:
        raise Refusal(f"schema: {folder} can't be written: {reason(error)}") from None
    print(f"{', '.join(SCHEMAS)} are in {folder}")
    return FINE
