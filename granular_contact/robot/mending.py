"""Mended copy of a robot file: meshes that laws of surfaces can use, and inertias that bodies can have.

Inertias that no body can have are changed in the XML as little as possible.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from granular_contact.geometry.mesh_quality import LARGEST
from granular_contact.robot.elements import Reader
from granular_contact.robot.files import find
from granular_contact.robot.inertia import impossibility, with_raised_moments
from granular_contact.robot.inspection import InspectedShape, Inspection
from granular_contact.robot.links import MOMENTS, read_mesh, tensor_of
from granular_contact.robot.mending_mesh import mended_mesh
from granular_contact.robot.source import Element, file_error, parse
from granular_contact.robot.surfaces import Surfaces
from granular_contact.robot.types import Vector

_MILLIMETRE = 1e-3
_Key = tuple[Path, tuple[float, float, float]]


@dataclass(frozen=True)
class Mended:
    """Path of a mended copy; done: a sentence on each mesh and each mended inertia."""

    path: Path
    done: tuple[str, ...]


def mend(inspection: Inspection, out: Path, packages: Mapping[str, Path] | None = None, hull: bool = False) -> Mended:
    """Write a mended copy of a robot file into a folder `out`, its meshes into `out`/meshes.

    Meshes of the inspected kind are mended by `mending_mesh` and written in m; other files stay where they are, and the
    copy names their paths. Inertias are mended by `mend_inertias`. Other faults of masses and joints are not mended.
    hull: whether meshes that still have faults are replaced by their convex hulls.

    Raises
    ------
    ConfigError
        A mesh can't be read, or the folder is not empty or can't be written.
    """
    source = Path(inspection.robot.file)
    names: dict[_Key, str] = {}
    done = list[str]()
    try:
        if out.exists() and (not out.is_dir() or any(out.iterdir())):
            raise file_error(out, "is there already; allowed is a new or empty folder")
        (out / "meshes").mkdir(parents=True, exist_ok=True)
        surfaces = Surfaces()
        for inspected in inspection.shapes:
            path, scale = inspected.path, inspected.shape.geometry.scale
            if path is not None and (key := (path, scale)) not in names:
                names[key] = _file_name(path, set(names.values()))
                done.append(f"{names[key]}: {_write(inspected, surfaces, out / 'meshes' / names[key], hull)}")
        target = out / source.name
        root = parse(source).root
        done += mend_inertias(root, inspection)
        _rename(root, inspection.which, source, names, out, packages or {})
        root.getroottree().write(target, xml_declaration=True, encoding="utf-8")
    except OSError as error:
        raise file_error(out, f"can't be written: {error.strerror or error}") from None
    return Mended(target, tuple(done))


def _file_name(path: Path, taken: set[str]) -> str:
    name, number = f"{path.stem}.stl", 2
    while name in taken:
        name, number = f"{path.stem}_{number}.stl", number + 1
    return name


def _write(inspected: InspectedShape, surfaces: Surfaces, target: Path, hull: bool) -> str:
    """Write the mended mesh of a shape; return a sentence on the repairs."""
    arrays = surfaces.of(inspected.shape.geometry, inspected.path)
    if isinstance(arrays, str):
        raise file_error(target, arrays)
    vertices, faces, unit = *arrays, ""
    if np.ptp(vertices[faces].reshape(-1, 3), axis=0).max() > LARGEST:
        vertices, unit = vertices * _MILLIMETRE, ", read as millimetres"
    (vertices, faces), report = mended_mesh(vertices, faces, hull)
    import trimesh

    trimesh.Trimesh(vertices, faces, process=False).export(target)
    return f"{report}{unit}"


def _rename(
    root: Element,
    which: str,
    source: Path,
    names: Mapping[_Key, str],
    out: Path,
    packages: Mapping[str, Path],
) -> None:
    """Write the names of mended meshes into the XML, and the paths of other meshes relative to the new folder."""
    for element in root.iter("mesh"):
        path = find(element.get("filename") or "", source, packages)
        if isinstance(path, str):
            continue
        kind, geometry = element.getparent().getparent().tag, read_mesh(Reader(""), element, "")
        new = names.get((path, geometry.scale)) if kind == which and geometry is not None else None
        if new is None:
            element.set("filename", os.path.relpath(path.resolve(), out.resolve()))
            continue
        element.set("filename", f"meshes/{new}")
        element.attrib.pop("scale", None)


ROUND_OFF = 1e-12  # relative to the largest entry: smaller ones are written as 0, as they differ between processors


def mend_inertias(root: Element, inspection: Inspection) -> Iterator[str]:
    """Mend inertias that no body can have; yield a sentence for each such link.

    Mass and centre of mass do not change. The smaller moments are raised until their sum is the largest; the largest
    moment and the axes do not change. If the shapes of the link are too small for the largest moment, the tensor
    becomes that of their convex hull.
    """
    for link in root.findall("link"):
        inertial, name = link.find("inertial"), link.get("name") or ""
        reader = Reader(inspection.robot.file)
        element = link.find("inertial/mass")
        mass = None if element is None else reader.number(element, "value", "")
        if not mass or mass < 0.0:
            continue
        tensor = tensor_of(reader, inertial, "", mass)
        if tensor is None or impossibility(tensor) is None:
            continue
        yield f"link {name}: {_mend_inertia(inertial, tensor, mass, _corners(inspection, name), reader)}"


def _corners(inspection: Inspection, link: str) -> Vector:
    """Corners (n, 3) m of all shapes of a link, in its frame."""
    corners = [inspected.corners for inspected in inspection.shapes if inspected.shape.link == link]
    return np.concatenate([np.zeros((0, 3)), *(points.reshape(-1, 3) for points in corners if points is not None)])


def _mend_inertia(inertial: Element, tensor: Vector, mass: float, corners: Vector, reader: Reader) -> str:
    """Mend an inertia (3, 3) kg m^2 in the XML; return a sentence on the change. corners (n, 3) m: of the shapes."""
    moments = np.linalg.eigvalsh(tensor)
    center = reader.pose(inertial, "").xyz
    reach = float(np.linalg.norm(corners - center, axis=1).max()) if len(corners) else np.inf
    if 0.0 < moments[2] <= mass * reach**2:
        new = with_raised_moments(tensor)
        _write_tensor(inertial, new)
        old_moments, new_moments = (
            ", ".join(f"{moment:.4g}" for moment in np.linalg.eigvalsh(inertia)[:2]) for inertia in (tensor, new)
        )
        return (
            f"its smaller moments of inertia are raised from {old_moments} to {new_moments} kg m^2; "
            "nothing else changes"
        )
    if len(corners) == 0:
        return "its inertia is not mended, as it has no shape to compute one from"
    if (origin := inertial.find("origin")) is not None:  # the new tensor is along the axes of the link
        origin.attrib.pop("rpy", None)
    _write_tensor(inertial, _of_hull(corners, mass))
    return "its inertia is now that of the hull of its shapes, which are too small for it; mass and centre of mass stay"


def _of_hull(points: Vector, mass: float) -> Vector:
    """Inertia (3, 3) kg m^2 about its centre of mass of the homogeneous convex hull of points (n, 3) m."""
    from trimesh.convex import convex_hull

    hull = convex_hull(points)
    hull.density = mass / hull.volume
    return np.asarray(hull.moment_inertia, float)


def _write_tensor(inertial: Element, tensor: Vector) -> None:
    tensor = np.where(np.abs(tensor) < ROUND_OFF * np.abs(tensor).max(), 0.0, tensor)
    for name in MOMENTS:
        inertial.find("inertia").set(name, f"{tensor['xyz'.index(name[1]), 'xyz'.index(name[2])]:.9g}")
