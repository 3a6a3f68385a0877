"""The command `warm`: compile ahead what runs need, so that the first run of a law does not wait for it."""

from __future__ import annotations

import argparse
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from granular_contact.cli.common import FINE, add_set, complain, read

if TYPE_CHECKING:
    from granular_contact.scene import Scene

HELP = "compile ahead what the first run of a law has to wait for"
LONG = 0.5  # of a run (s), whose end its error is estimated from


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    words = "YAML files of runs; left out: what the shipped configs need, some minutes of processor time"
    parser.add_argument("config", metavar="CONFIG", nargs="*", help=words)
    add_set(parser, "medium=rft3d_sand")
    parser.add_argument("--quiet", action="store_true", help="print faults only")


def execute(chosen: argparse.Namespace) -> int:
    """Run the command; returns the exit code."""
    from granular_contact.jit.compiling import announced, seconds
    from granular_contact.run import kernels_of, summary_of

    scenes = [(path, read(path, chosen.set)[1]) for path in chosen.config or _shipped()]
    started, before, done = time.perf_counter(), seconds(), dict[str, None]()
    for path, scene in scenes:
        if (kind := _kind(scene)) in done:
            continue
        done[kind] = None
        if not chosen.quiet:
            complain(f"{Path(path).stem} ({kind})")
        with announced(None if chosen.quiet else complain, kernels_of(scene)):
            summary_of(replace(scene, solver=scene.solver.model_copy(update={"max_wall_s": LONG})))
    if not chosen.quiet:
        elapsed = time.perf_counter() - started
        print(f"{len(done)} kinds of runs are ready: {seconds() - before:.1f} s of compiling, {elapsed:.1f} s in all")
    return FINE


def _shipped() -> Iterator[str]:
    """The shipped configs of one run."""
    from granular_contact import examples
    from granular_contact.config import is_run

    yield from (str(path) for name in examples.config_names() if (path := examples.config(name)) and is_run(path))


def _kind(scene: Scene) -> str:
    """What scenes have in common that need the same kernels: method, laws, kinds of bodies."""
    from granular_contact.run import kernels_of

    method = type(scene.method).__name__.lower() if scene.method is not None else "engine"
    return f"{kernels_of(scene)}, {method}"
