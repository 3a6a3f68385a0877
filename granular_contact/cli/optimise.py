"""The command `optimise`: the best numbers of a config looked for, going on where an earlier search was killed."""

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

HELP = "find the numbers of a config that are best, on all cores or a cluster"
MOST_REASONS = 5


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    words = "take all runs anew, also those that an earlier search has finished, and replace its results"
    many.add_arguments(parser, "YAML file with a config, parameters and an objective", words)


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
    from granular_contact.studies.optimise.search import search
    from granular_contact.studies.optimise.writing import write_outcome

    begin = time.perf_counter()
    with many.advancing(chosen, checkpoint, study.file.evaluations) as advance:
        outcome = search(study, pool, journal=checkpoint.journal, advance=advance)
    write_outcome(outcome, checkpoint.folder, figures=study.sweep.base.output.figures)
    code = _show(checkpoint.folder, folder, chosen.quiet)
    checkpoint.finish()
    if not chosen.quiet:
        taken = time.perf_counter() - begin
        print(
            f"{study.name}: {len(outcome.runs)} runs in {taken:.2f} s, saved in {folder}; best.yaml is a config to run"
        )
    return code


def _show(place: Path, folder: Path, quiet: bool) -> int:
    """Print what a search found, as it lies in a place; returns the exit code."""
    from granular_contact.report import OPTIMUM

    found: dict[str, Any] = json.loads((place / OPTIMUM).read_text(encoding="utf-8"))
    if not quiet:
        _tables(found)
    if found["failed"]:
        reasons = list(found["failures"].items())
        complain(f"{found['failed']} of {found['runs']} runs failed and count as worst:")
        for words, count in reasons[:MOST_REASONS]:
            complain(f"  {count} times: {words}")
    if found["ended"]:
        complain(f"notice: it ended before all runs were taken: {found['ended']}")
    if found["best"] is None:
        complain(f"every run failed, so there is no best; saved in {folder}")
        return FAILED
    if not found["best_is_allowed"]:
        complain("warning: no run keeps all constraints; the best is the one that breaks them least")
    return FINE


def _tables(found: dict[str, Any]) -> None:
    def rows(kind: str, *keys: str) -> list[list[str]]:
        return [[name, *(_number(one[key]) for key in keys)] for name, one in found[kind].items()]

    print_table("parameter", ("from", "to", "as it was", "best"), rows("parameters", "from", "to", "start", "best"))
    worth = [[found["objective"], "", "", _number(found["start"]), _number(found["best"])]]
    worth += rows("constraints", "at_least", "at_most", "start", "best")
    print_table(f"{found['sense']}, and constraints", ("at least", "at most", "as it was", "best"), worth)
    if found["gain_relative"] is not None:
        print(f"better by {100 * found['gain_relative']:.3g} % than the config as it was")


def _number(value: float | None) -> str:
    return "-" if value is None else f"{value:.5g}"
