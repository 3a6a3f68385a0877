"""Share of the processor time of a sweep or a search that is not spent on its runs.

    python validation/bookkeeping.py [--quick]

The processes are two workers and the parent that distributes the work. The runs are pendulums by finite elements (the
shortest runs that need the engine) and runners. Each run records the processor time of building its scene and solving
it. All other processor time of the three processes is bookkeeping: reading and checking scenarios, selecting runs,
communication, rows, journal. Processor time does not depend on other users of the machine. Starting Python is not
counted: workers count from their first run on. `waiting` is the share of the time in which workers are idle at the end
of generations, on a machine without other users.
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
    """Processor time (s) of the runs, of the workers after their first run, and of the parent; waiting: idle share."""

    runs: float
    workers: float
    parent: float
    waiting: float

    @property
    def lost(self) -> float:
        """Share of the processor time that is not spent on runs."""
        return 1.0 - self.runs / (self.workers + self.parent)


def timed(scenario: Scenario) -> Results:
    """Run a scenario; its summary also has its times and the process."""
    cpu, clock = time.process_time(), time.time()
    results = run(build(scenario))
    ended = time.process_time()
    times = {"pid": os.getpid(), "cpu": ended - cpu, "ended": ended, "begin": clock, "end": time.time()}
    return replace(results, summary=results.summary | {"timed": times})


def spent(rows: list[Row], parent: float) -> Spent:
    """Sum the times of rows, without the first run of each worker, which loads and compiles code."""
    by_worker: dict[int, list[dict[str, float]]] = {}
    for row in rows:
        times = {key: row.summary[f"timed.{key}"] for key in ("pid", "cpu", "ended", "begin", "end")}
        by_worker.setdefault(int(times["pid"]), []).append(times)
    runs = workers = wall = busy = 0.0
    for timings in by_worker.values():
        first, *later = sorted(timings, key=lambda timing: timing["ended"])
        runs += sum(timing["cpu"] for timing in later)
        workers += later[-1]["ended"] - first["ended"]
        wall += later[-1]["end"] - first["end"]
        busy += sum(timing["end"] - timing["begin"] for timing in later)
    return Spent(runs, workers, parent, 1.0 - busy / wall)


def text(name: str) -> str:
    """Common first lines of the sweep file and the search file of a scene."""
    config, changes, *_ = SCENES[name]
    held = ", ".join(f"{key}: {value}" for key, value in changes.items())
    return f"config: {ROOT / 'configs' / config}\nset: {{{held}}}\n"


def by_sweep(name: str, count: int, folder: Path) -> Spent:
    """Run a sweep by Latin hypercube sampling."""
    _, _, first, ends, second, second_ends = SCENES[name]
    ranges = f"{{{first}: {list(ends)}, {second}: {list(second_ends)}}}"
    path = folder / "sweep.yaml"
    path.write_text(f"{text(name)}sample: {{method: latin_hypercube, count: {count}, ranges: {ranges}}}\n")
    loaded = load_sweep(path)
    with sweeps.WorkerPool(WORKERS) as pool:
        begin = time.process_time()
        rows = list(sweeps.run(loaded, pool, journal=Journal(folder), function=timed))
        return spent(rows, time.process_time() - begin)


def by_search(name: str, count: int, folder: Path) -> Spent:
    """Run a search by CMA-ES."""
    _, _, first, ends, second, second_ends = SCENES[name]
    importlib.import_module("cma")  # imported here, as starting Python is not counted
    path = folder / "search.yaml"
    parameters = f"parameters: {{{first}: {list(ends)}, {second}: {list(second_ends)}}}\n"
    path.write_text(f"{text(name)}{parameters}objective: {{maximise: max_depth_m}}\nevaluations: {count}\n")
    study = load_optimise(path, probe=build)
    with sweeps.WorkerPool(WORKERS) as pool:
        begin = time.process_time()
        outcome = search(study, pool, journal=Journal(folder), function=timed)
        return spent([done.row for done in outcome.runs], time.process_time() - begin)


def study(quick: bool) -> Outcome:
    """Measure the share of processor time that is not spent on runs; quick: a quarter of the runs."""
    share, rows, claims = 4 if quick else 1, [], []
    for kind, measure in (("sweep", by_sweep), ("search", by_search)):
        for name, count in COUNTS.items():
            with tempfile.TemporaryDirectory() as folder:
                times = measure(name, count // share, Path(folder))
            detail = f"{100 * times.lost:.1f} % of the processor time (below {100 * MOST:g})"
            claims.append(Claim(f"bookkeeping.{kind} of {name}", times.lost < MOST, detail))
            numbers = (
                count // share,
                f"{1e3 * times.runs / (count // share):.1f}",
                f"{times.workers - times.runs:.2f}",
            )
            shares = f"{times.parent:.2f}", f"{100 * times.lost:.1f}", f"{100 * times.waiting:.1f}"
            rows.append([kind, name, *numbers, *shares])
    head = (
        "",
        "model",
        "runs",
        "CPU ms per run",
        "CPU s of workers outside the runs",
        "CPU s of the parent",
        "lost %",
        "waiting %",
    )
    return Outcome(markdown(head, rows), tuple(claims))


if __name__ == "__main__":
    sys.exit(script(study))
