"""The command `sweep`: run many cases; print and save them as a table. It resumes an interrupted sweep."""

from __future__ import annotations

import argparse
import time
from collections.abc import Iterable, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from granular_contact.cli import many
from granular_contact.cli.common import columns_with_values, complain, output_folder, print_numbers, print_table, say
from granular_contact.errors import ConfigError, Fault, short

if TYPE_CHECKING:
    from granular_contact.config import Sweep
    from granular_contact.config.schema.sweep import Sample
    from granular_contact.studies.sweep import Row, WorkerPool
    from granular_contact.studies.sweep.checkpoint import Checkpoint
    from granular_contact.studies.sweep.sensitivity import Indices

HELP = "simulate many cases of a config on all cores or a cluster; each gives a row of a table"
MOST_SHOWN = 40  # number of rows that are printed; table.csv has all
MOST_KEYS, MOST_LETTERS = 4, 20  # numbers of varied keys, and of letters of a value, in the printed rows
_COLUMNS = (
    ("stopping_time_s", "stop ms", 1e3, ".2f"),
    ("angle_at_stop_deg", "angle deg", 1.0, ".3f"),
    ("max_depth_m", "depth mm", 1e3, ".2f"),
    ("forward_speed_m_s", "speed m/s", 1.0, ".4f"),
    ("cost_of_transport", "cost", 1.0, ".3f"),
    ("energy.imbalance_relative", "imbalance", 1.0, ".1e"),
)
_WHEEL_COLUMNS = (
    ("wheel.drawbar_pull_N", "pull N", 1.0, ".3f"),
    ("wheel.torque_Nm", "torque N m", 1.0, ".3f"),
    ("wheel.sinkage_m", "sinkage mm", 1e3, ".2f"),
    ("wheel.efficiency", "efficiency", 1.0, ".3f"),
    _COLUMNS[-1],
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    text = "repeat all cases, also those that an earlier sweep has finished, and replace its results"
    many.add_arguments(parser, "YAML file with a config, and cases, vary or sample", text)
    parser.add_argument("--plots", action="store_true", help="save time series and figures of each case in a folder")


def execute(chosen: argparse.Namespace) -> int:
    """Run the command; returns the exit code."""
    folder = output_folder(chosen.out, Path(chosen.file).stem, "sweep")
    with many.pool(chosen, folder.resolve().parent if chosen.plots else None) as pool:
        from granular_contact.config import load_sweep
        from granular_contact.scene.variants import Builder
        from granular_contact.studies.sweep.runner import faults

        sweep = load_sweep(chosen.file, probe=Builder(), check=partial(faults, pool=pool))
        act = partial(_run, chosen, sweep, pool, folder)
        return many.with_cases(chosen, sweep, folder, pool, act, cases=chosen.plots)


def _run(chosen: argparse.Namespace, sweep: Sweep, pool: WorkerPool, folder: Path, checkpoint: Checkpoint) -> int:
    """Run the cases that are missing in the checkpoint, save and print the table; return the exit code."""
    from granular_contact.studies.sweep import run, sensitivity, slip, table

    count, begin = len(sweep.cases), time.perf_counter()
    rows = run(sweep, pool, done=checkpoint.done, journal=checkpoint.journal, cases_folder=checkpoint.cases)
    many.take(chosen, rows, checkpoint, count, partial(_check_outputs, sweep.sample, chosen.file))
    table.write(sweep, checkpoint.journal, checkpoint.folder)
    slip.write(sweep, checkpoint.journal, checkpoint.folder)
    indices = sensitivity.of_sweep(sweep, checkpoint.journal)
    if indices:
        sensitivity.write(indices, checkpoint.folder, figures=sweep.base.output.figures)
    ends = _show(sweep, checkpoint.journal, chosen.quiet)
    checkpoint.finish()
    if not chosen.quiet:
        _show_sensitivity(indices)
        duration, new = time.perf_counter() - begin, count - len(checkpoint.done)
        speed = f" ({new / duration:.3g} per s)" if new and duration > 0.0 else ""
        say(f"{sweep.name}: {count} of {count} cases in {duration:.2f} s{speed}, saved in {folder}")
    for of_output in indices:
        if of_output.refused:
            complain(f"no Sobol indices of {of_output.output}: {of_output.refused}")
        for warning in sensitivity.warnings(of_output):
            complain(f"warning: {warning}")
    return ends.code(folder, quiet=chosen.quiet)


def _check_outputs(sample: Sample | None, file: str, row: Row) -> None:
    """Raise ConfigError if the summary of a case lacks a number that is among the outputs of the sample."""
    from granular_contact.config.messages import unknown

    numbers = [key for key, value in row.summary.items() if value is None or isinstance(value, int | float)]
    for output in sample.outputs if sample is not None else ():
        if output not in numbers:
            message = f"got {output!r}, which is not a number of a summary; {unknown(output, numbers)}"
            raise ConfigError([Fault(file, None, "sample.outputs", message)])


def _show(sweep: Sweep, rows: Iterable[Row], quiet: bool) -> many.Ends:
    """Print the essential columns of the first rows, and the failed cases; return how all rows ended."""
    keys = sweep.keys[:MOST_KEYS]
    first: list[Row] = []
    failed: list[str] = []
    ends = many.Ends("cases")
    for row in rows:
        ends.add(row)
        if row.index < MOST_SHOWN:
            first.append(row)
        if row.failed:
            failed += [f"{row.name} failed: {row.summary['message']}"] if ends.failed <= MOST_SHOWN else []
    all_columns = _COLUMNS if sweep.base.wheel is None else _WHEEL_COLUMNS
    columns = columns_with_values(all_columns, [row.summary for row in first])
    if not quiet:
        texts = ([row.name, *(_value(row.values.get(key)) for key in keys), row.summary["status"]] for row in first)
        cells = zip(texts, (row.summary for row in first), strict=True)
        print_numbers(["case", *_short_names(keys), "status"], columns, cells)
        if len(sweep.cases) > MOST_SHOWN:
            print(f"... and {len(sweep.cases) - MOST_SHOWN} more cases in table.csv")
        for line in failed:
            say(line)
    return ends


def _short_names(keys: Sequence[str]) -> list[str]:
    """The last parts of dotted keys, as many as distinguish all keys."""
    parts = [key.split(".") for key in keys]
    for size in range(1, max(map(len, parts), default=0) + 1):
        names = [".".join(part[-size:]) for part in parts]
        if len(set(names)) == len(names):
            return names
    return list(keys)


def _value(value: Any) -> str:
    """A value of a case in a cell."""
    return short(f"{value:.5g}" if isinstance(value, float) else "null" if value is None else str(value), MOST_LETTERS)


def _show_sensitivity(indices: Iterable[Indices]) -> None:
    """Print the Sobol indices of each output with their confidence intervals."""
    for of_output in indices:
        if of_output.refused:
            continue
        rows = []
        for i, name in enumerate(of_output.inputs):
            pairs = ((of_output.first, of_output.first_interval), (of_output.total, of_output.total_interval))
            rows.append([name, *(f"{v[i]:.3f} ({ends[0, i]:.3f} to {ends[1, i]:.3f})" for v, ends in pairs)])
        print_table(f"Sobol indices of {of_output.output}", ("first order, 95 %", "total, 95 %"), rows)
