"""Motion of stations from the coordinates of their body, and generalised forces from forces at stations.

Rigid body in the plane: coordinates (x, y, phi), stations r (n, 2) in the body frame, p = x + R(phi) r. Run of n_e
planar ANCF cable elements: 4 coordinates (r_x, r_y, r'_x, r'_y) for each of its n_e + 1 nodes; a station lies in one
element, p = N_1 r_0 + N_2 r'_0 + N_3 r_1 + N_4 r'_1 with the Hermite polynomials N_k at its position. Rigid body in
space that moves in the plane: see `spatial`. All stations have one record type, so callers are compiled once.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from granular_contact.jit.compiled import part
from granular_contact.jit.records import fields, record_dtype

# Kinds of bodies; a line is on one body.
RIGID, CABLE, SPATIAL = 0, 1, 2

# x, y, z: position in the frame of a rigid body (m). first, shape: first coordinate of the element of a cable, and
# N_1 .. N_4 at the station. kept: whether the station also belongs to the division into strips of twice the length.
STATION = record_dtype(
    [("kind", "i8"), *fields("f8", "x", "y", "z"), ("first", "i8"), ("shape", "f8", (4,)), ("kept", "?")]
)


def ball_stations(center: NDArray[np.float64]) -> NDArray[np.void]:
    """Stations of a ball with its centre (2,) m in the body frame; see `balls`."""
    return _at_positions(np.stack([center, center]))


def curved_stations(
    points: NDArray[np.float64], turns: NDArray[np.float64], strips: int, split: int = 1
) -> list[tuple[NDArray[np.void], float]]:
    """Stations of about `strips` strips of similar length along the polyline points (k, 2) m of the body frame.

    Each side is the chord of an arc that turns by an angle (rad), 0 if it is straight, and has at least one strip.
    Returns runs of neighbouring sides whose strips turn by the same angle, each with this angle. split: number of
    parts into which each strip is divided.
    """
    lengths = np.linalg.norm(np.diff(points, axis=0), axis=1)
    shares = split * np.maximum(1, np.rint(strips * lengths / lengths.sum())).astype(int)
    angles = turns / shares
    runs = []
    first = 0
    for i in range(1, len(angles) + 1):
        if i < len(angles) and abs(angles[i] - angles[first]) < 1e-9:
            continue
        positions = _along(points[first : i + 1], turns[first:i], shares[first:i])
        stations = _at_positions(positions)
        pieces = shares[first:i] if angles[first] == 0.0 else [shares[first:i].sum()]
        stations["kept"] = np.concatenate([*map(_every_second, pieces), [True]])
        runs.append((stations, float(angles[first])))
        first = i
    return runs


def _along(points: NDArray[np.float64], turns: NDArray[np.float64], strips: NDArray[np.int64]) -> NDArray[np.float64]:
    """Ends (n + 1, 2) m of n strips along a polyline; strips, turns (rad): their number and the angle of each side."""
    side = np.repeat(np.arange(len(strips)), strips)
    share = (np.arange(len(side)) - (np.cumsum(strips) - strips)[side]) / strips[side]
    corners = points @ (1.0, 1.0j)
    start, chord, turn = corners[:-1][side], np.diff(corners)[side], turns[side]
    bent = turn != 0.0
    way = share.astype(complex)
    half = 0.5 * turn[bent]
    way[bent] = np.sin(share[bent] * half) / np.sin(half) * np.exp(1j * (share[bent] - 1.0) * half)
    ends = start + way * chord
    return np.vstack([np.column_stack([ends.real, ends.imag]), points[-1:]])


def _every_second(strips: int) -> NDArray[np.bool_]:
    """Return whether the first station of each strip (strips,) of a piece stays when strips are joined in pairs."""
    kept: NDArray[np.bool_] = np.arange(strips) % 2 == 0
    return kept


def _at_positions(positions: NDArray[np.float64]) -> NDArray[np.void]:
    stations = np.zeros(len(positions), STATION)
    stations["x"], stations["y"] = positions.T
    stations["kept"] = True
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
    stations = np.zeros(len(lengths) * strips + 1, STATION)
    stations["kind"] = CABLE
    for e, length in enumerate(lengths):
        element = slice(e * strips, (e + 1) * strips + 1)
        stations["first"][element] = 4 * e
        stations["shape"][element] = hermite(np.linspace(0.0, 1.0, strips + 1), length)
        stations["kept"][element] = [*_every_second(strips), True]
    return stations


def in_space(planar: NDArray[np.void]) -> NDArray[np.void]:
    """Stations in the plane z = 0 of a spatial body, from those of a planar body."""
    stations = planar.copy()
    stations["kind"] = SPATIAL
    return stations


@part
def stations(q, v, geometry, P, V):
    """Fill P (n, 2) m and V (n, 2) m/s from the coordinates q and rates v of the body; geometry (n,) records.

    Spatial bodies: see `spatial`.
    """
    if geometry[0].kind == CABLE:
        _cable_stations(q, v, geometry, P, V)
    else:
        _rigid_stations(q, v, geometry, P, V)


@part
def scatter(q, geometry, P, F, out):
    """Add the generalised forces J^T F of station forces F (n, 2) N to out (m,); spatial bodies: see `spatial`."""
    if geometry[0].kind == CABLE:
        _cable_scatter(geometry, F, out)
    else:
        _rigid_scatter(q, P, F, out)


@part
def spacing(geometry):
    """Distance of coordinates that have no generalised force in common; 0 if each coordinate changes all forces."""
    return 12 if geometry[0].kind == CABLE else 0  # a node has 4, which change forces up to its neighbours


@part
def _rigid_stations(q, v, geometry, P, V):
    c, s = np.cos(q[2]), np.sin(q[2])
    for i in range(geometry.shape[0]):
        rx = c * geometry[i].x - s * geometry[i].y
        ry = s * geometry[i].x + c * geometry[i].y
        P[i, 0] = q[0] + rx
        P[i, 1] = q[1] + ry
        V[i, 0] = v[0] - v[2] * ry
        V[i, 1] = v[1] + v[2] * rx


@part
def _rigid_scatter(q, P, F, out):
    for i in range(P.shape[0]):
        out[0] += F[i, 0]
        out[1] += F[i, 1]
        out[2] += (P[i, 0] - q[0]) * F[i, 1] - (P[i, 1] - q[1]) * F[i, 0]


@part
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


@part
def _cable_scatter(geometry, F, out):
    for i in range(F.shape[0]):
        if F[i, 0] == 0.0 and F[i, 1] == 0.0:
            continue
        first, shape = geometry[i].first, geometry[i].shape
        for k in range(4):
            out[first + 2 * k] += shape[k] * F[i, 0]
            out[first + 2 * k + 1] += shape[k] * F[i, 1]
