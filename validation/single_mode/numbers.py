"""One number that tells where a model is good enough, and power laws in it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from validation.single_mode.cases import EI, LENGTH, Point

# All numbers but that with the beam follow from the rigid run and the link; all grow as the link becomes softer.
NUMBERS: dict[str, Callable[[Point], float]] = {
    "F L^2 / EI": lambda p: p.rigid["F"] * (p.case.length * LENGTH) ** 2 / (p.case.stiffness * EI),
    "1 / (w1 T)": lambda p: 1.0 / (p.first * p.rigid["T"]),
    "peak deflection of the beam / L": lambda p: (p.value("fine", "deflection") or math.nan) / (p.case.length * LENGTH),
    "sag / z": lambda p: p.sag / p.rigid["z"],
    "sag / (R Q)": lambda p: p.sag / (p.reach * p.rigid["Q"]),
    "speed / w1": lambda p: p.case.speed / p.first,
}
CHOSEN = "1 / (w1 T)"
FASTEST = (
    11.0  # rad/s; the paper's greatest speed is 9.17, and at 20 rad/s the stopping time of its link has a larger error
)
SATURATED = 0.3  # above this error the motions have little in common, so that no power law can hold


@dataclass(frozen=True)
class Fit:
    """Power law error = c N^p by least squares in the logarithms, with R^2 and the number of cases."""

    c: float
    p: float
    r2: float
    count: int

    def threshold(self, error: float) -> float:
        """N for an error."""
        return float((error / self.c) ** (1.0 / self.p))


def fit(points: Sequence[Point], number: str, model: str, measure: str) -> Fit:
    """Fit over the cases whose error is at least three times the difference of the beams and is not saturated."""
    used = [p for p in points if p.known(model, measure) and 3.0 * p.doubt(measure) < p.error(model, measure)]
    used = [p for p in used if p.error(model, measure) < SATURATED]
    x = np.log([NUMBERS[number](p) for p in used])
    y = np.log([p.error(model, measure) for p in used])
    p, c = np.polyfit(x, y, 1)
    residual = np.sum((y - c - p * x) ** 2)
    return Fit(float(np.exp(c)), float(p), float(1.0 - residual / np.sum((y - y.mean()) ** 2)), len(used))


def judged(points: Iterable[Point], model: str, measure: str) -> list[Point]:
    """Cases with a significant error, so that they can be judged; a model that never stops has an infinite error."""
    return [p for p in points if p.known(model, measure)]


def misjudged(points: Sequence[Point], number: str, model: str, measure: str, limit: float) -> tuple[int, int, int]:
    """Numbers of cases beyond the limit that N puts within, of cases within that N puts beyond, and of judged cases."""
    threshold = fit(points, number, model, measure).threshold(limit)
    known = judged(points, model, measure)
    small = [NUMBERS[number](p) < threshold for p in known]
    within = [p.error(model, measure) <= limit for p in known]
    pairs = list(zip(small, within, strict=True))
    return sum(s and not w for s, w in pairs), sum(w and not s for s, w in pairs), len(known)
