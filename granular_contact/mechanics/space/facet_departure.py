"""What a motion in space departs by with larger facets, and the error that this stands for.

As `strip_departure` in the plane, by `mechanics.departure`, with the facets of `sand.space.other_facets` on the bodies
that touch. Rates are those of `SpatialKinematics`, six of each body; W spans what the joints leave of them. Of a run
that was repeated with smaller facets both runs bound the error, see `bounds_of_two`.

Left out: how W changes with x, inertial forces of the departure beside M x'', and how springs turn with their bodies.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from granular_contact.mechanics.constraints import together
from granular_contact.mechanics.departure import Flat, Motion, greatest, instants
from granular_contact.mechanics.freedoms import left_by, slopes
from granular_contact.mechanics.space.kinematics import SpatialKinematics
from granular_contact.mechanics.space.system import SpatialSystem
from granular_contact.sand.contact_lines import Body
from granular_contact.sand.load import GranularLoad
from granular_contact.sand.space.load import SpatialLoad
from granular_contact.sand.space.of_scene import add_part, load_of
from granular_contact.sand.space.other_facets import differing, numbers, others
from granular_contact.scene.space.types import Vector

GLANCE, LOOK = 16, 96  # instants of the motion at which its departure is followed
ORDERS = 2.0, 1.5  # of the error of facets [measured: 1.0 to 2.3 where facets are few, 2 where they are many]


def estimate(observer: Any, doubtful: float) -> float:
    """Estimated error of positions, as a part of the distance that the fastest point travels.

    A glance at few instants, and where that finds more than what is doubtful a look at more of them. Of links that bend
    there is no estimate: their springs would be needed.
    """
    if observer.scene.bends:
        return 0.0
    own = observer.system.facets
    other = others(own, partial(load_with, observer.system), _touching(observer))
    if other is None:  # there are none: bars and balls alone
        return 0.0
    error = 0.0
    for count in (GLANCE, LOOK):
        motion = _motion(observer, instants(observer, count))
        error = max(error, other.part * greatest(observer, motion, own, other.load, Poses()))
        if not error > doubtful:
            break
    return error


class Track(NamedTuple):
    """Where points of all bodies were: time (n,) s, places (n, 12 b) m; share: of the size of facets;
    numbers: of facets, of bodies that touch.
    """

    time: Vector
    places: Vector
    share: float
    numbers: dict[str, int]


def track(observer: Any) -> Track:
    """The way of the middle of each body, and of the ends of its axes as far out as it reaches."""
    scene, columns = observer.scene, []
    for body in (handle.body for handle in observer.system.rigid.values()):
        columns += [observer.center(body.name)[0], scene.radius(body) * observer.rotation(body.name).reshape(-1, 9)]
    counted = numbers(observer.system.facets, _touching(observer))
    return Track(observer.trajectory.time, np.column_stack(columns), scene.facet_share, counted)


def bounds_of_two(before: Track, observer: Any) -> tuple[float, float]:
    """Bounds for the error, as of `estimate`, by a run with larger facets: Richardson's extrapolation.

    An error e of order k, of facets with edges of the share s of those before, was e / s^k times as large before, so
    the runs differ by e (1 / s^k - 1). The bounds are those of `ORDERS`: errors of few facets, and of facets that come
    to lead or to trail, do not go down as smoothly as those of many. What else the runs differ by, the errors of their
    steps, counts as well. Where there are hardly more facets than before, two runs tell nothing.
    """
    now = track(observer)
    shared = {name: n for name, n in before.numbers.items() if name in now.numbers}
    if len(differing(shared, now.numbers)) < len(shared):
        return 0.0, math.inf
    at = now.time[now.time <= before.time[-1]]
    places = np.column_stack([np.interp(at, before.time, column) for column in before.places.T])
    apart = float(np.abs(places - now.places[: len(at)]).max())
    apart /= float(max(observer.path_length, observer.scene.least_path))
    least, most = (apart / ((before.share / now.share) ** order - 1.0) for order in ORDERS)
    return least, most


def _touching(observer: SpatialKinematics) -> set[str]:
    """Bodies that touch the medium."""
    history: Any = observer.trajectory.load
    return {name for i, name in enumerate(history.body_names) if history.bodies[:, i].any()}


def load_with(system: SpatialSystem, share: float) -> SpatialLoad:
    """The load of a scene with a share of its size of facets, without what scatters.

    Its bodies have seven coordinates, one body after another.
    """
    scene = system.scene
    load = load_of(scene)
    for i, handle in enumerate(system.rigid.values()):
        on = Body(handle.body.name, range(7 * i, 7 * i + 7))
        for part in (part for part in handle.body.parts if part.in_sand):
            add_part(load, on, part, scene, handle.body.mass, share)
    load.close()
    for batch in load.batches:
        batch.clusters["scatter"] = 0.0
    return load


def _motion(observer: SpatialKinematics, at: Any) -> Motion:
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
    return Motion(t.time[at], q, seen.trajectory.v, W, A, M, turned @ K @ W, turned @ D @ W)


_ENTRIES = np.array([[1, 2, 3], [0, 3, 2], [3, 0, 1], [2, 1, 0]])  # of e in the matrix of e (0, w) / 2
_SIGNS = 0.5 * np.array([[-1, -1, -1], [1, -1, 1], [1, 1, -1], [-1, 1, 1]])


class Poses(Flat):
    """Places and Euler parameters of bodies, seven coordinates each, whose rates are six: as of `SpatialKinematics`."""

    def moved(self, q: Vector, off: Vector) -> Vector:
        """As of `Flat`."""
        there = (q + self.rates(q, off)).reshape(-1, 7)
        there[:, 3:] /= np.linalg.norm(there[:, 3:], axis=1, keepdims=True)
        return there.ravel()

    def rates(self, q: Vector, v: Vector) -> Vector:
        """As of `Flat`."""
        return _by_turns(_turns(q), v)

    def forces(self, load: GranularLoad, q: Vector, v: Vector) -> Vector:
        """As of `Flat`."""
        turns = _turns(q)
        found = load.force(q, _by_turns(turns, v), np.zeros_like(q)).reshape(-1, 1, 7)
        return np.asarray((found @ turns).ravel())


def _by_turns(turns: Vector, v: Vector) -> Vector:
    """Rates (7 b, ...) of coordinates by those of bodies (6 b, ...)."""
    return np.asarray((turns @ v.reshape(len(turns), 6, -1)).reshape(7 * len(turns), *v.shape[1:]))


def _turns(q: Vector) -> Vector:
    """Rates of places and Euler parameters by those of bodies (b, 7, 6): e' = e (0, w) / 2."""
    e = q.reshape(-1, 7)[:, 3:]
    T = np.zeros((len(e), 7, 6))
    T[:, [0, 1, 2], [0, 1, 2]] = 1.0
    T[:, 3:, 3:] = _SIGNS * e[:, _ENTRIES]
    return T
