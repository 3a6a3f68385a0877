"""What is wrong with a robot for a law of surfaces: its meshes, its overlaps, its masses; a table and sentences."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from itertools import combinations
from os import PathLike
from pathlib import Path

import numpy as np

from granular_contact.errors import Fault
from granular_contact.geometry.mesh_quality import Quality, quality, share_inside
from granular_contact.robot.elements import Reader
from granular_contact.robot.files import find
from granular_contact.robot.massless import merged, mimicking, unsupported
from granular_contact.robot.surfaces import Surfaces
from granular_contact.robot.types import Link, Robot, Shape, Vector
from granular_contact.robot.urdf import read_all

OVERLAP = 0.02  # of the area of a shape: above it, an overlap is worth a word
MANY = 20_000  # triangles of a shape
_LEAST_GYRATION = 0.02  # of the farthest point of the shapes: radius of gyration below which an inertia is doubtful


@dataclass(frozen=True)
class Inspected:
    """One shape; name: its file or kind; path: of a mesh; quality: None of a primitive, or if it can't be read."""

    shape: Shape
    name: str
    path: Path | None = None
    quality: Quality | None = None
    corners: Vector | None = field(default=None, repr=False)

    @cached_property
    def box(self) -> tuple[Vector, Vector]:
        """Lowest and highest x, y, z (3,) m of its corners, in the frame of its link."""
        points = np.zeros((1, 3)) if self.corners is None else self.corners.reshape(-1, 3)
        return points.min(axis=0), points.max(axis=0)


@dataclass(frozen=True)
class Inspection:
    """A robot and what is wrong with it. faults: what a run would refuse; notes: what makes its forces doubtful.

    which: "collision" or "visual", the shapes that were looked at; robot: as in the file.
    """

    robot: Robot
    which: str
    shapes: tuple[Inspected, ...]
    faults: tuple[Fault, ...]
    notes: tuple[Fault, ...]


def inspect(
    path: str | PathLike[str], which: str | None = None, packages: Mapping[str, Path] | None = None
) -> Inspection:
    """Inspect a robot file.

    Parameters
    ----------
    path : str or path
        URDF file.
    which : str, optional
        Shapes to look at: "collision" or "visual"; unless given, collision shapes if there are any.
    packages : mapping, optional
        Folders of packages by name.

    Raises
    ------
    ConfigError
        The file can't be read as XML.
    """
    robot, reader = read_all(path)
    if which is None:
        which = "collision" if any(link.collision for link in robot.links.values()) else "visual"
    reader.use(which)
    notes = Reader(str(path))
    surfaces, known = Surfaces(), dict[tuple[Path, tuple[float, float, float]], Quality]()
    shapes = [
        _inspected(reader, notes, shape, surfaces, known, packages or {})
        for link in robot.links.values()
        for shape in link.shapes(which)
    ]
    _note_overlaps(notes, shapes)
    _note_shapeless(notes, robot, which)
    if not reader.faults:
        _check_bodies(reader, notes, robot, shapes)
    notes.faults += reader.notices
    in_order = [tuple(sorted(one.faults, key=lambda fault: fault.line or 0)) for one in (reader, notes)]
    return Inspection(robot, which, tuple(shapes), *in_order)


def _inspected(
    reader: Reader,
    notes: Reader,
    shape: Shape,
    surfaces: Surfaces,
    known: dict[tuple[Path, tuple[float, float, float]], Quality],
    packages: Mapping[str, Path],
) -> Inspected:
    """One shape, with what is said of it; known: qualities by file and scale, so that a mesh is looked through once."""
    geometry, key = shape.geometry, f"{shape.key}.geometry.{shape.geometry.kind}"
    path = find(geometry.file, Path(reader.file), packages) if geometry.kind == "mesh" else None
    name = Path(geometry.file.replace("\\", "/")).name if geometry.kind == "mesh" else geometry.kind
    arrays = path if isinstance(path, str) else surfaces.of(geometry, path)
    if isinstance(path, str) or isinstance(arrays, str):
        reader.fault(shape.line, f"{key}.filename", str(arrays))
        return Inspected(shape, name)
    vertices, faces = arrays
    corners = vertices[faces] @ shape.pose.rotation.T + shape.pose.xyz
    if path is None:
        return Inspected(shape, name, corners=corners)
    if (path, geometry.scale) not in known:
        known[path, geometry.scale] = quality(vertices, faces)
    found = known[path, geometry.scale]
    for words in found.faults:
        reader.fault(shape.line, key, f"{name}: {words}")
    for words in found.notes:
        notes.fault(shape.line, key, f"{name}: {words}")
    if len(faces) > MANY:
        notes.fault(shape.line, key, f"{name}: it has {len(faces)} triangles; forces cost their number")
    return Inspected(shape, name, path, found, corners)


def _note_overlaps(notes: Reader, shapes: list[Inspected]) -> None:
    """Note links with shapes that lie in each other: the medium acts on both surfaces."""
    of_link: dict[str, list[tuple[float, Inspected, Inspected]]] = {}
    for one, other in combinations(shapes, 2):
        if one.shape.link != other.shape.link or one.corners is None or other.corners is None:
            continue
        (low, high), (lower, higher) = one.box, other.box
        if (high <= lower).any() or (higher <= low).any():
            continue
        share = max(share_inside(one.corners, other.corners), share_inside(other.corners, one.corners))
        if share > OVERLAP:
            of_link.setdefault(one.shape.link, []).append((share, one, other))
    for link, found in of_link.items():
        share, one, other = max(found, key=lambda pair: pair[0])
        what = "two of its shapes overlap" if len(found) == 1 else f"{len(found)} pairs of its shapes overlap"
        words = f"{what}, where the medium acts on both: {one.name} and {other.name}, about {100 * share:.0f} % of one"
        notes.fault(one.shape.line, f"link.{link}", words)


def _note_shapeless(notes: Reader, robot: Robot, which: str) -> None:
    other = "visual" if which == "collision" else "collision"
    for link in robot.links.values():
        if link.inertial is not None and not link.shapes(which):
            hint = f"; it has {other} ones (shapes: {other})" if link.shapes(other) else ""
            notes.fault(link.line, f"link.{link.name}", f"has no {which} shape, so no medium acts on it{hint}")


def _check_bodies(reader: Reader, notes: Reader, robot: Robot, shapes: list[Inspected]) -> None:
    """Check masses, and what of joints no mechanism here can have."""
    massless = Reader(reader.file)
    merged(robot, massless)
    root_only = [fault for fault in massless.faults if fault.key == f"link.{robot.root}"]
    notes.faults += root_only
    reader.faults += [fault for fault in massless.faults if fault not in root_only]
    for one, found in ((reader, unsupported(robot)), (notes, mimicking(robot))):
        for joint, key, words in found:
            one.fault(joint.lines.get(key, joint.line), f"joint.{joint.name}.{key}", words)
    for link in robot.links.values():
        notes.faults += _doubtful(notes.file, link, [one for one in shapes if one.shape.link == link.name])


def _doubtful(file: str, link: Link, shapes: list[Inspected]) -> Iterator[Fault]:
    """Faults of an inertia that does not go with the size of the shapes."""
    corners = [one.corners.reshape(-1, 3) for one in shapes if one.corners is not None]
    if link.inertial is None or not corners:
        return
    points = np.concatenate(corners)
    farthest = float(np.linalg.norm(points - link.inertial.center, axis=1).max())
    largest = float(np.linalg.eigvalsh(link.inertial.tensor).max())
    gyration = float(np.sqrt(largest / link.inertial.mass))
    sizes = f"radius of gyration {1e3 * gyration:.3g} mm, farthest point of its shapes {1e3 * farthest:.3g} mm"
    key = f"link.{link.name}.inertial"
    if gyration > farthest:
        yield Fault(file, link.inertial.line, key, f"its inertia is larger than its shapes can have: {sizes}")
    elif gyration < _LEAST_GYRATION * farthest:
        yield Fault(file, link.inertial.line, key, f"its inertia is very small for its shapes: {sizes}")
    low, high = points.min(axis=0), points.max(axis=0)
    if (np.abs(link.inertial.center - 0.5 * (low + high)) > high - low).any():
        shown = ", ".join(f"{1e3 * x:.4g}" for x in link.inertial.center)
        yield Fault(file, link.inertial.line, key, f"its centre of mass ({shown}) mm lies far outside its shapes")
