"""How far a motion with other strips or facets departs from one that is known: solving for the correction.

Of a motion q, v with the forces Q of its own elements, and the forces Q* of others, the departure W x of all bodies,
x in the freedoms of the mechanism, has

    M x'' = W^T [Q*(q + W x, v + W x') - Q(q, v)] - K x - D x'

with the mass matrix M, and K and D of what acts in joints. Both media keep friction states of their own, led along the
motion and along what departs from it. What long steps leave out of the motion is the same in both, so it cancels.
Backward Euler in a few long steps, first order in the step, with Newton's method, of which a step is shortened where it
leads farther away; some ten evaluations of the forces a step, which take the time. Left out: how W changes with x.

Source: R. D. Skeel, "Thirteen ways to estimate global error", Numer. Math. 48 (1986), 1-20: solving for the correction.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from granular_contact.sand.load import GranularLoad

Vector = NDArray[np.float64]
ITERATIONS, SHORTENED, SHARE = 10, 4, 0.4  # most of them; most shares of a step, each so much of the one before
CLOSE, RENEW = 1e-4, 0.3  # part of the motion's speed; what of the residual (its root) may be left by an old matrix


class Motion(NamedTuple):
    """A motion at n instants, of m rates with d freedoms.

    time (n,) s; q (n, c): coordinates of the load; v (n, m); W (n, m, d): rates by those of the freedoms; A (n, d, m):
    of any rates the freedoms that have their momentum; M, K, D (n, d, d): mass, stiffness and damping of joints.
    """

    time: Vector
    q: Vector
    v: Vector
    W: Vector
    A: Vector
    M: Vector
    K: Vector
    D: Vector


class Flat:
    """Coordinates of a load whose rates are those of the motion: of bodies in the plane."""

    def moved(self, q: Vector, off: Vector) -> Vector:
        """Coordinates (c,) of what has departed by off (m,)."""
        return q + off

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
    way, change = (
        steps * observer.speeds[first + 1 :],
        np.abs(np.diff(t.v[first:], axis=0) * observer.lever).max(axis=1),
    )
    passed = sum(part / max(float(part.sum()), 1e-300) for part in (steps, way, change))
    sums = np.concatenate([[0.0], np.cumsum(passed)])
    at = np.searchsorted(sums, np.linspace(0.0, sums[-1], count + 1)).clip(0, len(steps))
    return first + np.unique([0, *at, len(steps)])


def departures(observer: Any, motion: Motion, own: GranularLoad, other: GranularLoad, chart: Flat) -> Vector:
    """Greatest departures (m,) of points with another load by rate, as parts of the distance that the fastest travels.

    own, other: loads on the motion's coordinates, which begin anew.
    """
    if motion.W.shape[2] == 0:
        return np.zeros(motion.v.shape[1])
    t = observer.trajectory
    speed = observer.path_length / (t.time[-1] - t.time[0])
    off = np.abs(_depart(motion, own, other, chart, CLOSE * speed, observer.lever)) * observer.lever
    return np.asarray(off.max(axis=0) / max(observer.path_length, observer.scene.least_path))


def _depart(motion: Motion, own: GranularLoad, other: GranularLoad, chart: Flat, close: float, lever: Vector) -> Vector:
    """Departure (n, m) of all bodies at the instants of a motion; close (m/s), lever (m,): as of `_Step.end`."""
    time, W, A = motion.time, motion.W, motion.A
    out, last = np.zeros(motion.v.shape), np.zeros(motion.v.shape[1])
    for load in (own, other):
        load.start(motion.q[0])
    for i in range(1, len(time)):
        q, v = (np.ascontiguousarray(one[i]) for one in (motion.q, motion.v))
        step = _Step(motion, i, A[i] @ out[i - 1], A[i] @ last, chart.forces(own, q, v), other, chart)
        x, rate = step.end(close, lever)
        out[i], last = W[i] @ x, W[i] @ rate
        own.accept(time[i], q, chart.rates(q, v))
        there = chart.moved(q, out[i])
        other.accept(time[i], there, chart.rates(there, v + last))
    return out


class _Step:
    """A step of backward Euler that ends at an instant i, from x and x' before it; own: forces (m,) of the motion's."""

    def __init__(
        self, motion: Motion, i: int, x: Vector, rate: Vector, own: Vector, other: GranularLoad, chart: Flat
    ) -> None:
        self.q, self.v, self.W, self.M = motion.q[i], motion.v[i], motion.W[i], motion.M[i]
        self.K, self.D, self.h = motion.K[i], motion.D[i], motion.time[i] - motion.time[i - 1]
        self.x, self.rate, self.own, self.other, self.chart = x, rate, own, other, chart

    def missing(self, rate: Vector) -> tuple[Vector, float, Vector]:
        """Impulses (d,) that are missing at a rate, their square over the masses, and where that is."""
        x = self.x + self.h * rate
        there = self.chart.moved(self.q, self.W @ x)
        force = self.chart.forces(self.other, there, self.v + self.W @ rate)
        left: Vector = self.M @ (rate - self.rate) + self.h * (self.K @ x + self.D @ rate)
        left -= self.h * (self.W.T @ (force - self.own))
        return left, float(np.sum(left**2 / np.diag(self.M))), there

    def matrix(self, there: Vector, rate: Vector) -> Vector:
        """Derivative (d, d) of the missing impulses by the rate."""
        rates, by = self.chart.rates(there, self.v + self.W @ rate), self.chart.rates(there, self.W)
        found, slopes = self.other.tangent(there, rates, self.h, 1.0), np.zeros((len(there), len(there)))
        np.add.at(slopes, (found[:, 0].astype(int), found[:, 1].astype(int)), found[:, 2])
        return np.asarray(self.M + self.h * (self.h * self.K + self.D - by.T @ slopes @ by))

    def end(self, close: float, lever: Vector) -> tuple[Vector, Vector]:
        """X and x' at the end: Newton's method, to a change of speed (m/s) of any point, lever (m,) of each rate."""
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
            if float(np.abs(lever * (self.W @ change)).max()) * share <= close:
                break
        return self.x + self.h * rate, rate
