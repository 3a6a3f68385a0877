"""Speed of the environments: simulated seconds for each second of wall-clock time, in one process and in two.

    python validation/gym_speed.py [--quick]

Runner (in the plane) and hexapod (in space) walk with their motors at 0.6 of their range, in episodes of 2 s with 50
steps a second. One process and two are measured in turn, in many rounds. Programs without any code of this project are
measured in the same rounds; they show the gain of two processes on this machine (`validation/peers/side_by_side.py`).

The best round counts, since other programs on the machine, or on the host of a virtual machine, only make a round
slower. The medians, and the share of the cores that other programs took, show how much slower.
"""

from __future__ import annotations

import multiprocessing
import os
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT))

from granular_contact.gym.environment import GranularEnv
from granular_contact.gym.hexapod import hexapod_env
from granular_contact.gym.runner import runner_env
from validation.peers.side_by_side import PROGRAMS
from validation.study import Claim, Outcome, script
from validation.tables import markdown

END, ACTION = 2.0, 0.2
WALKING, IN_SPACE = "runner, times real time", "hexapod, times real time"
LEAST, SCALES = (
    {WALKING: 5.0, IN_SPACE: 15.0},
    1.9,
)  # least speed in one process, relative to real time; least gain of the runner in two processes
_ENVS: dict[str, GranularEnv] = {}


@dataclass(frozen=True)
class Round:
    """Work done in a second of wall-clock time, and share of all cores that other programs took."""

    speed: float
    others: float


def walk(name: str, make: Callable[..., GranularEnv]) -> float:
    """Run one episode and return its processor time (s)."""
    if name not in _ENVS:
        _ENVS[name] = make(end_time_s=END)
    env = _ENVS[name]
    env.reset()
    began, over = time.process_time(), False
    action = np.full(env.action_space.shape, ACTION)
    while not over:
        *_, ended, cut, _ = env.step(action)
        over = ended or cut
    return time.process_time() - began


WORKS: dict[str, tuple[Callable[[], float], float]] = {
    WALKING: (partial(walk, WALKING, runner_env), END),
    IN_SPACE: (partial(walk, IN_SPACE, hexapod_env), END),
    **PROGRAMS,
}


def done(name: str) -> float:
    """Do the work of a program once and return its processor time (s)."""
    return WORKS[name][0]()


def busy() -> float:
    """Busy time (s) of all cores for all programs since boot; NaN if the system does not tell it."""
    try:
        user, nice, system, _, _, hard, soft, stolen, *_ = map(int, Path("/proc/stat").read_text().split()[1:11])
    except (OSError, ValueError):
        return float("nan")
    return (user + nice + system + hard + soft + stolen) / os.sysconf("SC_CLK_TCK")


def measured(name: str, pool: Any, tasks: int, processes: int) -> Round:
    """Measure one round of a program."""
    began, parent, before = time.perf_counter(), time.process_time(), busy()
    spent = pool.map(done, [name] * (tasks * processes), chunksize=1)
    wall, parent, taken = time.perf_counter() - began, time.process_time() - parent + sum(spent), busy() - before
    return Round(WORKS[name][1] * tasks * processes / wall, (taken - parent) / (wall * (os.cpu_count() or 1)))


def study(quick: bool = False) -> Outcome:
    """Measure the speeds of one and two processes, and those of other programs."""
    rounds, tasks = (6, 2) if quick else (40, 3)
    pools = {processes: multiprocessing.get_context("spawn").Pool(processes) for processes in (1, 2)}
    measured_rounds: dict[tuple[str, int], list[Round]] = {
        (name, processes): [] for name in WORKS for processes in pools
    }
    for name in WORKS:
        for processes, pool in pools.items():
            pool.map(done, [name] * (2 * processes), chunksize=1)  # builds the models and loads compiled code
    for _ in range(rounds):
        for name in WORKS:
            for processes, pool in pools.items():
                measured_rounds[name, processes].append(measured(name, pool, tasks, processes))
    for pool in pools.values():
        pool.close()
    speeds = {which: np.array([r.speed for r in repeated]) for which, repeated in measured_rounds.items()}
    rows = []
    for name in WORKS:
        single, double = speeds[name, 1], speeds[name, 2]
        cells = [single.max(), double.max(), double.max() / single.max(), np.median(single), np.median(double)]
        rows.append([name, *(f"{number:.{2 if number < 3.0 else 1}f}" for number in cells)])
    head = ["per second, best of all rounds", "one", "two", "gain", "median of one", "median of two"]
    others = 100.0 * np.median([r.others for repeated in measured_rounds.values() for r in repeated])
    note = f"{rounds} rounds; other programs used {others:.0f} % of the cores (median)"
    gain, claims = speeds[WALKING, 2].max() / speeds[WALKING, 1].max(), list[Claim]()
    for name, least in LEAST.items():
        robot, fast = name.partition(",")[0], speeds[name, 1].max()
        claims.append(
            Claim(f"gym_speed.{robot} at least {least:g} times real time", fast >= least, f"{fast:.1f} times")
        )
    claims.append(Claim("gym_speed.two processes are 1.9 times as fast as one", gain >= SCALES, f"{gain:.2f} times"))
    return Outcome(f"{markdown(head, rows)}\n\n{note}", tuple(claims))


if __name__ == "__main__":
    sys.exit(script(study))
