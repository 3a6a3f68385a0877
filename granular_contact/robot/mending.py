"""A copy of a robot file with meshes that a law of surfaces can take, and with inertias that bodies can have.

Inertias that no body can have are mended in the XML as little as serves.
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
from granular_contact.robot.inertia import impossible, raised
from granular_contact.robot.inspection import Inspected, Inspection
from granular_contact.robot.links import MOMENTS, read_mesh, tensor_of
from granular_contact.robot.mending_mesh import mended_mesh
from granular_contact.robot.source import Element, parse, refused
from granular_contact.robot.surfaces import Surfaces
from granular_contact.robot.types import Vector

_MILLIMETRE = 1e-3
_Key = tuple[Path, tuple[float, float, float]]


@dataclass(frozen=True)
class Mended:
    """The new file, and what was done, a sentence for each mesh and inertia."""

    path: Path
    done: tuple[str, ...]


def mend(inspection: Inspection, out: Path, packages: Mapping[str, Path] | None = None, hull: bool = False) -> Mended:
    """Write a mended copy of a robot file into a folder `out`, its meshes into `out`/meshes.

    Meshes of the inspected kind are written in m; other files are named where they are. Cures are those of
    `mending_mesh` and `mending_inertia`; what else is at fault with masses and joints stays. hull: whether meshes that
    still have faults are replaced by their convex hulls.

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
            raise refused(out, "is there already; allowed is a new or empty folder")
        (out / "meshes").mkdir(parents=True, exist_ok=True)
        surfaces = Surfaces()
        for one in inspection.shapes:
            if one.path is not None and (key := (one.path, one.shape.geometry.scale)) not in names:
                names[key] = _file_name(one.path, set(names.values()))
                done.append(f"{names[key]}: {_write(one, surfaces, out / 'meshes' / names[key], hull)}")
        target = out / source.name
        root = parse(source).root
        done += mend_inertias(root, inspection)
        _rename(root, inspection.which, source, names, out, packages or {})
        root.getroottree().write(target, xml_declaration=True, encoding="utf-8")
    except OSError as error:
        raise refused(out, f"can't be written: {error.strerror or error}") from None
    return Mended(target, tuple(done))


def _file_name(path: Path, taken: set[str]) -> str:
    name, number = f"{path.stem}.stl", 2
    while name in taken:
        name, number = f"{path.stem}_{number}.stl", number + 1
    return name


def _write(one: Inspected, surfaces: Surfaces, target: Path, hull: bool) -> str:
    """Write a mesh, mended if it has to be; says what was done."""
    arrays = surfaces.of(one.shape.geometry, one.path)
    if isinstance(arrays, str):
        raise refused(target, arrays)
    vertices, faces, words = *arrays, ""
    if np.ptp(vertices[faces].reshape(-1, 3), axis=0).max() > LARGEST:
        vertices, words = vertices * _MILLIMETRE, ", read as millimetres"
    (vertices, faces), found = mended_mesh(vertices, faces, hull)
    import trimesh

    trimesh.Trimesh(vertices, faces, process=False).export(target)
    return f"{found}{words}"


def _rename(
    root: Element,
    which: str,
    source: Path,
    names: Mapping[_Key, str],
    out: Path,
    packages: Mapping[str, Path],
) -> None:
    """Write the new names of mesh files into the XML; others as paths from the new folder."""
    for element in root.iter("mesh"):
        path = find(element.get("filename") or "", source, packages)
        if isinstance(path, str):
            continue
        kind, read = element.getparent().getparent().tag, read_mesh(Reader(""), element, "")
        new = names.get((path, read.scale)) if kind == which and read is not None else None
        if new is None:
            element.set("filename", os.path.relpath(path.resolve(), out.resolve()))
            continue
        element.set("filename", f"meshes/{new}")
        element.attrib.pop("scale", None)


ROUND_OFF = 1e-12  # of the largest moment of inertia: is written as 0, as its digits differ between processors


def mend_inertias(root: Element, inspection: Inspection) -> Iterator[str]:
    """Mend impossible inertias; says what was done, a sentence for each link.

    Mass and centre of mass stay. The small moments are raised until they reach the largest, which stays with the axes;
    where the shapes of the link are too small for the largest, the tensor becomes that of their convex hull.
    """
    for link in root.findall("link"):
        inertial, name = link.find("inertial"), link.get("name") or ""
        reader = Reader(inspection.robot.file)
        mass = link.find("inertial/mass")
        weight = None if mass is None else reader.number(mass, "value", "")
        if not weight or weight < 0.0:
            continue
        tensor = tensor_of(reader, inertial, "", weight)
        if tensor is None or impossible(tensor) is None:
            continue
        yield f"link {name}: {_mended(inertial, tensor, weight, _corners(inspection, name), reader)}"


def _corners(inspection: Inspection, link: str) -> Vector:
    """Corners (n, 3) m of all shapes of a link."""
    found = [one.corners for one in inspection.shapes if one.shape.link == link]
    return np.concatenate([np.zeros((0, 3)), *(one.reshape(-1, 3) for one in found if one is not None)])


def _mended(inertial: Element, tensor: Vector, mass: float, corners: Vector, reader: Reader) -> str:
    """Mend an inertia (3, 3) kg m^2 about its centre in the XML, and say how; corners (n, 3) m are those of shapes."""
    moments = np.linalg.eigvalsh(tensor)
    center = reader.pose(inertial, "").xyz
    reach = float(np.linalg.norm(corners - center, axis=1).max()) if len(corners) else np.inf
    if 0.0 < moments[2] <= mass * reach**2:
        new = raised(tensor)
        _write_tensor(inertial, new)
        was, now = (", ".join(f"{one:.4g}" for one in np.linalg.eigvalsh(one)[:2]) for one in (tensor, new))
        return f"its smaller moments of inertia are raised from {was} to {now} kg m^2; all else of it stays"
    if len(corners) == 0:
        return "its inertia stays, as it has no shape to take one from"
    if (origin := inertial.find("origin")) is not None:  # whose axes are those of the link from now on
        origin.attrib.pop("rpy", None)
    _write_tensor(inertial, _of_hull(corners, mass))
    return "its inertia is now that of the hull of its shapes, which are too small for it; mass and centre of mass stay"


def _of_hull(points: Vector, mass: float) -> Vector:
    """Inertia (3, 3) kg m^2 of the convex hull of points (n, 3) m about its centre of mass, of one density."""
    from trimesh.convex import convex_hull

    hull = convex_hull(points)
    hull.density = mass / hull.volume
    return np.asarray(hull.moment_inertia, float)


def _write_tensor(inertial: Element, tensor: Vector) -> None:
    tensor = np.where(np.abs(tensor) < ROUND_OFF * np.abs(tensor).max(), 0.0, tensor)
    for name in MOMENTS:
        inertial.find("inertia").set(name, f"{tensor['xyz'.index(name[1]), 'xyz'.index(name[2])]:.9g}")
