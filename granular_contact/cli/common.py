"""What several commands share: exit codes, complaints, reading a config, and whether a folder can take results."""

from __future__ import annotations

import argparse
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
LABEL = 18  # characters before the values of a summary
NARROW = 70  # columns of a terminal on which a bar does without words
# Columns of a table: key of the number, heading, factor, format.
Shown = Sequence[tuple[str, str, float, str]]
ENDS = {"failed": FAILED, "time_limit": OUT_OF_TIME, "interrupted": INTERRUPTED}


class Refusal(Exception):
    """Why a command does not start, as a sentence; the exit code is that of faulty input."""


def complain(text: str) -> None:
    """Say what is wrong."""
    say(text, sys.stderr)


def say(text: str, stream: TextIO | None = None) -> None:
    """Print lines, on stdout unless given; a terminal gets them broken between words, what goes on with an indent."""
    stream = stream or sys.stdout
    width = shutil.get_terminal_size().columns if stream.isatty() else 0
    for line in text.splitlines():
        own = " " * (LABEL if line.startswith("  ") else 2)
        if len(line) > width > 2 * len(own):
            line = fill(line, width, subsequent_indent=own, break_long_words=False, break_on_hyphens=False)
        print(line, file=stream)


def read(path: str, overrides: Sequence[str] = ()) -> tuple[Scenario, Scene]:
    """Scenario and scene of a config; a fault of the geometry gets the line that its key was written in."""
    from granular_contact import config, scene

    loaded = config.load(path, overrides)
    for notice in loaded.sources.notices:
        complain(f"notice: {notice}")
    built = scene.build(loaded)
    for note in loaded.sources.place(built.notes):
        complain(f"notice: {note}")
    return loaded.scenario, built


def exit_code(results: Results) -> int:
    """Exit code of a run."""
    return ENDS.get(results.status.code, FINE if results.summary.get("usable", True) else NOT_USABLE)


def worst(runs: Iterable[Results]) -> int:
    """Exit code of several runs: a failure counts more than a time limit, and that more than a useless result."""
    return min(filter(None, map(exit_code, runs)), default=FINE)


def worker_count(text: str) -> int:
    """Number of processes that was asked for."""
    if not text.isdecimal() or not 1 <= int(text) <= MOST_WORKERS:
        raise argparse.ArgumentTypeError(f"got {text!r}; allowed is a whole number from 1 to {MOST_WORKERS}")
    return int(text)


def reason(error: Exception) -> str:
    """What went wrong, without the system's numbers."""
    if isinstance(error, OSError) and error.strerror:
        return f"{error.strerror}: {error.filename}" if error.filename else error.strerror
    return str(error)


def add_set(parser: argparse.ArgumentParser, example: str = "medium.eta_h=9") -> None:
    """Add the argument --set, with an example in its help."""
    words = f"replace a value, as {example}; repeatable. Paths start from the folder that you are in"
    parser.add_argument("--set", metavar="KEY=VALUE", action="append", default=[], help=words)


def add_output(parser: argparse.ArgumentParser, default: str) -> None:
    """Add --out, whose default is `default` in words, and --quiet."""
    parser.add_argument("--out", metavar="DIR", help=f"folder of the results ({default})")
    parser.add_argument("--quiet", action="store_true", help="print faults only")


def view(directory: Path, file: Path | None = None) -> None:
    """Write the page of a results folder, unless `file` is it, and open it in the browser; say where it is if none."""
    import webbrowser

    from granular_contact.report import pages

    try:
        page = file or pages.write(directory)
    except (pages.FolderError, OSError) as error:
        raise Refusal(f"--view: {reason(error)}") from None
    if not webbrowser.open(page.resolve().as_uri()):
        complain(f"--view: no browser can be opened here; the page is {page}")


def add_comparison(parser: argparse.ArgumentParser, default: str, example: str = "medium.eta_h=9") -> None:
    """Add what comparisons of several runs of one config take beside what they compare; as `add_output`, `add_set`."""
    parser.add_argument("config", metavar="CONFIG", help="YAML file of the run")
    parser.add_argument("--no-plots", action="store_true", help="draw no figure")
    add_set(parser, example)
    add_output(parser, default)


@contextmanager
def running(chosen: argparse.Namespace) -> Iterator[dict[str, Any]]:
    """Arguments of a comparison that say what it is at, and what it compiles; none if nothing is to be said."""
    with telling(sys.stderr.isatty() and not chosen.quiet) as progress:
        yield {"overrides": chosen.set, "progress": progress, "compiling": None if chosen.quiet else complain}


@contextmanager
def telling(shown: bool, text: str = "running {}") -> Iterator[Callable[..., None] | None]:
    """Give a callable that shows a text on stderr, with its arguments in the places of {}, or None."""
    if not shown:
        yield None
        return
    from rich.console import Console

    with Console(stderr=True).status("starting") as status:
        yield lambda *what: status.update(text.format(*what))


def there(shown: Shown, rows: Sequence[Mapping[str, Any]]) -> Shown:
    """Those of the shown numbers that any of the rows has."""
    return [one for one in shown if any(row.get(one[0]) is not None for row in rows)]


def print_wide(table: Any, least: int = 120) -> None:
    """Print a table of words that is folded to the terminal, but to no fewer than so many columns."""
    from rich.console import Console

    console = Console()
    Console(width=max(least, console.width)).print(table)


def print_numbers(heads: Sequence[str], shown: Shown, rows: Iterable[tuple[Sequence[str], Mapping[str, Any]]]) -> None:
    """Print a table of the shown numbers, a dash for None, behind columns of words, whose heads are given."""

    def cell(value: float | None, factor: float, form: str) -> str:
        if value is None:
            return "-"
        words = format(factor * value, form)
        return words if float(words) or not value else format(factor * value, ".3g")  # too small for its digits

    cells = ([*words, *(cell(row.get(key), factor, form) for key, _, factor, form in shown)] for words, row in rows)
    print_table(heads[0], [*heads[1:], *(heading for _, heading, _, _ in shown)], cells)


def print_table(first: str, heads: Sequence[str], rows: Iterable[Sequence[str]]) -> None:
    """Print a table whose first column has names and the others numbers."""
    from rich.console import Console
    from rich.table import Table

    console, rows = Console(markup=False, highlight=False, emoji=False), list(rows)
    wide = sum(max(map(len, cells)) + 2 for cells in zip((first, *heads), *rows, strict=True))
    if console.is_terminal and console.width < wide:  # a column would be broken: one number below another
        size = max(map(len, heads), default=0)
        for name, *cells in rows:
            console.print(name)
            for head, cell in zip(heads, cells, strict=True):
                console.print(f"  {head:{size}}  {cell}")
        return
    table = Table(first, box=None, pad_edge=False)
    for head in heads:
        table.add_column(head, justify="right")
    for row in rows:
        table.add_row(*row)
    console.width = max(120, console.width)
    console.print(table)


def output_folder(out: str | None, name: str, kind: str = "run") -> Path:
    """The folder that was asked for, or results/NAME.

    Whether it can take results of a kind (of `report.ENTRIES`) is tried before the run, and leaves nothing behind.

    Raises
    ------
    Refusal
        It can't.
    """
    from granular_contact import report

    folder = Path(out) if out else Path("results", name)
    try:
        report.check_target(folder, kind)
        # The new folder is made beside the old one; where even the parent is missing, the nearest one there is decides.
        nearest = folder.resolve().parent
        while not nearest.exists():
            nearest = nearest.parent
        if not nearest.is_dir():
            raise Refusal(f"--out {folder}: {nearest} is a file, so no folder can be made in it")
        with tempfile.TemporaryDirectory(dir=nearest, prefix=f".{folder.resolve().name}."):
            return folder
    except OSError as error:
        # `check_target` raises sentences; the system raises numbers with a short reason.
        reason = f"can't be written: {error.strerror}" if error.strerror else str(error)
        raise Refusal(f"--out {folder}: {reason}") from None
