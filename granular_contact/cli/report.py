"""The command `report`: write a results folder as one self-contained HTML file."""

from __future__ import annotations

import argparse
import os
from pathlib import Path

from granular_contact.cli.common import FINE, Refusal, view

HELP = "write a results folder as one self-contained HTML file"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    text = "folder of a run, a comparison, a sweep, a search or a fit; several folders of runs make a gallery"
    parser.add_argument("directory", metavar="DIR", nargs="+", help=text)
    text = "file to write (DIR/report.html; for several folders gallery.html beside them)"
    parser.add_argument("--out", metavar="FILE", type=os.path.expanduser, help=text)
    parser.add_argument("--view", action="store_true", help="open the file in the browser")


def execute(chosen: argparse.Namespace) -> int:
    """Run the command; returns the exit code."""
    from granular_contact.report import pages

    file = Path(chosen.out) if chosen.out else None
    try:
        folders = [Path(folder) for folder in chosen.directory]
        written = pages.write(folders[0] if len(folders) == 1 else folders, file)
    except pages.FolderError as error:
        raise Refusal(f"report: {error}") from None
    except OSError as error:
        cause = error.strerror or error
        raise Refusal(f"report: {file or chosen.directory[0]} can't be written: {cause}") from None
    print(f"saved in {written}")
    if chosen.view:
        view(folders[0], written)
    return FINE
