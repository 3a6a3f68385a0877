"""How fast the runner's environment is: seconds of walking for each second of the clock, in one process and in two.

    python validation/gym_speed.py [--quick]

All walk with their motors at 0.6 of their range, episode after episode of 2 s, 50 steps a second. One process and two
are measured in turn, several times. By the clock the best is shown, which tells of two processes only what the other
programs on the machine leave them; so by processor time the medians, too: what two would take with a core each is the
time of their episodes shared evenly, and all of the time of the process that deals them out.
"""

from __future__ import annotations

import multiprocessing
import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))

from granular_contact.gym.environment import GranularEnv
from granular_contact.gym.runner import runner_env
from validation.study import Claim, Outcome, script
from validation.tables import markdown

END, ACTION = 2.0, np.full(4, 0.2)
LEAST, SCALES = 5.0, 1.9  # times real time in one process; of that in two
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


def alone(walks: list[float], processes: int, dealing: float) -> float:
    """Seconds that walks would take of processes with a core each; dealing: of the process that deals them out.

    Each gets as many: which one got more of them here is a matter of who else was at work.
    """
    return sum(walks) / processes + dealing


def study(quick: bool = False) -> Outcome:
    """Speeds, and how they scale."""
    repeats, episodes = (3, 2) if quick else (6, 4)
    pools = {count: multiprocessing.get_context("spawn").Pool(count) for count in (1, 2)}
    for count, pool in pools.items():
        pool.map(walk, range(4 * count), chunksize=1)  # builds, and loads what is compiled
    speeds: dict[int, list[float]] = {1: [], 2: []}
    free: dict[int, list[float]] = {1: [], 2: []}
    for _ in range(repeats):
        for count, pool in pools.items():
            began, dealing = time.perf_counter(), time.process_time()
            walks = pool.map(walk, range(episodes * count), chunksize=1)
            walked = END * episodes * count
            speeds[count].append(walked / (time.perf_counter() - began))
            free[count].append(walked / alone(walks, count, time.process_time() - dealing))
    for pool in pools.values():
        pool.close()
    one, two = max(speeds[1]), max(speeds[2])
    by_one, by_two = (float(np.median(free[count])) for count in (1, 2))
    rows = [
        ["1", f"{one:.1f}", "", f"{by_one:.1f}", ""],
        ["2", f"{two:.1f}", f"{two / one:.2f}", f"{by_two:.1f}", f"{by_two / by_one:.2f}"],
    ]
    table = markdown(["processes", "times real time", "to one", "by processor time", "to one"], rows)
    fast, scales = max(one, max(free[1])), by_two / by_one
    claims = (
        Claim("gym_speed.one process is at least 5 times real time", fast >= LEAST, f"{fast:.1f} times"),
        Claim("gym_speed.two with a core each are 1.9 times as fast", scales >= SCALES, f"{scales:.2f} times"),
    )
    return Outcome(table, claims)


if __name__ == "__main__":
    sys.exit(script(study))
