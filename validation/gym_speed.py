"""How fast the runner's environment is: seconds of walking for each second of the clock, in one process and in two.

    python validation/gym_speed.py [--quick]

All walk with their motors at 0.6 of their range, episode after episode of 2 s, 50 steps a second. One process and two
are measured in turn, in many rounds, and so are programs without any of this project, which tell what two processes
gain on this machine (`validation/peers/side_by_side.py`).

The best round counts: what else goes on, on the machine or on the host that lends it, makes a round slower and never
faster. How much that is, the medians show, and the share of the cores that other programs took.
"""

from __future__ import annotations

import multiprocessing
import os
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT))

from granular_contact.gym.environment import GranularEnv
from granular_contact.gym.runner import runner_env
from validation.peers.side_by_side import PROGRAMS
from validation.study import Claim, Outcome, script
from validation.tables import markdown

END, ACTION = 2.0, np.full(4, 0.2)
LEAST, SCALES = 5.0, 1.9  # times real time in one process; of that in two
WALKING = "walking, times real time"
_ENV: list[GranularEnv] = []


@dataclass(frozen=True)
class Round:
    """How much was done in a second of the clock; share of all cores that other programs took meanwhile."""

    speed: float
    others: float


def walk() -> float:
    """One episode; the processor time (s) that it took."""
    if not _ENV:
        _ENV.append(runner_env(end_time_s=END))
    _ENV[0].reset()
    began, over = time.process_time(), False
    while not over:
        *_, ended, cut, _ = _ENV[0].step(ACTION)
        over = ended or cut
    return time.process_time() - began


WORKS: dict[str, tuple[Callable[[], float], float]] = {WALKING: (walk, END), **PROGRAMS}


def done(name: str) -> float:
    """A program's work, once; the processor time (s) that it took."""
    return WORKS[name][0]()


def busy() -> float:
    """Seconds that all cores have been at work for any program; not a number where nothing tells."""
    try:
        user, nice, system, _, _, hard, soft, stolen, *_ = map(int, Path("/proc/stat").read_text().split()[1:11])
    except (OSError, ValueError):
        return float("nan")
    return (user + nice + system + hard + soft + stolen) / os.sysconf("SC_CLK_TCK")


def measured(name: str, pool: Any, tasks: int, processes: int) -> Round:
    """One round of a program."""
    began, own, before = time.perf_counter(), time.process_time(), busy()
    spent = pool.map(done, [name] * (tasks * processes), chunksize=1)
    wall, own, taken = time.perf_counter() - began, time.process_time() - own + sum(spent), busy() - before
    return Round(WORKS[name][1] * tasks * processes / wall, (taken - own) / (wall * (os.cpu_count() or 1)))


def study(quick: bool = False) -> Outcome:
    """Speeds of one process and of two, beside those of other programs."""
    rounds, tasks = (6, 2) if quick else (40, 3)
    pools = {processes: multiprocessing.get_context("spawn").Pool(processes) for processes in (1, 2)}
    found: dict[tuple[str, int], list[Round]] = {(name, processes): [] for name in WORKS for processes in pools}
    for name in WORKS:
        for processes, pool in pools.items():
            pool.map(done, [name] * (2 * processes), chunksize=1)  # builds, and loads what is compiled
    for _ in range(rounds):
        for name in WORKS:
            for processes, pool in pools.items():
                found[name, processes].append(measured(name, pool, tasks, processes))
    for pool in pools.values():
        pool.close()
    speeds = {which: np.array([one.speed for one in held]) for which, held in found.items()}
    rows = []
    for name in WORKS:
        one, two = speeds[name, 1], speeds[name, 2]
        cells = [one.max(), two.max(), two.max() / one.max(), np.median(one), np.median(two)]
        rows.append([name, *(f"{number:.{2 if number < 3.0 else 1}f}" for number in cells)])
    head = ["a second, best of all rounds", "one", "two", "gain", "median of one", "of two"]
    others = 100.0 * np.median([one.others for held in found.values() for one in held])
    words = f"{rounds} rounds, in which other programs took {others:.0f} % of the cores (median)"
    fast, gain = speeds[WALKING, 1].max(), speeds[WALKING, 2].max() / speeds[WALKING, 1].max()
    claims = (
        Claim("gym_speed.one process is at least 5 times real time", fast >= LEAST, f"{fast:.1f} times"),
        Claim("gym_speed.two are 1.9 times as fast as one", gain >= SCALES, f"{gain:.2f} times"),
    )
    return Outcome(f"{markdown(head, rows)}\n\n{words}", claims)


if __name__ == "__main__":
    sys.exit(script(study))
