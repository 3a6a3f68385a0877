"""How fast the runner's environment is: seconds of walking for each second, in one process and in two.

    python validation/gym_speed.py [--quick]

All walk with their motors at 0.6 of their range, episode after episode of 2 s, 50 steps a second. One process and two
are measured in turn, several times. By the clock the best is shown, which tells of two processes only what the other
programs on the machine leave them; so by processor time the medians, too: what two would take with a core each is the
time of their episodes shared evenly, and all of the time of the process that deals them out.

What the machine itself gives is measured in the same rounds, by programs without any of this project
(`validation/peers/side_by_side.py`): cores share their clock, caches and the way to the memory, and at a provider's the
host, so that two processes of any program may gain less than twice what one does. Two are near to walking: the engine
alone in what it does, and Python that compiles a module in the memory that it goes through.

Other programs that run meanwhile slow one process as a second one of ours would, and make the gain look greater. So
what they took is measured too, and only rounds in which that was little count, where there are enough of them.
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
from validation.peers.side_by_side import PROGRAMS, touched
from validation.study import Claim, Outcome, script
from validation.tables import markdown

END, ACTION = 2.0, np.full(4, 0.2)
LEAST, SCALES = 5.0, 1.9  # times real time in one process; of that in two
OF_NEAR = 0.95  # of what two of either near program gain: 1.9 where that is 2
QUIET, ENOUGH = 0.05, 3  # share of the cores that others may take in a round; so many such rounds are enough
WALKING, NEAR = "walking, times real time", list(PROGRAMS)[:2]
_ENV: list[GranularEnv] = []


@dataclass(frozen=True)
class Rate:
    """How much was done in a second of the clock, and of processor time as of `alone`; share that others took."""

    clock: float
    free: float
    others: float


Found = dict[tuple[str, int], list[Rate]]  # by program and processes, the rounds


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


def memory(name: str) -> float:
    """Memory (MB) that a program goes through."""
    return touched(WORKS[name][0])


def alone(spent: list[float], processes: int, dealing: float) -> float:
    """Seconds that work would take of processes with a core each; dealing: of the process that deals it out.

    Each gets as much: which one got more of it here is a matter of who else was at work.
    """
    return sum(spent) / processes + dealing


def busy() -> float:
    """Seconds that all cores have been at work for any program; not a number where nothing tells."""
    try:
        user, nice, system, _, _, hard, soft, stolen, *_ = map(int, Path("/proc/stat").read_text().split()[1:11])
    except (OSError, ValueError):
        return float("nan")
    return (user + nice + system + hard + soft + stolen) / os.sysconf("SC_CLK_TCK")


def rate(name: str, pool: Any, tasks: int, processes: int) -> Rate:
    """How fast a program is."""
    began, dealing, all_before = time.perf_counter(), time.process_time(), busy()
    spent = pool.map(done, [name] * (tasks * processes), chunksize=1)
    wall, dealing, all_of_them = time.perf_counter() - began, time.process_time() - dealing, busy() - all_before
    worth = WORKS[name][1] * tasks * processes
    others = (all_of_them - sum(spent) - dealing) / (wall * (os.cpu_count() or 1))
    return Rate(worth / wall, worth / alone(spent, processes, dealing), others)


def study(quick: bool = False) -> Outcome:
    """Speeds, how they scale, and how other programs do."""
    rounds, tasks = (6, 2) if quick else (16, 3)
    pools = {processes: multiprocessing.get_context("spawn").Pool(processes) for processes in (1, 2)}
    found: Found = {(name, processes): [] for name in WORKS for processes in pools}
    for name in WORKS:
        for processes, pool in pools.items():
            pool.map(done, [name] * (2 * processes), chunksize=1)  # builds, and loads what is compiled
    used = dict(zip(WORKS, pools[1].map(memory, WORKS, chunksize=1), strict=True))
    for _ in range(rounds):
        for name in WORKS:
            for processes, pool in pools.items():
                found[name, processes].append(rate(name, pool, tasks, processes))
    for pool in pools.values():
        pool.close()
    counted, quiet = counting(found)
    words = f"{quiet} of {rounds} rounds in which other programs took less than {100 * QUIET:.0f} % of the cores"
    if quiet < ENOUGH:
        shares = 100 * np.median([one.others for held in found.values() for one in held])
        words += f", too few: all rounds count, in which others took {shares:.0f} % (median)"
    return Outcome(f"{_table(counted, used)}\n\n{words}", _claims(counted))


def counting(found: Found) -> tuple[Found, int]:
    """What counts of the rounds, and how many were quiet from their beginning to their end."""
    rounds = len(next(iter(found.values())))
    kept = [i for i in range(rounds) if all(held[i].others < QUIET for held in found.values())]
    if len(kept) < ENOUGH:
        return found, len(kept)
    return {which: [held[i] for i in kept] for which, held in found.items()}, len(kept)


def _gains(found: Found, name: str) -> tuple[float, float]:
    """Of two processes to one: by the best of the clock, and by the median of processor time."""
    (clock, free), (clock_of_two, free_of_two) = (_typical(found[name, processes]) for processes in (1, 2))
    return clock_of_two / clock, free_of_two / free


def _typical(held: list[Rate]) -> tuple[float, float]:
    return max(one.clock for one in held), float(np.median([one.free for one in held]))


def _table(found: Found, used: dict[str, float]) -> str:
    rows = []
    for name in WORKS:
        (clock, free), (clock_of_two, free_of_two) = (_typical(found[name, processes]) for processes in (1, 2))
        by_clock, gain = _gains(found, name)
        ours = _gains(found, WALKING)[1]
        numbers = clock, clock_of_two, free, free_of_two
        first, second, third, fourth = (f"{number:.1f}" for number in numbers)
        gains = f"{gain:.2f}", f"{ours / gain:.2f}"
        rows.append([name, f"{used[name]:.1f}", first, second, f"{by_clock:.2f}", third, fourth, *gains])
    head = ["a second", "memory MB", "one, by the clock", "two", "gain"]
    head += ["one, by processor time", "two", "gain", "walking's to it"]
    return markdown(head, rows)


def _claims(found: Found) -> tuple[Claim, ...]:
    fast = _typical(found[WALKING, 1])[1]
    scales = _gains(found, WALKING)[1]
    near = [_gains(found, name)[1] for name in NEAR]
    said = f"{scales / max(near):.2f} of it, {scales:.2f} to {' and '.join(f'{one:.2f}' for one in near)}"
    return (
        Claim("gym_speed.one process is at least 5 times real time", fast >= LEAST, f"{fast:.1f} times"),
        Claim("gym_speed.two with a core each are 1.9 times as fast", scales >= SCALES, f"{scales:.2f} times"),
        Claim("gym_speed.two gain 0.95 of what two of either near program gain", scales >= OF_NEAR * max(near), said),
    )


if __name__ == "__main__":
    sys.exit(script(study))
