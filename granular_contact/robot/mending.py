"""A copy of a robot file in which meshes that no law of surfaces can take are repaired, or replaced by their hull, and
inertias that no body has by those of the shapes.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from granular_contact.geometry.mesh_quality import INNER, LARGEST, Quality, quality, sides
from granular_contact.robot.files import find
from granular_contact.robot.inspection import Inspected, Inspection
from granular_contact.robot.mending_inertia import mend_inertias
from granular_contact.robot.source import Element, parse, refused
from granular_contact.robot.surfaces import Arrays, Surfaces

_MILLIMETRE = 1e-3
_KEPT = 0.95  # of the size, and of the area that is not inside: less is no repair
_Key = tuple[Path, tuple[float, float, float]]


@dataclass(frozen=True)
class Mended:
    """The new file, and what was done, a sentence for each mesh and inertia."""

    path: Path
    done: tuple[str, ...]


def mend(inspection: Inspection, out: Path, packages: Mapping[str, Path] | None = None) -> Mended:
    """Write a mended copy of a robot file into a folder `out`, its meshes into `out`/meshes.

    Meshes of the inspected kind are written in m; other files are named where they are. Inertias that no body has are
    replaced by those of the shapes. What else is at fault with masses and joints stays.

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
                done.append(f"{names[key]}: {_write(one, surfaces, out / 'meshes' / names[key])}")
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


def _write(one: Inspected, surfaces: Surfaces, target: Path) -> str:
    """Write a mesh, mended if it has to be; says what was done."""
    arrays = surfaces.of(one.shape.geometry, one.path)
    if isinstance(arrays, str):
        raise refused(target, arrays)
    vertices, faces, words = *arrays, ""
    if np.ptp(vertices[faces].reshape(-1, 3), axis=0).max() > LARGEST:
        vertices, words = vertices * _MILLIMETRE, ", read as millimetres"
    (vertices, faces), found = mended_mesh(vertices, faces)
    import trimesh

    trimesh.Trimesh(vertices, faces, process=False).export(target)
    return f"{found}{words}"


def mended_mesh(vertices: np.ndarray, faces: np.ndarray) -> tuple[Arrays, str]:
    """A closed, outward mesh in place of one of vertices (n, 3) m and faces (m, 3), and what was done."""
    before = quality(vertices, faces)
    if _is_fine(before):
        return (vertices, faces), f"kept, {len(faces)} triangles"
    repaired = _repaired(vertices, faces)
    for found, verb in ((repaired, "repaired"), (_united(repaired), "its parts made one")):
        after = quality(*_arrays(found)) if found is not None and len(found.faces) else None
        if after is not None and _is_fine(after) and _is_whole(before, after):
            return _arrays(found), f"{verb} ({_changes(before, after)})"
    hull = _arrays(repaired.convex_hull if len(repaired.faces) else _mesh(vertices, faces).convex_hull)
    return hull, f"replaced by its convex hull ({_changes(before, quality(*hull))})"


def _is_whole(before: Quality, after: Quality) -> bool:
    """Whether a repair lost nothing but what lay inside: neither area nor size."""
    same = np.allclose(after.size, before.size, rtol=1.0 - _KEPT)
    return bool(same) and after.area > _KEPT * before.area * (1.0 - before.inner)


def _is_fine(found: Quality) -> bool:
    return not found.faults and found.inner <= INNER and found.volume > 0.0


def _repaired(vertices: np.ndarray, faces: np.ndarray) -> Any:
    """The mesh with its vertices joined, twice given and flat triangles left out, holes closed, normals outward."""
    from trimesh import repair

    found = _mesh(vertices, faces)
    found.merge_vertices(merge_tex=True, merge_norm=True)
    found.update_faces(found.unique_faces())
    found.update_faces(found.nondegenerate_faces(height=1e-9 * float(np.ptp(vertices, axis=0).max())))
    repair.fill_holes(found)
    repair.fix_normals(found, multibody=True)
    found.remove_unreferenced_vertices()
    return found


def _united(found: Any) -> Any:
    """The parts of a mesh as one body, without what lies inside; None if they can't be united."""
    try:
        from trimesh import boolean

        parts = [part for part in found.split(only_watertight=True) if part.volume > 0.0]
        return boolean.union(parts, engine="manifold") if len(parts) > 1 else None
    except (ImportError, ValueError):  # manifold3d is not installed, or refuses the parts
        return None


def _mesh(vertices: np.ndarray, faces: np.ndarray) -> Any:
    import trimesh

    return trimesh.Trimesh(vertices, faces, process=False)


def _arrays(found: Any) -> Arrays:
    return np.asarray(found.vertices, float), np.asarray(found.faces, np.int64)


def _changes(before: Quality, after: Quality) -> str:
    words = "; ".join(fault.split("; allowed")[0] for fault in (*before.faults, *before.notes))
    ratio = f"volume {1e6 * before.volume:.4g} to {1e6 * after.volume:.4g} cm3"
    return f"{before.triangles} to {after.triangles} triangles, {sides(1e3 * after.size)} mm, {ratio}; was: {words}"


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
        kind = element.getparent().getparent().tag
        scale = _scale(element.get("scale") or "1 1 1")
        new = names.get((path, scale)) if kind == which and scale is not None else None
        if new is None:
            element.set("filename", os.path.relpath(path.resolve(), out.resolve()))
            continue
        element.set("filename", f"meshes/{new}")
        element.attrib.pop("scale", None)


def _scale(text: str) -> tuple[float, float, float] | None:
    try:
        x, y, z = (float(word) for word in text.split())
    except ValueError:  # which has its fault
        return None
    return x, y, z
