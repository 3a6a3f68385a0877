"""The command `compare`: one config by several models, their table, figure and verdict."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from granular_contact.cli import FAILED, FAULTY_INPUT, FINE, complain, folder_problem
from granular_contact.compare import Comparison, Row, compare, write


def run(chosen: argparse.Namespace) -> int:
    """Run the command; returns the exit code."""
    folder = Path(chosen.out) if chosen.out else Path("results", f"{Path(chosen.config).stem}_compare")
    problem = folder_problem(folder, "compare")
    if problem:
        complain(problem)
        return FAULTY_INPUT
    with _progress(sys.stderr.isatty() and not chosen.quiet) as progress:
        comparison = compare(
            chosen.config,
            chosen.modes,
            chosen.elements,
            tolerance=chosen.tolerance,
            overrides=chosen.set,
            progress=progress,
        )
    write(comparison, folder, figures=not chosen.no_plots)
    if not chosen.quiet:
        _show(comparison)
        print(f"saved in {folder}")
    return FAILED if any(row.results.status.code == "failed" for row in comparison.rows) else FINE


@contextmanager
def _progress(shown: bool) -> Iterator[Callable[[str], None] | None]:
    """Give a callable that tells on stderr which model is under way, or None."""
    if not shown:
        yield None
        return
    from rich.console import Console

    with Console(stderr=True).status("") as status:
        yield lambda name: status.update(f"running {name}")


def _show(comparison: Comparison) -> None:
    from rich.console import Console
    from rich.table import Table

    table = Table(box=None, pad_edge=False)
    table.add_column("model")
    for head in ("stop ms", "angle deg", "peak um", "stop %", "travel %", "peak %", "rms mdeg", "rms um", "run ms"):
        table.add_column(head, justify="right")
    for row in comparison.rows:
        table.add_row(row.model.name, *_cells(row))
    Console(width=max(100, Console().width)).print(table)
    print(comparison.verdict)


def _cells(row: Row) -> Iterator[str]:
    summary = row.results.summary
    yield _number(summary["stopping_time_s"], 1e3, ".3f")
    yield _number(summary["angle_at_stop_deg"], 1.0, ".4f")
    yield _number(summary["max_deflection_m"], 1e6, ".1f")
    yield _number(row.stopping_time, 1e2, "+.3f")
    yield _number(row.travel, 1e2, "+.3f")
    yield _number(row.deflection, 1e2, "+.2f")
    yield _number(row.angle_rms, 1e3, ".2f")
    yield _number(row.deflection_rms, 1e6, ".2f")
    yield _number(row.seconds, 1e3, ".2f")


def _number(value: float | None, factor: float, form: str) -> str:
    return "-" if value is None else format(factor * value, form)
