"""Functions that several commands share: exit codes, messages, reading a config, results folders and tables."""

from __future__ import annotations

import argparse
import os
import shutil
import sys
import tempfile
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from textwrap import fill
from typing import TYPE_CHECKING, Any, TextIO

if TYPE_CHECKING:
    from granular_contact.config import Scenario
    from granular_contact.results import Results
    from granular_contact.scene import Scene

FINE, FAULTY_INPUT, FAILED, OUT_OF_TIME, NOT_USABLE, INTERRUPTED = 0, 2, 3, 4, 5, 130
MOST_WORKERS = 256
LABEL = 18  # width of the labels in front of the values of a summary, in characters
NARROW = 70  # width of a terminal, in columns, below which a progress bar has no words
# Columns of a table: key of the number, heading, factor, format.
NumberColumns = Sequence[tuple[str, str, float, str]]
ENDS = {"failed": FAILED, "time_limit": OUT_OF_TIME, "interrupted": INTERRUPTED}


class Refusal(Exception):
    """A command can't start; the message gives the reason, and the exit code is that of faulty input."""


def complain(text: str) -> None:
    """Print lines on stderr."""
    say(text, sys.stderr)


def say(text: str, stream: TextIO | None = None) -> None:
    """Print lines, by default on stdout.

    On a terminal long lines are broken between words, and their continuation is indented.
    """
    stream = stream or sys.stdout
    width = shutil.get_terminal_size().columns if stream.isatty() else 0
    for line in text.splitlines():
        indent = " " * (LABEL if line.startswith("  ") else 2)
        if len(line) > width > 2 * len(indent):
            line = fill(line, width, subsequent_indent=indent, break_long_words=False, break_on_hyphens=False)
        print(line, file=stream)


def read(path: str, overrides: Sequence[str] = ()) -> tuple[Scenario, Scene]:
    """Scenario and scene of a config; notices are printed, and faults of the geometry have the line of their key."""
    from granular_contact import config, scene

    loaded = config.load(path, overrides)
    for notice in loaded.sources.notices:
        complain(f"notice: {notice}")
    built = scene.build(loaded)
    for note in loaded.sources.place(built.notes):
        complain(f"notice: {note}")
    return loaded.scenario, built


def exit_code(results: Results) -> int:
    """Exit code for the results of a run."""
    return ENDS.get(results.status.code, FINE if results.summary.get("usable", True) else NOT_USABLE)


def worst(runs: Iterable[Results]) -> int:
    """Exit code of several runs: of the worst one, in the order failure, time limit, unusable result."""
    return min(filter(None, map(exit_code, runs)), default=FINE)


def worker_count(text: str) -> int:
    """Number of processes from the text of an option."""
    if not text.isdecimal() or not 1 <= int(text) <= MOST_WORKERS:
        raise argparse.ArgumentTypeError(f"got {text!r}; allowed is a whole number from 1 to {MOST_WORKERS}")
    return int(text)


def reason(error: Exception) -> str:
    """Message of an exception, without the error number of the operating system."""
    if isinstance(error, OSError) and error.strerror:
        return f"{error.strerror}: {error.filename}" if error.filename else error.strerror
    return str(error)


def add_set(parser: argparse.ArgumentParser, example: str = "medium.eta_h=9") -> None:
    """Add the option --set, with an example in its help."""
    text = f"replace a value of the config, as {example}; repeatable. Paths start from the working folder"
    parser.add_argument("--set", metavar="KEY=VALUE", action="append", default=[], help=text)


def add_output(parser: argparse.ArgumentParser, default: str) -> None:
    """Add the options --out, whose default is `default` in words, and --quiet."""
    # Shells leave the ~ of --out=~/results as it is.
    parser.add_argument("--out", metavar="DIR", type=os.path.expanduser, help=f"folder of the results ({default})")
    parser.add_argument("--quiet", action="store_true", help="print faults only")


def view(directory: Path, file: Path | None = None) -> None:
    """Write the HTML page of a results folder, unless `file` already is this page, and open it in the browser.

    If no browser can be opened, the path of the page is printed.
    """
    import webbrowser

    from granular_contact.report import pages

    try:
        page = file or pages.write(directory)
    except (pages.FolderError, OSError) as error:
        raise Refusal(f"--view: {reason(error)}") from None
    if not webbrowser.open(page.resolve().as_uri()):
        complain(f"--view: no browser can be opened here; the page is {page}")


def add_comparison(parser: argparse.ArgumentParser, default: str, example: str = "medium.eta_h=9") -> None:
    """Add the arguments that all comparisons of several runs of one config have.

    default: default of --out in words; example: of --set.
    """
    parser.add_argument("config", metavar="CONFIG", help="YAML file of the run")
    parser.add_argument("--no-plots", action="store_true", help="draw no figure")
    add_set(parser, example)
    add_output(parser, default)


@contextmanager
def running(chosen: argparse.Namespace) -> Iterator[dict[str, Any]]:
    """Keyword arguments for a comparison: overrides, and callables that report its progress and what it compiles."""
    with status_line(sys.stderr.isatty() and not chosen.quiet) as progress:
        yield {"overrides": chosen.set, "progress": progress, "compiling": None if chosen.quiet else complain}


@contextmanager
def status_line(shown: bool, text: str = "running {}") -> Iterator[Callable[..., None] | None]:
    """Give a callable that shows a status on stderr: `text` with its arguments in place of {}; None if not `shown`."""
    if not shown:
        yield None
        return
    from rich.console import Console

    with Console(stderr=True).status("starting") as status:
        yield lambda *values: status.update(text.format(*values))


def columns_with_values(columns: NumberColumns, rows: Sequence[Mapping[str, Any]]) -> NumberColumns:
    """The columns for which at least one row has a number."""
    return [column for column in columns if any(row.get(column[0]) is not None for row in rows)]


def print_wide(table: Any, least: int = 120) -> None:
    """Print a table of text, folded to the width of the terminal or to `least` columns, whichever is wider."""
    from rich.console import Console

    console = Console()
    Console(width=max(least, console.width)).print(table)


def print_numbers(
    heads: Sequence[str], columns: NumberColumns, rows: Iterable[tuple[Sequence[str], Mapping[str, Any]]]
) -> None:
    """Print a table: text columns with these heads, then columns of numbers, with a dash for None.

    rows: for each row the cells of the text columns, and its numbers by key.
    """

    def cell(value: float | None, factor: float, form: str) -> str:
        if value is None:
            return "-"
        text = format(factor * value, form)
        # A number that `form` rounds to zero gets three significant digits instead.
        return text if float(text) or not value else format(factor * value, ".3g")

    cells = ([*texts, *(cell(row.get(key), factor, form) for key, _, factor, form in columns)] for texts, row in rows)
    print_table(heads[0], [*heads[1:], *(heading for _, heading, _, _ in columns)], cells)


def print_table(first: str, heads: Sequence[str], rows: Iterable[Sequence[str]]) -> None:
    """Print a table whose first column, with the head `first`, has names and whose other columns have numbers."""
    from rich.console import Console
    from rich.table import Table

    console, rows = Console(markup=False, highlight=False, emoji=False), list(rows)
    table_width = sum(max(map(len, cells)) + 2 for cells in zip((first, *heads), *rows, strict=True))
    if console.is_terminal and console.width < table_width:  # the numbers of a row below one another
        head_width = max(map(len, heads), default=0)
        for name, *cells in rows:
            console.print(name)
            for head, cell in zip(heads, cells, strict=True):
                console.print(f"  {head:{head_width}}  {cell}")
        return
    table = Table(first, box=None, pad_edge=False)
    for head in heads:
        table.add_column(head, justify="right")
    for row in rows:
        table.add_row(*row)
    console.width = max(120, console.width)
    console.print(table)


def output_folder(out: str | None, name: str, kind: str = "run") -> Path:
    """The folder of the option --out, or results/NAME.

    Before the run this function tries whether results of a kind (of `report.ENTRIES`) can be written there. The trial
    leaves no file.

    Raises
    ------
    Refusal
        They can't be written.
    """
    from granular_contact import report

    folder = Path(out) if out else Path("results", name)
    try:
        report.check_target(folder, kind)
        # Results are made in a new folder beside `folder`. If its parent is missing, the nearest existing one decides.
        nearest = folder.resolve().parent
        while not nearest.exists():
            nearest = nearest.parent
        if not nearest.is_dir():
            raise Refusal(f"--out {folder}: {nearest} is a file, so no folder can be made in it")
        with tempfile.TemporaryDirectory(dir=nearest, prefix=f".{folder.resolve().name}."):
            return folder
    except OSError as error:
        # `check_target` raises whole sentences, the operating system an error number with a short reason.
        message = f"can't be written: {error.strerror}" if error.strerror else str(error)
        raise Refusal(f"--out {folder}: {message}") from None
