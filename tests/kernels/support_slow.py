"""The law of `media.lee_marghitu` once more, slow and obvious, and short ways to call the kernels.

Nothing here comes from the kernels: closed resultants of a straight link as the paper has them (Lee and Marghitu,
flexible link that impacts a granular medium; docs/about/model.md), and a midpoint rule or adaptive quadrature along its
true immersed part.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import quad
from support_parts import called

from granular_contact.laws.lee_marghitu import LeeMarghitu, VerticalResistance
from granular_contact.laws.static_friction import Elastoplastic, Smooth
from granular_contact.sand.kernels import lines, strips
from granular_contact.sand.kernels.forces import medium_record

Array = NDArray[np.float64]

G = 9.81
TWO_WAYS = LeeMarghitu(2500.0, 6.5, 8.0, VerticalResistance(22.0, 1.1), VerticalResistance(3.0, 1.7))
# On a bristle that is not stretched s = v / (1e-12 m/s): exactly the sign of anything faster, and its closed forms.
TRUE_SIGN = Elastoplastic(1e-12, 1.0)


@dataclass(frozen=True)
class Link:
    """Straight link with ends P (2, 2) m that move with V (2, 2) m/s."""

    P: Array
    V: Array
    diameter: float
    surface: float = 0.0


def cross(a: Array, b: Array) -> Array:
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def coefficients(law: LeeMarghitu, vy: float) -> tuple[float, float]:
    branch = law.plunging if vy < 0.0 else law.withdrawing
    return branch.eta_v, branch.lam


def resultants(link: Link, law: LeeMarghitu) -> Array:
    """Closed resultants (3, 2) of a link that moves with one velocity.

    A wholly immersed link is the piercing link on its line less the part of that above its upper end.
    """
    v, d, rho = link.V[0], link.diameter, law.density
    depth = link.surface - link.P[:, 1]
    top, tip = max(0.0, depth.min()), max(0.0, depth.max())
    c = link.P[1] - link.P[0]
    t = c / np.linalg.norm(c)
    level = c[1] == 0.0
    immersed = (np.linalg.norm(c) if tip > 0.0 else 0.0) if level else (tip - top) / abs(t[1])
    eta_v, lam = coefficients(law, v[1])
    out = np.zeros((3, 2))
    out[0] = -law.eta_d * rho * d * immersed * abs(cross(t, v)) * v
    out[1, 0] = -np.sign(v[0]) * law.eta_h * G * rho * (tip**2 - top**2) * d
    section = np.pi * d**2 / 4
    if level:  # the limit of the difference below
        volume = (lam + 1.0) * (tip / d) ** lam * section * immersed
    else:  # (z_T / d)^lam V with V = section z_T / |t_y|
        volume = ((tip / d) ** lam * tip - (top / d) ** lam * top) * section / abs(t[1])
    out[2, 1] = -np.sign(v[1]) * eta_v * G * rho * volume
    return out


def midpoint(link: Link, law: LeeMarghitu, points: int) -> Array:
    """Resultant x, y and moment about the origin (3, 3) of each term by a midpoint rule on the immersed part."""
    first, last = _immersed(link)
    xi = first + (last - first) * (np.arange(points) + 0.5) / points
    return np.sum(density(link, law, xi), axis=2) * (last - first) / points


def quadrature(link: Link, law: LeeMarghitu) -> Array:
    """The same to 1e-11 of each piece: adaptive, between the zeros of v_x, v_y and t x v, where the law has kinks."""
    first, last = _immersed(link)
    c = link.P[1] - link.P[0]
    pairs = [link.V[:, 0], link.V[:, 1], cross(c, link.V)]
    zeros = sorted(w[0] / (w[0] - w[1]) for w in pairs if w[0] * w[1] < 0.0)
    cuts = [first, *(x for x in zeros if first < x < last), last]

    def integral(term: int, part: int) -> float:
        def at(xi: float) -> float:
            return float(density(link, law, np.array([xi]))[term, part, 0])

        return sum(quad(at, *ends, epsabs=1e-12, epsrel=1e-11, limit=200)[0] for ends in pairwise(cuts))

    return np.array([[integral(term, part) for part in range(3)] for term in range(3)])


def density(link: Link, law: LeeMarghitu, xi: Array) -> Array:
    """Force and moment about the origin (3, 3, points) of each term by xi at points of the link."""
    p, v = (np.outer(1.0 - xi, X[0]) + np.outer(xi, X[1]) for X in (link.P, link.V))
    d, rho, c = link.diameter, law.density, link.P[1] - link.P[0]
    length = np.linalg.norm(c)
    t = c / length
    z = np.maximum(0.0, link.surface - p[:, 1])
    plunges = v[:, 1] < 0.0
    eta_v = np.where(plunges, law.plunging.eta_v, law.withdrawing.eta_v)
    lam = np.where(plunges, law.plunging.lam, law.withdrawing.lam)
    f = np.zeros((3, len(xi), 2))
    f[0] = (-law.eta_d * rho * d * np.abs(cross(t, v)))[:, None] * v
    f[1, :, 0] = -2 * law.eta_h * G * rho * d * z * abs(t[1]) * np.sign(v[:, 0])
    f[2, :, 1] = -(lam + 1) * eta_v * G * rho * np.pi * d**2 / 4 * (z / d) ** lam * np.sign(v[:, 1])
    return length * np.stack([f[..., 0], f[..., 1], cross(p, f)], axis=1)


def _immersed(link: Link) -> tuple[float, float]:
    """Ends of the immersed part by bisection."""
    z0, z1 = link.surface - link.P[:, 1]
    if z0 >= 0.0 and z1 >= 0.0:
        return 0.0, 1.0
    low, high = 0.0, 1.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        if ((1 - middle) * z0 + middle * z1 > 0.0) == (z0 > 0.0):
            low = middle
        else:
            high = middle
    return (0.0, low) if z0 > 0.0 else (high, 1.0)


def random_link(
    rng: np.random.Generator, slope: float | None = None, depths: tuple[float, float] | None = None, speed: float = 2.0
) -> Link:
    """Link at any slope (rad) whose ends lie between the depths (m), with one velocity, no component below 0.05 m/s."""
    length, diameter = rng.uniform(0.05, 0.3), rng.uniform(0.004, 0.02)
    q = rng.uniform(-np.pi, np.pi) if slope is None else slope
    c = length * np.array([np.cos(q), np.sin(q)])
    if slope in (0.0, np.pi):
        c[1] = 0.0
    low, high = (-0.5 * length, 0.5 * length) if depths is None else depths
    p0 = np.array([rng.uniform(-0.3, 0.3), 0.0])
    p0[1] = -rng.uniform(low, high) - 0.5 * c[1]
    v = rng.uniform(0.05, speed, 2) * rng.choice([-1.0, 1.0], 2)
    return Link(np.array([p0, p0 + c]), np.array([v, v]), diameter)


def medium(law: LeeMarghitu = TWO_WAYS, static: Elastoplastic | Smooth = TRUE_SIGN) -> NDArray[np.void]:
    return law.record(static, G)


def run_record(link: Link, cap: bool = False, resultant: bool = False) -> NDArray[np.void]:
    run = np.zeros(1, lines.LINE)
    run["width"], run["cap"], run["resultant"] = link.diameter, cap, resultant
    return run


def profile(link: Link) -> Array:
    return np.array([[0.0, link.surface]])


def stations_of(link: Link, strips_: int) -> tuple[Array, Array]:
    xi = np.linspace(0.0, 1.0, strips_ + 1)[:, None]
    return (1 - xi) * link.P[0] + xi * link.P[1], (1 - xi) * link.V[0] + xi * link.V[1]


def kernel(
    P: Array,
    V: Array,
    link: Link,
    record: NDArray[np.void] | None = None,
    anchors: Array | None = None,
    cap: bool = False,
    resultant: bool = False,
) -> tuple[Array, Array]:
    """Station forces F (n, 2) and totals (3, 3) of the production kernels; without anchors no bristle is stretched."""
    F, totals = np.full_like(P, np.nan), np.zeros((3, 3))
    form = called(strips.resultant_forces if resultant else strips.distributed_forces)
    m = medium_record(medium() if record is None else record)[0]
    run, bristles = run_record(link, cap, resultant)[0], P.copy() if anchors is None else anchors
    form(P, V, bristles, run, profile(link), m, F, totals)
    return F, totals


def fitted_order(sizes: Array, errors: Array, floor: float) -> float:
    """Slope of log error over log size, points at round-off (below the floor) dropped."""
    keep = errors > floor
    assert keep.sum() >= 3, "too few points above round-off for a fit"
    return float(np.polyfit(np.log(sizes[keep]), np.log(errors[keep]), 1)[0])
