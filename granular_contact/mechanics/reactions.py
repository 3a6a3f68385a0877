"""Torques and forces of prescribed motions, at the state that every step reached.

The engine solves M a + J^T f = F for positions that obey the joints, at the end of every step: its multipliers f belong
to its own accelerations a. These are what the scheme needs to bring positions to where they have to be. After a jump of
the force, or a step much shorter than the one before, they swing about the true ones by as much as these changed, and
fade by some 0.7 a step. The state itself asks for others: with J a + c, of what is held and of what is prescribed (see
`constraints`), J a + c = g'', the second derivative of what is followed. The force that the state takes is that of
these, -f - (J M^-1 J^T)^-1 (J a + c - g''), where all other forces are those that the engine had. What Newton's method
leaves in the positions, which acts on a as 1 / h^2, is taken out as well.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from granular_contact.mechanics.constraints import together
from granular_contact.mechanics.kinematics import Kinematics
from granular_contact.results.summary import Driving
from granular_contact.scene.signal_tables import jerks
from granular_contact.scene.types import Drive, Vector

AT_ONCE = 2_000_000  # numbers of J
AROUND = 1e-10  # s, before and after a jump of an acceleration


def reactions(motion: Kinematics) -> dict[str, Driving]:
    """What the drives of all prescribed motions did, by joint."""
    drives = [drive for drive in motion.scene.drives if drive.kind == "motion"]
    if not drives:
        return {}
    asked = _asked(drives, motion.trajectory.time)
    inverse = _inverse(motion.trajectory.mass)
    forces, inertias = (np.concatenate(part) for part in zip(*_parts(motion, drives, asked, inverse), strict=True))
    multipliers = motion.trajectory.multipliers
    # A multiplier pulls the constraint back; the drive pushes along the coordinate.
    forces = -np.column_stack([multipliers[drive.joint] for drive in drives]) - forces
    ways, rates = np.transpose([motion.coordinate(motion.scene.joint(drive.joint)) for drive in drives], (1, 2, 0))
    prescribed = _Prescribed(motion.trajectory.time, drives, asked, ways, rates, forces, inertias)
    return {drive.joint: prescribed.driving(i) for i, drive in enumerate(drives)}


def _parts(
    motion: Kinematics, drives: Sequence[Drive], asked: Vector, inverse: Vector
) -> Iterator[tuple[Vector, Vector]]:
    """What `_excess` finds, of so many instants at a time that their rows find room."""
    t = motion.engine
    each = max(1, AT_ONCE // (4 * len(motion.scene.joints) * t.q.shape[1]))
    for first in range(0, len(t.time), each):
        rows = slice(first, first + each)
        a = None if t.a is None else t.a[rows]
        piece = replace(t, time=t.time[rows], q=t.q[rows], v=t.v[rows], a=a)
        yield _excess(type(motion)(motion.system, piece), drives, asked[rows], inverse)


def _excess(motion: Kinematics, drives: Sequence[Drive], asked: Vector, inverse: Vector) -> tuple[Vector, Vector]:
    """What multipliers (n, d) have too much, and inertia (n, d, d) that the prescribed accelerations meet."""
    constraints, scene = motion.constraints, motion.scene
    moved = [constraints.moved(scene.joint(drive.joint)) for drive in drives]
    rows = together([*moved, *(constraints.held(joint) for joint in scene.joints)])
    off = np.einsum("nkm,nm->nk", rows.J, motion.accelerations) + rows.c
    off[:, : len(drives)] -= asked
    used = np.flatnonzero(rows.J.any(axis=(0, 1)))
    J = rows.J[:, :, used]
    A = J @ inverse[np.ix_(used, used)] @ J.transpose(0, 2, 1)
    sides = np.zeros((*off.shape, 1 + len(drives)))
    sides[:, :, 0], sides[:, : len(drives), 1:] = off, np.eye(len(drives))
    try:
        found = np.asarray(np.linalg.solve(A, sides)[:, : len(drives)], float)
    except np.linalg.LinAlgError:  # of a run that failed
        found = np.zeros((len(off), len(drives), 1 + len(drives)))
    return found[:, :, 0], found[:, :, 1:]


def _asked(drives: Sequence[Drive], time: Vector) -> Vector:
    """Prescribed accelerations (n, d); a signal that several follow is asked once."""
    each = {drive.signal: [drive.signal.acceleration(t) for t in time.tolist()] for drive in drives}
    return np.array([each[drive.signal] for drive in drives]).T


def _inverse(mass: Any) -> Vector:
    inverse: Vector = np.linalg.inv(mass if isinstance(mass, np.ndarray) else mass.toarray())
    return inverse


@dataclass(frozen=True)
class _Prescribed:
    """Motions at instants (n,) s: prescribed accelerations, coordinates, rates, forces (n, d), inertia (n, d, d)."""

    time: Vector
    drives: Sequence[Drive]
    asked: Vector
    ways: Vector
    rates: Vector
    forces: Vector
    inertias: Vector

    def driving(self, i: int) -> Driving:
        """What the drive of one of them did.

        Its work is that on inertia, by the change of the rates and their mean, also where an acceleration jumps within
        a step, and that of the rest of its force, by its mean and the way, as weights and springs have theirs.
        """
        force, rate, inertia = self.forces[:, i], self.rates[:, i], self.inertias[:, i]
        rest = force - np.sum(inertia * self.asked, axis=1)
        way = np.diff(self.ways[:, i])
        gained = 0.5 * np.sum((inertia[1:] + inertia[:-1]) * np.diff(self.rates, axis=0), axis=1)
        done = 0.5 * (rest[1:] + rest[:-1]) * way + gained * 0.5 * (rate[1:] + rate[:-1])
        jumps = self._jumps(i, rest)
        return Driving(force, force * rate, np.concatenate([[0.0], np.cumsum(done)]), jumps)

    @cached_property
    def _around(self) -> tuple[Vector, list[Vector]]:
        """When (k,) s any of the accelerations jumps, and all of them (k, d) before and after it."""
        every = {jerk for drive in self.drives for jerk in jerks(drive.signal)}
        at = np.array(sorted(jerk for jerk in every if self.time[0] < jerk <= self.time[-1]))
        return at, [_asked(self.drives, at + side).reshape(len(at), len(self.drives)) for side in (-AROUND, AROUND)]

    def _jumps(self, i: int, rest: Vector) -> Vector:
        """Time (s), force and power (W), (k, 3), on either side of each jump of the prescribed accelerations.

        rest (n,): of the force, without its inertia.
        """
        t, (at, sides) = self.time, self._around
        rate = np.array([self.drives[i].signal.rate(jerk) for jerk in at.tolist()])
        inertia = np.column_stack([np.interp(at, t, of) for of in self.inertias[:, i].T])
        found = []
        for side, asked in zip((-AROUND, AROUND), sides, strict=True):
            force = np.interp(at, t, rest) + np.sum(inertia * asked, axis=1)
            found.append(np.column_stack([at + side, force, force * rate]))
        return np.concatenate(found)
