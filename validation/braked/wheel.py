"""A smooth wheel in steady motion by 3D-RFT in numpy: midpoint rule on the rim, sinkage from the load.

x is forward, z up, the surface at z = 0. A point of the rim at the angle theta ahead of the lowest point has the
position (R sin theta, R (1 - cos theta) - s), the outward normal n = (sin theta, -cos theta) and, for an axle speed V
and a rim speed U, the velocity (V - U cos theta, -U sin theta). As n . v = V sin theta, only the front half is loaded,
at any slip. S(theta) does not depend on the sinkage s, so it is computed once for each slip:

    (Fx, Fz) = b R int S(theta) g(z(theta)) dtheta,      g(z) = z for a level surface.

Both sides of the wheel move in their own plane. 3D-RFT in the package gives no force there: for the mean of both
normals alpha_n is 0, and so is the friction limit.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from granular_contact.laws.rft3d import F1, F2, F3, UPRIGHT, cubic

Vector = NDArray[np.float64]

POINTS = 360  # number on the rim from the lowest to the highest point
G = 9.81
SHALLOWEST, DEEPEST, DEPTHS = 1e-4, 0.115, 36  # m, m, number: grid of sinkages that brackets the balance


@dataclass(frozen=True)
class Sand:
    """Bulk density (kg/m3) and coefficient of internal friction; surface friction is equal, as in the preset."""

    density: float = 1330.0
    mu: float = 0.5543

    @property
    def weight(self) -> float:
        """Specific weight (N/m3)."""
        return self.density * G

    @property
    def stiffness(self) -> float:
        """Stiffness xi_n (N/m3)."""
        return self.weight * (894.0 * self.mu**3 - 386.0 * self.mu**2 + 89.0 * self.mu)


SAND = Sand()


def stress(normal: Vector, direction: Vector, sand: Sand = SAND) -> Vector:
    """Stress per depth S (n, 2) N/m3 on elements with outward normals (n, 2) that move in directions (n, 2); x, z."""
    (nx, nz), (ux, uz) = normal.T, direction.T
    x1, x2, x3 = -uz, -nz, nx * ux + nz * uz
    side = np.clip(x2 / UPRIGHT, -1.0, 1.0)
    (even1, odd1), (even2, odd2), (even3, odd3) = (cubic(x1, x2, x3, coefficients) for coefficients in (F1, F2, F3))
    f1, f2, f3 = side * even1 + odd1, even2 + side * odd2, even3 + side * odd3
    alpha = np.column_stack([f1 * nx + f2 * ux, f1 * nz + f2 * uz - f3])
    along = np.sum(alpha * normal, axis=1)[:, None] * normal
    slide = alpha - along
    most = sand.mu * np.linalg.norm(along, axis=1)
    share = np.minimum(1.0, most / np.maximum(np.linalg.norm(slide, axis=1), 1e-300))
    alpha = along + share[:, None] * slide
    driving = np.maximum(0.0, np.sum(alpha * direction, axis=1))
    return sand.stiffness * (alpha - driving[:, None] * direction)


@dataclass(frozen=True, eq=False)
class Rim:
    """A wheel of a radius and width (m) at a ratio of speeds U / V, with S (n, 2) at its angles (n,)."""

    radius: float
    width: float
    ratio: float
    angle: Vector
    traction: Vector

    def place(self, sinkage: float) -> tuple[Vector, Vector]:
        """Positions x, z (n,) m of the points of the rim."""
        return self.radius * np.sin(self.angle), self.radius * (1.0 - np.cos(self.angle)) - sinkage

    def front(self, sinkage: float) -> float:
        """Distance (m) ahead of the axle at which the rim meets a level surface."""
        return float(np.sqrt(max(0.0, self.radius**2 - max(0.0, self.radius - sinkage) ** 2)))

    def sides(self, sinkage: float) -> Vector:
        """Integral (2,) m3 of depth times -v / |v| over both sides below a level surface, x and z.

        It is the friction force of a friction stress that grows by 1 Pa/m.
        """
        z, area, against = _sides(self.radius, self.ratio)
        depth = np.maximum(0.0, sinkage - self.radius - z)
        return 2.0 * ((area * depth) @ against)

    def force(self, sinkage: float, effective: Callable[[Vector, Vector], Vector]) -> Vector:
        """Force (Fx, Fz) N on the wheel; effective: depth g (n,) m of points x, z (n,) m, with negative values as 0."""
        g = np.maximum(0.0, effective(*self.place(sinkage)))
        return self.width * self.radius * (np.pi / POINTS) * (g @ self.traction)


@cache
def rim(radius: float, width: float, ratio: float, sand: Sand = SAND) -> Rim:
    """Rim at a ratio of speeds U / V, which is 0 for a locked wheel."""
    angle = (np.arange(POINTS) + 0.5) * (np.pi / POINTS)
    normal = np.column_stack([np.sin(angle), -np.cos(angle)])
    velocity = np.column_stack([1.0 - ratio * np.cos(angle), -ratio * np.sin(angle)])
    direction = velocity / np.maximum(np.linalg.norm(velocity, axis=1), 1e-12)[:, None]
    return Rim(radius, width, ratio, angle, stress(normal, direction, sand))


@cache
def _sides(radius: float, ratio: float) -> tuple[Vector, Vector, Vector]:
    """Heights over the axle (n,) m and areas (n,) m2 of cells of a side; unit vectors (n, 2) against their motion."""
    r = (np.arange(24) + 0.5) / 24.0 * radius
    turn = (np.arange(120) + 0.5) / 120.0 * 2.0 * np.pi
    x, z = (np.outer(r, component).ravel() for component in (np.cos(turn), np.sin(turn)))
    area = np.repeat(r * (radius / 24.0) * (2.0 * np.pi / 120.0), 120)
    velocity = np.column_stack([1.0 + ratio * z / radius, -ratio * x / radius])
    return z, area, -velocity / np.maximum(np.linalg.norm(velocity, axis=1), 1e-9)[:, None]


def level(x: Vector, z: Vector) -> Vector:
    """Depth (m) below a level surface."""
    return -z + 0.0 * x


def balance(force: Callable[[float], Vector], load: float) -> tuple[float, float]:
    """Least sinkage (m) at which the vertical force is the load (N), and Fx (N) there; nan if there is none."""
    depths = np.linspace(SHALLOWEST, DEEPEST, DEPTHS)
    lacks = [load - force(float(s))[1] for s in depths]
    for low, high, a, b in zip(depths, depths[1:], lacks, lacks[1:], strict=False):
        if a > 0.0 >= b:
            s = float(brentq(lambda s: load - force(s)[1], low, high, xtol=1e-8))
            return s, float(force(s)[0])
    return np.nan, np.nan
