"""Every config in space: what it takes, and whether its energy is accounted for.

    python validation/space_configs.py

The configs as they are. CPU time of the solve alone, with compiled kernels in the cache. What is asked: the energy at
each instant within 1e-3 of the greatest.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

from granular_contact import config, scene
from granular_contact import run as run_module
from granular_contact.results.observation import results as results_of
from validation.gallery import number
from validation.tables import machine, markdown

CONFIGS, MOST = Path(__file__).parents[1] / "configs", 1e-3


def row(path: Path) -> list[str] | None:
    """What a config of one run in space comes to; None for others."""
    if not config.is_run(path):
        return None
    loaded = config.load(path)
    built = scene.build(loaded)
    if not built.in_space:
        return None
    begun = run_module.begin(built, None, None)
    start = time.process_time()
    begun.solving.advance()
    taken = time.process_time() - start
    results = results_of(begun.observe(begun.solving.trajectory()), {}, 0)
    cost, off = results.summary["cost"], results.summary["energy"]["imbalance_relative"]
    accuracy = built.solver.accuracy
    steps = f"accuracy {accuracy:g}" if accuracy is not None else f"{1e3 * built.solver.step_s:g} ms"
    counts = [str(cost[key]) for key in ("steps", "newton_iterations", "jacobians")]
    told = "; ".join(results.warnings) or "none"
    end = f"{results['time_s'][-1]:.3g}"
    return [path.stem, end, steps, *counts, f"{taken:.2f}", f"{off:.1e}", number(results.summary), told]


def main() -> int:
    """Print the table; 0 when all energies are accounted for, else 1."""
    rows = [one for path in sorted(CONFIGS.glob("*.yaml")) if (one := row(path)) is not None]
    print(f"{machine('exudyn', 'numba')}\n")
    head = [
        "config",
        "s",
        "steps by",
        "steps",
        "iterations",
        "Jacobians",
        "CPU s",
        "energy imbalance",
        "number",
        "told",
    ]
    print(markdown(head, rows))
    kept = all(float(one[7]) <= MOST for one in rows)
    print(f"\n{'kept' if kept else 'NOT KEPT'}: energy imbalance of at most {MOST:g} on {len(rows)} configs")
    return 0 if kept else 1


if __name__ == "__main__":
    sys.exit(main())
