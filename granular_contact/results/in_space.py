"""Results of a run in space: columns of vectors in three dimensions, and the motion for playback.

World frame: x ahead, y left, z up. Roll, pitch and yaw are defined as in robot files; angular velocities and moments
are vectors in the world frame.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np

from granular_contact.geometry.rotations import vector_products
from granular_contact.results import CENTRAL_MOMENT, Snapshot, series
from granular_contact.results.frames import Later, instants
from granular_contact.results.motion import Bedding, Motion, frames_of, over_ground
from granular_contact.results.observation import Observation, bed_of
from granular_contact.results.observed import POSES, VELOCITIES, Place, Seen, angle, in_a_row
from granular_contact.values.arrays import Vector

AXES = (("x", "ahead"), ("y", "to the left"), ("z", "upward"))


@dataclass(frozen=True, kw_only=True)
class SpatialObservation(Observation):
    """`Observation` of a run in space.

    tip: (n, 3) m; term_forces: (n, terms, 6); moments_about: (n, 3) m, the centre of mass of the mechanism;
    body_forces: (n, 6). moved: function from times (k,) s to the motion for playback.
    """

    _DEFLECTION: ClassVar[str] = "distance of the tip of the last link that bends from the axis of its root"

    moved: Callable[[Vector], Motion]

    def _tip_columns(self) -> series.Series:
        return vector("tip_{}_m", "position of the tip", self.tip)

    def _force_columns(self) -> series.Series:
        terms = (force(term, self.term_forces[:, i], self.moments_about) for i, term in enumerate(self.terms))
        return {name: column for columns in terms for name, column in columns.items()}

    def film(self, most: int) -> dict[str, Any]:
        """Fields `motion` and `frames` of `Results`: the motion at evenly spaced times, and pictures in side view."""
        at = instants(float(self.time[0]), float(self.time[-1]), most)
        motion = self.moved(np.minimum(at, self.time[-1]))
        bed: Any = self.scene.bed  # a bed in space
        grounded = motion
        if bed is not None and self.scene.media:
            grounded = over_ground(motion, bed.height, level=bed.level)
            bed_data, walls = bed_of(self.scene), tuple((axis, place) for _, axis, place, _ in bed.walls)
            grounded = replace(grounded, bedding=Bedding(bed_data["layers"], bed_data["floor"], walls))
        return {"motion": grounded, "frames": Later(lambda: side_view(motion))}


def vector(column: str, quantity: str, values: Vector) -> series.Series:
    """Columns of the components (n, 3) of a vector in the world frame."""
    return {column.format(axis): (f"{quantity}, {name}", values[:, i]) for i, (axis, name) in enumerate(AXES)}


def force(term: str, wrench: Vector, about: Vector) -> series.Series:
    """Columns of one term of the medium's force: wrench (n, 6) about the origin; moments are about points (n, 3) m."""
    quantity = f"{term.replace('_', ' ')} force of the medium"
    about_points = wrench[:, 3:] - vector_products(about, wrench[:, :3])
    name, unit = CENTRAL_MOMENT.rsplit("_", 1)
    moment = f"moment of the {quantity} about the centre of mass of the whole mechanism, about the axis"
    forces = vector(f"{term}_force_{{}}_N", quantity, wrench[:, :3])
    return forces | vector(f"{term}_{name}_{{}}_{unit}", moment, about_points)


def body(name: str, center: Vector, rpy: Vector, velocity: Vector, spin: Vector) -> series.Series:
    """Columns of a body's motion: centre of mass (m), roll-pitch-yaw (rad), its velocity (m/s), angular velocity
    (rad/s), (n, 3) each.
    """
    columns = vector(f"{name}_{{}}_m", f"position of the centre of mass of {name}", center)
    for i, turn in enumerate(("roll", "pitch", "yaw")):
        columns[f"{name}_{turn}_deg"] = (f"{turn} of {name}", np.degrees(rpy[:, i]))
    columns |= vector(f"{name}_v{{}}_m_s", f"velocity of the centre of mass of {name}", velocity)
    return columns | vector(f"{name}_spin_{{}}_rad_s", f"angular velocity of {name}, about the axis", spin)


def body_force(name: str, wrench: Vector, center: Vector) -> series.Series:
    """Columns of the medium's force on a body: wrench (n, 6) about the origin; center: its centre of mass (n, 3) m."""
    about_center = wrench[:, 3:] - vector_products(center, wrench[:, :3])
    moment = f"moment of that force about the centre of mass of {name}, about the axis"
    forces = vector(f"{name}_granular_{{}}_N", f"force of the medium on {name}", wrench[:, :3])
    return forces | vector(f"{name}_granular_moment_{{}}_Nm", moment, about_center)


# ---- one instant ----


@dataclass(frozen=True)
class SpatialSeen(Seen):
    """`Seen` with the names of columns in space. Roll, pitch and yaw lie within one turn."""

    _WRENCH: ClassVar[Sequence[str]] = ("x_N", "y_N", "z_N", "moment_x_Nm", "moment_y_Nm", "moment_z_Nm")

    @staticmethod
    def _body_places(name: str, i: int) -> dict[str, Place]:
        places = in_a_row(name, ("x_m", "y_m", "z_m"), POSES, i)
        for k, turn in enumerate(("roll", "pitch", "yaw"), 3):
            places |= angle(f"{name}_{turn}", POSES, i, k)
        ends = [f"v{axis}_m_s" for axis in "xyz"] + [f"spin_{axis}_rad_s" for axis in "xyz"]
        return places | in_a_row(name, ends, VELOCITIES, i)


# ---- pictures of the plane ----

_AROUND = np.linspace(0.0, 2.0 * np.pi, 64, endpoint=False)
_DIRECTIONS = np.column_stack([np.cos(_AROUND), np.sin(_AROUND)])


def silhouette(points: Vector) -> Vector:
    """Closed polygon (65, 2) m around points (k, 2) m, of the outermost point in each of 64 directions."""
    corners: Vector = points[(points @ _DIRECTIONS.T).argmax(axis=0)]
    return np.vstack([corners, corners[:1]])


def side_view(motion: Motion) -> tuple[Snapshot, ...]:
    """Pictures of a motion in space seen from the right (x ahead, z up), each part as its silhouette."""
    plane = [0, 2]
    shapes = {i: [silhouette(points) for points in motion.points(i)[:, :, plane]] for i in range(len(motion.parts))}
    bent = {i: np.array(polygons) for i, polygons in shapes.items()}
    forces = {body: (at[:, plane], force[:, plane]) for body, (at, force) in motion.forces.items()}
    return frames_of(Motion(motion.time, motion.parts, motion.poses[:, :, :3], bent, forces))
