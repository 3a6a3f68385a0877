"""What a motion in space departs by with larger facets, and the error that this stands for.

As `strip_departure` in the plane, by `mechanics.departure`, with the facets of `sand.space.other_facets` on the bodies
that touch. Rates are those of `SpatialKinematics`, six of each body; W spans what the joints leave of them. Of a run
that was repeated with smaller facets both runs tell it, see `of_two`.

Left out: how W changes with x, inertial forces of the departure beside M x'', and how springs turn with their bodies.
Neighbouring elements of a link that has many of them move as one.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from granular_contact.mechanics.constraints import together
from granular_contact.mechanics.departure import Flat, Instant, departures, pieces
from granular_contact.mechanics.freedoms import null_space, slopes
from granular_contact.mechanics.space.kinematics import SpatialKinematics
from granular_contact.mechanics.space.system import SpatialSystem
from granular_contact.sand.contact_lines import Body
from granular_contact.sand.load import GranularLoad
from granular_contact.sand.space.from_scene import add_part, load_from_scene
from granular_contact.sand.space.load import SpatialLoad
from granular_contact.sand.space.other_facets import (
    SHARES,
    FacetComparison,
    changed_bodies,
    comparison_with_others,
    facet_counts,
    richardson_factor,
)
from granular_contact.scene.space.types import Vector

# Of the motion at which its departure is followed at a glance, at the least, and for a body that touches alone: its
# impact may be a few of them, so that with 24 one was told 0.5 % for 3.4 %, and a strip that falls and bends 11 times
# its error. Looks have twice and four times as many.
INSTANTS, ALONE = 24, 96
GLANCE = 2.0  # edges of the other facets at a glance, over those of the load's own
AGREE = 1.5  # factor between two estimates in turn, from which on there is another look
# Of the error of a motion by facets, which is that of forces, 2, where facets are many [measured: 1.0 to 2.3 where few
# are loaded, or come to lead or to trail, as under a ball that rolls].
ORDER = 1.5
# Freedoms of all links that bend. With 24 the estimate of a tail of 64 elements is 0.5 % less than with all 192 and
# takes a tenth of the time; of 8 elements, with 12 and with 3, it is 2 % more and 5 % less.
BENDING = 48
GROUND = -1
Errors = dict[str, float]  # of positions by mechanism, as parts of the distance that the fastest point travels


def errors(observer: Any, doubtful: float, coarser: Track | None = None) -> Errors:
    """Estimated errors.

    coarser: the same run with larger facets of some mechanisms, with which their errors are found; those of others are
    what they were.
    """
    if coarser is None:
        return estimate(observer, doubtful)
    found = of_two(coarser, observer)
    if math.inf in found.values():
        told = estimate(observer, doubtful)
        found = {name: error if error < math.inf else told.get(name, 0.0) for name, error in found.items()}
    return found


def estimate(observer: Any, doubtful: float) -> Errors:
    """Errors by what the motion departs by with other facets.

    A glance at few instants, with facets of twice the size, which tell much more than round-off and no less than the
    error where it is small. Where that finds more than what is doubtful looks at more instants, with facets that are
    nearer in size, until two in turn agree, and a look at smaller facets, if the others were larger; of looks the
    greatest counts. Where facets are far too large either may be a tenth of the error, rarely both; a glance may be
    thirty times as large as it.
    """
    touching = _touching(observer)
    given = observer.system.facets, partial(load_with, observer.system), touching
    other = comparison_with_others(*given, (GLANCE, *SHARES[1:]))
    if other is None:  # there are none: bars and balls alone
        return {}
    of, told = observer.scene.mechanisms, Errors()
    instants = max(INSTANTS, ALONE // max(1, _links(observer.scene, touching)))
    before = _seen(observer, other, of, instants)
    if max(before.values()) <= doubtful:
        return before
    other = comparison_with_others(*given) or other
    for count in (2 * instants, 4 * instants):
        now = _seen(observer, other, of, count)
        told = {name: max(error, told.get(name, 0.0)) for name, error in now.items()}
        pairs = [sorted((error, before.get(name, 0.0))) for name, error in now.items() if error > doubtful]
        if all(high <= AGREE * low for low, high in pairs):
            break
        before = now
    smaller = comparison_with_others(*given, [share for share in SHARES if share < 1.0]) if other.share > 1.0 else None
    for name, error in _seen(observer, smaller, of, count).items() if smaller is not None else ():
        told[name] = max(error, told.get(name, 0.0))
    return told


def _seen(observer: Any, other: FacetComparison, of: dict[str, str], count: int) -> Errors:
    """Errors by the departure that so many instants of the motion show."""
    (rates,) = departures(observer, _motion(observer, count), observer.system.facets, [other.load], Poses())
    far = rates.reshape(-1, 6).max(axis=1)
    found: Errors = {}
    for name, one in zip(observer.system.rigid, far.tolist(), strict=True):
        own, there = (
            sum(n for body, n in each.items() if of[body] == of[name]) for each in (other.counts, other.other_counts)
        )
        if own > 0:
            found[of[name]] = max(found.get(of[name], 0.0), richardson_factor(own, there) * one)
    return found


class Track(NamedTuple):
    """Where points of all bodies were: time (n,) s, places (n, b, 12) m.

    shares: of the size of facets, by mechanism; numbers: of facets, of bodies that touch; errors: as found of it.
    """

    time: Vector
    places: Vector
    shares: dict[str, float]
    numbers: dict[str, int]
    errors: Errors


def track(observer: Any, found: Errors | None = None) -> Track:
    """The way of the middle of each body, and of the ends of its axes as far out as it reaches."""
    scene, places = observer.scene, []
    for body in (handle.body for handle in observer.system.rigid.values()):
        ends = scene.radius(body) * observer.rotation(body.name).reshape(-1, 9)
        places.append(np.hstack([observer.center(body.name)[0], ends]))
    shares = {of: scene.facet_shares.get(of, 1.0) for of in scene.mechanisms.values()}
    counted = facet_counts(observer.system.facets, _touching(observer))
    return Track(observer.trajectory.time, np.stack(places, axis=1), shares, counted, found or {})


def of_two(before: Track, observer: Any) -> Errors:
    """Errors by a run with larger facets: Richardson's extrapolation.

    An error e of order k, of facets with edges of the share s of those before, was e / s^k times as large before, so
    the runs differ by e (1 / s^k - 1). What else they differ by, the errors of their steps, counts as well. Where there
    are hardly more facets than before, two runs tell nothing: infinite. Where they are the same, the error is what it
    was.
    """
    now, of = track(observer), observer.scene.mechanisms
    at = now.time[now.time <= before.time[-1]]
    places = before.places.reshape(len(before.time), -1)
    there = np.column_stack([np.interp(at, before.time, column) for column in places.T]).reshape(len(at), -1, 12)
    apart = np.abs(there - now.places[: len(at)]).max(axis=(0, 2))
    apart /= float(max(observer.path_length, observer.scene.least_path))
    found = {}
    for name, share in now.shares.items():
        mine = {body: n for body, n in before.numbers.items() if of[body] == name and body in now.numbers}
        if share == before.shares[name]:
            found[name] = before.errors.get(name, 0.0)
        elif len(changed_bodies(mine, now.numbers)) < len(mine):
            found[name] = math.inf
        else:
            far = max(one for body, one in zip(observer.system.rigid, apart.tolist(), strict=True) if of[body] == name)
            found[name] = far / ((before.shares[name] / share) ** ORDER - 1.0)
    return found


def _touching(observer: SpatialKinematics) -> set[str]:
    """Bodies that touch the medium."""
    history: Any = observer.trajectory.load
    return {name for i, name in enumerate(history.body_names) if history.bodies[:, i].any()}


def _links(scene: Any, touching: set[str]) -> int:
    """How many bodies touch; elements of a link that bends are one."""
    beam = {name: i for i, one in enumerate(scene.beams) for name, *_ in one.pieces}
    return len({beam.get(name, name) for name in touching})


def load_with(system: SpatialSystem, share: float) -> SpatialLoad:
    """The load of a scene with a share of its size of facets, without what scatters.

    Its bodies have seven coordinates, one body after another.
    """
    scene = system.scene
    load = load_from_scene(scene)
    for i, handle in enumerate(system.rigid.values()):
        on = Body(handle.body.name, range(7 * i, 7 * i + 7))
        for one in (one for one in handle.body.parts if one.in_sand):
            add_part(load, on, one, scene, handle.body.mass, share)
    load.close()
    for batch in load.batches:
        batch.clusters["scatter"] = 0.0
    return load


def _motion(observer: Any, count: int) -> Iterator[Instant]:
    """The motion at so many of its instants, with its freedoms there."""
    for some in pieces(observer, observer.engine, count):
        seen = SpatialKinematics(observer.system, some)
        W, K, D = _freedoms(seen)
        places = [one for name in seen.system.rigid for one in (seen.center(name)[0], seen.quaternion(name))]
        # (of rows with gaps, as numpy may join them, all kernels would be compiled anew)
        q, v = np.ascontiguousarray(np.concatenate(places, axis=1)), seen.trajectory.v
        for i, time in enumerate(some.time.tolist()):
            yield Instant(time, q[i], v[i], W[i], seen.trajectory.mass, K[i], D[i])


def _freedoms(seen: SpatialKinematics) -> tuple[Vector, Vector, Vector]:
    """W (n, m, d) of the freedoms, and stiffness and damping (n, d, d) of joints."""
    n, scene = len(seen.trajectory.v), seen.scene
    each = _elements_together(scene)
    group = _groups(scene, each)
    joints: Any = [joint for joint in scene.joints if group[joint.parent] != group[joint.child]]
    moved = {drive.joint for drive in scene.drives if drive.kind == "motion"}
    rows = [seen.constraints.held(joint) for joint in joints]
    rows += [seen.constraints.moved(joint) for joint in joints if joint.name in moved]
    W = _carried(seen, group)
    if rows and (held := together(rows).J).shape[1]:
        W = W @ null_space(held @ W)
    K, D = np.zeros((2, n, W.shape[2], W.shape[2]))
    for joint in joints:
        if joint.name in moved or not (joint.has_coordinate or joint.acts):
            continue
        J = seen.constraints.coordinates(joint).J @ W
        stiffness, damping = (one / each if joint.elastic is not None else one for one in _acting(seen, joint))
        K += J.transpose(0, 2, 1) @ (stiffness * J)
        D += J.transpose(0, 2, 1) @ (damping * J)
    return W, K, D


def _elements_together(scene: Any) -> int:
    """How many neighbouring elements of links that bend move as one, so that they have `BENDING` freedoms at most.

    An odd number: the joint between two such groups is in the middle of the joints whose compliance it has.
    """
    freedoms: int = sum((4 if beam.stretches else 3) * beam.elements for beam in scene.beams)
    return 2 * math.ceil(max(0.0, freedoms / BENDING - 1.0) / 2.0) + 1


def _groups(scene: Any, each: int) -> dict[str | None, int]:
    """By body the group that moves as one: itself, or so many elements of a link, with what is welded to them.

    Of the ground, None, and what is welded to it: GROUND.
    """
    group: dict[str | None, int] = {None: GROUND}
    for beam in scene.beams if each > 1 else ():
        names = [name for name, *_ in beam.pieces]
        for some in np.split(np.array(names, object), range(each // 2 + 1, len(names), each)):
            number = next((group[name] for name in some if name in group), len(group))
            group |= {name: group.get(name, number) for name in some}
    return group | {body.name: len(scene.rigid) + i for i, body in enumerate(scene.rigid) if body.name not in group}


def _carried(seen: SpatialKinematics, group: dict[str | None, int]) -> Vector:
    """Rates of bodies by those of groups (n, m, 6 g): of the middle of the first body of each, and spins in the world.

    Of a body that is a group by itself, its own rates.
    """
    n, m = seen.trajectory.v.shape
    leads: dict[int, str] = {}
    for name in seen.system.rigid:
        if group[name] != GROUND:
            leads.setdefault(group[name], name)
    column = {number: 6 * i for i, number in enumerate(leads)}
    alone = Counter(group.values())
    found = np.zeros((n, m, 6 * len(leads)))
    for i, name in enumerate(seen.system.rigid):
        if group[name] == GROUND:
            continue
        at = column[group[name]]
        block = found[:, 6 * i : 6 * i + 6, at : at + 6]
        block[:] = np.eye(6)
        if alone[group[name]] > 1:
            arm = seen.center(name)[0] - seen.center(leads[group[name]])[0]
            block[:, :3, 3:] = np.cross(np.eye(3), arm[:, None]).transpose(0, 2, 1)
            block[:, 3:, 3:] = seen.rotation(name).transpose(0, 2, 1)
    return found


def _acting(seen: SpatialKinematics, joint: Any) -> tuple[Vector, Vector]:
    """Stiffness and damping of what acts in a joint, to be multiplied with the rows (n, k, m) of its coordinates."""
    elastic = joint.elastic
    if elastic is None:
        stiffness, damping = slopes(seen, joint, seen.scene.drive(joint.name))
        return stiffness[:, None, None], damping[:, None, None]
    axial = np.reshape(elastic.axial or (), (2, -1))
    return np.append(elastic.stiffness, axial[0])[:, None], np.append(elastic.damping, axial[1])[:, None]


_ENTRIES = np.array([[1, 2, 3], [0, 3, 2], [3, 0, 1], [2, 1, 0]])  # of e in the matrix of e (0, w) / 2
_SIGNS = 0.5 * np.array([[-1, -1, -1], [1, -1, 1], [1, 1, -1], [-1, 1, 1]])
_FIXED, _BY_E = np.zeros((7, 6)), np.zeros((4, 7, 6))  # the rates by those of a body: fixed, and in proportion to e
_FIXED[:3, :3] = np.eye(3)
_BY_E[_ENTRIES, [[3], [4], [5], [6]], [3, 4, 5]] = _SIGNS


class Poses(Flat):
    """Places and Euler parameters of bodies, seven coordinates each, whose rates are six: as of `SpatialKinematics`."""

    def moved(self, q: Vector, by: Vector) -> Vector:
        """As of `Flat`."""
        there = (q + by).reshape(-1, 7)
        there[:, 3:] /= np.sqrt((there[:, 3:] ** 2).sum(axis=1, keepdims=True))
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
    """Rates of places and Euler parameters by those of bodies (b, 7, 6)."""
    return _FIXED + (q.reshape(-1, 7)[:, 3:] @ _BY_E.reshape(4, -1)).reshape(-1, 7, 6)
