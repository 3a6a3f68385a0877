"""What part of its processor time a sweep or a search spends on anything but its runs.

    python validation/bookkeeping.py [--quick]

Two workers and the process that deals out the work, of pendulums by finite elements (the shortest runs that engines
are needed for) and of runners. Each run tells the processor time of building its scene and solving it; all other time
of the three processes is bookkeeping: reading and checking its scenario, choosing what to run, handing it over, rows,
journal. Processor time does not depend on who else uses the machine. Starting Python is left out: workers count from
their first run on. `waiting` is what workers stand idle at the end of generations, where nobody else uses the cores.
"""

from __future__ import annotations

import importlib
import os
import sys
import tempfile
import time
from dataclasses import dataclass, replace
from pathlib import Path

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT))
os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, [str(ROOT), os.environ.get("PYTHONPATH")]))

from granular_contact.config import Scenario, load_optimise, load_sweep
from granular_contact.results import Results
from granular_contact.run import run
from granular_contact.scene import build
from granular_contact.studies import sweep as sweeps
from granular_contact.studies.optimise.search import search
from granular_contact.studies.sweep.journal import Journal, Row
from validation.study import Claim, Outcome, script
from validation.tables import markdown

WORKERS, MOST = 2, 0.05
SCENES = {
    "pendulum": ("pendulum.yaml", {}, "initial.impact_speed_rad_s", (4, 9), "initial.impact_angle_deg", (20, 60)),
    "runner": (
        "runner.yaml",
        {"solver.accuracy": 1e-2, "solver.end_time_s": 0.5},
        *("signals.stride.frequency_Hz", (1.5, 5), "signals.stride.stance_sweep_deg", (30, 150)),
    ),
}
COUNTS = {"pendulum": 300, "runner": 60}


@dataclass(frozen=True)
class Spent:
    """Seconds: processor time of the runs, of the workers from their first run on, of this process; waiting share."""

    runs: float
    workers: float
    parent: float
    waiting: float

    @property
    def lost(self) -> float:
        """Share of the processor time that is not spent on runs."""
        return 1.0 - self.runs / (self.workers + self.parent)


def timed(scenario: Scenario) -> Results:
    """A run that tells its times."""
    cpu, clock = time.process_time(), time.time()
    results = run(build(scenario))
    ended = time.process_time()
    told = {"pid": os.getpid(), "cpu": ended - cpu, "ended": ended, "begin": clock, "end": time.time()}
    return replace(results, summary=results.summary | {"timed": told})


def spent(rows: list[Row], parent: float) -> Spent:
    """The times of rows; the first run of each worker, which loads and compiles, counts for none."""
    by_worker: dict[int, list[dict[str, float]]] = {}
    for row in rows:
        told = {key: row.summary[f"timed.{key}"] for key in ("pid", "cpu", "ended", "begin", "end")}
        by_worker.setdefault(int(told["pid"]), []).append(told)
    runs = workers = wall = busy = 0.0
    for found in by_worker.values():
        first, *others = sorted(found, key=lambda one: one["ended"])
        runs += sum(one["cpu"] for one in others)
        workers += others[-1]["ended"] - first["ended"]
        wall += others[-1]["end"] - first["end"]
        busy += sum(one["end"] - one["begin"] for one in others)
    return Spent(runs, workers, parent, 1.0 - busy / wall)


def text(name: str) -> str:
    """What sweep and search files have in common."""
    config, changes, *_ = SCENES[name]
    held = ", ".join(f"{key}: {value}" for key, value in changes.items())
    return f"config: {ROOT / 'configs' / config}\nset: {{{held}}}\n"


def by_sweep(name: str, count: int, folder: Path) -> Spent:
    """A latin hypercube."""
    _, _, one, ends, other, others = SCENES[name]
    ranges = f"{{{one}: {list(ends)}, {other}: {list(others)}}}"
    path = folder / "sweep.yaml"
    path.write_text(f"{text(name)}sample: {{method: latin_hypercube, count: {count}, ranges: {ranges}}}\n")
    loaded = load_sweep(path)
    with sweeps.WorkerPool(WORKERS) as pool:
        begin = time.process_time()
        rows = list(sweeps.run(loaded, pool, journal=Journal(folder), function=timed))
        return spent(rows, time.process_time() - begin)


def by_search(name: str, count: int, folder: Path) -> Spent:
    """A search by cma."""
    _, _, one, ends, other, others = SCENES[name]
    importlib.import_module("cma")  # starting Python is left out
    path = folder / "search.yaml"
    parameters = f"parameters: {{{one}: {list(ends)}, {other}: {list(others)}}}\n"
    path.write_text(f"{text(name)}{parameters}objective: {{maximise: max_depth_m}}\nevaluations: {count}\n")
    study = load_optimise(path, probe=build)
    with sweeps.WorkerPool(WORKERS) as pool:
        begin = time.process_time()
        outcome = search(study, pool, journal=Journal(folder), function=timed)
        return spent([one.row for one in outcome.runs], time.process_time() - begin)


def study(quick: bool) -> Outcome:
    """Share of the processor time that is not spent on runs; quick: a quarter of the runs."""
    share, rows, claims = 4 if quick else 1, [], []
    for kind, measure in (("sweep", by_sweep), ("search", by_search)):
        for name, count in COUNTS.items():
            with tempfile.TemporaryDirectory() as folder:
                found = measure(name, count // share, Path(folder))
            told = f"{100 * found.lost:.1f} % of the processor time (below {100 * MOST:g})"
            claims.append(Claim(f"bookkeeping.{kind} of {name}", found.lost < MOST, told))
            numbers = (
                count // share,
                f"{1e3 * found.runs / (count // share):.1f}",
                f"{found.workers - found.runs:.2f}",
            )
            shares = f"{found.parent:.2f}", f"{100 * found.lost:.1f}", f"{100 * found.waiting:.1f}"
            rows.append([kind, name, *numbers, *shares])
    head = (
        "",
        "runs of",
        "runs",
        "CPU ms a run",
        "CPU s of workers besides",
        "CPU s of the parent",
        "lost %",
        "waiting %",
    )
    return Outcome(markdown(head, rows), tuple(claims))


if __name__ == "__main__":
    sys.exit(script(study))
