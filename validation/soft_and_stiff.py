"""Links in space from a rope to a rod that hardly bends, in sand: right, or told that they are not.

The source's link on a heavy hub strikes play sand, as in `tests/space/support_bending.py`, its bending stiffness
multiplied by 1e-4 to 1e6. Soft ones are compared with four times as many elements and a tenth of `solver.accuracy`,
stiff ones with a rigid link, which they come to; the distance of the tip is divided by its way.
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
FINE = 4 * ELEMENTS  # of references
FACTORS = (1e-4, 1e-2, 1.0, 1e2, 1e4, 1e6)
RIGID_FROM = 100.0  # times the stiffness: compared with a rigid link


@dataclass(frozen=True)
class Case:
    """A run: factor of the stiffness, elements, error (of the way), whether elements were told of, imbalance, s."""

    factor: float
    elements: int
    error: float
    told: bool
    imbalance: float
    seconds: float

    @property
    def cells(self) -> list[str]:
        """Its row of the table."""
        words = "too few elements" if self.told else "nothing"
        numbers = f"{self.error:.1e}", words, f"{self.imbalance:.1e}", f"{self.seconds:.2f}"
        return [f"{self.factor:g}", str(self.elements), *numbers]


@cache
def run(factor: float, elements: int, accuracy: float = 1e-3) -> Results:
    """A run; elements: 0 for a rigid link."""
    flat = pendulum(BENDING * factor, max(1, elements))
    if elements == 0:
        del flat["model"]["bodies"]["link"]["flexible"]
    flat["solver"]["accuracy"] = accuracy
    return simulate(load(into_space(flat, 0.0)))


def cases(factors: tuple[float, ...], many: int) -> list[Case]:
    """All factors with `ELEMENTS`, the softest with too few, and the link as it is with `many`."""
    found = []
    for factor in factors:
        rigid = factor >= RIGID_FROM
        reference = run(1.0, 0, 1e-4) if rigid else run(factor, FINE, 1e-4)
        found.append(_case(factor, ELEMENTS, reference))
    softest = run(factors[0], FINE, 1e-4)
    found += [_case(factors[0], count, softest) for count in (4, 8)]
    return [*found, _case(1.0, many, run(1.0, FINE, 1e-4))]


def _case(factor: float, elements: int, reference: Results) -> Case:
    results = run(factor, elements)
    times = np.linspace(0.0, reference["time_s"][-1], 400)
    here, there = (
        np.array([np.interp(times, one["time_s"], one[f"tip_{x}_m"]) for x in "xz"]) for one in (results, reference)
    )
    way = float(np.linalg.norm(np.diff(there, axis=1), axis=0).sum())
    error = float(np.linalg.norm(here - there, axis=0).max()) / way
    told = any("too few elements" in one for one in results.warnings)
    summary: dict[str, Any] = results.summary
    return Case(factor, elements, error, told, summary["energy"]["imbalance_relative"], summary["cost"]["solve_s"])
