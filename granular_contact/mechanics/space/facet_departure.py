"""Discretisation error of a motion in space by its facets: Richardson extrapolation of a departure, or of two runs.

As `strip_departure` in the plane, by `mechanics.departure`, with other facets on the bodies that touch
(`sand.space.facet_comparison`). Rates are those of `SpatialKinematics`, six for each body; W spans the null space of
the joints' constraints. If a run was repeated with smaller facets, the error follows from both runs
(`errors_from_two_runs`).

Neglected: the change of W with x, inertial forces of the departure other than M x'', and the rotation of springs with
their bodies. Neighbouring elements of a link with many elements move as one rigid body.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from granular_contact.mechanics.departure import Instant, PlanarCoordinates, departures, pieces
from granular_contact.mechanics.space.freedoms import freedoms
from granular_contact.mechanics.space.kinematics import SpatialKinematics
from granular_contact.mechanics.space.system import SpatialSystem
from granular_contact.sand.contact_lines import Body
from granular_contact.sand.load import GranularLoad
from granular_contact.sand.space.facet_comparison import (
    SHARES,
    FacetComparison,
    changed_bodies,
    comparison_with_others,
    facet_counts,
    richardson_factor,
)
from granular_contact.sand.space.from_scene import add_part, load_from_scene
from granular_contact.sand.space.load import SpatialLoad
from granular_contact.scene.space.types import Vector

# Number of instants of the first estimate: at least, and for a single touching body. Its impact may last only a few of
# them: with 24 instants one error was estimated as 0.5 % in place of 3.4 %, and that of a falling flexible strip as 11
# times its value. Later estimates use twice and four times as many.
INSTANTS, ALONE = 24, 96
# Instants of a long run in the time (length / gravity)^1/2, in which what stands falls over: with 24 in all the
# estimate for a walker of 0.2 m was 40 times its error after 16 s.
PER_FALL = 1.5
GLANCE = 2.0  # edges of the other facets in the first estimate, over the load's own
AGREE = 1.5  # ratio of two successive estimates up to which they agree
# Order of the error of a motion in the edge of facets. With many loaded facets it is that of forces, 2 [measured: 1.0
# to 2.3 with few loaded facets, or facets that change between leading and trailing, as under a rolling ball].
ORDER = 1.5
Missing = Callable[[SpatialKinematics, Vector], Vector]
Errors = dict[str, float]  # of positions by mechanism, over the path of the fastest point


def errors(observer: Any, doubtful: float, coarser: Track | None = None) -> Errors:
    """Estimated errors, by mechanism.

    coarser: the same run with larger facets on some mechanisms, whose errors then follow from both runs; the errors of
    the other mechanisms are kept.
    """
    if coarser is None:
        return estimate(observer, doubtful)
    by_mechanism = errors_from_two_runs(coarser, observer)
    if math.inf in by_mechanism.values():
        single = estimate(observer, doubtful)
        by_mechanism = {
            name: error if error < math.inf else single.get(name, 0.0) for name, error in by_mechanism.items()
        }
    return by_mechanism


def estimate(observer: Any, doubtful: float) -> Errors:
    """Errors from the departure of the motion with other facets.

    First from few instants, with facets of twice the edge: these estimates are far above round-off, and where the error
    is small they are not below it. Where an error is above `doubtful`, from more instants and with facets of a more
    similar size, until two successive estimates agree, and once more with smaller facets if the others were larger; the
    greatest of these estimates counts. Where facets are far too large, the estimate by larger or by smaller facets may
    be a tenth of the error, rarely both; the first estimate may be thirty times the error.
    """
    touching = _touching(observer)
    arguments = observer.system.facets, partial(load_with, observer.system), touching
    other = comparison_with_others(*arguments, (GLANCE, *SHARES[1:]))
    if other is None:  # no facets: bars and balls alone
        return {}
    mechanisms, greatest = observer.scene.mechanisms, Errors()
    scene, time = observer.scene, observer.trajectory.time
    falls = float(time[-1] - time[0]) * math.sqrt(abs(scene.gravity) / max(scene.length, 1e-3))
    instants = max(INSTANTS, ALONE // max(1, _links(scene, touching)), math.ceil(PER_FALL * falls))
    last = _by_departure(observer, other, mechanisms, instants)
    if max(last.values()) <= doubtful:
        return last
    other = comparison_with_others(*arguments) or other
    for count in (2 * instants, 4 * instants):
        estimates = _by_departure(observer, other, mechanisms, count)
        greatest = {name: max(error, greatest.get(name, 0.0)) for name, error in estimates.items()}
        pairs = [sorted((error, last.get(name, 0.0))) for name, error in estimates.items() if error > doubtful]
        if all(high <= AGREE * low for low, high in pairs):
            break
        last = estimates
    smaller = (
        comparison_with_others(*arguments, [share for share in SHARES if share < 1.0]) if other.share > 1.0 else None
    )
    for name, error in _by_departure(observer, smaller, mechanisms, count).items() if smaller is not None else ():
        greatest[name] = max(error, greatest.get(name, 0.0))
    return greatest


def _by_departure(observer: Any, other: FacetComparison, mechanisms: dict[str, str], count: int) -> Errors:
    """Errors by mechanism, from the departure with other facets at `count` instants; mechanisms: names, by body."""
    (by_rate,) = departures(observer, known_motion(observer, count), observer.system.facets, [other.load], Poses())
    by_body = by_rate.reshape(-1, 6).max(axis=1)
    by_mechanism: Errors = {}
    for body, departure in zip(observer.system.rigid, by_body.tolist(), strict=True):
        name = mechanisms[body]
        own, of_other = (
            sum(n for body, n in counts.items() if mechanisms[body] == name)
            for counts in (other.counts, other.other_counts)
        )
        if own > 0:
            by_mechanism[name] = max(by_mechanism.get(name, 0.0), richardson_factor(own, of_other) * departure)
    return by_mechanism


class Track(NamedTuple):
    """Motion of points of all bodies: time (n,) s, places (n, b, 12) m.

    shares: sizes of facets over those of the scene, by mechanism; numbers: of facets, by touching body; errors: as
    estimated for this run.
    """

    time: Vector
    places: Vector
    shares: dict[str, float]
    numbers: dict[str, int]
    errors: Errors


def track(observer: Any, estimated: Errors | None = None) -> Track:
    """Track of a run: centre of mass of each body, and its axes times its radius; estimated: errors of the run."""
    scene, places = observer.scene, []
    for body in (handle.body for handle in observer.system.rigid.values()):
        ends = scene.radius(body) * observer.rotation(body.name).reshape(-1, 9)
        places.append(np.hstack([observer.center(body.name)[0], ends]))
    shares = {name: scene.facet_shares.get(name, 1.0) for name in scene.mechanisms.values()}
    counts = facet_counts(observer.system.facets, _touching(observer))
    return Track(observer.trajectory.time, np.stack(places, axis=1), shares, counts, estimated or {})


def errors_from_two_runs(before: Track, observer: Any) -> Errors:
    """Errors from this run and an earlier one with larger facets: Richardson extrapolation.

    Let the edges be s times those of the earlier run. An error e of order k was then e / s^k in the earlier run, so the
    two runs differ by e (1 / s^k - 1). Errors of their steps, by which they differ too, count as well. The error is
    infinite, as unknown, where there are hardly more facets than before; it is that of the earlier run where the facets
    are the same.
    """
    now, mechanisms = track(observer), observer.scene.mechanisms
    times = now.time[now.time <= before.time[-1]]
    places = before.places.reshape(len(before.time), -1)
    resampled = np.column_stack([np.interp(times, before.time, column) for column in places.T])
    distances = np.abs(resampled.reshape(len(times), -1, 12) - now.places[: len(times)]).max(axis=(0, 2))
    distances /= float(max(observer.path_length, observer.scene.least_path))
    by_body = dict(zip(observer.system.rigid, distances.tolist(), strict=True))
    by_mechanism = {}
    for name, share in now.shares.items():
        counts = {body: n for body, n in before.numbers.items() if mechanisms[body] == name and body in now.numbers}
        if share == before.shares[name]:
            by_mechanism[name] = before.errors.get(name, 0.0)
        elif len(changed_bodies(counts, now.numbers)) < len(counts):
            by_mechanism[name] = math.inf
        else:
            distance = max(d for body, d in by_body.items() if mechanisms[body] == name)
            by_mechanism[name] = distance / ((before.shares[name] / share) ** ORDER - 1.0)
    return by_mechanism


def _touching(observer: SpatialKinematics) -> set[str]:
    """Names of the bodies that touch the medium in the run."""
    history: Any = observer.trajectory.load
    return {name for i, name in enumerate(history.body_names) if history.bodies[:, i].any()}


def _links(scene: Any, touching: set[str]) -> int:
    """Number of touching bodies; the elements of a flexible link count as one."""
    link = {name: i for i, beam in enumerate(scene.beams) for name, *_ in beam.pieces}
    return len({link.get(name, name) for name in touching})


def load_with(system: SpatialSystem, share: float = 1.0) -> SpatialLoad:
    """Load of a scene with facets of `share` times their size, without scatter.

    Each body has seven coordinates, in the order of bodies.
    """
    scene = system.scene
    load = load_from_scene(scene)
    bodies = {name: Body(name, range(7 * i, 7 * i + 7)) for i, name in enumerate(system.rigid)}
    if share == 1.0:
        load.take([replace(elements, body=bodies[elements.body.name]) for elements in system.elements])
    else:
        for handle in system.rigid.values():
            for shape in (shape for shape in handle.body.parts if shape.in_sand):
                add_part(load, bodies[handle.body.name], shape, scene, handle.body.mass, share)
    load.close()
    for batch in load.batches:
        batch.clusters["scatter"] = 0.0
    return load


def known_motion(observer: Any, count: int, missing: Missing | None = None) -> Iterator[Instant]:
    """Yield the motion at `count` instants, with its degrees of freedom.

    missing: returns the forces (n, d) by which a motion is not in equilibrium, from the motion and W (n, m, d).
    """
    for trajectory in pieces(observer, observer.engine, count):
        motion = SpatialKinematics(observer.system, trajectory)
        W, K, D = freedoms(motion, all_modes=missing is not None)
        forces = np.zeros(W.shape[::2]) if missing is None else missing(motion, W)
        poses = [values for name in motion.system.rigid for values in (motion.center(name)[0], motion.quaternion(name))]
        # Contiguous, as kernels would be compiled anew for rows with gaps, which numpy may return.
        q, v = np.ascontiguousarray(np.concatenate(poses, axis=1)), motion.trajectory.v
        for i, time in enumerate(trajectory.time.tolist()):
            yield Instant(time, q[i], v[i], W[i], motion.trajectory.mass, K[i], D[i], forces[i])


_ENTRIES = np.array([[1, 2, 3], [0, 3, 2], [3, 0, 1], [2, 1, 0]])  # indices of e in the matrix of e (0, w) / 2
_SIGNS = 0.5 * np.array([[-1, -1, -1], [1, -1, 1], [1, 1, -1], [-1, 1, 1]])
_FIXED, _BY_E = np.zeros((7, 6)), np.zeros((4, 7, 6))  # Jacobian of the rates of a pose: constant, and linear in e
_FIXED[:3, :3] = np.eye(3)
_BY_E[_ENTRIES, [[3], [4], [5], [6]], [3, 4, 5]] = _SIGNS


class Poses(PlanarCoordinates):
    """Positions and Euler parameters of bodies, seven coordinates each; six rates each, as in `SpatialKinematics`."""

    def displaced(self, q: Vector, change: Vector) -> Vector:
        """Coordinates q (c,) plus a change (c,), with normalised Euler parameters."""
        poses = (q + change).reshape(-1, 7)
        poses[:, 3:] /= np.sqrt(np.einsum("bi,bi->b", poses[:, 3:], poses[:, 3:]))[:, None]
        return poses.ravel()

    def rates(self, q: Vector, v: Vector) -> Vector:
        """See `PlanarCoordinates.rates`."""
        return _pose_rates(_jacobians(q), v)

    def forces(self, load: GranularLoad, q: Vector, v: Vector) -> Vector:
        """See `PlanarCoordinates.forces`."""
        jacobians = _jacobians(q)
        forces = load.force(q, _pose_rates(jacobians, v), np.zeros_like(q)).reshape(-1, 1, 7)
        return np.asarray((forces @ jacobians).ravel())


def _pose_rates(jacobians: Vector, v: Vector) -> Vector:
    """Rates (7 b, ...) of poses from the rates (6 b, ...) of bodies."""
    return np.asarray((jacobians @ v.reshape(len(jacobians), 6, -1)).reshape(7 * len(jacobians), *v.shape[1:]))


def _jacobians(q: Vector) -> Vector:
    """Jacobians (b, 7, 6) from the rates of bodies to the rates of their positions and Euler parameters."""
    return _FIXED + (q.reshape(-1, 7)[:, 3:] @ _BY_E.reshape(4, -1)).reshape(-1, 7, 6)
