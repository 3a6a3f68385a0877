"""The command `ensemble`: run a config with many seeds of its medium's scatter; save bands, quantiles and means."""

from __future__ import annotations

import argparse
import time
from dataclasses import replace
from functools import partial
from importlib import import_module
from pathlib import Path
from threading import Thread
from typing import TYPE_CHECKING

from granular_contact.cli import many
from granular_contact.cli.common import add_set, output_folder, print_table, read

if TYPE_CHECKING:
    from granular_contact.config import Sweep
    from granular_contact.studies.ensemble import Summary
    from granular_contact.studies.sweep import Row, WorkerPool
    from granular_contact.studies.sweep.checkpoint import Checkpoint

HELP = "run a config with many seeds of its medium's scatter: bands, quantiles and means"
MOST_SHOWN = 12  # number of quantities that are printed; statistics.csv has all


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    many.add_arguments(parser, "YAML file of a run whose medium has scatter", "run all seeds again")
    add_set(parser, "medium.scatter.relative=0.2")
    parser.add_argument("--count", metavar="N", type=int, default=200, help="number of runs (200)")
    parser.add_argument("--seed", metavar="N", type=int, help="seed of the first run (that of the config)")


def execute(chosen: argparse.Namespace) -> int:
    """Run the command; returns the exit code."""
    folder = output_folder(chosen.out, f"{Path(chosen.file).stem}_ensemble", "sweep")
    with many.pool(chosen, None) as pool:
        from granular_contact.studies.ensemble import cases

        scenario, _ = read(chosen.file, chosen.set)
        sweep = cases(scenario, chosen.count, chosen.seed, Path(chosen.file).stem)
        act, nouns = partial(_run, chosen, sweep, pool, folder), ("ensemble", "runs")
        return many.with_cases(chosen, sweep, folder, pool, act, rows=_plain, nouns=nouns)


def _plain(checkpoint: Checkpoint) -> list[Row]:
    """Rows of the journal in the order of the seeds, without the time series in them."""
    from granular_contact.studies.ensemble.runs import SERIES

    return [
        replace(row, summary={key: x for key, x in row.summary.items() if not key.startswith(f"{SERIES}.")})
        for row in checkpoint.journal
    ]


def _run(chosen: argparse.Namespace, sweep: Sweep, pool: WorkerPool, folder: Path, checkpoint: Checkpoint) -> int:
    """Run the members that are missing in the checkpoint, save and print statistics; return the exit code."""
    from granular_contact.studies.ensemble import observed, of_rows
    from granular_contact.studies.ensemble.statistics import write
    from granular_contact.studies.sweep import run, table

    count, begin = len(sweep.cases), time.perf_counter()
    rows = run(sweep, pool, done=checkpoint.done, journal=checkpoint.journal, function=observed)
    if sweep.base.output.figures:  # load matplotlib while the workers start
        Thread(target=import_module, args=("granular_contact.report.figures.studies",), daemon=True).start()
    many.take(chosen, rows, checkpoint, count)
    table.write(sweep, _plain(checkpoint), checkpoint.folder)
    statistics = of_rows(checkpoint.journal)
    write(statistics, checkpoint.folder, figures=sweep.base.output.figures)
    ends = many.Ends("runs")
    for row in checkpoint.journal:
        ends.add(row)
    checkpoint.finish()
    if not chosen.quiet:
        _show(statistics)
        print(f"{sweep.name}: {count} runs in {time.perf_counter() - begin:.2f} s, saved in {folder}")
    return ends.code(folder, quiet=chosen.quiet)


def _show(statistics: Summary) -> None:
    """Print the statistics of the first key numbers."""
    heads = ("mean", "+- 95 %", "st. dev.", "5 %", "median", "95 %")
    rows = []
    for key, number in list(statistics.numbers.items())[:MOST_SHOWN]:
        low, _, median, _, high = number.quantiles
        cells = (number.mean, number.settling()[2][-1], number.deviation, low, median, high)
        rows.append([key, *(f"{x:.4g}" for x in cells)])
    print_table("key number", heads, rows)
