"""The command `optimise`: find the best values of parameters of a config. It continues an interrupted search."""

from __future__ import annotations

import argparse
import json
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

from granular_contact.cli import many
from granular_contact.cli.common import FAILED, FINE, Refusal, complain, output_folder, print_table
from granular_contact.errors import MissingPackageError

if TYPE_CHECKING:
    from granular_contact.config import Study
    from granular_contact.studies.sweep import WorkerPool
    from granular_contact.studies.sweep.checkpoint import Checkpoint

HELP = "find the best values of parameters of a config, on all cores or a cluster"
MOST_REASONS = 5  # number of reasons of failed runs that are printed


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    text = "repeat all runs, also those that an earlier search has finished, and replace its results"
    many.add_arguments(parser, "YAML file with a config, parameters and an objective", text)


def execute(chosen: argparse.Namespace) -> int:
    """Run the command; returns the exit code."""
    folder = output_folder(chosen.out, Path(chosen.file).stem, "optimise")
    with many.pool(chosen, None) as pool:
        from granular_contact import scene
        from granular_contact.config import load_optimise
        from granular_contact.studies.optimise.writing import work_of

        study = load_optimise(chosen.file, probe=scene.build)
        try:
            work = work_of(study)
        except MissingPackageError as error:
            raise Refusal(f"{chosen.file}: {error}") from None
        return many.with_checkpoint(
            chosen,
            work,
            folder,
            pool,
            lambda checkpoint: _run(chosen, study, pool, checkpoint, folder),
            count=study.file.evaluations,
            finished=lambda: _show(folder, folder, chosen.quiet),
        )


def _run(chosen: argparse.Namespace, study: Study, pool: WorkerPool, checkpoint: Checkpoint, folder: Path) -> int:
    """Search, save and print the outcome; return the exit code."""
    from granular_contact.studies.optimise.search import search
    from granular_contact.studies.optimise.writing import write_outcome

    begin = time.perf_counter()
    with many.advancing(chosen, checkpoint, study.file.evaluations) as advance:
        outcome = search(study, pool, journal=checkpoint.journal, advance=advance)
    write_outcome(outcome, checkpoint.folder, figures=study.sweep.base.output.figures)
    code = _show(checkpoint.folder, folder, chosen.quiet)
    checkpoint.finish()
    if not chosen.quiet:
        duration = time.perf_counter() - begin
        runs = f"{len(outcome.runs)} runs in {duration:.2f} s"
        print(f"{study.name}: {runs}, saved in {folder}; best.yaml is a config to run")
    return code


def _show(source: Path, folder: Path, quiet: bool) -> int:
    """Print the outcome of a search; return the exit code.

    source: folder that contains the outcome; folder: the results folder that messages name.
    """
    from granular_contact.report import OPTIMUM

    outcome: dict[str, Any] = json.loads((source / OPTIMUM).read_text(encoding="utf-8"))
    if not quiet:
        _print_tables(outcome)
    if outcome["failed"]:
        reasons = list(outcome["failures"].items())
        complain(f"{outcome['failed']} of {outcome['runs']} runs failed and count as worst:")
        for reason, count in reasons[:MOST_REASONS]:
            complain(f"  {count} times: {reason}")
    if outcome["ended"]:
        complain(f"notice: the search ended before all runs were made: {outcome['ended']}")
    if outcome["best"] is None:
        complain(f"every run failed, so there is no best; saved in {folder}")
        return FAILED
    if not outcome["best_is_allowed"]:
        complain("warning: no run keeps all constraints; the best is the one that breaks them least")
    return FINE


def _print_tables(outcome: dict[str, Any]) -> None:
    """Print a table of the parameters, and one of the objective and the constraints."""

    def rows(kind: str, *keys: str) -> list[list[str]]:
        return [[name, *(_number(entry[key]) for key in keys)] for name, entry in outcome[kind].items()]

    print_table("parameter", ("from", "to", "as it was", "best"), rows("parameters", "from", "to", "start", "best"))
    objective = [outcome["objective"], "", "", _number(outcome["start"]), _number(outcome["best"])]
    values = [objective, *rows("constraints", "at_least", "at_most", "start", "best")]
    print_table(f"{outcome['sense']}, and constraints", ("at least", "at most", "as it was", "best"), values)
    if outcome["gain_relative"] is not None:
        print(f"better by {100 * outcome['gain_relative']:.3g} % than the config as it was")


def _number(value: float | None) -> str:
    """A number in a cell; a dash for None."""
    return "-" if value is None else f"{value:.5g}"
