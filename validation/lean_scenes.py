"""Start-up time, run time and memory of scenes that need only parts of the package, each in its own process.

    python validation/lean_scenes.py

Start-up begins with the interpreter and includes reading the config and building the system; the solve is that of 40 ms
(200 steps). Memory is the largest resident set of the process. Numbers are medians of several processes that run in
turn, after one process that does not count and fills the cache of compiled kernels.
"""

from __future__ import annotations

import json
import os
import statistics
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parent))

from validation.study import Outcome, script
from validation.tables import markdown

VACUUM = "medium=null"
SCENES = (
    ("rigid in vacuum", "pendulum_rigid", (VACUUM,)),
    ("flexible in vacuum", "pendulum", (VACUUM,)),
    ("rigid in sand", "pendulum_rigid", ()),
    ("flexible in sand", "pendulum", ()),
    ("flexible in sand without drag", "pendulum", ("medium.eta_d=0",)),
)
CHILD = """
import json, resource, sys, time
began = time.perf_counter()
from granular_contact.config import load_scenario
from granular_contact.run import run
from granular_contact.scene import build
scenario = load_scenario(sys.argv[1], ["solver.end_time_s=0.04", "solver.rest_time_s=null", *sys.argv[2:]])
scene = build(scenario)
results = run(scene, scenario)
whole = time.perf_counter() - began
solve = results.summary["cost"]["solve_s"]
memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
parts = [name for name in ("numba", "matplotlib", "scipy", "rich") if name in sys.modules]
cost = results.summary["cost"]
print(json.dumps([whole - solve, solve, memory, parts, cost["newton_iterations"], cost["load_calls"]]))
"""


def measure(config: str, overrides: tuple[str, ...]) -> list[object]:
    """Measure one process: start-up and solve (s), memory (kB), imported packages, Newton iterations, load calls."""
    line = [sys.executable, "-c", CHILD, str(HERE.parent / "configs" / f"{config}.yaml"), *overrides]
    path = os.pathsep.join(filter(None, [str(HERE.parent), os.environ.get("PYTHONPATH", "")]))
    done = subprocess.run(line, capture_output=True, text=True, check=True, env={**os.environ, "PYTHONPATH": path})
    numbers: list[object] = json.loads(done.stdout)
    return numbers


def study(quick: bool) -> Outcome:
    """Measure all scenes in turn."""
    rounds = 3 if quick else 9
    runs_by_scene: dict[str, list[list[object]]] = {name: [] for name, *_ in SCENES}
    for i in range(rounds + 1):
        for name, config, overrides in SCENES:
            measured = measure(config, overrides)
            if i > 0:
                runs_by_scene[name].append(measured)
    middle = {
        name: [statistics.median(float(str(run[k])) for run in runs) for k in (0, 1, 2, 4, 5)]
        for name, runs in runs_by_scene.items()
    }
    first = middle[SCENES[0][0]]
    rows = []
    for name, runs in runs_by_scene.items():
        start, solve, memory, iterations, calls = middle[name]
        ratios = [f"{1e3 * start:.0f} ({start / first[0]:.2f})", f"{1e3 * solve:.1f} ({solve / first[1]:.2f})"]
        per = 1e6 * solve / iterations
        counts = [f"{memory / 1024:.0f} ({memory / first[2]:.2f})", f"{iterations:.0f}", f"{per:.0f}", f"{calls:.0f}"]
        rows.append([name, *ratios, *counts, ", ".join(map(str, runs[-1][3])) or "-"])  # type: ignore[call-overload]
    head = [
        "scene",
        "start-up ms",
        "solve ms",
        "memory MB",
        "iterations",
        "us per iteration",
        "load evaluations",
        "imports",
    ]
    text = (
        "In brackets: ratio to the first row. Last column: which of numba, matplotlib, scipy and rich are "
        f"imported. {rounds} processes per scene."
    )
    return Outcome(f"{text}\n\n{markdown(head, rows)}")


if __name__ == "__main__":
    sys.exit(script(study))
