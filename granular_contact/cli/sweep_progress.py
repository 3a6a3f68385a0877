"""How far a sweep or a search is: a bar on a terminal, a line a minute in a log."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TextIO

from granular_contact.cli.common import NARROW

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
