"""A copy of a robot file with meshes that a law of surfaces can take, and with inertias that bodies can have."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from granular_contact.geometry.mesh_quality import LARGEST
from granular_contact.robot.files import find
from granular_contact.robot.inspection import Inspected, Inspection
from granular_contact.robot.mending_inertia import mend_inertias
from granular_contact.robot.mending_mesh import mended_mesh
from granular_contact.robot.source import Element, parse, refused
from granular_contact.robot.surfaces import Surfaces

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
