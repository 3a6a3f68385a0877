"""What results of a run in space hold besides those of the plane: columns of three dimensions, and the motion as it is
drawn.

World: x ahead, y left, z up. Roll, pitch and yaw are those of robot files; angular velocities and moments are vectors
along the world's axes.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np

from granular_contact.results import CENTRAL_MOMENT, Snapshot, series
from granular_contact.results.frames import Later, instants
from granular_contact.results.motion import Bedding, Motion, frames_of, over_ground
from granular_contact.results.observation import Observation, bed_of
from granular_contact.results.observed import POSES, VELOCITIES, Place, Seen, angle, in_a_row
from granular_contact.values.arrays import Vector

AXES = (("x", "ahead"), ("y", "to the left"), ("z", "upward"))


@dataclass(frozen=True, kw_only=True)
class SpatialObservation(Observation):
    """As `Observation`, with vectors in space: tip (n, 3), term_forces (n, terms, 6), moments_about (n, 3) the common
    centre of mass, body_forces (n, 6). moved: the motion as it is drawn, at given times (k,) s.
    """

    _DEFLECTION: ClassVar[str] = "distance of the tip of the last link that bends from the axis of its root"

    moved: Callable[[Vector], Motion]

    def _of_tip(self) -> series.Series:
        return vector("tip_{}_m", "position of the tip", self.tip)

    def _of_terms(self) -> series.Series:
        columns = (force(term, self.term_forces[:, i], self.moments_about) for i, term in enumerate(self.terms))
        return {name: one for found in columns for name, one in found.items()}

    def film(self, most: int) -> dict[str, Any]:
        """The motion at evenly spaced times, and its pictures in side view, as `Results` has them."""
        at = instants(float(self.time[0]), float(self.time[-1]), most)
        motion = self.moved(np.minimum(at, self.time[-1]))
        bed: Any = self.scene.bed  # one of space
        grounded = motion
        if bed is not None and self.scene.media:
            grounded = over_ground(motion, bed.height, level=bed.level)
            bed_data, walls = bed_of(self.scene), tuple((axis, place) for _, axis, place, _ in bed.walls)
            grounded = replace(grounded, bedding=Bedding(bed_data["layers"], bed_data["floor"], walls))
        return {"motion": grounded, "frames": Later(lambda: side_view(motion))}


def vector(column: str, what: str, values: Vector) -> series.Series:
    """Columns of a vector (n, 3) along the world's axes."""
    return {column.format(axis): (f"{what}, {where}", values[:, i]) for i, (axis, where) in enumerate(AXES)}


def force(term: str, wrench: Vector, about: Vector) -> series.Series:
    """Columns of a term of the medium's force: wrench (n, 6) about the origin, given about points (n, 3) m."""
    what = f"{term.replace('_', ' ')} force of the medium"
    moment = wrench[:, 3:] - np.cross(about, wrench[:, :3])
    name, unit = CENTRAL_MOMENT.rsplit("_", 1)
    of = f"moment of the {what} about the centre of mass of the whole mechanism, about the axis"
    return vector(f"{term}_force_{{}}_N", what, wrench[:, :3]) | vector(f"{term}_{name}_{{}}_{unit}", of, moment)


def body(name: str, center: Vector, rpy: Vector, velocity: Vector, spin: Vector) -> series.Series:
    """Motion of a body: centre of mass, roll-pitch-yaw (rad), velocity and angular velocity (rad/s), (n, 3) each."""
    found = vector(f"{name}_{{}}_m", f"position of the centre of mass of {name}", center)
    for i, turned in enumerate(("roll", "pitch", "yaw")):
        found[f"{name}_{turned}_deg"] = (f"{turned} of {name}", np.degrees(rpy[:, i]))
    found |= vector(f"{name}_v{{}}_m_s", f"velocity of the centre of mass of {name}", velocity)
    return found | vector(f"{name}_spin_{{}}_rad_s", f"angular velocity of {name}, about the axis", spin)


def body_force(name: str, wrench: Vector, center: Vector) -> series.Series:
    """Force of the medium on a body, (n, 6) about the origin; its centre of mass (n, 3) m."""
    moment = wrench[:, 3:] - np.cross(center, wrench[:, :3])
    of = f"moment of that force about the centre of mass of {name}, about the axis"
    found = vector(f"{name}_granular_{{}}_N", f"force of the medium on {name}", wrench[:, :3])
    return found | vector(f"{name}_granular_moment_{{}}_Nm", of, moment)


# ---- one instant ----


@dataclass(frozen=True)
class SpatialSeen(Seen):
    """As `Seen`, with the names of columns in space. Roll, pitch and yaw are those within a turn."""

    _WRENCH: ClassVar[Sequence[str]] = ("x_N", "y_N", "z_N", "moment_x_Nm", "moment_y_Nm", "moment_z_Nm")

    @staticmethod
    def _of_body(name: str, i: int) -> dict[str, Place]:
        found = in_a_row(name, ("x_m", "y_m", "z_m"), POSES, i)
        for k, turned in enumerate(("roll", "pitch", "yaw"), 3):
            found |= angle(f"{name}_{turned}", POSES, i, k)
        ends = [f"v{axis}_m_s" for axis in "xyz"] + [f"spin_{axis}_rad_s" for axis in "xyz"]
        return found | in_a_row(name, ends, VELOCITIES, i)


# ---- pictures of the plane ----

_AROUND = np.linspace(0.0, 2.0 * np.pi, 64, endpoint=False)
_DIRECTIONS = np.column_stack([np.cos(_AROUND), np.sin(_AROUND)])


def silhouette(points: Vector) -> Vector:
    """Polygon (65, 2) m, closed, around points (k, 2) m: what of them is outermost in 64 directions, in each one."""
    corners: Vector = points[(points @ _DIRECTIONS.T).argmax(axis=0)]
    return np.vstack([corners, corners[:1]])


def side_view(motion: Motion) -> tuple[Snapshot, ...]:
    """A motion in space seen from the right: ahead and up, each part by its silhouette."""
    flat = [0, 2]
    shapes = {i: [silhouette(at) for at in motion.points(i)[:, :, flat]] for i in range(len(motion.parts))}
    drawn = {i: np.array(polygons) for i, polygons in shapes.items()}
    forces = {body: (at[:, flat], force[:, flat]) for body, (at, force) in motion.forces.items()}
    return frames_of(Motion(motion.time, motion.parts, motion.poses[:, :, :3], drawn, forces))
