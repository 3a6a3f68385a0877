"""How far a motion with other strips or facets departs from one that is known: solving for the correction.

Of a motion q, v with the forces Q of its own elements, and the forces Q* of others, the departure W x of all bodies,
x in the freedoms of the mechanism, has

    M x'' = W^T [Q*(q + W x, v + W x') - Q(q, v)] - K x - D x'

with the mass matrix M, and K and D of what acts in joints and bends links. Both media keep friction states of their
own, led along the motion and along what departs from it. What long steps leave out of the motion is the same in both,
so it cancels.
Backward Euler in a few long steps, first order in the step, with Newton's method, of which a step is shortened where it
leads farther away; some ten evaluations of the forces a step, which take the time. Left out: how W changes with x.

Source: R. D. Skeel, "Thirteen ways to estimate global error", Numer. Math. 48 (1986), 1-20: solving for the correction.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from granular_contact.mechanics.system import Trajectory
from granular_contact.sand.load import GranularLoad

Vector = NDArray[np.float64]
ITERATIONS, SHORTENED, SHARE = 10, 4, 0.4  # most of them; most shares of a step, each so much of the one before
CLOSE, RENEW = 1e-4, 0.3  # part of the motion's speed; what of the residual (its root) may be left by an old matrix
BLOCK = 2**29  # bytes


class Instant(NamedTuple):
    """A motion at an instant, of c coordinates of the load and m rates with d freedoms.

    time (s); q (c,); v (m,); W (m, d): rates by those of the freedoms; mass (m, m), sparse or not; K, D (d, d):
    stiffness and damping of joints, and of links that bend.
    """

    time: float
    q: Vector
    v: Vector
    W: Vector
    mass: Any
    K: Vector
    D: Vector


class Flat:
    """Coordinates of a load whose rates are those of the motion: of bodies in the plane."""

    def moved(self, q: Vector, by: Vector) -> Vector:
        """Coordinates (c,) that have changed by so much (c,)."""
        return q + by

    def rates(self, q: Vector, v: Vector) -> Vector:
        """Rates of the coordinates (c,) by those of the motion (m,); of several motions (m, d) in columns (c, d)."""
        del q
        return v

    def forces(self, load: GranularLoad, q: Vector, v: Vector) -> Vector:
        """Forces (m,) that belong to the rates of the motion."""
        return load.force(q, v, np.zeros_like(q))


def instants(observer: Any, count: int) -> NDArray[np.int64]:
    """Indices from the touch to the end, so that little passes in between: of the time, the way, changes of speed."""
    t = observer.trajectory
    first = max(0, int(np.argmax(t.load.depth > 0.0)) - 1)
    steps = np.diff(t.time[first:])
    way = steps * observer.speeds[first + 1 :]
    change = np.abs(np.diff(t.v[first:], axis=0) * observer.lever).max(axis=1)
    passed = sum(part / max(float(part.sum()), 1e-300) for part in (steps, way, change))
    sums = np.concatenate([[0.0], np.cumsum(passed)])
    at = np.searchsorted(sums, np.linspace(0.0, sums[-1], count + 1)).clip(0, len(steps))
    return first + np.unique([0, *at, len(steps)])


def pieces(observer: Any, trajectory: Trajectory, count: int) -> Iterator[Trajectory]:
    """So many instants of the trajectory of a load, in pieces of which all W (m, d), d <= m, take `BLOCK` bytes."""
    at, t = instants(observer, count), trajectory
    for some in np.array_split(at, min(len(at), 1 + len(at) * 8 * observer.trajectory.v.shape[1] ** 2 // BLOCK)):
        yield replace(t, time=t.time[some], q=t.q[some], v=t.v[some], load=None, a=None, multipliers={}, set_to={})


def departures(
    observer: Any, motion: Iterator[Instant], own: GranularLoad, others: Sequence[GranularLoad], chart: Flat
) -> Vector:
    """Greatest departures (k, m) of points with k other loads by rate, as parts of the distance that the fastest
    travels.

    own, others: loads on the motion's coordinates, which begin anew.
    """
    t, lever = observer.trajectory, observer.lever
    close = CLOSE * observer.path_length / (t.time[-1] - t.time[0])
    before = next(motion)
    off, last, most = np.zeros((3, len(others), len(before.v)))
    for load in (own, *others):
        load.start(before.q)
    for now in motion:
        at = _Known(now, own, chart)
        for i, other in enumerate(others):
            if now.W.shape[1] > 0:
                off[i], last[i] = _Step(at, now.time - before.time, off[i], last[i], other).end(close, lever)
            there = chart.moved(now.q, chart.rates(now.q, off[i]))
            other.accept(now.time, there, chart.rates(there, now.v + last[i]))
        own.accept(now.time, now.q, chart.rates(now.q, now.v))
        before, most = now, np.maximum(most, np.abs(off))
    return np.asarray(most * lever / max(observer.path_length, observer.scene.least_path))


class _Known:
    """What is known at an instant before another load is: M (d, d), momenta (m, d) by the rates of freedoms, rates
    (c, d) of the load's coordinates by them, and the forces (m,) of the motion's own load.
    """

    def __init__(self, now: Instant, own: GranularLoad, chart: Flat) -> None:
        self.now, self.chart = now, chart
        self.momenta = now.mass @ now.W
        self.M = now.W.T @ self.momenta
        self.by = chart.rates(now.q, now.W)
        self.force = chart.forces(own, now.q, now.v)


class _Step:
    """A step of h s of backward Euler to an instant, from the departure off (m,) before it and its rates."""

    def __init__(self, at: _Known, h: float, off: Vector, rates: Vector, other: GranularLoad) -> None:
        self.at, self.now, self.chart, self.h, self.other = at, at.now, at.chart, h, other
        self.M, self.masses = at.M, np.diag(at.M)
        momenta = at.momenta.T @ np.column_stack([off, rates])
        try:
            self.x, self.rate = np.linalg.solve(at.M, momenta).T
        except np.linalg.LinAlgError:  # round-off leaves nothing of a mass beside that of what hangs on it
            self.x, self.rate = np.linalg.lstsq(at.M, momenta)[0].T

    def missing(self, rate: Vector) -> tuple[Vector, float, Vector]:
        """Impulses (d,) that are missing at a rate, their square over the masses, and where that is."""
        W, x = self.now.W, self.x + self.h * rate
        there = self.chart.moved(self.now.q, self.at.by @ x)
        force = self.chart.forces(self.other, there, self.now.v + W @ rate)
        left: Vector = self.M @ (rate - self.rate) + self.h * (self.now.K @ x + self.now.D @ rate)
        left -= self.h * (W.T @ (force - self.at.force))
        return left, float(np.sum(left**2 / self.masses)), there

    def matrix(self, there: Vector, rate: Vector) -> Vector:
        """Derivative (d, d) of the missing impulses by the rate; few coordinates are in the sand."""
        W = self.now.W
        rates, by = self.chart.rates(there, self.now.v + W @ rate), self.chart.rates(there, W)
        entries = self.other.tangent(there, rates, self.h, 1.0)
        places = entries[:, :2].T.astype(int)
        loaded = np.flatnonzero(np.bincount(places.ravel()))
        row, column = np.searchsorted(loaded, places)
        size = len(loaded)
        slopes = np.bincount(size * row + column, entries[:, 2], size * size).reshape(size, size)
        of_sand = by[loaded].T @ (slopes @ by[loaded])
        return np.asarray(self.M + self.h * (self.h * self.now.K + self.now.D - of_sand))

    def end(self, close: float, lever: Vector) -> tuple[Vector, Vector]:
        """Departure (m,) and its rates at the end: Newton's method, to a change of speed (m/s) of any point.

        lever (m,): distance by rate.
        """
        rate, old = self.rate.copy(), False
        left, size, there = self.missing(rate)
        for _ in range(ITERATIONS):
            if not old:
                matrix = self.matrix(there, rate)
            try:
                change = -np.linalg.solve(matrix, left)
            except np.linalg.LinAlgError:
                break
            share = 1.0
            for _ in range(SHORTENED):
                now = self.missing(rate + share * change)
                if now[1] < size:
                    break
                share *= SHARE
            else:
                if not old:
                    break
                old = False
                continue
            rate, old = rate + share * change, share == 1.0 and now[1] < RENEW**2 * size
            left, size, there = now
            if float(np.abs(lever * (self.now.W @ change)).max()) * share <= close:
                break
        return self.now.W @ (self.x + self.h * rate), self.now.W @ rate
