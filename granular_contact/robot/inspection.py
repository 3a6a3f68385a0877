"""Flaws of a robot for laws of surfaces: meshes, overlaps of shapes, masses; as a table and sentences."""

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
from granular_contact.robot.massless import merge_massless, mimicking, unsupported
from granular_contact.robot.surfaces import Surfaces
from granular_contact.robot.types import Link, Robot, Shape, Vector
from granular_contact.robot.urdf import read_all

OVERLAP = 0.02  # of the area of a shape: a larger overlap gives a note
MANY = 20_000  # triangles of a shape: more give a note
_LEAST_GYRATION = 0.02  # radius of gyration over the distance of the farthest point: a smaller inertia gives a note


@dataclass(frozen=True)
class InspectedShape:
    """Shape of a robot with its quality.

    name: its file or kind. path: of a mesh. quality: of a mesh, None of a primitive or if the mesh can't be read.
    corners (n, 3, 3) m: of its triangles, in the frame of its link; None if they can't be read.
    """

    shape: Shape
    name: str
    path: Path | None = None
    quality: Quality | None = None
    corners: Vector | None = field(default=None, repr=False)

    @cached_property
    def box(self) -> tuple[Vector, Vector]:
        """Axis-aligned bounding box: least and greatest x, y, z (3,) m of its corners, in the frame of its link."""
        points = np.zeros((1, 3)) if self.corners is None else self.corners.reshape(-1, 3)
        return points.min(axis=0), points.max(axis=0)


@dataclass(frozen=True)
class Inspection:
    """Robot as in its file, with its flaws. faults: a run would refuse them; notes: they make forces doubtful.

    which: kind of the inspected shapes, "collision" or "visual".
    """

    robot: Robot
    which: str
    shapes: tuple[InspectedShape, ...]
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
        Kind of shapes to inspect, "collision" or "visual"; unless given, collision shapes if there are any.
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
    reader.use_shapes(which)
    notes = Reader(str(path))
    surfaces, qualities = Surfaces(), dict[tuple[Path, tuple[float, float, float]], Quality]()
    shapes = [
        _inspected(reader, notes, shape, surfaces, qualities, packages or {})
        for link in robot.links.values()
        for shape in link.shapes(which)
    ]
    _note_overlaps(notes, shapes)
    _note_shapeless(notes, robot, which)
    if not reader.faults:
        _check_bodies(reader, notes, robot, shapes)
    notes.faults += reader.notices
    by_line = [tuple(sorted(collected.faults, key=lambda fault: fault.line or 0)) for collected in (reader, notes)]
    return Inspection(robot, which, tuple(shapes), *by_line)


def _inspected(
    reader: Reader,
    notes: Reader,
    shape: Shape,
    surfaces: Surfaces,
    qualities: dict[tuple[Path, tuple[float, float, float]], Quality],
    packages: Mapping[str, Path],
) -> InspectedShape:
    """Inspect a shape; its faults and notes are appended.

    qualities: by file and scale, extended here, so that each mesh is inspected once.
    """
    geometry, key = shape.geometry, f"{shape.key}.geometry.{shape.geometry.kind}"
    path = find(geometry.file, Path(reader.file), packages) if geometry.kind == "mesh" else None
    name = Path(geometry.file.replace("\\", "/")).name if geometry.kind == "mesh" else geometry.kind
    arrays = path if isinstance(path, str) else surfaces.of(geometry, path)
    if isinstance(path, str) or isinstance(arrays, str):
        reader.fault(shape.line, f"{key}.filename", str(arrays))
        return InspectedShape(shape, name)
    vertices, faces = arrays
    corners = vertices[faces] @ shape.pose.rotation.T + shape.pose.xyz
    if path is None:
        return InspectedShape(shape, name, corners=corners)
    if (path, geometry.scale) not in qualities:
        qualities[path, geometry.scale] = quality(vertices, faces)
    mesh_quality = qualities[path, geometry.scale]
    for words in mesh_quality.faults:
        reader.fault(shape.line, key, f"{name}: {words}")
    for words in mesh_quality.notes:
        notes.fault(shape.line, key, f"{name}: {words}")
    if len(faces) > MANY:
        notes.fault(shape.line, key, f"{name}: it has {len(faces)} triangles; forces cost their number")
    return InspectedShape(shape, name, path, mesh_quality, corners)


def _note_overlaps(notes: Reader, shapes: list[InspectedShape]) -> None:
    """Note links with overlapping shapes, as the medium acts on both surfaces."""
    overlaps: dict[str, list[tuple[float, InspectedShape, InspectedShape]]] = {}
    for first, second in combinations(shapes, 2):
        if first.shape.link != second.shape.link or first.corners is None or second.corners is None:
            continue
        (first_low, first_high), (second_low, second_high) = first.box, second.box
        if (first_high <= second_low).any() or (second_high <= first_low).any():
            continue
        share = max(share_inside(first.corners, second.corners), share_inside(second.corners, first.corners))
        if share > OVERLAP:
            overlaps.setdefault(first.shape.link, []).append((share, first, second))
    for link, pairs in overlaps.items():
        share, first, second = max(pairs, key=lambda pair: pair[0])
        count = "two of its shapes overlap" if len(pairs) == 1 else f"{len(pairs)} pairs of its shapes overlap"
        names = f"{first.name} and {second.name}, about {100 * share:.0f} % of one"
        notes.fault(first.shape.line, f"link.{link}", f"{count}, where the medium acts on both: {names}")


def _note_shapeless(notes: Reader, robot: Robot, which: str) -> None:
    """Note links with mass that have no shape of the inspected kind."""
    other = "visual" if which == "collision" else "collision"
    for link in robot.links.values():
        if link.inertial is not None and not link.shapes(which):
            hint = f"; it has {other} ones (shapes: {other})" if link.shapes(other) else ""
            notes.fault(link.line, f"link.{link.name}", f"has no {which} shape, so no medium acts on it{hint}")


def _check_bodies(reader: Reader, notes: Reader, robot: Robot, shapes: list[InspectedShape]) -> None:
    """Check masses and joints.

    A root without mass and joints that follow others give notes only, as a config can mend them.
    """
    massless = Reader(reader.file)
    merge_massless(robot, massless)
    at_root = [fault for fault in massless.faults if fault.key == f"link.{robot.root}"]
    notes.faults += at_root
    reader.faults += [fault for fault in massless.faults if fault not in at_root]
    for collected, joints in ((reader, unsupported(robot)), (notes, mimicking(robot))):
        for joint, key, words in joints:
            collected.fault(joint.lines.get(key, joint.line), f"joint.{joint.name}.{key}", words)
    for link in robot.links.values():
        own_shapes = [inspected for inspected in shapes if inspected.shape.link == link.name]
        notes.faults += _doubtful_inertia(notes.file, link, own_shapes)


def _doubtful_inertia(file: str, link: Link, shapes: list[InspectedShape]) -> Iterator[Fault]:
    """Notes on an inertia or a centre of mass that does not fit the size of the shapes of its link."""
    corners = [inspected.corners.reshape(-1, 3) for inspected in shapes if inspected.corners is not None]
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
