"""What the commands that run many scenes share: who works, where unfinished work is kept, and what is said of it."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from granular_contact.cli.common import FAULTY_INPUT, INTERRUPTED, add_output, complain, reason, worker_count
from granular_contact.errors import ConfigError

if TYPE_CHECKING:
    from granular_contact.studies.sweep import Crew
    from granular_contact.studies.sweep.part import Part, Work


def add_arguments(parser: argparse.ArgumentParser, words: str, restart: str) -> None:
    """Add the arguments of such a command; words: what its FILE holds; restart: what --restart does."""
    parser.add_argument("file", metavar="FILE", help=words)
    where = parser.add_mutually_exclusive_group()
    where.add_argument("--workers", metavar="N", type=worker_count, help="processes to run in (one a core)")
    words = "run on the workers of a Dask cluster, as tcp://host:8786"
    where.add_argument("--scheduler", metavar="ADDRESS", help=words)
    parser.add_argument("--restart", action="store_true", help=restart)
    add_output(parser, "results/NAME_OF_FILE")


def in_crew(chosen: argparse.Namespace, shared: Path | None, act: Callable[[Crew], int]) -> int:
    """Exit code of what is done with the crew that was asked for; shared: a folder that workers must see."""
    from granular_contact.studies.sweep import CrewError, FolderRefused

    try:
        with crew(chosen, shared) as made:
            return act(made)
    except (CrewError, FolderRefused) as error:
        complain(str(error))
        return FAULTY_INPUT


def crew(chosen: argparse.Namespace, shared: Path | None) -> Crew:
    """Who works: processes of this machine, or those of a cluster."""
    from granular_contact.studies.sweep import Crew
    from granular_contact.studies.sweep.pool import prepare

    if chosen.scheduler is None:
        prepare()  # while the file is read
        return Crew(chosen.workers)
    from granular_contact.studies.sweep.cluster import cluster_crew

    return cluster_crew(chosen.scheduler, shared)


def in_part(
    chosen: argparse.Namespace,
    work: Work,
    folder: Path,
    crew: Crew,
    act: Callable[[Part], int],
    *,
    count: int,
    interrupted: Callable[[Part], None],
    cases: bool = False,
) -> int:
    """Exit code of what is done in the work folder; what is finished is kept there, however it ends.

    count: runs in all; interrupted: what is written besides after Ctrl-C; cases: whether cases have folders.
    """
    from granular_contact.studies.sweep import CrewError
    from granular_contact.studies.sweep.part import opened

    try:
        with opened(work, folder, cases, chosen.restart) as part:
            try:
                return act(part)
            except BaseException as error:
                crew.dismiss()
                kept = _kept(part, count)
                if kept and isinstance(error, KeyboardInterrupt):
                    interrupted(part)
                    complain(f"interrupted; {kept}")
                    return INTERRUPTED
                if kept and isinstance(error, OSError | CrewError):
                    complain(f"the {work.noun} can't go on: {reason(error)}; {kept}")
                    return FAULTY_INPUT
                if not kept or isinstance(error, ConfigError):
                    part.discard()
                raise
    except OSError as error:
        complain(f"the {work.noun} can't go on, or can't be saved in {folder}: {reason(error)}")
        return FAULTY_INPUT


def _kept(part: Part, count: int) -> str:
    """What unfinished work leaves, in words; empty if that is nothing."""
    saved, what = len(part.journal), "cases" if part.work.kind == "sweep" else "runs"
    if not saved:
        return ""
    return f"{saved} of {count} {what} are kept in {part.folder}, and the same command goes on from there"
