"""How fast the runner's environment is: seconds of walking for each second of the clock, in one process and in two.

    python validation/gym_speed.py [--quick]

All walk with their motors at 0.6 of their range, episode after episode of 2 s, 50 steps a second. One process and two
are measured in turn, several times. By the clock the best is shown, which tells of two processes only what the other
programs on the machine leave them; so by processor time the medians, too: what two would take with a core each is the
time of their episodes shared evenly, and all of the time of the process that deals them out.

What the machine itself gives is measured in the same rounds: the same processes do nothing but count. Two cores that
share their clock, or a core of the host, count less than twice as fast as one, and no program gains more than they do.
"""

from __future__ import annotations

import multiprocessing
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))

from granular_contact.gym.environment import GranularEnv
from granular_contact.gym.runner import runner_env
from validation.study import Claim, Outcome, script
from validation.tables import markdown

END, ACTION = 2.0, np.full(4, 0.2)
LEAST, SCALES = 5.0, 1.9  # times real time in one process; of that in two
OF_BOUND = 0.95  # of what two processes gain that only count: 1.9 where that is 2
NUMBERS = 3_000_000  # that are added up
Found = dict[tuple[str, int], list[tuple[float, float]]]  # by work and processes: rates by the clock, of processors
_ENV: list[GranularEnv] = []


def walk(_: int) -> float:
    """One episode; the processor time (s) that it took."""
    if not _ENV:
        _ENV.append(runner_env(end_time_s=END))
    _ENV[0].reset()
    began, over = time.process_time(), False
    while not over:
        *_, ended, cut, _ = _ENV[0].step(ACTION)
        over = ended or cut
    return time.process_time() - began


def count(_: int) -> float:
    """Add up numbers; the processor time (s) that it took. It needs no memory, no file and no other process."""
    began, total = time.process_time(), 0
    for number in range(NUMBERS):
        total += number
    return time.process_time() - began


def alone(walks: list[float], processes: int, dealing: float) -> float:
    """Seconds that walks would take of processes with a core each; dealing: of the process that deals them out.

    Each gets as many: which one got more of them here is a matter of who else was at work.
    """
    return sum(walks) / processes + dealing


def rates(what: Callable[[int], float], worth: float, pool: Any, tasks: int, processes: int) -> tuple[float, float]:
    """How much of a worth is done in a second of the clock, and of processor time as of `alone`."""
    began, dealing = time.perf_counter(), time.process_time()
    spent = pool.map(what, range(tasks * processes), chunksize=1)
    done = worth * tasks * processes
    return done / (time.perf_counter() - began), done / alone(spent, processes, time.process_time() - dealing)


def study(quick: bool = False) -> Outcome:
    """Speeds, how they scale, and how counting does."""
    repeats, tasks = (3, 2) if quick else (6, 4)
    pools = {processes: multiprocessing.get_context("spawn").Pool(processes) for processes in (1, 2)}
    for processes, pool in pools.items():
        pool.map(walk, range(4 * processes), chunksize=1)  # builds, and loads what is compiled
    works = {"walking": (walk, END), "counting": (count, NUMBERS / 1e6)}
    found: dict[tuple[str, int], list[tuple[float, float]]] = {(name, n): [] for name in works for n in pools}
    for _ in range(repeats):
        for name, (what, worth) in works.items():
            for processes, pool in pools.items():
                found[name, processes].append(rates(what, worth, pool, tasks, processes))
    for pool in pools.values():
        pool.close()
    return Outcome(_table(found), _claims(found))


def _gains(found: Found, name: str) -> tuple[float, float]:
    """Of two processes to one: by the best of the clock, and by the median of processor time."""
    one, two = found[name, 1], found[name, 2]
    by_clock = max(by for by, _ in two) / max(by for by, _ in one)
    return by_clock, float(np.median([by for _, by in two]) / np.median([by for _, by in one]))


def _table(found: Found) -> str:
    rows = []
    for name, unit in (("walking", "times real time"), ("counting", "millions a second")):
        gains = _gains(found, name)
        for processes in (1, 2):
            held = found[name, processes]
            clock, free = max(by for by, _ in held), float(np.median([by for _, by in held]))
            words = ["", ""] if processes == 1 else [f"{gain:.2f}" for gain in gains]
            rows.append([f"{name}, {unit}", str(processes), f"{clock:.1f}", words[0], f"{free:.1f}", words[1]])
    return markdown(["", "processes", "by the clock", "to one", "by processor time", "to one"], rows)


def _claims(found: Found) -> tuple[Claim, ...]:
    fast = max(by for both in found["walking", 1] for by in both)
    scales, bound = _gains(found, "walking")[1], _gains(found, "counting")[1]
    said = f"{scales / bound:.2f} of it, {scales:.2f} to {bound:.2f}"
    return (
        Claim("gym_speed.one process is at least 5 times real time", fast >= LEAST, f"{fast:.1f} times"),
        Claim("gym_speed.two with a core each are 1.9 times as fast", scales >= SCALES, f"{scales:.2f} times"),
        Claim("gym_speed.two gain 0.95 of what two gain that count", scales >= OF_BOUND * bound, said),
    )


if __name__ == "__main__":
    sys.exit(script(study))
