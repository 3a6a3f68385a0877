"""Cures of a mesh that a law of surfaces can't take, those that change least first; most are trimesh's.

Triangles without area or given twice are dropped, corners that lie apart are welded, holes filled, triangles turned
outward, parts united. A cure is kept if the mesh is no worse by it, and no other is tried once the mesh is sound.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from granular_contact.geometry import mesh
from granular_contact.geometry.mesh_quality import INNER, Quality, quality
from granular_contact.robot.surfaces import Arrays, Faces
from granular_contact.robot.types import Vector

_KEPT = 0.95  # of the size, and of the area that is not inside: less is no cure
_FLAT = 0.9  # of the area of a hole: its projection, less is not filled [ours]
_APART = (1e-6, 1e-5, 1e-4)  # of the extent: how far corners lie apart that are welded
_Face = tuple[int, int, int]
Cured = tuple[Arrays, str] | None  # None where there is nothing for a cure to do, or it fails


def mended_mesh(vertices: Vector, faces: Faces, hull: bool = False) -> tuple[Arrays, str]:
    """A mesh without faults in place of one of vertices (n, 3) m and faces (m, 3), as far as the cures go.

    hull: whether one that still has faults is replaced by its convex hull.

    Returns
    -------
    tuple
        The mesh, and what was done and is left, each cure with the volume before and after.
    """
    now, arrays, said = quality(vertices, faces), (vertices, faces), list[str]()
    for cure in (_dropped, _welded, _filled, _turned, _united):
        if cure is not _dropped and _is_sound(now):
            break
        cured = cure(arrays, now)
        after = None if cured is None else quality(*cured[0])
        if cured is None or after is None or not _serves(now, after, cure is not _dropped):
            continue
        said.append(f"{cured[1]}{_volumes(now, after)}")
        now, arrays = after, cured[0]
    if now.faults and hull:
        arrays = _arrays(_mesh(*arrays).convex_hull)
        said.append(f"replaced by its convex hull{_volumes(now, quality(*arrays))}")
        now = quality(*arrays)
    if now.faults:
        why = "; ".join(fault.split("; allowed")[0] for fault in now.faults)
        said.append(f"not mended: {why}" + ("" if hull else "; --hull takes its convex hull"))
    elif now.inner > INNER:
        said.append(f"left: about {100 * now.inner:.0f} % of its area lies inside it")
    return arrays, "; ".join(said) or f"kept, {len(faces)} triangles"


def _is_sound(found: Quality) -> bool:
    return not found.faults and found.inner <= INNER and found.volume > 0.0


def _serves(before: Quality, after: Quality, keeps_area: bool) -> bool:
    """Whether a cure lost nothing but what lay inside, and added no fault.

    keeps_area: not where triangles that are given twice are dropped.
    """
    whole = bool(np.allclose(after.size, before.size, rtol=1.0 - _KEPT))
    if keeps_area and after.area <= _KEPT * before.area * (1.0 - before.inner):
        return False
    return whole and len(after.faults) <= len(before.faults)


def _volumes(before: Quality, after: Quality) -> str:
    return f" (volume {1e6 * before.volume:.4g} to {1e6 * after.volume:.4g} cm3)"


# ---- the cures, in their order ----


def _dropped(arrays: Arrays, _: Quality) -> Cured:
    """Without triangles that have no area, or are given twice."""
    vertices, faces = arrays
    found = _joined(vertices, faces)
    corners, kept = np.asarray(found.vertices, float), np.asarray(found.faces, np.int64)
    empty = int(mesh.without_area(corners, kept).sum())
    left = without_slivers(corners, kept)
    found = _mesh(corners, left)
    found.update_faces(found.unique_faces())
    twice = len(left) - len(found.faces)
    if not (empty or twice) or len(found.faces) == 0:
        return None
    words = [f"{empty} without area"] * (empty > 0) + [f"{twice} given twice"] * (twice > 0)
    return _arrays(found), f"triangles dropped: {' and '.join(words)}"


def without_slivers(vertices: Vector, faces: Faces) -> Faces:
    """Faces without those that have no area, (k, 3); vertices (n, 3) m are joined.

    One that has its three corners on a line closes the mesh between them: the triangle at its longest edge is cut in
    two at the corner between, so that the mesh stays closed and keeps its volume.
    """
    empty = mesh.without_area(vertices, faces)
    if not empty.any():
        return faces
    numbers: list[list[int]] = faces.tolist()
    waiting = {i for i, face in enumerate(numbers) if empty[i] and len(set(face)) == 3}
    left = {i: (face[0], face[1], face[2]) for i, face in enumerate(numbers) if not empty[i] or i in waiting}
    at = {edge: i for i, face in left.items() for edge in _edges(face)}
    while waiting:
        across = {i: at.get(_longest(vertices, left[i])[1::-1]) for i in waiting}
        beside = [i for i, other in across.items() if other not in waiting]
        for i in beside or list(waiting)[:1]:  # two of them back to back become two shorter ones
            a, b, c = _longest(vertices, left.pop(i))
            waiting.discard(i)
            other = at.get((b, a))
            if other is None or not {a, b} <= set(left.get(other, ())):  # where more than two triangles meet
                continue
            (d,) = set(left.pop(other)) - {a, b}
            if c == d:  # the same from the other side
                waiting.discard(other)
                continue
            for number, face in ((other, (b, c, d)), (i, (c, a, d))):
                left[number] = face
                at |= dict.fromkeys(_edges(face), number)
            if other in waiting:
                waiting.add(i)
    return np.array([left[i] for i in sorted(left)], np.int64).reshape(-1, 3)


def _edges(face: _Face) -> list[tuple[int, int]]:
    a, b, c = face
    return [(a, b), (b, c), (c, a)]


def _longest(vertices: Vector, face: _Face) -> _Face:
    """The corners of a face, the ends of its longest edge first."""
    lengths = [float(np.linalg.norm(vertices[b] - vertices[a])) for a, b in _edges(face)]
    turn = int(np.argmax(lengths))
    a, b, c = (face[(turn + k) % 3] for k in range(3))
    return a, b, c


def _welded(arrays: Arrays, now: Quality) -> Cured:
    """With corners joined that lie a little apart, as little as closes it."""
    if now.closed:
        return None
    size = mesh.extent(arrays[0])
    for share in _APART:
        found = _joined(*arrays, digits=int(np.floor(-np.log10(share * size))))
        faces = without_slivers(np.asarray(found.vertices, float), np.asarray(found.faces, np.int64))
        made = np.asarray(found.vertices, float), faces
        if len(faces) and quality(*made).closed:
            return made, f"corners up to {1e3 * share * size:.2g} mm apart welded"
    return None


def _filled(arrays: Arrays, now: Quality) -> Cured:
    """With its holes closed by triangles, and all of them turned outward."""
    from trimesh import repair

    if now.closed:
        return None
    found = _joined(*arrays)
    before = len(found.faces)
    repair.fill_holes(found)
    if not found.is_watertight:
        try:
            fan = repair.stitch(found)  # of holes with more than four corners
            found = _mesh(np.asarray(found.vertices, float), np.vstack([found.faces, fan]))
        except (ValueError, IndexError):  # there is no loop of open edges
            pass
    added = found.faces[before:]
    if len(added) == 0 or not all(map(_is_flat, _mesh(found.vertices, added).split(only_watertight=False))):
        return None
    repair.fix_normals(found, multibody=True)
    return _arrays(found), f"holes filled by {len(added)} triangles"


def _is_flat(patch: Any) -> bool:
    """Whether triangles in the place of a hole span it, and not some surface between far sides of the mesh."""
    return bool(np.linalg.norm(mesh.areas(patch.triangles).sum(axis=0)) > _FLAT * patch.area)


def _turned(arrays: Arrays, now: Quality) -> Cured:
    """With all triangles turned outward."""
    from trimesh import repair

    if now.outward:
        return None
    found = _joined(*arrays)
    repair.fix_normals(found, multibody=True)
    return _arrays(found), "triangles turned outward"


def _united(arrays: Arrays, now: Quality) -> Cured:
    """As one body, without what lies inside; None if its parts can't be united."""
    from trimesh import repair

    if now.faults:
        return None
    try:
        from trimesh import boolean

        parts = _joined(*arrays).split(only_watertight=True)
        for part in parts:
            repair.fix_normals(part)
        united = boolean.union(parts, engine="manifold") if len(parts) > 1 else None
    except (ImportError, ValueError):  # manifold3d is not installed, or refuses the parts
        return None
    if united is None or len(united.faces) == 0 or not _is_sound(quality(*_arrays(united))):
        return None
    return _arrays(united), f"its {len(parts)} parts made one"


# ---- trimesh ----


def _joined(vertices: Vector, faces: Faces, digits: int | None = None) -> Any:
    """The mesh with one number for corners at one place, to so many decimal digits of a metre."""
    found = _mesh(vertices, faces)
    if digits is None:
        low = vertices.min(axis=0)
        numbers = mesh.joined(vertices, faces)
        places = np.zeros((int(numbers.max()) + 1, 3)) + low
        places[numbers.ravel()] = vertices[faces.ravel()]
        return _mesh(places, numbers)
    found.merge_vertices(merge_tex=True, merge_norm=True, digits_vertex=digits)
    return found


def _mesh(vertices: Vector, faces: Faces) -> Any:
    import trimesh

    return trimesh.Trimesh(vertices, faces, process=False)


def _arrays(found: Any) -> Arrays:
    return np.asarray(found.vertices, float), np.asarray(found.faces, np.int64)
