"""Processor time of the runner's environment beside other programs, to tell what two of them take from each other.

    python validation/gym_neighbours.py [--quick]

One process works on the first core: it walks (as in `gym_speed`), steps the bare engine, or counts. On the second one
another program does something else meanwhile, for longer: nothing, counting, reading numbers here and there in more and
more memory, the bare engine, walking. All take turns, several times; what counts is the processor time of the first
one, over that of the same round with nothing beside it. Cores share no caches but the last, and the way to the memory:
who is slowed by reading and not by counting waits for memory, who is slowed by both shares a core or its clock.
"""

from __future__ import annotations

import multiprocessing
import os
import sys
import time
from multiprocessing.synchronize import Event
from pathlib import Path
from typing import Any

import numpy as np

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT))

from validation.gym_speed import WALKING, busy, done
from validation.study import Outcome, script
from validation.tables import markdown

COUNTING, ENGINE, NOTHING = "counting, millions", "Exudyn alone, s of motion", "nothing"
FIRST = {"walking": (WALKING, 3), "bare engine": (ENGINE, 3), "counting": (COUNTING, 4)}  # works, and how many
MEMORY = {f"reading {size:g} MB": size for size in (0.25, 4.0, 64.0)}
BESIDE = [NOTHING, "counting", *MEMORY, "bare engine", "walking"]
WARM = 0.1  # s, until the second one is at work


def read(size: float) -> int:
    """Numbers here and there in so many MB, each at a place that the one before tells."""
    if size not in _LINES:
        order = np.random.default_rng(0).permutation(int(size * 2**20) // 64)
        _LINES[size] = np.zeros((len(order), 8), np.int64)  # a line of the caches each
        _LINES[size][order, 0] = np.roll(order, 1)
    return chase(_LINES[size], 200_000)


_LINES: dict[float, Any] = {}


def chase(lines: Any, times: int) -> int:
    """The place that so many steps from line to line lead to; compiled below."""
    at = 0
    for _ in range(times):
        at = lines[at, 0]
    return at


def settle_on(core: int) -> None:
    """Stay on a core, where the system lets choose."""
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {core})


def beside(name: str, ready: Event, over: Event) -> None:
    """Work as told until the other one has done; in the second process."""
    global chase
    if name in MEMORY:
        import numba

        chase = numba.njit(chase)
        read(MEMORY[name])
    settle_on(1)
    while not over.is_set():
        if name in MEMORY:
            read(MEMORY[name])
        else:
            done(FIRST[name][0])
        ready.set()


def first(name: str) -> float:
    """Processor time (s) of the first one's work; in its own process."""
    settle_on(0)
    work, times = FIRST[name]
    return float(np.median([done(work) for _ in range(times)]))


def rates(pool: Any, name: str, context: Any) -> tuple[dict[str, float], float]:
    """Processor times (s) of all first ones beside a program, and the share of both cores that others took."""
    ready, over = context.Event(), context.Event()
    other = None
    if name != NOTHING:
        other = context.Process(target=beside, args=(name, ready, over))
        other.start()
        ready.wait()
        time.sleep(WARM)
    began, before = time.perf_counter(), busy()
    spent = {one: pool.apply(first, (one,)) for one in FIRST}
    wall, all_of_them = time.perf_counter() - began, busy() - before
    over.set()
    if other is not None:
        other.join()
    own = sum(spent[one] * FIRST[one][1] for one in FIRST) + (wall if other is not None else 0.0)
    return spent, (all_of_them - own) / (wall * (os.cpu_count() or 1))


def study(quick: bool = False) -> Outcome:
    """Processor times by what is beside."""
    context = multiprocessing.get_context("spawn")
    found: dict[str, dict[str, list[float]]] = {name: {one: [] for one in FIRST} for name in BESIDE}
    others = []
    with context.Pool(1) as pool:
        for one in FIRST:
            pool.apply(first, (one,))  # builds, and loads what is compiled
        for _ in range(3 if quick else 12):
            for name in BESIDE:
                spent, share = rates(pool, name, context)
                others.append(share)
                for one, seconds in spent.items():
                    found[name][one].append(seconds)
    rows = []
    for name in BESIDE:
        cells = []
        for one in FIRST:
            ratio = np.median(np.array(found[name][one]) / np.array(found[NOTHING][one]))
            cells += [f"{1e3 * np.median(found[name][one]):.1f}", f"{ratio:.2f}"]
        rows.append([name, *cells])
    head = ["beside", *(cell for one in FIRST for cell in (f"{one}, CPU ms", "times alone"))]
    shares = 100.0 * np.median(others)
    return Outcome(f"{markdown(head, rows)}\n\nOther programs took {shares:.0f} % of both cores (median).")


if __name__ == "__main__":
    sys.exit(script(study))
