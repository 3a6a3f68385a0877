"""Throughput of sweeps in impacts a second, gain of two workers over one, and growth of memory.

    python validation/sweep_throughput.py [--quick] [--together] [--alone] [--beside CHECKOUT]

The whole command is measured as a user runs it: 10 000 impacts of a rigid pendulum and of the source's single-mode
pendulum, and 1 000 impacts of the finite-element pendulum, by Latin hypercube over four inputs. Runs with one and with
two workers take turns, and the best of the repeats counts, to reduce the effect of other programs on the machine.

Efficiency is the time with one worker over twice the time with two. `whole` includes starting, reading, checking and
writing; `running` is the time from the first rows to the last. `by CPU` does not depend on other users of the cores: it
is the CPU time of one worker for the rows, over the CPU time of two workers and the parent, which shares the cores with
them.

Another table has the same impacts of reduced models in this process, by CPU time: each run alone with whole results,
each alone with its key numbers, and all integrated together by one compiled call; on one thread and on two. --together
prints only this table. A loop of additions is timed in between to measure the speed of the machine; the last column is
in units of this loop.

--alone prints the parts of one run in a warm process. --beside compares the sweeps of another checkout of this
repository with those of this one, in turn, on two workers: the ratio of runs for the same CPU time, including starting,
checking and writing.
"""

from __future__ import annotations

import argparse
import csv
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT))

from granular_contact.config import Case, Sweep, load, load_sweep, scenario_to_dict
from granular_contact.results.observation import results
from granular_contact.run import begin, summaries_of, summary_of
from granular_contact.run import run as run_whole
from granular_contact.scene.build import build_checked
from granular_contact.scene.variants import Builder
from validation.study import Claim, Outcome, script
from validation.tables import machine, markdown

CONFIG = Path("configs", "pendulum.yaml")
METHODS = {
    "rigid link, reduced": "{reduced: {modes: 0}}",
    "single mode, reduced": "{reduced: {modes: 1}}",
    "finite elements": "engine",
}
COUNTS = {"rigid link, reduced": 10_000, "single mode, reduced": 10_000, "finite elements": 1_000}
RANGES = """
    medium.eta_d: [4, 9]
    medium.eta_h: [4, 16]
    initial.impact_speed_rad_s: [2, 9]
    initial.impact_angle_deg: [22, 60]
"""
LOOK_SECONDS = 0.05
WORTH = 0.95  # least efficiency of two workers
TICK = os.sysconf("SC_CLK_TCK")


@dataclass(frozen=True)
class Look:
    """Sample at one time.

    time: since the start, s; rows: bytes of rows in the journal; parent, workers: CPU time, s; memory: of the parent,
    MB.
    """

    time: float
    rows: int
    parent: float
    workers: float
    memory: float


@dataclass(frozen=True)
class Timing:
    """Times of a sweep.

    whole: wall-clock time of the command, s; cpu: CPU time of parent and workers, s; running, parent, workers:
    wall-clock time and CPU times from the first rows to the last, s; memory: of the parent after a fifth of the rows,
    and at most, MB.
    """

    whole: float
    cpu: float
    running: float
    parent: float
    workers: float
    memory: tuple[float, float]


def sweep_file(method: str, count: int, folder: Path, root: Path = ROOT) -> Path:
    """Write a sweep of `count` impacts for the config of a checkout; method: as in a config, or a name of METHODS."""
    path = folder / "many.yaml"
    sample = f"sample:\n  method: latin_hypercube\n  count: {count}\n  ranges:{RANGES}"
    path.write_text(
        f"config: {root / CONFIG}\nset: {{method: {METHODS.get(method, method)}}}\n{sample}", encoding="utf-8"
    )
    return path


def run(method: str, count: int, workers: int, root: Path = ROOT) -> tuple[Timing, int]:
    """Time the command of a checkout in a process; return the times and the number of cases that did not fail."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        path = sweep_file(method, count, folder, root)
        arguments = ["sweep", str(path), "--out", str(folder / "out"), "--workers", str(workers), "--quiet"]
        environment = os.environ | {"PYTHONPATH": f"{root}{os.pathsep}{os.environ.get('PYTHONPATH', '')}"}
        begin = time.perf_counter()
        with subprocess.Popen(
            [sys.executable, "-m", "granular_contact", *arguments], env=environment, cwd=folder
        ) as process:
            timing = watch(process, folder / "out.part" / "journal", begin)
        with (folder / "out" / "table.csv").open(encoding="utf-8", newline="") as file:
            good = sum(row["status"] in ("rest", "end_time") for row in csv.DictReader(file))
    return timing, good


def watch(process: subprocess.Popen[bytes], journal: Path, begin: float) -> Timing:
    """Sample the command and the bytes in its journal until the command ends."""
    samples: list[Look] = []
    while process.poll() is None:
        time.sleep(LOOK_SECONDS)
        try:
            size = sum(path.stat().st_size for path in journal.glob("*.jsonl"))
            # The child of the command is the server of the workers; the workers are its children.
            workers = [w for server in children(process.pid) for w in children(server)]
            cpu = sum(map(cpu_seconds, workers))
            now = time.perf_counter() - begin
            samples.append(Look(now, size, cpu_seconds(process.pid), cpu, memory(process.pid)))
        except OSError:  # the process has ended meanwhile
            continue
    whole = time.perf_counter() - begin
    rows = [look for look in samples if look.rows > 0] or samples[-1:]  # with very few cases no sample may have rows
    most = max(look.rows for look in rows)
    first, last = rows[0], next(look for look in rows if look.rows == most)
    early = next(look for look in rows if look.rows >= most / 5)
    spent = last.time - first.time, last.parent - first.parent, last.workers - first.workers
    return Timing(whole, last.parent + last.workers, *spent, (early.memory, max(look.memory for look in rows)))


def children(process: int) -> list[int]:
    return list(map(int, Path(f"/proc/{process}/task/{process}/children").read_text().split()))


def cpu_seconds(process: int) -> float:
    """CPU seconds of one process, without its children."""
    fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / TICK


def memory(process: int) -> float:
    """Resident memory of one process, MB."""
    text = Path(f"/proc/{process}/status").read_text()
    line = next((line for line in text.splitlines() if line.startswith("VmRSS")), "VmRSS: 0 kB")
    return int(line.split()[1]) / 1024.0


def measure(method: str, count: int, repeats: int) -> tuple[list[str], float]:
    """Row of the table, and the efficiency of the running sweep."""
    run(method, 2, 1)  # compiles the kernels if they are not in the cache
    timings: dict[int, list[Timing]] = {1: [], 2: []}
    good = count
    for _ in range(repeats):
        for workers, repeated in timings.items():
            timing, fine = run(method, count, workers)
            repeated.append(timing)
            good = min(good, fine)
    single, double = (
        {
            name: min(getattr(timing, name) for timing in timings[n])
            for name in ("whole", "running", "parent", "workers")
        }
        for n in (1, 2)
    )
    running = single["running"] / (2 * double["running"])
    by_cpu = single["workers"] / (double["workers"] + double["parent"])
    early, most = timings[2][-1].memory
    cells = [
        method,
        f"{good} of {count}",
        *(f"{times['whole']:.1f}" for times in (single, double)),
        *(f"{count / times['whole']:.0f}" for times in (single, double)),
        f"{100 * single['whole'] / (2 * double['whole']):.1f}",
        f"{100 * running:.1f}",
        f"{100 * by_cpu:.1f}",
        f"{1e3 * double['parent'] / count:.3f}",
        f"{1e3 * double['workers'] / count:.2f}",
        f"{early:.0f}, {most:.0f}",
    ]
    return cells, running


HEAD = (
    "impacts",
    "run",
    "s, 1 worker",
    "s, 2 workers",
    "per s, 1",
    "per s, 2",
    "efficiency %, whole",
    "efficiency %, while running",
    "efficiency %, by CPU",
    "CPU ms per case, parent",
    "CPU ms per case, workers",
    "parent MB after a fifth, largest",
)


def measure_beside(method: str, count: int, repeats: int, other: Path) -> list[list[str]]:
    """Rows of the table that compares this checkout with another one, run in turn."""
    roots, timings_by_name = {"before": other, "now": ROOT}, dict[str, list[Timing]]()
    for root in roots.values():
        run(method, 2, 1, root)
    for _ in range(repeats):
        for name, root in roots.items():
            timings_by_name.setdefault(name, []).append(run(method, count, 2, root)[0])
    cpu = {name: min(timing.cpu for timing in timings) for name, timings in timings_by_name.items()}
    least = {name: min(timing.whole for timing in timings) for name, timings in timings_by_name.items()}
    return [
        [method, name, str(count), f"{least[name]:.1f}", f"{count / least[name]:.0f}", f"{1e3 * cpu[name] / count:.2f}",
         f"{cpu['before'] / cpu[name]:.2f}"]
        for name in roots
    ]  # fmt: skip


HEAD_BESIDE = (
    "impacts",
    "code",
    "run",
    "s, 2 workers",
    "per s",
    "CPU ms per case, all",
    "runs per CPU time, ratio",
)

REDUCED = {
    "rigid, true sign": "{reduced: {modes: 0}}",
    "single mode, elastoplastic": "{reduced: {modes: 1}}",
}
CHUNK = 64  # runs that are integrated together


def whole(sweep: Sweep, cases: list[Case]) -> None:
    """Run each case alone, from the config to the whole results."""
    for case in cases:
        run_whole(build_checked(sweep.scenario(case)))


def key_numbers(sweep: Sweep, cases: list[Case]) -> None:
    """Run each case alone to the key numbers of a row of a sweep; each scene is built from the previous one."""
    builder = Builder()
    for case in cases:
        summary_of(builder(sweep.scenario(case)))


def together(sweep: Sweep, cases: list[Case], threads: int = 1) -> None:
    """Compute the key numbers of cases that are integrated together, as a worker of a sweep does."""
    builder = Builder(sweep.base)

    def chunk(first: int) -> None:
        summaries_of([builder(sweep.scenario(case)) for case in cases[first : first + CHUNK]])

    with ThreadPoolExecutor(threads) as pool:
        list(pool.map(chunk, range(0, len(cases), CHUNK)))


WAYS: dict[str, Callable[[Sweep, list[Case]], None]] = {
    "alone, whole results": whole,
    "alone, key numbers": key_numbers,
    "together, 1 thread": together,
    "together, 2 threads": lambda sweep, cases: together(sweep, cases, 2),
}


ALONE = {
    "rigid, true sign": ("pendulum", {"reduced": {"modes": 0}}),
    "single mode, elastoplastic": ("pendulum", {"reduced": {"modes": 1}}),
    "rigid, minimal coordinates": ("pendulum_rigid", "minimal"),
}


def of_one_run(repeats: int) -> list[list[str]]:
    """CPU time (ms) of the parts of one run alone in a warm process, in the fastest round relative to the loop."""
    rows = []
    for name, (config, method) in ALONE.items():
        rounds = [_parts(config, method) for _ in range(repeats + 1)][1:]
        parts, least = min(rounds, key=lambda timing: sum(timing[0]) / timing[1])
        cells = [f"{1e3 * part:.2f}" for part in (*parts, sum(parts))]
        rows.append([name, *cells, f"{sum(parts) / least:.2f}"])
    return rows


def _parts(config: str, method: Any) -> tuple[list[float], float]:
    """CPU time (s) of config, scene, start, march, observation and results of a run, and of the loop before it."""
    begin_loop, at = loop(), [time.process_time()]

    def passed(value: Any) -> Any:
        at.append(time.process_time())
        return value

    scenario = passed(load(config, method=method).scenario)
    begun = passed(begin(passed(build_checked(scenario))))
    begun.solving.advance()
    observed = passed(begun.observe(passed(begun.solving.trajectory())))
    passed(results(observed, scenario_to_dict(scenario)))
    return [later - earlier for earlier, later in pairwise(at)], begin_loop


HEAD_ALONE = ("run", "config", "scene", "start", "march", "observation", "results", "CPU ms in all", "loops")


def loop() -> float:
    """CPU time (s) of a loop of 100 000 additions, as a measure of the present speed of the machine."""
    begin, total = time.process_time(), 0
    for i in range(100_000):
        total += i * i
    return time.process_time() - begin


def in_this_process(count: int, repeats: int) -> list[list[str]]:
    """Rows of the table of runs in this process: least CPU and wall times of rounds in which the variants alternate."""
    rows = []
    for name, method in REDUCED.items():
        with tempfile.TemporaryDirectory() as folder:
            sweep = load_sweep(sweep_file(method, count, Path(folder)))
        cases, spent, loops = list(sweep.cases), {variant: [] for variant in WAYS}, [loop()]
        for variant in WAYS.values():
            variant(sweep, cases[:4])
        for _ in range(repeats):
            for variant, act in WAYS.items():
                clock, cpu = time.perf_counter(), time.process_time()
                act(sweep, cases)
                spent[variant].append((time.process_time() - cpu, time.perf_counter() - clock))
                loops.append(loop())
        least = {
            variant: [min(column) / count for column in zip(*times, strict=True)] for variant, times in spent.items()
        }
        first = least[next(iter(WAYS))][0]
        rows += [
            [name, variant, f"{1e3 * cpu:.2f}", f"{first / cpu:.2f}", f"{1.0 / clock:.0f}", f"{cpu / min(loops):.2f}"]
            for variant, (cpu, clock) in least.items()
        ]
    return rows


HEAD_TOGETHER = ("runs", "how", "CPU ms per run", "runs per CPU time, ratio", "per s, wall", "reference loops per run")


def study(quick: bool, repeats: int = 3) -> Outcome:
    """Measure the runs a second of one and of two workers; quick: a tenth of the impacts, once."""
    share, repeats = (10, 1) if quick else (1, repeats)
    together = in_this_process(64 if quick else 256, repeats)
    measured = {method: measure(method, count // share, repeats) for method, count in COUNTS.items()}
    text = (
        f"Least of {repeats} rounds after a warm-up.\n\nRuns of one process, by processor time:\n\n"
        f"{markdown(HEAD_TOGETHER, together)}\n\nThe whole command:\n\n"
        f"{markdown(HEAD, [cells for cells, _ in measured.values()])}"
    )
    claims = [
        Claim(
            f"sweep_throughput.{method}",
            gain >= WORTH,
            f"{gain:.2f} of twice the rate of one worker (at least {WORTH:g})",
        )
        for method, (_, gain) in measured.items()
    ]
    return Outcome(text, tuple(claims))


def main() -> int:
    """Run the study, or print one of the other tables."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--quick", action="store_true", help="a tenth of the impacts, once")
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--together", action="store_true", help="print only the first table")
    parser.add_argument("--alone", action="store_true", help="print only the times of the parts of one run")
    parser.add_argument(
        "--beside",
        type=Path,
        help="path of another checkout: run its code and this one in turn, and print only this comparison",
    )
    chosen = parser.parse_args()
    share, repeats = (10, 1) if chosen.quick else (1, chosen.repeats)
    if chosen.alone:
        print(f"{machine('numba', 'scipy')}; the fastest of 20 after a warm-up\n")
        print(markdown(HEAD_ALONE, of_one_run(20)))
        return 0
    if chosen.beside is not None:
        several = [measure_beside(m, count // share, repeats, chosen.beside) for m, count in COUNTS.items()]
        print(f"{machine('exudyn', 'numba', 'scipy')}; least of {repeats} after a warm-up\n")
        print(markdown(HEAD_BESIDE, [row for rows in several for row in rows]))
        return 0
    if chosen.together:
        print(f"{machine('exudyn', 'numba', 'scipy')}; least of {repeats} rounds after a warm-up\n")
        print(markdown(HEAD_TOGETHER, in_this_process(64 if chosen.quick else 256, repeats)))
        return 0
    return script(partial(study, repeats=repeats), ["--quick"] if chosen.quick else [])


if __name__ == "__main__":
    sys.exit(main())
