"""Progress of a sweep: a bar on a terminal, a line per minute in a log."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TextIO

LINE_SECONDS = 60.0


@contextmanager
def progress(stream: TextIO, count: int, done: int, quiet: bool) -> Iterator[Callable[[], None]]:
    """Give a callable that reports one more case on `stream`; `done` of the `count` cases were there before."""
    if quiet:
        yield lambda: None
    elif stream.isatty():
        with _bar(stream, count, done) as advance:
            yield advance
    else:
        yield _lines(stream, count, done)


@contextmanager
def _bar(stream: TextIO, count: int, done: int) -> Iterator[Callable[[], None]]:
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    rate = TextColumn("cases, {task.fields[rate]}")
    columns = (BarColumn(), MofNCompleteColumn(), rate, TimeRemainingColumn(), TextColumn("left"))
    with Progress(*columns, console=Console(file=stream), transient=True) as bar:
        task = bar.add_task("", total=count, completed=done, rate="starting")
        begin, new = time.perf_counter(), 0

        def advance() -> None:
            nonlocal new
            new += 1
            bar.update(task, advance=1, rate=f"{new / max(time.perf_counter() - begin, 1e-9):.3g} per s")

        yield advance


def _lines(stream: TextIO, count: int, done: int) -> Callable[[], None]:
    begin = told = time.perf_counter()
    new = 0

    def advance() -> None:
        nonlocal new, told
        new += 1
        now = time.perf_counter()
        if now - told >= LINE_SECONDS:
            told = now
            rate = new / (now - begin)
            left = (count - done - new) / rate
            print(f"{done + new} of {count} cases, {rate:.3g} per s, about {left:.0f} s left", file=stream, flush=True)

    return advance
