"""Links in sand in space, from a rope to a rod that hardly bends: their results must be right, or the run must warn.

The source's link on a heavy hub strikes play sand, as in `tests/space/support_bending.py`, with its bending stiffness
multiplied by 1e-4 to 1e6. The reference of soft links has four times as many elements and a tenth of `solver.accuracy`;
the reference of stiff links is a rigid link, their limit. The error is the distance of the tip over its path length.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from support_bending import into_space, pendulum

from granular_contact import Results, load, simulate

Vector = NDArray[np.float64]
BENDING, ELEMENTS = 15.1642, 16
FINE = 4 * ELEMENTS  # elements of references
FACTORS = (1e-4, 1e-2, 1.0, 1e2, 1e4, 1e6)
RIGID_FROM = 100.0  # factor of the stiffness from which the reference is a rigid link


@dataclass(frozen=True)
class Case:
    """Results of a run.

    factor: of the stiffness; error: over the path length; told: whether the run warned of too few elements; imbalance:
    of energies; seconds: solve time, s.
    """

    factor: float
    elements: int
    error: float
    told: bool
    imbalance: float
    seconds: float

    @property
    def cells(self) -> list[str]:
        """Row of the table."""
        warning = "too few elements" if self.told else "nothing"
        numbers = f"{self.error:.1e}", warning, f"{self.imbalance:.1e}", f"{self.seconds:.2f}"
        return [f"{self.factor:g}", str(self.elements), *numbers]


@cache
def run(factor: float, elements: int, accuracy: float = 1e-3) -> Results:
    """Run the link with a factor of its stiffness; elements: 0 for a rigid link."""
    flat = pendulum(BENDING * factor, max(1, elements))
    if elements == 0:
        del flat["model"]["bodies"]["link"]["flexible"]
    flat["solver"]["accuracy"] = accuracy
    return simulate(load(into_space(flat, 0.0)))


def cases(factors: tuple[float, ...], many: int) -> list[Case]:
    """Run all factors with `ELEMENTS`, the softest also with too few elements, and the unchanged link with `many`."""
    runs = []
    for factor in factors:
        rigid = factor >= RIGID_FROM
        reference = run(1.0, 0, 1e-4) if rigid else run(factor, FINE, 1e-4)
        runs.append(_case(factor, ELEMENTS, reference))
    softest = run(factors[0], FINE, 1e-4)
    runs += [_case(factors[0], count, softest) for count in (4, 8)]
    return [*runs, _case(1.0, many, run(1.0, FINE, 1e-4))]


def _case(factor: float, elements: int, reference: Results) -> Case:
    results = run(factor, elements)
    times = np.linspace(0.0, reference["time_s"][-1], 400)
    computed, expected = (
        np.array([np.interp(times, source["time_s"], source[f"tip_{x}_m"]) for x in "xz"])
        for source in (results, reference)
    )
    path_length = float(np.linalg.norm(np.diff(expected, axis=1), axis=0).sum())
    error = float(np.linalg.norm(computed - expected, axis=0).max()) / path_length
    warned = any("too few elements" in warning for warning in results.warnings)
    summary: dict[str, Any] = results.summary
    return Case(factor, elements, error, warned, summary["energy"]["imbalance_relative"], summary["cost"]["solve_s"])
