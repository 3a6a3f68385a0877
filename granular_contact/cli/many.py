"""Functions that the commands with many runs share: worker processes, checkpoints of unfinished work, progress.

The progress of a sweep, an ensemble or an optimisation is a bar on a terminal, and a line per minute in a log.
"""

from __future__ import annotations

import argparse
import csv
import sys
import threading
import time
from collections.abc import Callable, Generator, Iterable, Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, TextIO

from granular_contact.cli.common import (
    FAILED,
    FAULTY_INPUT,
    FINE,
    INTERRUPTED,
    NARROW,
    NOT_USABLE,
    add_output,
    complain,
    reason,
    worker_count,
)
from granular_contact.errors import ConfigError

if TYPE_CHECKING:
    from granular_contact.config import Sweep
    from granular_contact.studies.sweep import Row, WorkerPool
    from granular_contact.studies.sweep.checkpoint import Checkpoint, Contents


def add_arguments(parser: argparse.ArgumentParser, file: str, restart: str) -> None:
    """Add the arguments of such a command; file, restart: help texts of its FILE and of --restart."""
    parser.add_argument("file", metavar="FILE", help=file)
    workers = parser.add_mutually_exclusive_group()
    workers.add_argument("--workers", metavar="N", type=worker_count, help="number of worker processes (one per core)")
    text = "run on the workers of a Dask cluster with this scheduler, as tcp://host:8786"
    workers.add_argument("--scheduler", metavar="ADDRESS", help=text)
    parser.add_argument("--restart", action="store_true", help=restart)
    add_output(parser, "results/NAME_OF_FILE")


def pool(chosen: argparse.Namespace, shared: Path | None) -> WorkerPool:
    """Worker processes: of this machine, or of a cluster, whose machines must have access to the folder `shared`."""
    from granular_contact.studies.processes import prepare
    from granular_contact.studies.sweep import WorkerPool

    if chosen.scheduler is None:
        prepare()  # the processes start while the file is read
        return WorkerPool(chosen.workers)
    from granular_contact.studies.sweep.cluster import cluster_pool

    return cluster_pool(chosen.scheduler, shared)


def with_checkpoint(
    chosen: argparse.Namespace,
    work: Contents,
    folder: Path,
    pool: WorkerPool,
    act: Callable[[Checkpoint], int],
    *,
    count: int,
    finished: Callable[[], int],
    interrupted: Callable[[Checkpoint], None] = lambda _: None,
    cases: bool = False,
) -> int:
    """Do the work in a folder that keeps finished runs, however the work ends; return the exit code.

    Parameters
    ----------
    work
        Content that identifies the work, to recognise an earlier state of the same work.
    folder
        Folder of the results.
    act
        Does the work with the checkpoint, and gives the exit code.
    count
        Number of runs in all.
    finished
        Gives the exit code of work that an earlier command completed.
    interrupted
        Called after Ctrl-C with the checkpoint, to write intermediate results.
    cases
        Whether each case has a folder.
    """
    from granular_contact.errors import WorkerPoolError
    from granular_contact.studies.sweep.checkpoint import is_finished, open_checkpoint

    if is_finished(work, folder, cases and not chosen.restart) and not chosen.restart:
        if not chosen.quiet:
            print(f"{folder} holds all {work.runs} of this {work.noun} already; --restart runs them again")
        return finished()
    try:
        with open_checkpoint(work, folder, cases, chosen.restart) as checkpoint:
            try:
                return act(checkpoint)
            except BaseException as error:
                pool.shutdown()
                kept = _kept(checkpoint, count)
                if kept and isinstance(error, KeyboardInterrupt):
                    interrupted(checkpoint)
                    complain(f"interrupted; {kept}")
                    return INTERRUPTED
                if kept and isinstance(error, OSError | WorkerPoolError):
                    complain(f"the {work.noun} can't go on: {reason(error)}; {kept}")
                    return FAULTY_INPUT
                if not kept or isinstance(error, ConfigError):
                    checkpoint.discard()
                raise
    except OSError as error:
        complain(f"the {work.noun} can't go on, or can't be saved in {folder}: {reason(error)}")
        return FAULTY_INPUT


def with_cases(
    chosen: argparse.Namespace,
    sweep: Sweep,
    folder: Path,
    pool: WorkerPool,
    act: Callable[[Checkpoint], int],
    *,
    rows: Callable[[Checkpoint], Iterable[Row]] = lambda checkpoint: checkpoint.journal,
    cases: bool = False,
    nouns: tuple[str, str] = ("sweep", "cases"),
) -> int:
    """`with_checkpoint` for the cases of a sweep.

    rows: gives the rows of the table that is written after Ctrl-C. nouns: words of messages for the sweep and its runs.
    """
    from granular_contact.studies.sweep import table

    return with_checkpoint(
        chosen,
        table.work_of(sweep, *nouns),
        folder,
        pool,
        act,
        count=len(sweep.cases),
        finished=lambda: Ends.before(folder, nouns[1]).code(folder, quiet=chosen.quiet),
        interrupted=lambda checkpoint: table.write(sweep, rows(checkpoint), checkpoint.folder),
        cases=cases,
    )


@contextmanager
def advancing(chosen: argparse.Namespace, checkpoint: Checkpoint, count: int) -> Iterator[Callable[[], None]]:
    """Give a callable that reports one more finished run.

    Runs that an earlier command finished are reported first. If no run ends within SILENT_SECONDS, a message says that
    the first runs may wait for compiling.
    """
    done, noun = len(checkpoint.done), checkpoint.work.runs
    if done and not chosen.quiet:
        print(f"going on in {checkpoint.folder}: {done} of {count} {noun} are there", flush=True)
    reason = (
        f"the first {noun} wait: in a new installation the forces of the sand are compiled once, for a minute or so"
    )
    explanation = threading.Timer(SILENT_SECONDS, complain, (reason,))
    explanation.daemon = True
    with progress(sys.stderr, count, done, chosen.quiet, noun) as advance:
        if not chosen.quiet:
            explanation.start()

        def finish_run() -> None:
            explanation.cancel()
            advance()

        try:
            yield finish_run
        finally:
            explanation.cancel()


def take(
    chosen: argparse.Namespace,
    rows: Generator[Row, None, None],
    checkpoint: Checkpoint,
    count: int,
    check: Callable[[Row], None] = lambda _: None,
) -> None:
    """Run all cases of a sweep; `check` is called with the first row that did not fail.

    Raises
    ------
    WorkerPoolError
        The journal of the checkpoint lacks rows at the end.
    """
    from granular_contact.errors import WorkerPoolError

    is_checked = False
    with advancing(chosen, checkpoint, count) as advance, closing(rows):
        for row in rows:
            if not is_checked and not row.failed:
                check(row)
                is_checked = True
            advance()
    if missing := count - len(checkpoint.journal):
        raise WorkerPoolError(f"{missing} rows did not reach {checkpoint.folder}")


MOST_WARNINGS = 5  # number of kinds of warnings that are printed


class Ends:
    """Counts how the runs of a sweep ended, and collects their warnings.

    runs: word for the runs in messages; warnings: kinds of warnings; count, failed, useless: numbers of all runs, of
    failed runs, and of runs with an unusable result.
    """

    def __init__(self, runs: str) -> None:
        from granular_contact.results.alike import Kinds

        self.runs, self.warnings = runs, Kinds()
        self.count = self.failed = self.useless = 0

    def add(self, row: Row) -> None:
        """Count a run and its warnings."""
        self.count += 1
        self.failed += row.failed
        self.useless += row.useless
        for warning in row.summary.get("warnings") or ():
            self.warnings.add(warning)

    def code(self, folder: Path, *, quiet: bool) -> int:
        """Exit code. The numbers of failed and unusable runs are printed, and the warnings unless `quiet`.

        folder: folder of the results.
        """
        for line in self.warnings.lines(self.count, self.runs, MOST_WARNINGS, str(folder)) if not quiet else ():
            complain(f"warning: {line}")
        for number, predicate in ((self.useless, "are not usable, see their warnings"), (self.failed, "failed")):
            if number:
                complain(f"{number} of {self.count} {self.runs} {predicate}; saved in {folder}")
        return FAILED if self.failed else NOT_USABLE if self.useless else FINE

    @classmethod
    def before(cls, folder: Path, runs: str) -> Ends:
        """Counts from the table of a finished sweep, without warnings."""
        from granular_contact.report import TABLE
        from granular_contact.results import FINISHED

        ends = cls(runs)
        with (folder / TABLE).open(encoding="utf-8", newline="") as file:
            for row in csv.DictReader(file):
                is_finished = row["status"] in FINISHED
                ends.count += 1
                ends.failed += not is_finished
                ends.useless += is_finished and row.get("usable") == "false"
        return ends


def _kept(checkpoint: Checkpoint, count: int) -> str:
    """Sentence on the runs that unfinished work keeps; empty if there are none."""
    if not (saved := len(checkpoint.journal)):
        return ""
    runs = checkpoint.work.runs
    return f"{saved} of {count} {runs} are kept in {checkpoint.folder}, and the same command goes on from there"


LINE_SECONDS = 60.0  # between two lines of progress in a log
SILENT_SECONDS = 20.0  # without a finished run until a message explains why


@contextmanager
def progress(stream: TextIO, count: int, done: int, quiet: bool, noun: str = "cases") -> Iterator[Callable[[], None]]:
    """Give a callable that reports one more finished case on `stream`.

    count: number of cases in all; done: number of cases that an earlier command finished.
    """
    if quiet:
        yield lambda: None
    elif stream.isatty():
        with _bar(stream, count, done, noun) as advance:
            yield advance
    else:
        yield _lines(stream, count, done, noun)


@contextmanager
def _bar(stream: TextIO, count: int, done: int, noun: str) -> Iterator[Callable[[], None]]:
    """Progress as a bar on a terminal."""
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    console = Console(file=stream)
    narrow = console.width < NARROW
    rate = TextColumn(noun + ("" if narrow else ", {task.fields[rate]}"))
    columns = (BarColumn(8 if narrow else 40), MofNCompleteColumn(), rate, TimeRemainingColumn(), TextColumn("left"))
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task("", total=count, completed=done, rate="starting")
        begin, new = time.perf_counter(), 0

        def advance() -> None:
            nonlocal new
            new += 1
            bar.update(task, advance=1, rate=f"{new / max(time.perf_counter() - begin, 1e-9):.3g} per s")

        yield advance


def _lines(stream: TextIO, count: int, done: int, noun: str) -> Callable[[], None]:
    """Progress as lines in a log. The rate counts from the first finished run, which may have waited for compiling."""
    begin = printed = time.perf_counter()
    new = 0

    def advance() -> None:
        nonlocal begin, new, printed
        new += 1
        now = time.perf_counter()
        begin = now if new == 1 else begin
        if now - printed >= LINE_SECONDS:
            printed = now
            rate = (new - 1) / max(now - begin, 1e-9)
            left = f", {rate:.3g} per s, about {(count - done - new) / rate:.0f} s left" if rate else ""
            print(f"{done + new} of {count} {noun}{left}", file=stream, flush=True)

    return advance
