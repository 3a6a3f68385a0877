"""What the commands that run many scenes share: who works, where unfinished work is kept, and what is said of it.

How far a sweep or a search is stands in a bar on a terminal, or in a line a minute in a log.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable, Generator, Iterable, Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, TextIO

from granular_contact.cli.common import FAULTY_INPUT, INTERRUPTED, NARROW, add_output, complain, reason, worker_count
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
    finished: Callable[[], int],
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
        finished=finished,
        interrupted=lambda checkpoint: table.write(sweep, rows(checkpoint), checkpoint.folder),
        cases=cases,
    )


@contextmanager
def advancing(chosen: argparse.Namespace, checkpoint: Checkpoint, count: int) -> Iterator[Callable[[], None]]:
    """Give a callable that tells of one run more; what is there already is said first."""
    done, noun = len(checkpoint.done), checkpoint.work.runs
    if done and not chosen.quiet:
        print(f"going on in {checkpoint.folder}: {done} of {count} {noun} are there", flush=True)
    with progress(sys.stderr, count, done, chosen.quiet, noun) as advance:
        yield advance


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


def _kept(checkpoint: Checkpoint, count: int) -> str:
    """What unfinished work leaves, in words; empty if that is nothing."""
    if not (saved := len(checkpoint.journal)):
        return ""
    runs = checkpoint.work.runs
    return f"{saved} of {count} {runs} are kept in {checkpoint.folder}, and the same command goes on from there"


LINE_SECONDS = 60.0


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
    begin = printed = time.perf_counter()
    new = 0

    def advance() -> None:
        nonlocal new, printed
        new += 1
        now = time.perf_counter()
        if now - printed >= LINE_SECONDS:
            printed = now
            rate = new / (now - begin)
            left = (count - done - new) / rate
            print(f"{done + new} of {count} {noun}, {rate:.3g} per s, about {left:.0f} s left", file=stream, flush=True)

    return advance
