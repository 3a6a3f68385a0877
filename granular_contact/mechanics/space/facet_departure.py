"""What a motion in space departs by with larger facets, and the error that this stands for.

The twin of `mechanics.strip_departure`, by the same equation (see `sand.kernels.departure`): with the forces Q of its
own facets along a motion, and Q* of larger ones, the departure W x has

    M x'' = W^T [Q*(q + W x, v + W x') - Q(q, v)] - K x - D x'.

Rates are those of `SpatialKinematics`, six of each body; W spans what the joints leave of them. Backward Euler in a
few long steps and Newton's method with a line search, in plain numpy: what takes time are the forces. An error goes
with the square of facets, and so with one over their number: of N facets and N* others it is |N* / (N* - N)| of what
the motion departs by. Where there are hardly larger ones, on a mesh with triangles of its own, smaller ones are taken.
Of a run that was repeated with smaller facets the error follows from both, see `estimate_of_two`.

Left out: how W changes with x, inertial forces of the departure beside M x'', and how springs turn with their bodies.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from granular_contact.mechanics.constraints import together
from granular_contact.mechanics.freedoms import left_by, slopes
from granular_contact.mechanics.space.kinematics import SpatialKinematics
from granular_contact.mechanics.strip_departure import instants
from granular_contact.sand.contact_lines import Body
from granular_contact.sand.space.load import SpatialLoad
from granular_contact.sand.space.of_scene import add_part, load_of
from granular_contact.scene.space.types import Vector

GLANCE, LOOK = 16, 96  # instants of the motion at which its departure is followed
COARSER = np.sqrt(2.0)  # edges of the other facets over those of the motion's
FEWER = 0.8  # of the number of facets: with more of them left smaller ones are taken
ITERATIONS, SHORTENED, SHARE, CLOSE, RENEW = 10, 4, 0.4, 1e-4, 0.3  # as of `sand.kernels.departure`


class _Motion(NamedTuple):
    """A motion at n instants with d freedoms.

    time (n,) s; q (n, 7 b): places and Euler parameters of the b bodies; v (n, 6 b); W (n, 6 b, d), A (n, d, 6 b): of
    any rates the freedoms that have their momentum; M, K, D (n, d, d).
    """

    time: Vector
    q: Vector
    v: Vector
    W: Vector
    A: Vector
    M: Vector
    K: Vector
    D: Vector


def estimate(observer: Any, doubtful: float) -> float:
    """Estimated error of positions, as a part of the distance that the fastest point travels.

    A glance at few instants, and where that finds more than what is doubtful a look at more of them. Of links that bend
    there is no estimate: their springs would be needed.
    """
    if observer.scene.bends:
        return 0.0
    own, other = _load(observer, 1.0), _load(observer, COARSER)
    if _number(other) > FEWER * _number(own):
        other = _load(observer, 1.0 / COARSER)
    if _number(other) == _number(own):  # there are none: bars and balls alone
        return 0.0
    of_departure = abs(_number(other) / (_number(other) - _number(own)))
    error = of_departure * _departure(observer, own, other, GLANCE)
    if error > doubtful:
        error = max(error, of_departure * _departure(observer, own, other, LOOK))
    return error


class Track(NamedTuple):
    """Where points of all bodies were: time (n,) s, places (n, 12 b) m; share: of the size of facets that was taken."""

    time: Vector
    places: Vector
    share: float


def track(observer: Any) -> Track:
    """The way of the middle of each body, and of the ends of its axes as far out as it reaches."""
    scene, columns = observer.scene, []
    for body in (handle.body for handle in observer.system.rigid.values()):
        columns += [observer.center(body.name)[0], scene.radius(body) * observer.rotation(body.name).reshape(-1, 9)]
    return Track(observer.trajectory.time, np.column_stack(columns), scene.facet_share)


def estimate_of_two(before: Track, observer: Any) -> float:
    """As `estimate`, from a run with larger facets: Richardson's extrapolation of what the two differ by.

    An error e of second order, of facets with edges of the share s, was e / s^2 times as large before, so the runs
    differ by e (1 / s^2 - 1). What else they differ by, the errors of their steps, counts as well.
    """
    now = track(observer)
    square = (now.share / before.share) ** 2
    at = now.time[now.time <= before.time[-1]]
    places = np.column_stack([np.interp(at, before.time, column) for column in before.places.T])
    apart = float(np.abs(places - now.places[: len(at)]).max()) * square / (1.0 - square)
    return apart / float(max(observer.path_length, observer.scene.least_path))


def _number(load: SpatialLoad) -> int:
    """Number of facets of a load."""
    return sum(len(one.rows) for one in load.lines)


def _load(observer: SpatialKinematics, share: float) -> SpatialLoad:
    """The load of a scene on bodies whose seven coordinates follow one another, without what scatters."""
    scene: Any = observer.scene
    load = load_of(scene)
    for i, handle in enumerate(observer.system.rigid.values()):
        on = Body(handle.body.name, range(7 * i, 7 * i + 7))
        for part in (part for part in handle.body.parts if part.in_sand):
            add_part(load, on, part, scene, handle.body.mass, share)
    load.close()
    for batch in load.batches:
        batch.clusters["scatter"] = 0.0
    return load


def _departure(observer: SpatialKinematics, own: SpatialLoad, other: SpatialLoad, count: int) -> float:
    """Greatest departure of any point with another load, as a part of the distance that the fastest one travels."""
    motion = _motion(observer, instants(observer, count))
    if motion.W.shape[2] == 0:
        return 0.0
    t = observer.trajectory
    speed = observer.path_length / (t.time[-1] - t.time[0])
    off = np.abs(_depart(motion, own, other, speed, observer.lever)) * observer.lever
    return float(off.max()) / max(observer.path_length, observer.scene.least_path)


def _motion(observer: SpatialKinematics, at: Any) -> _Motion:
    """The motion at some of its instants, with its freedoms there."""
    t = observer.engine
    part = replace(t, time=t.time[at], q=t.q[at], v=t.v[at], load=None, a=None, multipliers={}, set_to={})
    seen = SpatialKinematics(observer.system, part)
    (n, m), scene = seen.trajectory.v.shape, seen.scene
    joints: Any = scene.joints
    moved = {drive.joint for drive in scene.drives if drive.kind == "motion"}
    rows = [seen.constraints.held(joint) for joint in joints]
    rows += [seen.constraints.moved(joint) for joint in joints if joint.name in moved]
    held = together(rows).J if rows else np.zeros((n, 0, m))
    W = left_by(held) if held.shape[1] else np.broadcast_to(np.eye(m), (n, m, m))
    K, D = np.zeros((n, m, m)), np.zeros((n, m, m))
    for joint in joints:
        if joint.name in moved or not (joint.has_coordinate or joint.is_sprung):
            continue
        J = seen.constraints.coordinates(joint).J
        stiffness, damping = slopes(seen, joint, scene.drive(joint.name))
        K += stiffness[:, None, None] * (J.transpose(0, 2, 1) @ J)
        D += damping[:, None, None] * (J.transpose(0, 2, 1) @ J)
    turned = W.transpose(0, 2, 1)
    momenta = turned @ seen.trajectory.mass
    M = momenta @ W
    A = np.linalg.solve(M, momenta) if M.shape[1] else momenta
    places = [part for name in seen.system.rigid for part in (seen.center(name)[0], seen.quaternion(name))]
    q = np.concatenate(places, axis=1)
    return _Motion(t.time[at], q, seen.trajectory.v, W, A, M, turned @ K @ W, turned @ D @ W)


def _depart(motion: _Motion, own: SpatialLoad, other: SpatialLoad, speed: float, lever: Vector) -> Vector:
    """Departure (n, 6 b) of all bodies at the instants of a motion; speed (m/s): of the motion."""
    time, W, A = motion.time, motion.W, motion.A
    out, last = np.zeros(motion.v.shape), np.zeros(motion.v.shape[1])
    for load in (own, other):
        load.start(motion.q[0])
    for i in range(1, len(time)):
        step = _Step(motion, i, A[i] @ out[i - 1], A[i] @ last, _forces(own, motion.q[i], motion.v[i])[0], other)
        x, rate = step.end(CLOSE * speed, lever)
        out[i], last = W[i] @ x, W[i] @ rate
        own.accept(time[i], motion.q[i], _rates(motion.q[i], motion.v[i]))
        there = _moved(motion.q[i], out[i])
        other.accept(time[i], there, _rates(there, motion.v[i] + last))
    return out


class _Step:
    """A step of backward Euler that ends at an instant i, from x and x' before it."""

    def __init__(self, motion: _Motion, i: int, x: Vector, rate: Vector, own: Vector, other: SpatialLoad) -> None:
        self.q, self.v, self.W, self.M, self.K, self.D = (
            getattr(motion, name)[i] for name in ("q", "v", "W", "M", "K", "D")
        )
        self.h, self.x, self.rate, self.own, self.other = motion.time[i] - motion.time[i - 1], x, rate, own, other

    def missing(self, rate: Vector) -> tuple[Vector, float, Vector]:
        """Impulses (d,) that are missing at a rate, their square over the masses, and where that is."""
        x = self.x + self.h * rate
        there = _moved(self.q, self.W @ x)
        force, _ = _forces(self.other, there, self.v + self.W @ rate)
        left: Vector = self.M @ (rate - self.rate) + self.h * (self.K @ x + self.D @ rate)
        left -= self.h * (self.W.T @ (force - self.own))
        return left, float(np.sum(left**2 / np.diag(self.M))), there

    def matrix(self, there: Vector, rate: Vector) -> Vector:
        """Derivative (d, d) of the missing impulses by the rate."""
        S = self.M + self.h * (self.h * self.K + self.D)
        T = _turns(there)
        rates = np.einsum("bij,bj->bi", T, (self.v + self.W @ rate).reshape(-1, 6)).ravel()
        TW = np.einsum("bij,bjd->bid", T, self.W.reshape(len(T), 6, -1)).reshape(7 * len(T), -1)
        found, slopes_there = self.other.tangent(there, rates, self.h, 1.0), np.zeros((len(there), len(there)))
        np.add.at(slopes_there, (found[:, 0].astype(int), found[:, 1].astype(int)), found[:, 2])
        return np.asarray(S - self.h * (TW.T @ slopes_there @ TW))

    def end(self, close: float, lever: Vector) -> tuple[Vector, Vector]:
        """X and x' at the end: Newton's method, to a change of speed (m/s) of any point."""
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


# ---- between the rates of bodies and the coordinates of a load ----


_ENTRIES = np.array([[1, 2, 3], [0, 3, 2], [3, 0, 1], [2, 1, 0]])  # of e in the matrix of e (0, w) / 2
_SIGNS = 0.5 * np.array([[-1, -1, -1], [1, -1, 1], [1, 1, -1], [-1, 1, 1]])


def _turns(q: Vector) -> Vector:
    """Rates of places and Euler parameters by those of bodies (b, 7, 6): e' = e (0, w) / 2."""
    e = q.reshape(-1, 7)[:, 3:]
    T = np.zeros((len(e), 7, 6))
    T[:, [0, 1, 2], [0, 1, 2]] = 1.0
    T[:, 3:, 3:] = _SIGNS * e[:, _ENTRIES]
    return T


def _rates(q: Vector, v: Vector) -> Vector:
    return np.asarray(np.einsum("bij,bj->bi", _turns(q), v.reshape(-1, 6)).ravel())


def _moved(q: Vector, off: Vector) -> Vector:
    """Coordinates of bodies that have moved and turned by off (6 b,)."""
    there = (q + _rates(q, off)).reshape(-1, 7)
    there[:, 3:] /= np.linalg.norm(there[:, 3:], axis=1, keepdims=True)
    return there.ravel()


def _forces(load: SpatialLoad, q: Vector, v: Vector) -> tuple[Vector, Vector]:
    """Forces (6 b,) that belong to the rates of bodies, and these in the coordinates of the load."""
    rates = _rates(q, v)
    found = load.force(q, rates, np.zeros_like(q))
    return np.asarray(np.einsum("bij,bi->bj", _turns(q), found.reshape(-1, 7)).ravel()), rates
