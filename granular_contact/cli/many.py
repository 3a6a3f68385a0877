"""What the commands that run many scenes share: who works, where unfinished work is kept, and what is said of it.

How far a sweep or a search is stands in a bar on a terminal, or in a line a minute in a log.
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


def add_arguments(parser: argparse.ArgumentParser, words: str, restart: str) -> None:
    """Add the arguments of such a command; words: what its FILE holds; restart: what --restart does."""
    parser.add_argument("file", metavar="FILE", help=words)
    where = parser.add_mutually_exclusive_group()
    where.add_argument("--workers", metavar="N", type=worker_count, help="processes to run in (one a core)")
    words = "run on the workers of a Dask cluster, as tcp://host:8786"
    where.add_argument("--scheduler", metavar="ADDRESS", help=words)
    parser.add_argument("--restart", action="store_true", help=restart)
    add_output(parser, "results/NAME_OF_FILE")


def pool(chosen: argparse.Namespace, shared: Path | None) -> WorkerPool:
    """Who works: processes of this machine, or those of a cluster, which must see the folder `shared`."""
    from granular_contact.studies.processes import prepare
    from granular_contact.studies.sweep import WorkerPool

    if chosen.scheduler is None:
        prepare()  # while the file is read
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
    """Exit code of what is done in the work folder; what is finished is kept there, however it ends.

    count: runs in all; finished: gives the exit code of work that is done already; interrupted: what is written besides
    after Ctrl-C; cases: whether cases have folders.
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
    """`with_checkpoint` of the cases of a sweep; rows: of the table that is written after Ctrl-C.

    nouns: what messages call the sweep, and its runs.
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
    """Give a callable that tells of one run more; what is there already is said first, and why the first take long."""
    done, noun = len(checkpoint.done), checkpoint.work.runs
    if done and not chosen.quiet:
        print(f"going on in {checkpoint.folder}: {done} of {count} {noun} are there", flush=True)
    why = f"the first {noun} wait: in a new installation the forces of the sand are compiled once, for a minute or so"
    waiting = threading.Timer(SILENT_SECONDS, complain, (why,))
    waiting.daemon = True
    with progress(sys.stderr, count, done, chosen.quiet, noun) as advance:
        if not chosen.quiet:
            waiting.start()

        def one_more() -> None:
            waiting.cancel()
            advance()

        try:
            yield one_more
        finally:
            waiting.cancel()


def take(
    chosen: argparse.Namespace,
    rows: Generator[Row, None, None],
    checkpoint: Checkpoint,
    count: int,
    look: Callable[[Row], None] = lambda _: None,
) -> None:
    """Take all rows of a sweep, the first good one of which is looked at; the journal must have them in the end."""
    from granular_contact.errors import WorkerPoolError

    looked = False
    with advancing(chosen, checkpoint, count) as advance, closing(rows):
        for row in rows:
            if not looked and not row.failed:
                look(row)
                looked = True
            advance()
    if missing := count - len(checkpoint.journal):
        raise WorkerPoolError(f"{missing} rows did not reach {checkpoint.folder}")


MOST_WARNINGS = 5  # kinds


class Ends:
    """How the runs of a sweep ended, and what they warn of; runs: what they are called."""

    def __init__(self, runs: str) -> None:
        from granular_contact.results.alike import Kinds

        self.runs, self.warnings = runs, Kinds()
        self.count = self.failed = self.useless = 0

    def add(self, row: Row) -> None:
        """Count a run."""
        self.count += 1
        self.failed += row.failed
        self.useless += row.useless
        for warning in row.summary.get("warnings") or ():
            self.warnings.add(warning)

    def code(self, folder: Path, *, quiet: bool) -> int:
        """Exit code; says what it rests on, and what the warnings are unless `quiet`. folder: of the results."""
        for line in self.warnings.lines(self.count, self.runs, MOST_WARNINGS, str(folder)) if not quiet else ():
            complain(f"warning: {line}")
        for number, words in ((self.useless, "are not usable, see their warnings"), (self.failed, "failed")):
            if number:
                complain(f"{number} of {self.count} {self.runs} {words}; saved in {folder}")
        return FAILED if self.failed else NOT_USABLE if self.useless else FINE

    @classmethod
    def before(cls, folder: Path, runs: str) -> Ends:
        """As the table of a finished sweep has them, without warnings."""
        from granular_contact.report import TABLE
        from granular_contact.results import FINISHED

        found = cls(runs)
        with (folder / TABLE).open(encoding="utf-8", newline="") as file:
            for row in csv.DictReader(file):
                ended = row["status"] in FINISHED
                found.count += 1
                found.failed += not ended
                found.useless += ended and row.get("usable") == "false"
        return found


def _kept(checkpoint: Checkpoint, count: int) -> str:
    """What unfinished work leaves, in words; empty if that is nothing."""
    if not (saved := len(checkpoint.journal)):
        return ""
    runs = checkpoint.work.runs
    return f"{saved} of {count} {runs} are kept in {checkpoint.folder}, and the same command goes on from there"


LINE_SECONDS = 60.0
SILENT_SECONDS = 20.0  # without a run that is done


@contextmanager
def progress(stream: TextIO, count: int, done: int, quiet: bool, noun: str = "cases") -> Iterator[Callable[[], None]]:
    """Give a callable that reports on `stream` one case more; `done` of the `count` cases were there before."""
    if quiet:
        yield lambda: None
    elif stream.isatty():
        with _bar(stream, count, done, noun) as advance:
            yield advance
    else:
        yield _lines(stream, count, done, noun)


@contextmanager
def _bar(stream: TextIO, count: int, done: int, noun: str) -> Iterator[Callable[[], None]]:
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
    """The rate is that since the first run, which may have waited for compiling."""
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
