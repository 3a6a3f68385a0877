"""The command `warm`: compile the kernels of runs in advance, so that the first run of a law does not wait for them."""

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

HELP = "compile in advance what the first run of a law would have to wait for"
WALL_TIME = 0.5  # limit (s) of each run; the estimates of its errors at the end use further kernels


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    text = "YAML files of runs; without any: all shipped configs, which takes some minutes of processor time"
    parser.add_argument("config", metavar="CONFIG", nargs="*", help=text)
    add_set(parser, "medium=rft3d_sand")
    parser.add_argument("--quiet", action="store_true", help="print faults only")


def execute(chosen: argparse.Namespace) -> int:
    """Run the command; returns the exit code."""
    from granular_contact.jit.compiling import announced, seconds
    from granular_contact.run import kernels_of, summary_of

    scenes = [(path, read(path, chosen.set)[1]) for path in chosen.config or _shipped()]
    started, compiled_before, kinds = time.perf_counter(), seconds(), set[str]()
    for path, scene in scenes:
        if (kind := _kind(scene)) in kinds:
            continue
        kinds.add(kind)
        if not chosen.quiet:
            complain(f"{Path(path).stem} ({kind})")
        with announced(None if chosen.quiet else complain, kernels_of(scene)):
            summary_of(replace(scene, solver=scene.solver.model_copy(update={"max_wall_s": WALL_TIME})))
    if not chosen.quiet:
        elapsed = time.perf_counter() - started
        compiling = seconds() - compiled_before
        print(f"{len(kinds)} kinds of runs are ready: {compiling:.1f} s of compiling, {elapsed:.1f} s in all")
    return FINE


def _shipped() -> Iterator[str]:
    """Paths of the shipped configs, without sweeps and other files of many runs."""
    from granular_contact import examples
    from granular_contact.config import is_run

    yield from (str(path) for name in examples.config_names() if (path := examples.config(name)) and is_run(path))


def _kind(scene: Scene) -> str:
    """Text that is equal for scenes that need the same kernels: laws, kinds of bodies and method."""
    from granular_contact.run import kernels_of

    method = type(scene.method).__name__.lower() if scene.method is not None else "engine"
    return f"{kernels_of(scene)}, {method}"
