"""Benchmark case for other tools (peers): a compound pendulum strikes play sand at 31 degrees and 6.24 rad/s.

Angles q are measured downwards from the horizontal: a link of angle q points along (cos q, -sin q), and q grows as the
link plunges. The pivot is the origin, the tip touches the surface at t = 0, y is up. SI units.

The law is that of this package (`granular_contact.laws.lee_marghitu`), called strip by strip. So every tool has the
same force, integrated exactly up to the surface. The peers differ in their models of the link and in their time
integration.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from granular_contact.laws.lee_marghitu import LeeMarghitu, VerticalResistance
from granular_contact.laws.static_friction import Elastoplastic
from granular_contact.sand.kernels.forces import medium_record
from granular_contact.sand.kernels.immersion import immersed_interval
from granular_contact.sand.kernels.law import LINE, drag_anchor, strip_force
from granular_contact.sand.kernels.strip import Strip

GRAVITY = 9.81  # m/s^2
DENSITY = 7700.0  # kg/m^3
DIAMETER = 0.00635  # of the flexible link, m
LENGTH = 0.23876  # of the flexible link, m
BENDING_STIFFNESS = 15.1642  # EI, N m^2
DISC_LENGTH, DISC_DIAMETER = 0.019812, 0.01905  # RB1, about the pivot axis, m
CLAMP_LENGTH, CLAMP_DIAMETER = 0.01524, 0.01524  # RB2, along the link, m
ROOT = 0.5 * DISC_DIAMETER + CLAMP_LENGTH  # pivot to the start of the flexible link, m

ANGLE = math.radians(31.0)  # at touch
RATE = 6.24  # rad/s
SURFACE = -(ROOT + LENGTH) * math.sin(ANGLE)  # height of the free surface, m
NO_SURFACE = -1e3  # a surface out of reach: motion without sand, m

AREA = 0.25 * math.pi * DIAMETER**2  # m^2
SECOND_MOMENT = math.pi * DIAMETER**4 / 64.0  # m^4
YOUNGS_MODULUS = BENDING_STIFFNESS / SECOND_MOMENT  # Pa

DISC_MASS = DENSITY * 0.25 * math.pi * DISC_DIAMETER**2 * DISC_LENGTH  # kg
CLAMP_MASS = DENSITY * 0.25 * math.pi * CLAMP_DIAMETER**2 * CLAMP_LENGTH  # kg
CLAMP_CENTRE = 0.5 * (DISC_DIAMETER + CLAMP_LENGTH)  # m
ROOT_INERTIA = (  # RB1 and RB2 about the pivot, kg m^2
    DISC_MASS * DISC_DIAMETER**2 / 8.0
    + CLAMP_MASS * (CLAMP_CENTRE**2 + CLAMP_LENGTH**2 / 12.0 + CLAMP_DIAMETER**2 / 16.0)
)

BAR = np.zeros(1, LINE)
BAR["width"] = DIAMETER
BAR = BAR[0]
SAND_LAW = LeeMarghitu(2500.0, 6.5, 8.0, VerticalResistance(22.0, 1.1))
SAND = medium_record(SAND_LAW.record(Elastoplastic(1e-5, 1e-3), GRAVITY))[0]


class Path(NamedTuple):
    """Result of a peer: the tip path, and the wall time of the stepping loop alone."""

    time: NDArray[np.float64]
    """(n,) sample times, s."""
    tip: NDArray[np.float64]
    """(n, 2) tip position, pivot at the origin, y up, m."""
    seconds: float
    """Wall time of the steps; building and warming up stand outside."""


def segment_inertia(length: float, rotary: bool = True) -> float:
    """Transverse inertia (kg m^2) of a piece of the link about its centre; rotary: include that of the section."""
    return DENSITY * AREA * length * (length**2 / 12.0 + (DIAMETER**2 / 16.0 if rotary else 0.0))


@njit
def sand_on_strip(p0, p1, v0, v1, a0, a1, surface, run, m, f):
    """Write the sand's force terms (N) at both ends of a strip to f (3, 2, 2); return whether the strip is immersed.

    p0, p1: positions of the ends (2,), m; v0, v1: their velocities (2,), m/s; a0, a1: anchors (2,) of their bristles,
    m; run, m: records of the kernels. The function is not cached, as the cache would miss a change of the law.
    """
    f[:] = 0.0
    z0, z1 = surface - p0[1], surface - p1[1]
    a, b = immersed_interval(z0, z1)
    if a == b:
        return False
    e0, e1 = (p0[0] - a0[0], p0[1] - a0[1]), (p1[0] - a1[0], p1[1] - a1[1])
    c = p1[0] - p0[0], p1[1] - p0[1]
    strip_force(Strip(a, b, z0, z1, c, (v0[0], v0[1]), (v1[0], v1[1]), e0, e1), run, m, f)
    return True


@njit
def follow(points, anchors, surface, m):
    """Update the anchors (n, 2) m after a step that ended with the stations of a line at points (n, 2 or more) m.

    The return mapping drags anchors at the ends of immersed strips along; other anchors move with their stations.
    """
    n = points.shape[0]
    for i in range(n):
        sticks = False
        for k in range(max(0, i - 1), min(n, i + 2)):
            sticks = sticks or points[k, 1] < surface
        x, y = points[i, 0], points[i, 1]
        if sticks:
            x, y = drag_anchor((x, y), (anchors[i, 0], anchors[i, 1]), m)
        anchors[i, 0], anchors[i, 1] = x, y
