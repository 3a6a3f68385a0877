"""Standing robots in space: whether they stay at rest, and the CPU time.

    python validation/standing.py

Three robots stand on 3D-RFT sand with a slope of 10 degrees, in a direction 30 degrees from their heading; all joints
are held by PD control. The robots are settled and then stand for 20 s, with adaptive steps at an accuracy of 1e-2.
Bounds: a speed below 1 um/s, and a resistance equal to the weight. The first robot is also dropped, from 15 mm and at
0.1 m/s, and judged from 2 s on. CPU times are those of the solve alone, with compiled kernels in the cache.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[1]))

import numpy as np

from granular_contact import config, scene
from granular_contact import run as run_module
from granular_contact.results.observation import results as results_of
from validation.tables import machine, markdown

SECONDS, MOST, FROM_DROP = 20.0, 1e-6, 2.0  # (s, m/s, s)
LEG = {"type": "rigid", "density_kg_m3": 1200} | {
    "shapes": [{"type": "capsule", "diameter_m": 0.02, "start_m": [0, 0, 0], "end_m": [0, 0, -0.08]}]
}
HIPS = {
    "front_left": [0.08, 0.05],
    "front_right": [0.08, -0.05],
    "rear_left": [-0.08, 0.05],
    "rear_right": [-0.08, -0.05],
}
SEAT = {"type": "rigid", "density_kg_m3": 800, "shapes": [{"type": "box", "size_m": [0.2, 0.12, 0.03]}]}
STOOL: dict[str, Any] = {
    "in_space": True,
    "name": "stool",
    "bodies": {"trunk": SEAT} | dict.fromkeys(HIPS, LEG),
    "joints": {"trunk": {"type": "free", "parent": "ground", "child": "trunk"}}
    | {
        name: {"type": "hinge", "axis": [0, 1, 0], "parent": "trunk", "child": name, "parent_point_m": [*place, 0]}
        for name, place in HIPS.items()
    },
}
SIDES = [f"{end}_{side}" for end in ("front", "rear") for side in ("left", "right")]
# Model, angles (deg) at which its joints are held, gains.
ROBOTS: dict[str, tuple[Any, dict[str, float], float]] = {
    "stool on four pegs": (STOOL, dict.fromkeys(HIPS, 0.0), 10.0),
    "walker_in_space": ("walker_in_space", {f"{j}_{s}": 60.0 for j in ("hip", "knee") for s in SIDES}, 4.0),
    "hexapod": ("hexapod", {f"hip_{e}_{s}": 0.0 for e in ("front", "middle", "rear") for s in ("left", "right")}, 10.0),
}
DROPPED = {"joints": {"trunk": {"z_m": 0.1, "vx_m_s": 0.1}}}


def stand(name: str, seconds: float, *, dropped: bool = False) -> list[str]:
    """Let a robot stand for some seconds; return its row of the table. dropped: it is dropped instead of settled."""
    model, angles, gain = ROBOTS[name]
    drives = {
        joint: {"type": "pd", "angle_deg": angle, "gain_Nm_per_rad": gain, "rate_gain_Nm_s_per_rad": 0.005 * gain}
        for joint, angle in angles.items()
    }
    run = {
        "model": model,
        "medium": "rft3d_sand",
        "bed": {"slope_deg": 10, "slope_direction_deg": 30},
        "initial": DROPPED if dropped else {"settle": True},
        "drives": drives,
        "solver": {"end_time_s": seconds, "accuracy": 1e-2},
    }
    built = scene.build(config.load(run))
    start = time.process_time()
    begun = run_module.begin(built)
    settled = time.process_time()
    begun.solving.advance()
    taken = time.process_time() - settled
    results = results_of(begun.observe(begun.solving.trajectory()), {}, 0)
    path, t = np.column_stack([results[f"trunk_{axis}_m"] for axis in "xyz"]), results["time_s"]
    first = int(np.searchsorted(t, FROM_DROP)) if dropped else 0
    off = float(np.linalg.norm(path[first:] - path[first], axis=1).max())
    weight = built.mass * 9.81  # type: ignore[union-attr]
    force = np.array([results[f"static_force_{axis}_N"][-1] for axis in "xyz"])
    wrong = float(np.linalg.norm(force - [0.0, 0.0, weight])) / weight
    cost = results.summary["cost"]
    drift = 1e6 * off / (t[-1] - t[first])
    facets = sum(len(line.rows) for line in begun.system.facets.lines)
    counts = [str(cost[key]) for key in ("steps", "newton_iterations", "jacobians")]
    label = f"{name}, dropped" if dropped else name
    return [label, str(facets), f"{drift:.1e}", f"{wrong:.1e}", *counts, f"{settled - start:.1f}", f"{taken:.1f}"]


def main() -> int:
    """Print the table; return 0 if all robots stand still, else 1."""
    for name in ROBOTS:
        stand(name, 0.01)
    rows = [stand(name, SECONDS) for name in ROBOTS]
    rows.append(stand("stool on four pegs", SECONDS, dropped=True))
    print(f"{machine('exudyn', 'numba')}; {SECONDS:g} s\n")
    head = ["robot", "facets", "drift um/s", "unbalanced force over weight", "steps", "iterations", "Jacobians"]
    print(markdown([*head, "CPU s to build and settle", "CPU s of the solve"], rows))
    kept = all(1e-6 * float(row[2]) < MOST for row in rows)
    print(f"\n{'kept' if kept else 'NOT KEPT'}: less than {1e6 * MOST:g} um/s")
    return 0 if kept else 1


if __name__ == "__main__":
    sys.exit(main())
