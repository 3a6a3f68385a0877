"""CPU time of compiling: in the first run of an installation, and for each further law and kind of shape.

    python validation/compile_cost.py [--quick]

Scenes run one after another, each in its own process, starting with an empty cache of compiled kernels. So each scene
compiles only the functions that earlier scenes did not need. The table has the CPU time of numba's compilations,
without imports and run, and the number of compiled functions, including those that other functions call. The first
scenes have round bars in the plane; other laws, shapes and scenes in space follow. *further law* means a shape of an
earlier scene with another law.

Bounds: 25 CPU s for the first run, 8 for each further law or shape, and 10 for the first robot in space, which needs a
further method of solution. The times also depend on the clock rate of the processor: if it varies, state it.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parent))

from validation.study import Claim, Outcome, script
from validation.tables import markdown

FIRST, FURTHER, ROBOT = 25.0, 8.0, 10.0  # CPU s
IN_SPACE = "robot in space, rft3d"
# New part of a scene, its config, overrides.
SCENES: tuple[tuple[str, str, tuple[str, ...]], ...] = (
    ("first run: round bar that bends, lee_marghitu", "pendulum", ()),
    ("rigid links, free in the plane", "free_link", ()),
    ("further law: bar, hill", "pendulum", ("medium={from: hill_cylinders, density_kg_m3: 1500}",)),
    ("plates, rft", "runner", ()),
    ("further law: plates, drft", "walker", ("medium=quikrete_play_sand_rft",)),
    ("wheel, pressure and sinkage", "wheel", ()),
    (IN_SPACE, "hexapod", ()),
    ("further law: robot, rft", "hexapod", ("medium=rft_generic",)),
    ("layers in space", "thin_sand", ()),
    ("shapes that turn in space", "screw", ()),
    ("joints of a walker in space", "walker_in_space", ()),
)
QUICK = (0, 1, 2, 6)
CHILD = """
import json, sys, time
from numba.core import event

class Sum(event.Listener):
    depth, begin, spent, number = 0, 0.0, 0.0, 0

    def on_start(self, event):
        if self.depth == 0:
            self.begin = time.process_time()
        self.depth += 1
        self.number += event.kind == "numba:compile"

    def on_end(self, event):
        self.depth -= 1
        if self.depth == 0:
            self.spent += time.process_time() - self.begin

found = Sum()
event.register("numba:compile", found)
event.register("numba:run_pass", found)  # of C functions there is no other event
from granular_contact.config import load_scenario
from granular_contact.run import run
from granular_contact.scene import build
scenario = load_scenario(sys.argv[1], ["solver.end_time_s=0.004", "solver.rest_time_s=null", *sys.argv[2:]])
run(build(scenario), scenario)
print(json.dumps([found.spent, found.number]))
"""


def measure(cache: str, config: str, overrides: tuple[str, ...]) -> tuple[float, int]:
    """CPU time (s) of compiling the functions that a scene needs and the cache lacks, and their number."""
    path = os.pathsep.join(filter(None, [str(HERE.parent), os.environ.get("PYTHONPATH", "")]))
    line = [sys.executable, "-c", CHILD, str(HERE.parent / "configs" / f"{config}.yaml"), *overrides]
    environment = {**os.environ, "PYTHONPATH": path, "NUMBA_CACHE_DIR": cache}
    done = subprocess.run(line, capture_output=True, text=True, check=True, env=environment)
    seconds, functions = json.loads(done.stdout.splitlines()[-1])
    return seconds, functions


def study(quick: bool) -> Outcome:
    """Run the scenes one after another with one cache, which is empty at first."""
    rows, seconds = [], []
    with tempfile.TemporaryDirectory() as cache:
        for i, (new, config, overrides) in enumerate(SCENES):
            if quick and i not in QUICK:
                continue
            spent, functions = measure(cache, config, overrides)
            seconds.append(spent)
            rows.append([new, " ".join([config, *overrides]), f"{spent:.1f}", functions])
    further = {row[0]: spent for row, spent in zip(rows, seconds, strict=True)}
    first, robot = further.pop(SCENES[0][0]), further.pop(IN_SPACE)
    over = [new for new, spent in further.items() if spent > FURTHER]
    detail = f"; above the bound: {'; '.join(over)}" if over else ""
    most = max(further.values())
    claims = (
        Claim("compile_cost.first_run", first <= FIRST, f"{first:.1f} CPU s (at most {FIRST:g})"),
        Claim("compile_cost.first_robot_in_space", robot <= ROBOT, f"{robot:.1f} CPU s (at most {ROBOT:g})"),
        Claim("compile_cost.each_further", not over, f"at most {most:.1f} CPU s (at most {FURTHER:g}){detail}"),
    )
    return Outcome(markdown(["newly compiled", "scene", "CPU s", "functions"], rows), claims)


if __name__ == "__main__":
    sys.exit(script(study))
