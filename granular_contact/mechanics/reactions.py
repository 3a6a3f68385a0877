"""Reactions of prescribed motions: torques and forces at the end of every step, consistent with the acceleration level.

The engine solves M a + J^T f = F with constraints on positions at the end of every step. Its multipliers f belong to
its own accelerations a, which the scheme needs to bring the positions to their prescribed values. After a jump of the
force, or a step much shorter than the last, these accelerations oscillate about the true ones, with the size of that
change, and the oscillation decays by a factor of about 0.7 a step. The constraints on accelerations are J a + c = g''
(J, c: see `constraints`; g'': second derivative of the prescribed values, zero for fixed directions). With all other
forces as in the engine, the consistent reaction is -f - (J M^-1 J^T)^-1 (J a + c - g''). This also removes the effect
of the residual that Newton's method leaves in the positions, which enters a divided by h^2.
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

AT_ONCE = 2_000_000  # entries of J that are held in memory at a time
AROUND = 1e-10  # s, offset of the instants before and after a jump of an acceleration


def reactions(motion: Kinematics) -> dict[str, Driving]:
    """Force, power and work of the drives of all prescribed motions, by joint."""
    drives = [drive for drive in motion.scene.drives if drive.kind == "motion"]
    if not drives:
        return {}
    accelerations = _accelerations(drives, motion.trajectory.time)
    inverse = _inverse(motion.trajectory.mass)
    parts = _parts(motion, drives, accelerations, inverse)
    excess, inertias = (np.concatenate(part) for part in zip(*parts, strict=True))
    multipliers = motion.trajectory.multipliers
    # A multiplier acts against the constraint, the drive along the coordinate.
    forces = -np.column_stack([multipliers[drive.joint] for drive in drives]) - excess
    coordinates, rates = np.transpose(
        [motion.coordinate(motion.scene.joint(drive.joint)) for drive in drives], (1, 2, 0)
    )
    prescribed = _Prescribed(motion.trajectory.time, drives, accelerations, coordinates, rates, forces, inertias)
    return {drive.joint: prescribed.driving(i) for i, drive in enumerate(drives)}


def _parts(
    motion: Kinematics, drives: Sequence[Drive], accelerations: Vector, inverse: Vector
) -> Iterator[tuple[Vector, Vector]]:
    """Yield the results of `_excess` for blocks of instants whose constraint rows fit into memory."""
    t = motion.engine
    each = max(1, AT_ONCE // (4 * len(motion.scene.joints) * t.q.shape[1]))
    if each >= len(t.time):
        yield _excess(motion, drives, accelerations, inverse)
        return
    for first in range(0, len(t.time), each):
        rows = slice(first, first + each)
        a = None if t.a is None else t.a[rows]
        piece = replace(t, time=t.time[rows], q=t.q[rows], v=t.v[rows], a=a)
        yield _excess(type(motion)(motion.system, piece), drives, accelerations[rows], inverse)


def _excess(
    motion: Kinematics, drives: Sequence[Drive], accelerations: Vector, inverse: Vector
) -> tuple[Vector, Vector]:
    """Error (n, d) of the multipliers, and effective inertia (n, d, d) for the prescribed accelerations (n, d)."""
    constraints, scene = motion.constraints, motion.scene
    moved = [constraints.moved(scene.joint(drive.joint)) for drive in drives]
    rows = together([*moved, *(constraints.held(joint) for joint in scene.joints if joint.kind != "free")])
    residual = (rows.J @ motion.accelerations[:, :, None])[:, :, 0] + rows.c
    residual[:, : len(drives)] -= accelerations
    used = np.flatnonzero(rows.J.any(axis=(0, 1)))
    J = rows.J[:, :, used]
    A = J @ inverse[np.ix_(used, used)] @ J.transpose(0, 2, 1)
    right_sides = np.zeros((*residual.shape, 1 + len(drives)))
    right_sides[:, :, 0], right_sides[:, : len(drives), 1:] = residual, np.eye(len(drives))
    try:
        solution = np.asarray(np.linalg.solve(A, right_sides)[:, : len(drives)], float)
    except np.linalg.LinAlgError:  # as in a run that failed
        solution = np.zeros((len(residual), len(drives), 1 + len(drives)))
    return solution[:, :, 0], solution[:, :, 1:]


def _accelerations(drives: Sequence[Drive], time: Vector) -> Vector:
    """Prescribed accelerations (n, d); a signal that several drives follow is evaluated once."""
    by_signal = {drive.signal: [drive.signal.acceleration(t) for t in time.tolist()] for drive in drives}
    return np.array([by_signal[drive.signal] for drive in drives]).T


def _inverse(mass: Any) -> Vector:
    """Inverse (m, m) of a mass matrix, sparse or not."""
    inverse: Vector = np.linalg.inv(mass if isinstance(mass, np.ndarray) else mass.toarray())
    return inverse


@dataclass(frozen=True)
class _Prescribed:
    """Prescribed motions at instants (n,) s: accelerations, coordinates, rates, forces (n, d), inertias (n, d, d)."""

    time: Vector
    drives: Sequence[Drive]
    accelerations: Vector
    coordinates: Vector
    rates: Vector
    forces: Vector
    inertias: Vector

    def driving(self, i: int) -> Driving:
        """Force, power and work of the drive of motion i.

        The work of a step has two parts. Work on inertia is mean inertia times change of the rates times mean rate,
        which holds also where an acceleration jumps within the step. Work of the rest of the force is its mean times
        the displacement, as for weights and springs.
        """
        force, rate, inertia = self.forces[:, i], self.rates[:, i], self.inertias[:, i]
        rest = force - np.sum(inertia * self.accelerations, axis=1)
        displacement = np.diff(self.coordinates[:, i])
        impulse = 0.5 * np.sum((inertia[1:] + inertia[:-1]) * np.diff(self.rates, axis=0), axis=1)
        done = 0.5 * (rest[1:] + rest[:-1]) * displacement + impulse * 0.5 * (rate[1:] + rate[:-1])
        jumps = self._jumps(i, rest)
        return Driving(force, force * rate, np.concatenate([[0.0], np.cumsum(done)]), jumps)

    @cached_property
    def _around(self) -> tuple[Vector, list[Vector]]:
        """Times (k,) s at which any acceleration jumps, and all accelerations (k, d) just before and after them."""
        times = {time for drive in self.drives for time in jerks(drive.signal)}
        t = np.array(sorted(time for time in times if self.time[0] < time <= self.time[-1]))
        return t, [
            _accelerations(self.drives, t + side).reshape(len(t), len(self.drives)) for side in (-AROUND, AROUND)
        ]

    def _jumps(self, i: int, rest: Vector) -> Vector:
        """Time (s), force and power (W), (k, 3), on either side of each jump of the prescribed accelerations.

        rest (n,): force without its part for inertia.
        """
        t, sides = self._around
        rate = np.array([self.drives[i].signal.rate(time) for time in t.tolist()])
        inertia = np.column_stack([np.interp(t, self.time, column) for column in self.inertias[:, i].T])
        rows = []
        for side, accelerations in zip((-AROUND, AROUND), sides, strict=True):
            force = np.interp(t, self.time, rest) + np.sum(inertia * accelerations, axis=1)
            rows.append(np.column_stack([t + side, force, force * rate]))
        return np.concatenate(rows)
