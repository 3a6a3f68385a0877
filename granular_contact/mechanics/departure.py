"""Solving for the correction: departure of the motion with other strips or facets from a known motion.

Let the known motion q, v have the forces Q of its own strips or facets. With the forces Q* of others the motion departs
by W x, with x in the degrees of freedom of the mechanism:

    M x'' = W^T [Q*(q + W x, v + W x') - Q(q, v)] - K x - D x' - r

M: mass matrix in the degrees of freedom; K, D: tangent stiffness and damping of joints and flexible links; r: forces by
which the known motion is not in equilibrium, 0 but for links in a few modes. Each of the
two loads has its own friction state: one follows the known motion, the other the departed one. Both take the same few
long steps, so what these steps miss of the motion cancels.

Method: backward Euler in a few long steps, first order, with a damped Newton's method. Cost: some ten evaluations of
the forces a step. Neglected: the change of W with x.

Source: R. D. Skeel, "Thirteen ways to estimate global error", Numer. Math. 48 (1986), 1-20: solving for the correction.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import reduce
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from granular_contact.mechanics.system import Trajectory
from granular_contact.sand.load import GranularLoad

Vector = NDArray[np.float64]
ITERATIONS = 10  # of Newton's method, at most
SHORTENED, SHARE = 4, 0.4  # greatest number of step lengths tried in an iteration, and ratio of each to the last
CLOSE = 1e-4  # tolerance over the mean speed of the fastest point
RENEW = 0.3  # ratio of two residuals above which the Jacobian is renewed
BLOCK = 2**29  # bytes


class Instant(NamedTuple):
    """A motion at an instant, with c coordinates of the load, m rates and d degrees of freedom.

    time (s); q (c,): coordinates of the load; v (m,): rates; W (m, d): Jacobian of v; mass (m, m): mass matrix, sparse
    or not; K, D (d, d): tangent stiffness and damping of joints and flexible links; missing (d,): forces by which the
    motion is not in equilibrium, as that of links in a few modes.
    """

    time: float
    q: Vector
    v: Vector
    W: Vector
    mass: Any
    K: Vector
    D: Vector
    missing: Vector | float = 0.0


class PlanarCoordinates:
    """Coordinates of a load in the plane; their rates are the rates of the motion."""

    def displaced(self, q: Vector, change: Vector) -> Vector:
        """Coordinates q (c,) plus a change (c,)."""
        return q + change

    def rates(self, q: Vector, v: Vector) -> Vector:
        """Rates (c,) of the coordinates for rates v (m,) of the motion; (c, d) for several of them, (m, d)."""
        del q
        return v

    def forces(self, load: GranularLoad, q: Vector, v: Vector) -> Vector:
        """Generalised forces (m,) for the rates of the motion."""
        return load.force(q, v, np.zeros_like(q))


def instants(observer: Any, count: int) -> NDArray[np.int64]:
    """Indices of instants from the touch to the end, spread evenly over time, path and changes of speed."""
    t = observer.trajectory
    first = max(0, int(np.argmax(t.load.depth > 0.0)) - 1)
    steps = np.diff(t.time[first:])
    path = steps * observer.speeds[first + 1 :]
    change = np.abs(np.diff(t.v[first:], axis=0) * observer.lever).max(axis=1)
    progress = sum(part / max(float(part.sum()), 1e-300) for part in (steps, path, change))
    sums = np.concatenate([[0.0], np.cumsum(progress)])
    rows = np.searchsorted(sums, np.linspace(0.0, sums[-1], count + 1)).clip(0, len(steps))
    return first + np.unique([0, *rows, len(steps)])


def pieces(observer: Any, trajectory: Trajectory, count: int) -> Iterator[Trajectory]:
    """Yield `count` instants of a trajectory in pieces whose W (m, d) together take at most `BLOCK` bytes."""
    rows, t = instants(observer, count), trajectory
    for part in np.array_split(rows, min(len(rows), 1 + len(rows) * 8 * observer.trajectory.v.shape[1] ** 2 // BLOCK)):
        yield at(t, part)


def at(t: Trajectory, rows: NDArray[np.int64]) -> Trajectory:
    """Some instants of a trajectory, without loads."""
    histories = (t.set_to, t.mode_residuals)
    set_to, residuals = ({joint: values[rows] for joint, values in each.items()} for each in histories)
    none: Any = {"load": None, "a": None, "multipliers": {}}
    return replace(t, time=t.time[rows], q=t.q[rows], v=t.v[rows], set_to=set_to, mode_residuals=residuals, **none)


def departures(
    observer: Any,
    motion: Iterator[Instant],
    own: GranularLoad,
    others: Sequence[GranularLoad],
    coordinates: PlanarCoordinates,
) -> Vector:
    """Greatest departures (k, m) with k other loads, by rate of the motion, over the path of the fastest point.

    own, others: loads on the motion's coordinates; their friction states are reset.
    """
    histories = (np.abs(departure) for departure in departed(observer, motion, own, others, coordinates))
    greatest = reduce(np.maximum, histories)
    return np.asarray(greatest * observer.lever / max(observer.path_length, observer.scene.least_path))


def departed(
    observer: Any,
    motion: Iterator[Instant],
    own: GranularLoad,
    others: Sequence[GranularLoad],
    coordinates: PlanarCoordinates,
) -> Iterator[Vector]:
    """Yield the departures (k, m) with k other loads at each instant, see `departures`."""
    t, lever = observer.trajectory, observer.lever
    tolerance = CLOSE * observer.path_length / (t.time[-1] - t.time[0])
    previous = next(motion)
    departure, departure_rate = np.zeros((2, len(others), len(previous.v)))
    yield departure.copy()
    for load in (own, *others):
        load.start(previous.q)
    for instant in motion:
        known, h = _KnownMotion(instant, own, coordinates), instant.time - previous.time
        for i, other in enumerate(others):
            if instant.W.shape[1] > 0:
                step = _Step(known, h, departure[i], departure_rate[i], other)
                departure[i], departure_rate[i] = step.solve(tolerance, lever)
            q = coordinates.displaced(instant.q, coordinates.rates(instant.q, departure[i]))
            other.accept(instant.time, q, coordinates.rates(q, instant.v + departure_rate[i]))
        own.accept(instant.time, instant.q, coordinates.rates(instant.q, instant.v))
        previous = instant
        yield departure.copy()


class _KnownMotion:
    """Terms of the equation at an instant that do not depend on the other load.

    momenta (m, d): mass matrix times W; M (d, d); W_q (c, d): Jacobian of the load's coordinates; force (m,): Q.
    """

    def __init__(self, instant: Instant, own: GranularLoad, coordinates: PlanarCoordinates) -> None:
        self.instant, self.coordinates = instant, coordinates
        self.momenta = instant.mass @ instant.W
        self.M = instant.W.T @ self.momenta
        self.W_q = coordinates.rates(instant.q, instant.W)
        self.force = coordinates.forces(own, instant.q, instant.v)


class _Step:
    """A step of h s of backward Euler to an instant, from the last departure (m,) and its rate."""

    def __init__(
        self, known: _KnownMotion, h: float, departure: Vector, departure_rate: Vector, other: GranularLoad
    ) -> None:
        self.known, self.instant, self.coordinates = known, known.instant, known.coordinates
        self.h, self.other = h, other
        self.masses = np.diag(known.M)
        momenta = known.momenta.T @ np.column_stack([departure, departure_rate])
        try:
            self.x, self.rate = np.linalg.solve(known.M, momenta).T
        except np.linalg.LinAlgError:  # a mass that vanishes by round-off beside the mass of what hangs on it
            self.x, self.rate = np.linalg.lstsq(known.M, momenta)[0].T
        self.inertial = known.M + h * (h * self.instant.K + self.instant.D)  # of residuals that are linear in the rate
        self.at_rest = known.M @ self.rate - h * (self.instant.K @ self.x + self.instant.missing)

    def residual(self, rate: Vector) -> tuple[Vector, float, Vector]:
        """Residual impulses (d,) at a rate x', the sum of squares over masses, and the load's coordinates (c,)."""
        W, x = self.instant.W, self.x + self.h * rate
        q = self.coordinates.displaced(self.instant.q, self.known.W_q @ x)
        force = self.coordinates.forces(self.other, q, self.instant.v + W @ rate)
        r: Vector = self.inertial @ rate - self.at_rest - self.h * (W.T @ (force - self.known.force))
        return r, float(r @ (r / self.masses)), q

    def jacobian(self, q: Vector, rate: Vector) -> Vector:
        """Jacobian (d, d) of the residual by the rate; only the few coordinates in the medium enter its force."""
        W = self.instant.W
        v, W_q = self.coordinates.rates(q, self.instant.v + W @ rate), self.coordinates.rates(q, W)
        triplets = self.other.tangent(q, v, self.h, 1.0)
        places = triplets[:, :2].T.astype(int)
        loaded = np.flatnonzero(np.bincount(places.ravel()))
        row, column = np.searchsorted(loaded, places)
        size = len(loaded)
        tangent = np.bincount(size * row + column, triplets[:, 2], size * size).reshape(size, size)
        medium = W_q[loaded].T @ (tangent @ W_q[loaded])
        return np.asarray(self.inertial - self.h * medium)

    def solve(self, tolerance: float, lever: Vector) -> tuple[Vector, Vector]:
        """Departure (m,) and its rate at the end of the step, by a damped modified Newton's method.

        tolerance (m/s): change of the speed of any point in the last iteration; lever (m,): factors from rates to
        speeds.
        """
        # Where a step is too long to be solved, a rate that is kept would carry the departure away without bound.
        starts = [(self.residual(rate), rate) for rate in (self.rate, np.zeros_like(self.rate))]
        (r, square, q), rate = min(starts, key=lambda start: start[0][1])
        is_old = False  # whether the Jacobian is that of an earlier iteration
        for _ in range(ITERATIONS):
            if not is_old:
                jacobian = self.jacobian(q, rate)
            try:
                change = -np.linalg.solve(jacobian, r)
            except np.linalg.LinAlgError:
                break
            share = 1.0
            for _ in range(SHORTENED):
                trial = self.residual(rate + share * change)
                if trial[1] < square:
                    break
                share *= SHARE
            else:
                if not is_old:
                    break
                is_old = False
                continue
            rate, is_old = rate + share * change, share == 1.0 and trial[1] < RENEW**2 * square
            r, square, q = trial
            if float(np.abs(lever * (self.instant.W @ change)).max()) * share <= tolerance:
                break
        return self.instant.W @ (self.x + self.h * rate), self.instant.W @ rate
