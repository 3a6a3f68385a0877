"""How a mechanism moved, as it is drawn: the shapes of its parts once, then a pose of each for every picture.

The form in which a motion is saved (`motion.json`) and played. In the plane it is made from pictures; a run in space
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

RIGID = 1e-6  # of the size of the mechanism: what changes its shape by less is drawn as rigid
DIGITS = 7  # of positions in files, of the largest
BESIDE = 0.1  # of the extent of a motion: how far the ground that is drawn goes on beside it, as pictures have margins
MOST_FACES = 12_000  # triangles that are drawn of all parts; finer meshes are made coarser
GROUND = 41  # points of the ground along each side, where it is not level


@dataclass(frozen=True)
class Part:
    """A shape as it is drawn.

    name: of the part or body. points: (n, 2) m in the frame of the part, of the kinds of an `Outline`; in space
    (n, 3) m. faces: (m, 3) corners of triangles, in space alone. diameter: m, of a disc or across a bar.
    """

    name: str
    points: Vector
    faces: NDArray[np.int64] | None = None
    diameter: float = 0.0


@dataclass(frozen=True)
class Bedding:
    """What of a bed in space is drawn beside its surface.

    layers: depths (m) of their tops below the surface; floor: its height (m), None without one; walls: of those of the
    container the axis that they stand across (0 for x, 1 for y) and their place on it (m).
    """

    layers: tuple[float, ...] = ()
    floor: float | None = None
    walls: tuple[tuple[int, float], ...] = ()


@dataclass(frozen=True)
class Motion:
    """Pictures of a motion.

    time: (k,) s. poses: (k, parts, 3) x, y (m) and angle (rad, counter-clockwise) of the frames of parts; in space
    (k, parts, 7) x, y, z (m) and a quaternion w, x, y, z. bent: (k, n, 2) m, world frame, of parts that change their
    shape, by their place. forces: of the medium by body, where they act (k, d) m and how large they are (k, d) N, zero
    where there is none.
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
        """Whether this is a motion in three dimensions."""
        return bool(self.poses.shape[2] == 7)

    def points(self, part: int, instants: slice = slice(None)) -> Vector:
        """Points (k, n, d) m of a part in the world frame, at all instants or some of them."""
        if part in self.bent:
            return self.bent[part][instants]
        own, poses = self.parts[part].points, self.poses[instants, part]
        if self.in_space:
            placed: Vector = np.einsum("kij,nj->kni", rotations.of_quaternion(poses[:, 3:]), own) + poses[:, None, :3]
            return placed
        c, s = np.cos(poses[:, 2, None]), np.sin(poses[:, 2, None])
        turned = np.stack([c * own[:, 0] - s * own[:, 1], s * own[:, 0] + c * own[:, 1]], axis=-1)
        return np.asarray(turned + poses[:, None, :2])


def scaled(motion: Motion, factor: float) -> Motion:
    """A motion in the plane with all lengths times a factor."""
    parts = [replace(one, points=factor * one.points, diameter=factor * one.diameter) for one in motion.parts]
    bent = {i: factor * points for i, points in motion.bent.items()}
    forces = {body: (factor * at, force) for body, (at, force) in motion.forces.items()}
    return replace(motion, parts=tuple(parts), poses=motion.poses * (factor, factor, 1.0), bent=bent, forces=forces)


def over_ground(motion: Motion, height: Callable[[Vector, Vector], Vector], *, level: bool) -> Motion:
    """A motion in space with the ground below it, from heights (n,) m at x, y (n,) m."""
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
    """A part in space with at most about so many triangles: corners in one cell of a grid become their mean."""
    cells = 64
    while part.faces is not None and len(part.faces) > most and cells > 2:
        low, size = part.points.min(axis=0), float(np.ptp(part.points, axis=0).max()) or 1.0
        place = np.floor((part.points - low) / size * cells).astype(np.int64)
        _, own = np.unique(place, axis=0, return_inverse=True)
        own = own.ravel()
        count = np.bincount(own)
        points = np.column_stack([np.bincount(own, part.points[:, i]) / count for i in range(3)])
        faces = own[part.faces]
        corners = np.sort(faces, axis=1)
        kept = (corners[:, 0] < corners[:, 1]) & (corners[:, 1] < corners[:, 2])
        if kept.sum() <= most or cells <= 4:
            return replace(part, points=points, faces=faces[kept])
        cells = int(cells / 1.4)
    return part


# ---- pictures of the plane ----


def of_frames(frames: Sequence[Snapshot]) -> Motion | None:
    """The motion that pictures of the plane show, all of the same parts; None if there are none."""
    if not frames:
        return None
    first = frames[0].outlines
    shapes = [np.array([frame.outlines[i].points for frame in frames]) for i in range(len(first))]
    size = max((float(np.ptp(shape[0], axis=0).max()) for shape in shapes), default=0.0)
    size = max(size, *(outline.diameter for outline in first))
    parts, poses, bent = [], np.zeros((len(frames), len(first), 3)), {}
    for i, (outline, shape) in enumerate(zip(first, shapes, strict=True)):
        center, angle, miss = _rigid(shape)
        poses[:, i] = np.column_stack([center, angle])
        if miss > RIGID * size:
            bent[i] = shape
        parts.append(Part(outline.part, shape[0] - center[0], None, outline.diameter))
    return Motion(np.array([frame.time for frame in frames]), tuple(parts), poses, bent, _forces(frames))


def _rigid(shape: Vector) -> tuple[Vector, Vector, float]:
    """Centre (k, 2) m and angle (k,) rad of a shape (k, n, 2) m, and how far (m) it is from turning as one."""
    center = shape.mean(axis=1)
    own = (shape - center[:, None]) @ np.array([1.0, 1.0j])
    turned = np.sum(own * own[0].conj(), axis=1)
    angle = np.unwrap(np.angle(turned))
    return center, angle, float(np.max(np.abs(own - own[0] * np.exp(1j * angle[:, None])), initial=0.0))


def _forces(frames: Sequence[Snapshot]) -> dict[str, tuple[Vector, Vector]]:
    bodies = dict.fromkeys(force.body for frame in frames for force in frame.forces)
    found = {body: (np.zeros((len(frames), 2)), np.zeros((len(frames), 2))) for body in bodies}
    for k, frame in enumerate(frames):
        for force in frame.forces:
            point, vector = found[force.body]
            point[k], vector[k] = force.point, force.force
    return found


def motion_of(results: Results) -> Motion | None:
    """How a run moved, as far as it was asked for pictures."""
    return results.motion or of_frames(results.frames)


def frames_of(motion: Motion) -> tuple[Snapshot, ...]:
    """Pictures of a motion in the plane; none of one in space."""
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


# ---- as plain data ----


def plain(motion: Motion) -> dict[str, Any]:
    """A motion in JSON types, positions to `DIGITS` of the largest."""
    bodies = {body: {"point_m": _listed(at), "force_N": _listed(force)} for body, (at, force) in motion.forces.items()}
    count = sum(len(part.faces) for part in motion.parts if part.faces is not None)
    share = min(1.0, MOST_FACES / count) if count else 1.0
    drawn = [
        part if part.faces is None or share == 1.0 else coarser(part, max(60, int(share * len(part.faces))))
        for part in motion.parts
    ]
    ground: dict[str, Any] = {} if motion.ground is None else {"ground": [_listed(one) for one in motion.ground]}
    if motion.bedding != Bedding():
        of = motion.bedding
        ground["bedding"] = {"layers_m": list(of.layers), "floor_m": of.floor, "walls": [list(w) for w in of.walls]}
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
    """Positions as they are large, angles and quaternions to as many decimals: turns add up to large angles."""
    places = 3 if poses.shape[2] == 7 else 2
    at, turned = _rounded(poses[..., :places]), np.round(poses[..., places:], DIGITS)
    return np.concatenate([at, turned], axis=2).tolist()


def _listed(values: Vector) -> Any:
    return _rounded(values).tolist()


def _rounded(values: Vector) -> Vector:
    largest = float(np.max(np.abs(values), initial=0.0, where=np.isfinite(values)))
    if not largest > 0.0:
        return np.zeros_like(values)
    return np.asarray(np.round(values, DIGITS - 1 - int(np.floor(np.log10(largest)))))


def of_plain(saved: Mapping[str, Any]) -> Motion:
    """The motion of `plain`; KeyError, TypeError or ValueError of anything else."""
    parts = tuple(
        Part(
            str(one["name"]),
            _array(one["points_m"], 2),
            np.array(one["faces"], np.int64) if "faces" in one else None,
            float(one["diameter_m"]),
        )
        for one in saved["parts"]
    )
    bent = {int(i): _array(points, 3) for i, points in saved["bent"].items()}
    forces = {str(key): (_array(one["point_m"], 2), _array(one["force_N"], 2)) for key, one in saved["forces"].items()}
    ground = None
    if saved.get("ground") is not None:
        x, y, z = saved["ground"]
        ground = _array(x, 1), _array(y, 1), _array(z, 2)
    of = saved.get("bedding") or {"layers_m": (), "floor_m": None, "walls": ()}
    floor = None if of["floor_m"] is None else float(of["floor_m"])
    walls = tuple((int(axis), float(at)) for axis, at in of["walls"])
    bedding = Bedding(tuple(float(depth) for depth in of["layers_m"]), floor, walls)
    return Motion(_array(saved["time_s"], 1), parts, _array(saved["poses"], 3), bent, forces, ground, bedding)


def _array(values: ArrayLike, dimensions: int) -> Vector:
    found = np.array(values, dtype=np.float64)
    if found.ndim != dimensions:
        raise ValueError(f"got an array of {found.ndim} dimensions; {dimensions} are needed")
    return found
