"""The command `sweep`: cases run and shown, their table saved, also of those that were finished before a Ctrl-C."""

from __future__ import annotations

import argparse
import shutil
import sys
import time
from collections.abc import Callable, Generator, Iterator, Sequence
from contextlib import closing, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from granular_contact.cli.common import FAILED, FAULTY_INPUT, FINE, INTERRUPTED, add_output, complain, folder_problem
from granular_contact.config import Sweep, load_sweep

if TYPE_CHECKING:
    from granular_contact.sweep import Row

HELP = "simulate many cases of a config on all cores, a row of a table each"
MOST_WORKERS = 256
MOST_SHOWN = 40  # rows; the rest is in the table
# Summary key, heading, factor, format.
_SHOWN = (
    ("stopping_time_s", "stop ms", 1e3, ".2f"),
    ("angle_at_stop_deg", "angle deg", 1.0, ".3f"),
    ("max_depth_m", "depth mm", 1e3, ".2f"),
    ("energy.imbalance_relative", "imbalance", 1.0, ".1e"),
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("file", metavar="FILE", help="YAML file with a config, and cases or vary")
    parser.add_argument("--workers", metavar="N", type=_worker_count, help="processes to run in (one a core)")
    parser.add_argument("--plots", action="store_true", help="save a folder with series and figures for each case")
    add_output(parser, "results/NAME_OF_FILE")


def _worker_count(text: str) -> int:
    if not text.isdecimal() or not 1 <= int(text) <= MOST_WORKERS:
        raise argparse.ArgumentTypeError(f"got {text!r}; allowed is a whole number from 1 to {MOST_WORKERS}")
    return int(text)


def act(chosen: argparse.Namespace) -> int:
    """Run the command; returns the exit code."""
    from granular_contact import report, scene
    from granular_contact.sweep import run, table

    cases = load_sweep(chosen.file, probe=scene.build)
    folder = Path(chosen.out) if chosen.out else Path("results", Path(chosen.file).stem)
    problem = folder_problem(folder, "sweep")
    if problem:
        complain(problem)
        return FAULTY_INPUT
    begin = time.perf_counter()
    rows: list[Row] = []
    try:
        with report.whole_folder(folder, "sweep") as making:
            case_folders = making / report.CASES if chosen.plots else None
            shown = sys.stderr.isatty() and not chosen.quiet
            with _progress(shown, len(cases.cases)) as advance:
                interrupted = _collect(run(cases, chosen.workers, case_folders), rows, advance)
            _drop_unfinished(case_folders, {row.name for row in rows})
            table.write(cases, rows, making)
    except OSError as error:
        complain(f"the sweep can't go on, or can't be saved in {folder}: {error}")
        return FAULTY_INPUT
    rows.sort(key=lambda row: row.index)
    if not chosen.quiet:
        _show(cases, rows, time.perf_counter() - begin, folder)
    failed = sum(row.failed for row in rows)
    if interrupted:
        complain(f"interrupted; the {len(rows)} of {len(cases.cases)} cases that were finished are saved in {folder}")
        return INTERRUPTED
    if failed:
        complain(f"{failed} of {len(rows)} cases failed; saved in {folder}")
    return FAILED if failed else FINE


def _collect(coming: Generator[Row, None, None], rows: list[Row], advance: Callable[[], None]) -> bool:
    """Append all rows that come to `rows`; returns whether Ctrl-C came first. Without a single row it is passed on."""
    try:
        with closing(coming):
            for row in coming:
                rows.append(row)
                advance()
    except KeyboardInterrupt:
        if not rows:
            raise
        return True
    return False


def _drop_unfinished(folder: Path | None, finished: set[str]) -> None:
    """Remove what cases without a row have written."""
    for path in folder.iterdir() if folder is not None and folder.exists() else ():
        if path.name not in finished:
            shutil.rmtree(path, ignore_errors=True)


@contextmanager
def _progress(shown: bool, count: int) -> Iterator[Callable[[], None]]:
    """Give a callable that moves a bar on stderr by one case, or does nothing if nothing is to be shown."""
    if not shown:
        yield lambda: None
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    rate = TextColumn("cases, {task.fields[rate]}")
    columns = (BarColumn(), MofNCompleteColumn(), rate, TimeRemainingColumn(), TextColumn("left"))
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("", total=count, rate="starting")
        begin, done = time.perf_counter(), 0

        def advance() -> None:
            nonlocal done
            done += 1
            bar.update(task, advance=1, rate=f"{done / max(time.perf_counter() - begin, 1e-9):.3g} per s")

        yield advance


def _show(cases: Sweep, rows: Sequence[Row], elapsed: float, folder: Path) -> None:
    """Print the essential columns of the first rows, and where the others are."""
    from rich.console import Console
    from rich.table import Table

    shown = Table("case", "status", box=None, pad_edge=False)
    for _, heading, _, _ in _SHOWN:
        shown.add_column(heading, justify="right")
    for row in rows[:MOST_SHOWN]:
        shown.add_row(row.name, row.summary["status"], *_numbers(row.summary))
    console = Console(markup=False, highlight=False, emoji=False)
    console.print(shown)
    if len(rows) > MOST_SHOWN:
        print(f"... and {len(rows) - MOST_SHOWN} more cases in table.csv")
    failed = [row for row in rows if row.failed]
    for row in failed[:MOST_SHOWN]:
        print(f"{row.name} failed: {row.summary['message']}")
    print(f"{cases.name}: {len(rows)} of {len(cases.cases)} cases in {elapsed:.2f} s, saved in {folder}")


def _numbers(summary: dict[str, Any]) -> Iterator[str]:
    for key, _, factor, form in _SHOWN:
        value = summary.get(key)
        yield "-" if value is None else format(factor * value, form)
