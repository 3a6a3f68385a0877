"""The bed in several versions of MuJoCo: order of convergence, sinking of a standing robot, CPU time.

    python validation/mujoco_versions.py PYTHON [PYTHON ...]

Each PYTHON is the interpreter of an environment in which this checkout is installed, with its own version of MuJoCo;
they run one after another. Three step sizes give the order of the end position of a plate thrown into 3D-RFT sand
(`two_engines`). The hexapod stands (`two_engines.drift`). A step of its walk is timed with and without the bed
(`mujoco_cost`); the table has the difference in us, and relative to a step of MuJoCo without the bed.
"""

from __future__ import annotations

import json
import subprocess
import sys
from importlib import metadata
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

from validation.tables import machine, markdown

STEPS, INSTANTS = (4e-4, 2e-4, 1e-4), 600
ROWS = ("MuJoCo", "numba", "plate, mm off at 0.1 ms", "order", "sinks um/s at 1 ms", "at 4 ms", "bed us", "share")


def alone() -> list[str]:
    """Row of the table for this interpreter's version of MuJoCo."""
    from validation import mujoco_cost, two_engines

    place = two_engines.PLATE.by_exudyn(two_engines.FALL, INSTANTS)
    apart = [two_engines.PLATE.by_mujoco(two_engines.FALL, step) - place for step in STEPS]
    off = [1e3 * float((difference @ difference) ** 0.5) for difference in apart]
    (_, bare), (_, whole), *_ = mujoco_cost.hexapod_rows()[0]
    sinks = [two_engines.drift(step) for step in (1e-3, 4e-3)]
    numbers = [f"{off[-1]:.3f}", f"{two_engines.order(list(STEPS), off):.2f}", *(f"{speed:.3f}" for speed in sinks)]
    versions = [metadata.version(name) for name in ("mujoco", "numba")]
    return [*versions, *numbers, f"{whole - bare:.1f}", f"{(whole - bare) / bare:.2f}"]


def main() -> int:
    """Print the table; return 0 if all orders are near one and all robots sink by less than 1 um/s, else 1."""
    rows = []
    for python in sys.argv[1:]:
        line = [python, __file__, "--alone"]
        rows.append(json.loads(subprocess.run(line, stdout=subprocess.PIPE, text=True, check=True).stdout))
    print(f"{machine('exudyn')}; steps of 1 ms are timed\n\n{markdown(ROWS, rows)}")
    return 0 if all(0.7 < float(row[3]) < 1.4 and abs(float(row[4])) < 1.0 for row in rows) else 1


if __name__ == "__main__":
    if sys.argv[1:] == ["--alone"]:
        print(json.dumps(alone()))
    else:
        sys.exit(main())
