"""Judgement of one case: refused with an error message, run to an honest end, or a fault."""

from __future__ import annotations

import signal
import time
import traceback
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from granular_contact import config
from granular_contact.errors import ConfigError, SceneError, SolveError
from granular_contact.results import Results
from granular_contact.results.accuracy import IMBALANCE_LIMIT
from granular_contact.run import run
from granular_contact.scene import Scene, build
from granular_contact.scene.types import Reduced

LIMIT = 60.0  # s of processor time, including compilation of the kernels that a scene needs
WALL = 10.0  # s, `solver.max_wall_s` of every run: a run may be long, but must keep this limit
MOST_STEPS, MOST_PARTS = 40, 64
FAULTS = ("traceback", "not finite", "no warning", "late", "died", "bad sentence")


@dataclass(frozen=True)
class Outcome:
    """Outcome of a case: kind, one of FAULTS if the outcome is a fault; detail: a line or a traceback."""

    kind: str
    detail: str = ""
    seconds: float = 0.0

    @property
    def is_fault(self) -> bool:
        """Whether the outcome is a fault."""
        return self.kind in FAULTS


class _Late(BaseException):
    """Raised at the limit of processor time; a BaseException, so that no library handles it."""


def judge(path: Path) -> Outcome:
    """Load, build and run a config, and judge the outcome."""
    began = time.process_time()
    try:
        with _limited(LIMIT):
            outcome = _outcome(path)
    except (Exception, _Late):
        # The engine wraps every exception that is raised in one of its calls, also `_Late`.
        trace = traceback.format_exc()
        outcome = Outcome("late" if _Late.__name__ in trace else "traceback", trace[-4000:])
    return replace(outcome, seconds=time.process_time() - began)


@contextmanager
def _limited(seconds: float) -> Iterator[None]:
    """Raise `_Late` in the main thread as soon as the block has used this much processor time."""

    def late(*_: Any) -> None:
        raise _Late

    before = signal.signal(signal.SIGVTALRM, late)
    signal.setitimer(signal.ITIMER_VIRTUAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0.0)
        signal.signal(signal.SIGVTALRM, before)


def _outcome(path: Path) -> Outcome:
    try:
        if config.is_sweep(path):
            config.load_sweep(path)
            return Outcome("fine sweep")
        scenario, sources = config.load(path)
        try:
            scene = build(scenario)
        except SceneError as error:
            raise SceneError(sources.place(error.faults)) from None
    except (ConfigError, SceneError) as error:
        return _refusal(error)
    if len(scene.rigid) + sum(link.elements for link in scene.links) > MOST_PARTS:
        return Outcome("fine, too large to run here")
    end = min(scene.solver.end_time_s, MOST_STEPS * scene.solver.step_s)
    wall = min(WALL, scene.solver.max_wall_s or WALL)
    scene = build(scenario.replace({"solver.end_time_s": end, "solver.max_wall_s": wall}))
    try:
        return _honesty(scene, run(scene))
    except SolveError as error:
        return Outcome("could not begin" if _is_a_line(str(error)) else "bad sentence", str(error))


def _refusal(error: ConfigError | SceneError) -> Outcome:
    lines = [str(fault) for fault in error.faults]
    if not lines or not all(fault.message and _is_a_line(str(fault)) for fault in error.faults):
        return Outcome("bad sentence", repr(lines))
    return Outcome("refused", lines[0])


def _is_a_line(text: str) -> bool:
    return bool(text) and text.isprintable() and len(text) < 2000


def _numbers(name: str, value: Any) -> Iterator[tuple[str, float]]:
    """All numbers of a summary by their dotted keys."""
    if isinstance(value, dict | list | tuple):
        for key, entry in value.items() if isinstance(value, dict) else enumerate(value):
            yield from _numbers(f"{name}.{key}", entry)
    elif isinstance(value, int | float | np.number):
        yield name, float(value)


def _honesty(scene: Scene, results: Results) -> Outcome:
    """Outcome of a run: honest if all numbers are finite, it ends with a sentence, and warns if the energy is off."""
    status = results.status
    if not _is_a_line(status.message):
        return Outcome("bad sentence", status.message)
    method = "reduced" if isinstance(scene.method, Reduced) else "engine" if scene.method is None else "minimal"
    kind = f"{method}: {status.code}"
    drawn = [outline.points for shot in results.snapshots for outline in shot.outlines]
    infinite = [c.name for i, c in enumerate(results.columns) if not np.isfinite(results.table[:, i]).all()]
    if infinite or not all(np.isfinite(points).all() for points in drawn):
        return Outcome("not finite", f"{kind}: {', '.join(infinite) or 'a snapshot'}; {status.message}")
    if infinite := [key for key, value in _numbers("", results.summary) if not np.isfinite(value)]:
        return Outcome("not finite", f"{kind}: summary: {', '.join(infinite)}; {status.message}")
    imbalance = results.summary["energy"]["imbalance_relative"]
    if status.code in ("rest", "end_time") and imbalance > IMBALANCE_LIMIT and not results.warnings:
        return Outcome("no warning", f"{kind}: imbalance {imbalance:.3g}")
    return Outcome(f"{kind}, with a warning" if results.warnings else kind, status.message)
