"""Motion of a mechanism for playback: the shape of each part once, and its pose in every picture.

A motion is saved (`motion.json`) and played in this form. In the plane it is computed from the pictures; a run in space
gives it directly.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from granular_contact.geometry import rotations
from granular_contact.results import Force, Outline, Results, Snapshot
from granular_contact.values.arrays import Vector

RIGID = 1e-6  # of the size of the mechanism: a part whose shape changes by less is drawn as rigid
DIGITS = 7  # significant digits of the largest position in files
BESIDE = 0.1  # margin of the drawn ground around the motion, relative to the extent of the motion
MOST_FACES = 12_000  # greatest number of triangles of all parts in a file; finer meshes are coarsened
GROUND = 41  # grid points along each side of the drawn ground, if it is not level


@dataclass(frozen=True)
class Part:
    """A drawn shape.

    name: of the part or body. points: (n, 2) m in the frame of the part, a disc, bar or area as in `Outline`; in space
    (n, 3) m. faces: (m, 3) indices of the corners of triangles, in space alone. diameter: m, of a disc or across a bar.
    """

    name: str
    points: Vector
    faces: NDArray[np.int64] | None = None
    diameter: float = 0.0


@dataclass(frozen=True)
class Bedding:
    """Layers, floor and walls of a bed in space, as drawn.

    layers: depths (m) of their tops below the surface; floor: height (m), None without a floor; walls: for each wall of
    the container the axis normal to it (0 for x, 1 for y) and its coordinate on this axis (m).
    """

    layers: tuple[float, ...] = ()
    floor: float | None = None
    walls: tuple[tuple[int, float], ...] = ()


@dataclass(frozen=True)
class Motion:
    """Poses of the parts of a mechanism, and forces of the medium, at k instants.

    time: (k,) s. poses: (k, parts, 3) x, y (m) and angle (rad, counter-clockwise) of the frames of parts; in space
    (k, parts, 7) x, y, z (m) and a quaternion w, x, y, z. bent: points (k, n, 2) m in the world frame of each part that
    changes its shape, by index of the part. forces: of the medium by body: points of action (k, d) m and forces
    (k, d) N, zero where no force acts. ground: grid of the surface in space, x (m,) m, y (n,) m and heights (n, m) m.
    """

    time: Vector
    parts: tuple[Part, ...]
    poses: Vector
    bent: Mapping[int, Vector] = field(default_factory=dict)
    forces: Mapping[str, tuple[Vector, Vector]] = field(default_factory=dict)
    ground: tuple[Vector, Vector, Vector] | None = None
    bedding: Bedding = Bedding()

    @property
    def in_space(self) -> bool:
        """Whether the motion is in three dimensions."""
        return bool(self.poses.shape[2] == 7)

    def points(self, part: int, instants: slice = slice(None)) -> Vector:
        """Points (k, n, d) m of a part in the world frame, at all or the given instants."""
        if part in self.bent:
            return self.bent[part][instants]
        local, poses = self.parts[part].points, self.poses[instants, part]
        if self.in_space:
            placed: Vector = np.einsum("kij,nj->kni", rotations.of_quaternion(poses[:, 3:]), local) + poses[:, None, :3]
            return placed
        c, s = np.cos(poses[:, 2, None]), np.sin(poses[:, 2, None])
        turned = np.stack([c * local[:, 0] - s * local[:, 1], s * local[:, 0] + c * local[:, 1]], axis=-1)
        return np.asarray(turned + poses[:, None, :2])


def scaled(motion: Motion, factor: float) -> Motion:
    """Return a motion in the plane with all lengths multiplied by a factor."""
    parts = [replace(part, points=factor * part.points, diameter=factor * part.diameter) for part in motion.parts]
    bent = {i: factor * points for i, points in motion.bent.items()}
    forces = {body: (factor * at, force) for body, (at, force) in motion.forces.items()}
    return replace(motion, parts=tuple(parts), poses=motion.poses * (factor, factor, 1.0), bent=bent, forces=forces)


def over_ground(motion: Motion, height: Callable[[Vector, Vector], Vector], *, level: bool) -> Motion:
    """Return a motion in space with the ground around it; height: function from x, y (n,) m to heights (n,) m."""
    reach = max((float(np.linalg.norm(part.points, axis=1).max()) for part in motion.parts), default=0.0)
    places = motion.poses[..., :3].reshape(-1, 3)
    reach += BESIDE * (2.0 * reach + float(np.ptp(places, axis=0).max()))
    low, high = places[:, :2].min(axis=0) - reach, places[:, :2].max(axis=0) + reach
    count = 2 if level else GROUND
    x, y = (np.linspace(a, b, count) for a, b in zip(low, high, strict=True))
    grid = np.meshgrid(x, y)
    z = np.asarray(height(grid[0].ravel(), grid[1].ravel()), float) * np.ones(count * count)
    return replace(motion, ground=(x, y, z.reshape(count, count)))


def coarser(part: Part, most: int) -> Part:
    """Coarsen a part in space to at most about `most` triangles by vertex clustering.

    The corners in one cell of a grid are replaced by their mean.
    """
    cells = 64
    while part.faces is not None and len(part.faces) > most and cells > 2:
        low, size = part.points.min(axis=0), float(np.ptp(part.points, axis=0).max()) or 1.0
        cell = np.floor((part.points - low) / size * cells).astype(np.int64)
        _, cluster = np.unique(cell, axis=0, return_inverse=True)
        cluster = cluster.ravel()
        count = np.bincount(cluster)
        points = np.column_stack([np.bincount(cluster, part.points[:, i]) / count for i in range(3)])
        faces = cluster[part.faces]
        corners = np.sort(faces, axis=1)
        kept = (corners[:, 0] < corners[:, 1]) & (corners[:, 1] < corners[:, 2])
        if kept.sum() <= most or cells <= 4:
            return replace(part, points=points, faces=faces[kept])
        cells = int(cells / 1.4)
    return part


# ---- pictures of the plane ----


def of_frames(frames: Sequence[Snapshot]) -> Motion | None:
    """Compute the motion from pictures in the plane, which all show the same parts; None without pictures."""
    if not frames:
        return None
    first = frames[0].outlines
    shapes = [np.array([frame.outlines[i].points for frame in frames]) for i in range(len(first))]
    size = max((float(np.ptp(shape[0], axis=0).max()) for shape in shapes), default=0.0)
    size = max(size, *(outline.diameter for outline in first))
    parts, poses, bent = [], np.zeros((len(frames), len(first), 3)), {}
    for i, (outline, shape) in enumerate(zip(first, shapes, strict=True)):
        center, angle, deviation = _rigid(shape)
        poses[:, i] = np.column_stack([center, angle])
        if deviation > RIGID * size:
            bent[i] = shape
        parts.append(Part(outline.part, shape[0] - center[0], None, outline.diameter))
    return Motion(np.array([frame.time for frame in frames]), tuple(parts), poses, bent, _forces(frames))


def _rigid(shape: Vector) -> tuple[Vector, Vector, float]:
    """Fit a rigid motion to a shape (k, n, 2) m: centre (k, 2) m, angle (k,) rad, largest deviation of a point (m)."""
    center = shape.mean(axis=1)
    local = (shape - center[:, None]) @ np.array([1.0, 1.0j])  # as complex numbers
    angle = np.unwrap(np.angle(np.sum(local * local[0].conj(), axis=1)))
    return center, angle, float(np.max(np.abs(local - local[0] * np.exp(1j * angle[:, None])), initial=0.0))


def _forces(frames: Sequence[Snapshot]) -> dict[str, tuple[Vector, Vector]]:
    bodies = dict.fromkeys(force.body for frame in frames for force in frame.forces)
    histories = {body: (np.zeros((len(frames), 2)), np.zeros((len(frames), 2))) for body in bodies}
    for k, frame in enumerate(frames):
        for force in frame.forces:
            points, vectors = histories[force.body]
            points[k], vectors[k] = force.point, force.force
    return histories


def motion_of(results: Results) -> Motion | None:
    """Motion of a run for playback; None if the run was made without pictures."""
    return results.motion or of_frames(results.frames)


def frames_of(motion: Motion) -> tuple[Snapshot, ...]:
    """Pictures of a motion in the plane; empty for a motion in space."""
    if motion.in_space:
        return ()
    drawn = [(part, motion.points(i)) for i, part in enumerate(motion.parts)]
    return tuple(
        Snapshot(
            "frame",
            float(time),
            tuple(Outline(part.name, points[k], part.diameter) for part, points in drawn),
            tuple(Force(body, at[k], force[k]) for body, (at, force) in motion.forces.items() if force[k].any()),
        )
        for k, time in enumerate(motion.time)
    )


# ---- motion.json ----


def plain(motion: Motion) -> dict[str, Any]:
    """Convert a motion to JSON types; positions are rounded to `DIGITS` significant digits of the largest."""
    bodies = {body: {"point_m": _listed(at), "force_N": _listed(force)} for body, (at, force) in motion.forces.items()}
    count = sum(len(part.faces) for part in motion.parts if part.faces is not None)
    share = min(1.0, MOST_FACES / count) if count else 1.0
    drawn = [
        part if part.faces is None or share == 1.0 else coarser(part, max(60, int(share * len(part.faces))))
        for part in motion.parts
    ]
    ground: dict[str, Any] = {} if motion.ground is None else {"ground": [_listed(array) for array in motion.ground]}
    if motion.bedding != Bedding():
        bed = motion.bedding
        walls = [list(wall) for wall in bed.walls]
        ground["bedding"] = {"layers_m": list(bed.layers), "floor_m": bed.floor, "walls": walls}
    return {
        "time_s": _listed(motion.time),
        "parts": [_part(part) for part in drawn],
        "poses": _poses(motion.poses),
        "bent": {str(i): _listed(points) for i, points in motion.bent.items()},
        "forces": bodies,
        **ground,
    }


def _part(part: Part) -> dict[str, Any]:
    faces = {} if part.faces is None else {"faces": part.faces.tolist()}
    return {"name": part.name, "points_m": _listed(part.points), **faces, "diameter_m": part.diameter}


def _poses(poses: Vector) -> Any:
    """Round positions to `DIGITS` significant digits of the largest, angles and quaternions to `DIGITS` decimals.

    Angles of several turns can be large, so their largest value does not give the precision to keep.
    """
    dimensions = 3 if poses.shape[2] == 7 else 2
    positions, angles = _rounded(poses[..., :dimensions]), np.round(poses[..., dimensions:], DIGITS)
    return np.concatenate([positions, angles], axis=2).tolist()


def _listed(values: Vector) -> Any:
    return _rounded(values).tolist()


def _rounded(values: Vector) -> Vector:
    largest = float(np.max(np.abs(values), initial=0.0, where=np.isfinite(values)))
    if not largest > 0.0:
        return np.zeros_like(values)
    return np.asarray(np.round(values, DIGITS - 1 - int(np.floor(np.log10(largest)))))


def of_plain(saved: Mapping[str, Any]) -> Motion:
    """Inverse of `plain`; raises KeyError, TypeError or ValueError for other data."""
    parts = tuple(
        Part(
            str(part["name"]),
            _array(part["points_m"], 2),
            np.array(part["faces"], np.int64) if "faces" in part else None,
            float(part["diameter_m"]),
        )
        for part in saved["parts"]
    )
    bent = {int(i): _array(points, 3) for i, points in saved["bent"].items()}
    forces = {
        str(body): (_array(force["point_m"], 2), _array(force["force_N"], 2)) for body, force in saved["forces"].items()
    }
    ground = None
    if saved.get("ground") is not None:
        x, y, z = saved["ground"]
        ground = _array(x, 1), _array(y, 1), _array(z, 2)
    bed = saved.get("bedding") or {"layers_m": (), "floor_m": None, "walls": ()}
    floor = None if bed["floor_m"] is None else float(bed["floor_m"])
    walls = tuple((int(axis), float(at)) for axis, at in bed["walls"])
    bedding = Bedding(tuple(float(depth) for depth in bed["layers_m"]), floor, walls)
    return Motion(_array(saved["time_s"], 1), parts, _array(saved["poses"], 3), bent, forces, ground, bedding)


def _array(values: ArrayLike, dimensions: int) -> Vector:
    array = np.array(values, dtype=np.float64)
    if array.ndim != dimensions:
        raise ValueError(f"got an array of {array.ndim} dimensions; {dimensions} are needed")
    return array
