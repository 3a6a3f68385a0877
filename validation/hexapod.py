"""CPU time of the hexapod and the error of its steps: configs/hexapod.yaml, which comes from a URDF.

    python validation/hexapod.py

The hexapod has seven bodies and walks for two seconds in sand of 3D-RFT. CPU times are those of the solve alone
(without loading, building and results), with compiled kernels in the cache, after a warm-up; the least of three, since
noise can only add to a time. The same walk runs with adaptive steps for smaller errors; the table compares forward
speed, path of the trunk and energy imbalance. Bound: 3 s with `accuracy: 1e-2`.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

import numpy as np

from granular_contact import config, scene
from granular_contact import run as run_module
from granular_contact.results import Results
from granular_contact.results.observation import results as results_of
from validation.tables import machine, markdown

CONFIG = Path(__file__).parents[1] / "configs" / "hexapod.yaml"
ACCURACIES, REPEATS, BOUND = (1e-2, 3e-3, 1e-3), 3, 3.0  # (the bound in s)


def walk(accuracy: float, end: float = 2.0) -> tuple[Results, float, int]:
    """Let the hexapod walk; return the results, the CPU time of the solve (s), and the number of facets in sand."""
    loaded = config.load(CONFIG, [f"solver.accuracy={accuracy}", f"solver.end_time_s={end}"])
    begun = run_module.begin(scene.build(loaded))
    load = begun.solving.tree.load  # type: ignore[attr-defined]  # of a tree in minimal coordinates
    facets = sum(len(line.rows) for line in load.lines)
    start = time.process_time()
    begun.solving.advance()
    taken = time.process_time() - start
    return results_of(begun.observe(begun.solving.trajectory()), {}, 0), taken, facets


def main() -> int:
    """Print the table; return 0 if the bound is kept, else 1."""
    walk(ACCURACIES[0], 0.02)
    runs = {
        accuracy: [walk(accuracy) for _ in range(REPEATS if accuracy == ACCURACIES[0] else 1)]
        for accuracy in ACCURACIES
    }
    finest = runs[ACCURACIES[-1]][0][0]
    t = np.linspace(0.0, 2.0, 201)
    rows = []
    for accuracy, repeats in runs.items():
        results, _, facets = repeats[0]
        cost, summary = results.summary["cost"], results.summary
        path = [np.interp(t, run["time_s"], run[f"trunk_{axis}_m"]) for axis in "xyz" for run in (results, finest)]
        off = max(np.abs(x - reference).max() for x, reference in zip(path[::2], path[1::2], strict=True))
        rows.append([
            f"{accuracy:g}", f"{min(taken for _, taken, _ in repeats):.2f}",
            *(cost[key] for key in ("steps", "newton_iterations", "jacobians")),
            f"{summary['forward_speed_m_s']:.5f}", f"{1e3 * off:.3f}", f"{summary['energy']['imbalance_relative']:.1e}",
        ])  # fmt: skip
    print(f"{machine('exudyn', 'numba')}; {facets} facets on 7 bodies, 2 s of walking\n")
    head = ["accuracy", "CPU s", "steps", "iterations", "Jacobians", "speed m/s", "trunk off mm", "energy imbalance"]
    print(markdown(head, rows))
    kept = float(rows[0][1]) <= BOUND
    print(f"\n{'kept' if kept else 'NOT KEPT'}: {rows[0][1]} s of {BOUND:g} s")
    return 0 if kept else 1


if __name__ == "__main__":
    sys.exit(main())
