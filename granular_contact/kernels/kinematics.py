"""How the coordinates of a body move its stations, and how forces at the stations become generalised forces.

Rigid body in the plane: coordinates (x, y, phi), stations r (n, 2) in the body frame, p = x + R(phi) r. Run of n_e
planar ANCF cable elements: 4 coordinates (r_x, r_y, r'_x, r'_y) for each of its n_e + 1 nodes; a station lies in one
element, p = N_1 r_0 + N_2 r'_0 + N_3 r_1 + N_4 r'_1 with the Hermite polynomials N_k of its place.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from granular_contact.kernels.law import provide

RIGID_STATION = np.dtype([("x", "f8"), ("y", "f8")])
CABLE_STATION = np.dtype([("first", "i8"), ("shape", "f8", (4,))])


def stations(q, v, geometry, P, V):
    """Fill P (n, 2) m and V (n, 2) m/s from the coordinates q and rates v of the body; by the type of geometry (n,)."""
    raise NotImplementedError


def scatter(q, geometry, P, F, out):
    """Add the generalised forces J^T F of station forces F (n, 2) N to out (m,)."""
    raise NotImplementedError


def spacing(geometry):
    """How far apart coordinates are that no generalised force has in common; 0 where each acts on all."""
    raise NotImplementedError


def rigid_stations(points: NDArray[np.float64], strips: int) -> NDArray[np.void]:
    """Stations of about `strips` strips of like length along the polyline points (k, 2) m of the body frame.

    Every piece of the line has at least one strip.
    """
    lengths = np.linalg.norm(np.diff(points, axis=0), axis=1)
    shares = np.maximum(1, np.rint(strips * lengths / lengths.sum())).astype(int)
    pieces = [np.linspace(a, b, n, endpoint=False) for a, b, n in zip(points, points[1:], shares, strict=False)]
    return _at_places(np.vstack([*pieces, points[-1:]]))


def ball_stations(center: NDArray[np.float64]) -> NDArray[np.void]:
    """Stations of a ball with its centre (2,) m in the body frame; see `balls`."""
    return _at_places(np.stack([center, center]))


def _at_places(places: NDArray[np.float64]) -> NDArray[np.void]:
    stations = np.zeros(len(places), RIGID_STATION)
    stations["x"], stations["y"] = places.T
    return stations


def hermite(xi: NDArray[np.float64], length: float) -> NDArray[np.float64]:
    """Shape functions N_1 .. N_4 of an element of `length` (m) at xi in [0, 1], shape (n, 4)."""
    return np.stack(
        [
            1.0 - 3.0 * xi**2 + 2.0 * xi**3,
            length * (xi - 2.0 * xi**2 + xi**3),
            3.0 * xi**2 - 2.0 * xi**3,
            length * (xi**3 - xi**2),
        ],
        axis=-1,
    )


def cable_stations(lengths: NDArray[np.float64], strips: int) -> NDArray[np.void]:
    """Stations of a run of elements with the given lengths (m), `strips` equal strips in each."""
    stations = np.zeros(len(lengths) * strips + 1, CABLE_STATION)
    for e, length in enumerate(lengths):
        place = slice(e * strips, (e + 1) * strips + 1)
        stations["first"][place] = 4 * e
        stations["shape"][place] = hermite(np.linspace(0.0, 1.0, strips + 1), length)
    return stations


@provide(stations, "geometry", RIGID_STATION)
@njit(cache=True)
def _rigid_stations(q, v, geometry, P, V):
    c, s = np.cos(q[2]), np.sin(q[2])
    for i in range(geometry.shape[0]):
        rx = c * geometry[i].x - s * geometry[i].y
        ry = s * geometry[i].x + c * geometry[i].y
        P[i, 0] = q[0] + rx
        P[i, 1] = q[1] + ry
        V[i, 0] = v[0] - v[2] * ry
        V[i, 1] = v[1] + v[2] * rx


@provide(scatter, "geometry", RIGID_STATION)
@njit(cache=True)
def _rigid_scatter(q, geometry, P, F, out):
    for i in range(P.shape[0]):
        out[0] += F[i, 0]
        out[1] += F[i, 1]
        out[2] += (P[i, 0] - q[0]) * F[i, 1] - (P[i, 1] - q[1]) * F[i, 0]


@provide(spacing, "geometry", RIGID_STATION)
@njit(cache=True)
def _rigid_spacing(geometry):
    return 0


@provide(stations, "geometry", CABLE_STATION)
@njit(cache=True)
def _cable_stations(q, v, geometry, P, V):
    for i in range(geometry.shape[0]):
        first, shape = geometry[i].first, geometry[i].shape
        for xy in range(2):
            p, w = 0.0, 0.0
            for k in range(4):
                p += shape[k] * q[first + 2 * k + xy]
                w += shape[k] * v[first + 2 * k + xy]
            P[i, xy] = p
            V[i, xy] = w


@provide(scatter, "geometry", CABLE_STATION)
@njit(cache=True)
def _cable_scatter(q, geometry, P, F, out):
    for i in range(P.shape[0]):
        if F[i, 0] == 0.0 and F[i, 1] == 0.0:
            continue
        first, shape = geometry[i].first, geometry[i].shape
        for k in range(4):
            out[first + 2 * k] += shape[k] * F[i, 0]
            out[first + 2 * k + 1] += shape[k] * F[i, 1]


@provide(spacing, "geometry", CABLE_STATION)
@njit(cache=True)
def _cable_spacing(geometry):
    return 12  # a node of four coordinates acts on itself and on both of its neighbours
