"""Clamped-free modes of a uniform Euler-Bernoulli beam, each scaled to a deflection of 1 at the tip.

With xi = z / L and the roots beta of cos(beta) cosh(beta) = -1,

    phi(xi) = cosh(beta xi) - cos(beta xi) - s (sinh(beta xi) - sin(beta xi)),
    s = (cosh(beta) + cos(beta)) / (sinh(beta) + sin(beta)),         Phi = phi / phi(1),    |phi(1)| = 2.

The hyperbolic functions cancel to exp(-beta) of their size, which costs all digits from the twelfth mode on; here their
sum is written with decaying exponentials only, so every mode is good to round-off.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]


def roots(count: int) -> Vector:
    """First roots beta (count,) of cos(beta) cosh(beta) = -1."""
    beta: Vector = (np.arange(count, dtype=np.float64) + 0.5) * np.pi
    for _ in range(50):
        small = 1.0 / np.cosh(beta)
        change = (np.cos(beta) + small) / (np.sin(beta) + small * np.tanh(beta))
        beta = beta + change
        if np.all(np.abs(change) <= 1e-15 * beta):
            break
    return beta


@dataclass(frozen=True)
class Modes:
    """Modes of a beam: roots (n,) and length (m). All methods return one column, or entry, for each mode."""

    beta: Vector
    length: float

    @cached_property
    def _decay(self) -> Vector:
        """Coefficient of exp(-beta (1 - xi)) in phi."""
        b, small = self.beta, np.exp(-self.beta)
        decay: Vector = (np.sin(b) - np.cos(b) - small) / (1.0 - small**2 + 2.0 * small * np.sin(b))
        return decay

    @cached_property
    def _s(self) -> Vector:
        """The ratio s = 1 - 2 _decay exp(-beta)."""
        s: Vector = 1.0 - 2.0 * self._decay * np.exp(-self.beta)
        return s

    @cached_property
    def _tip(self) -> Vector:
        tip: Vector = np.where(np.arange(len(self.beta)) % 2 == 0, 2.0, -2.0)
        return tip

    def _sum(self, z: Vector, sign: float) -> Vector:
        xi = np.asarray(z, float)[:, None] / self.length
        b, s = self.beta, self._s
        grown = self._decay * np.exp(-b * (1.0 - xi)) + 0.5 * (1.0 + s) * np.exp(-b * xi)
        shape: Vector = (grown - sign * (np.cos(b * xi) - s * np.sin(b * xi))) / self._tip
        return shape

    def shape(self, z: Vector) -> Vector:
        """Phi (points, n) at places z (points,) m along the beam."""
        return self._sum(z, 1.0)

    def curvature(self, z: Vector) -> Vector:
        """Second derivative of Phi (points, n), 1/m2."""
        curvature: Vector = self._sum(z, -1.0) * (self.beta / self.length) ** 2
        return curvature

    def mean(self) -> Vector:
        """Integral of Phi over xi, exact: 2 s / (beta phi(1))."""
        mean: Vector = 2.0 * self._s / (self.beta * self._tip)
        return mean

    def first_moment(self) -> Vector:
        """Integral of xi Phi over xi, exact: 2 / (beta^2 phi(1))."""
        moment: Vector = 2.0 / (self.beta**2 * self._tip)
        return moment

    def bending(self) -> Vector:
        """Integral of the squared curvature along the beam (1/m3), exact, as that of Phi^2 over xi is 1/4."""
        bending: Vector = self.beta**4 / (4.0 * self.length**3)
        return bending

    def frequencies(self, bending_stiffness: float, mass_per_length: float) -> Vector:
        """Clamped-free frequencies (n,) Hz, for N m2 and kg/m."""
        f: Vector = (self.beta / self.length) ** 2 * np.sqrt(bending_stiffness / mass_per_length) / (2.0 * np.pi)
        return f
