"""Random scenarios and damaged files: every input must give an error message or a run with honest results.

    python validation/fuzz.py --count 10000                     # a night's worth
    python validation/fuzz.py --first 4711 --count 1 --keep failures

A seed determines a case (validation/fuzzing/cases.py). Cases run in their own processes, so that a case that crashes or
hangs is counted and does not stop the others. The files of every case with a fault, and a description of it, are kept
in the folder --keep. The exit code is 1 if there is a fault.
"""

from __future__ import annotations

import argparse
import os
import resource
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from itertools import islice
from multiprocessing import get_context
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[1]))

from validation.fuzzing import cases
from validation.fuzzing.judgement import LIMIT, Outcome, judge
from validation.tables import machine

MEMORY = (
    4 << 30
)  # bytes, limit of a process: a case that needs more counts as a fault, and must not bring down the machine
PATIENCE = 10.0  # wall-clock time until a case is killed, over its limit of processor time, for a busy machine
_processes = get_context("spawn")


def work(line: Connection) -> None:
    """Judge the seeds that are received through a pipe, until None is received."""
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # hides what libraries print about odd input
    os.dup2(1, 2)
    while (seed := line.recv()) is not None:
        line.send(judge_seed(seed))


def judge_seed(seed: int) -> Outcome:
    """Judge one case in this process."""
    with tempfile.TemporaryDirectory() as folder:
        return judge(cases.write(seed, Path(folder)))


class Judge:
    """A process that judges cases; a new process replaces it if it dies or does not answer."""

    def __init__(self) -> None:
        self._process: Any = None

    def __call__(self, seed: int) -> Outcome:
        """Judge the case of a seed."""
        if self._process is None or not self._process.is_alive():
            self._line, remote = _processes.Pipe()
            self._process = _processes.Process(target=work, args=(remote,), daemon=True)
            self._process.start()
            remote.close()
        self._line.send(seed)
        try:
            if self._line.poll(PATIENCE * LIMIT):
                outcome: Outcome = self._line.recv()
                if outcome.kind == "late":  # the interrupted libraries may be in a broken state
                    self._end()
                return outcome
            self._end()
            return Outcome("late", f"no answer in {PATIENCE * LIMIT:g} s: killed")
        except (EOFError, ConnectionError):
            self._process.join()
            return Outcome("died", f"the process ended with the code {self._process.exitcode}")

    def _end(self) -> None:
        self._process.kill()
        self._process.join()


def outcomes(seeds: Iterable[int], processes: int) -> Iterator[tuple[int, Outcome]]:
    """Seeds with their outcomes, in the order of the seeds."""
    seeds, judges = iter(seeds), [Judge() for _ in range(processes)]
    with ThreadPoolExecutor(processes) as pool:
        while batch := list(islice(seeds, 8 * processes)):
            shares = [batch[i::processes] for i in range(processes)]
            by_seed = dict(
                pair
                for share in pool.map(lambda j, s: [(seed, j(seed)) for seed in s], judges, shares)
                for pair in share
            )
            yield from ((seed, by_seed[seed]) for seed in batch)


def table(count: Counter[tuple[str, str]]) -> str:
    """Table of the number of outcomes by kind of case, in Markdown."""
    kinds = sorted({kind for kind, _ in count})
    rows = sorted({outcome for _, outcome in count}, key=lambda outcome: -sum(count[kind, outcome] for kind in kinds))
    lines = [f"| outcome | {' | '.join(kinds)} | all |", f"|---|{'---:|' * (len(kinds) + 1)}"]
    for outcome in rows:
        numbers = [count[kind, outcome] for kind in kinds]
        lines.append(f"| {outcome} | {' | '.join(map(str, numbers))} | {sum(numbers)} |")
    return "\n".join(lines)


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser()
    parser.add_argument("--count", type=int, default=300)
    parser.add_argument("--first", type=int, default=0, help="seed of the first case")
    parser.add_argument("--processes", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--keep", type=Path, default=Path("fuzz_failures"), help="folder for cases with a fault")
    chosen = parser.parse_args(arguments)
    began, count, faults, slowest = time.perf_counter(), Counter[tuple[str, str]](), 0, (0.0, 0)
    for seed, outcome in outcomes(range(chosen.first, chosen.first + chosen.count), chosen.processes):
        count[cases.kind_of(seed), outcome.kind] += 1
        slowest = max(slowest, (outcome.seconds, seed))
        if outcome.is_fault:
            faults += 1
            folder = chosen.keep / str(seed)
            folder.mkdir(parents=True, exist_ok=True)
            cases.write(seed, folder)
            (folder / "fault.txt").write_text(f"{outcome.kind}\n{outcome.detail}\n", encoding="utf-8")
            print(f"seed {seed}: {outcome.kind}: {outcome.detail.strip().splitlines()[-1]}", flush=True)
    print(f"{machine('exudyn', 'numba')}; {chosen.count} cases in {time.perf_counter() - began:.0f} s\n")
    print(table(count))
    print(f"\n{faults} faults; the longest case took {slowest[0]:.1f} s of processor time (seed {slowest[1]})")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
