"""How fast the runner's environment is: seconds of walking for each second of the clock, in one process and in two.

    python validation/gym_speed.py [--quick]

All walk with their motors at 0.6 of their range, episode after episode of 2 s, 50 steps a second. One process and two
are measured in turn, several times; the best is shown, with the processor time of a single one beside it.
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


def study(quick: bool = False) -> Outcome:
    """Speeds, and how they scale."""
    repeats, episodes = (3, 2) if quick else (6, 4)
    pools = {count: multiprocessing.get_context("spawn").Pool(count) for count in (1, 2)}
    for count, pool in pools.items():
        pool.map(walk, range(4 * count), chunksize=1)  # builds, and loads what is compiled
    speeds: dict[int, list[float]] = {1: [], 2: []}
    processor: list[float] = []
    for _ in range(repeats):
        for count, pool in pools.items():
            began = time.perf_counter()
            spent = pool.map(walk, range(episodes * count), chunksize=1)
            speeds[count].append(END * episodes * count / (time.perf_counter() - began))
            processor += spent if count == 1 else []
    for pool in pools.values():
        pool.close()
    one, two = max(speeds[1]), max(speeds[2])
    rows = [
        ["1", f"{one:.1f}", f"{END / min(processor):.1f}", ""],
        ["2", f"{two:.1f}", "", f"{two / one:.2f}"],
    ]
    table = markdown(["processes", "times real time", "by processor time", "to one process"], rows)
    claims = (
        Claim("gym_speed.one process is at least 5 times real time", one >= LEAST, f"{one:.1f} times"),
        Claim("gym_speed.two processes are 1.9 times as fast", two >= SCALES * one, f"{two / one:.2f} times"),
    )
    return Outcome(table, claims)


if __name__ == "__main__":
    sys.exit(script(study))
