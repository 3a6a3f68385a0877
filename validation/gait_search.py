"""Run time of a search for a gait in space: 300 runs of the hexapod, 2 s each, on two processes.

    python validation/gait_search.py [--quick]

`optimise` maximises the forward speed of configs/hexapod.yaml over the sweep, the offset and the duty factor of the
stance, at one stride a second. The run time is wall time with all processes and their imports, after the kernels are
compiled. Its parts are measured in one process: reading and building a scene, the solve, and computing the results.
"""

from __future__ import annotations

import resource
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

from granular_contact import load, simulate
from granular_contact.results.observation import results
from granular_contact.run import begin
from granular_contact.scene import build
from granular_contact.studies.optimise.calls import optimise
from validation.study import Claim, Outcome, script
from validation.tables import markdown

SETTINGS = ["solver.accuracy=0.1"]  # as in the environment of the hexapod
STANCE = {
    "signals.stride.stance_sweep_deg": [30, 120],
    "signals.stride.stance_offset_deg": [-30, 30],
    "signals.stride.duty_factor": [0.4, 0.7],
}
CHILDREN = resource.RUSAGE_CHILDREN
RUNS, MOST, SEED, WORKERS = 300, 90.0, 1, 2  # (s)


def parts() -> list[list[str]]:
    """Rows of the table: least processor time of each part of a run, and its share of the whole."""
    least: dict[str, float] = {}
    for _ in range(5):
        times = [time.process_time()]
        scene = build(load("hexapod", SETTINGS))
        times.append(time.process_time())
        begun = begin(scene)
        times.append(time.process_time())
        begun.solving.advance()
        times.append(time.process_time())
        results(begun.observe(begun.solving.trajectory()), {}, 0)
        times.append(time.process_time())
        names = "config and scene", "arrays for kernels", "solve", "results"
        for i, name in enumerate(names):
            least[name] = min(least.get(name, 1e9), times[i + 1] - times[i])
    whole = sum(least.values())
    return [[name, f"{1e3 * seconds:.0f}", f"{seconds / whole:.0%}"] for name, seconds in least.items()]


def used() -> float:
    """Processor time (s) of this process and of its child processes that have ended."""
    return sum(usage.ru_utime + usage.ru_stime for usage in map(resource.getrusage, (resource.RUSAGE_SELF, CHILDREN)))


def study(quick: bool) -> Outcome:
    """Run the search, and time the parts of a run."""
    runs, base = 16 if quick else RUNS, load("hexapod", SETTINGS)
    plain = simulate(base).summary["forward_speed_m_s"]  # kernels are compiled before the clock starts
    began, before = time.perf_counter(), used()
    search = optimise(base, STANCE, maximise="forward_speed_m_s", evaluations=runs, seed=SEED, workers=WORKERS)
    spent, processors = time.perf_counter() - began, used() - before
    best = search.best
    text = f"{runs} runs of 2 s in {spent:.1f} s on {WORKERS} processes, {processors:.1f} CPU s in all (seed {SEED}): "
    text += f"from {1e3 * plain:.0f} to {1e3 * (best.value or 0.0):.0f} mm/s by {_listed(best.numbers)}"
    claim = Claim(f"gait_search.{RUNS} runs take less than {MOST:g} s", spent <= MOST, f"{spent:.0f} s for {runs} runs")
    return Outcome(f"{text}\n\n{markdown(['part of a run', 'ms', 'share'], parts())}", (claim,))


def _listed(numbers: dict[str, float]) -> str:
    return ", ".join(f"{key.split('.')[-1]} {value:.3g}" for key, value in numbers.items())


if __name__ == "__main__":
    raise SystemExit(script(study))
