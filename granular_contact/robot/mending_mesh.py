"""Repairs of a mesh that laws of surfaces can't use, those that change least first; most are trimesh's.

They drop triangles without area or given twice, weld corners that lie apart, fill holes, turn triangles outward, and
unite parts. A repair is kept if it does not make the mesh worse. Once the mesh is sound, no other repair is tried.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from granular_contact.geometry import mesh
from granular_contact.geometry.mesh_quality import INNER, Quality, quality
from granular_contact.robot.surfaces import Arrays, Faces
from granular_contact.robot.types import Vector

_KEPT = 0.95  # of the size, and of the area that is not inside the mesh: a repair has to keep at least this
_FLAT = 0.9  # projected area over area of the triangles in a hole: a hole is not filled below this [ours]
_APART = (1e-6, 1e-5, 1e-4)  # of the extent of a mesh: distances of corners that are welded
_Face = tuple[int, int, int]
Repaired = tuple[Arrays, str] | None  # mesh and sentence; None if there is nothing to repair, or the repair fails


def mended_mesh(vertices: Vector, faces: Faces, hull: bool = False) -> tuple[Arrays, str]:
    """Mend a mesh with vertices (n, 3) m and faces (m, 3), as far as the repairs can.

    hull: whether a mesh that still has faults is replaced by its convex hull.

    Returns
    -------
    tuple
        The mesh, and sentences on the repairs (each with the volume before and after) and on remaining faults.
    """
    current, arrays, report = quality(vertices, faces), (vertices, faces), list[str]()
    for repair in (_drop_triangles, _weld_corners, _fill_holes, _turn_outward, _unite_parts):
        if repair is not _drop_triangles and _is_sound(current):
            break
        repaired = repair(arrays, current)
        after = None if repaired is None else quality(*repaired[0])
        if repaired is None or after is None or not _is_no_worse(current, after, repair is not _drop_triangles):
            continue
        report.append(f"{repaired[1]}{_volumes(current, after)}")
        current, arrays = after, repaired[0]
    if current.faults and hull:
        arrays = _arrays(_mesh(*arrays).convex_hull)
        report.append(f"replaced by its convex hull{_volumes(current, quality(*arrays))}")
        current = quality(*arrays)
    if current.faults:
        why = "; ".join(fault.split("; allowed")[0] for fault in current.faults)
        report.append(f"not mended: {why}" + ("" if hull else "; --hull takes its convex hull"))
    elif current.inner > INNER:
        report.append(f"left: about {100 * current.inner:.0f} % of its area lies inside it")
    return arrays, "; ".join(report) or f"kept, {len(faces)} triangles"


def _is_sound(current: Quality) -> bool:
    return not current.faults and current.inner <= INNER and current.volume > 0.0


def _is_no_worse(before: Quality, after: Quality, keeps_area: bool) -> bool:
    """Whether a repair kept the size, the outer area (if keeps_area), and added no fault.

    keeps_area: False for dropping triangles that are given twice.
    """
    keeps_size = bool(np.allclose(after.size, before.size, rtol=1.0 - _KEPT))
    if keeps_area and after.area <= _KEPT * before.area * (1.0 - before.inner):
        return False
    return keeps_size and len(after.faults) <= len(before.faults)


def _volumes(before: Quality, after: Quality) -> str:
    return f" (volume {1e6 * before.volume:.4g} to {1e6 * after.volume:.4g} cm3)"


# ---- the repairs, in their order ----


def _drop_triangles(arrays: Arrays, _: Quality) -> Repaired:
    """Drop triangles without area and triangles that are given twice."""
    welded = _welded(*arrays)
    vertices, faces = np.asarray(welded.vertices, float), np.asarray(welded.faces, np.int64)
    empty = int(mesh.without_area(vertices, faces).sum())
    with_area = without_slivers(vertices, faces)
    result = _mesh(vertices, with_area)
    result.update_faces(result.unique_faces())
    twice = len(with_area) - len(result.faces)
    if not (empty or twice) or len(result.faces) == 0:
        return None
    words = [f"{empty} without area"] * (empty > 0) + [f"{twice} given twice"] * (twice > 0)
    return _arrays(result), f"triangles dropped: {' and '.join(words)}"


def without_slivers(vertices: Vector, faces: Faces) -> Faces:
    """Faces (k, 3) without triangles that have no area; vertices (n, 3) m are welded.

    A sliver is a triangle with three distinct corners on a line, which connects its neighbours. To remove it, the
    triangle across its longest edge is cut in two at the corner between the ends of that edge. The mesh stays closed
    and keeps its volume.
    """
    empty = mesh.without_area(vertices, faces)
    if not empty.any():
        return faces
    corners: list[list[int]] = faces.tolist()
    slivers = {i for i, face in enumerate(corners) if empty[i] and len(set(face)) == 3}
    kept = {i: (face[0], face[1], face[2]) for i, face in enumerate(corners) if not empty[i] or i in slivers}
    face_at = {edge: i for i, face in kept.items() for edge in _edges(face)}
    while slivers:
        across = {i: face_at.get(_longest_edge_first(vertices, kept[i])[1::-1]) for i in slivers}
        beside_area = [i for i, other in across.items() if other not in slivers]
        for i in beside_area or list(slivers)[:1]:  # two slivers back to back become two shorter ones
            a, b, c = _longest_edge_first(vertices, kept.pop(i))
            slivers.discard(i)
            other = face_at.get((b, a))
            if other is None or not {a, b} <= set(kept.get(other, ())):  # more than two triangles meet at the edge
                continue
            (d,) = set(kept.pop(other)) - {a, b}
            if c == d:  # the same triangle with the opposite direction
                slivers.discard(other)
                continue
            for number, face in ((other, (b, c, d)), (i, (c, a, d))):
                kept[number] = face
                face_at |= dict.fromkeys(_edges(face), number)
            if other in slivers:
                slivers.add(i)
    return np.array([kept[i] for i in sorted(kept)], np.int64).reshape(-1, 3)


def _edges(face: _Face) -> list[tuple[int, int]]:
    a, b, c = face
    return [(a, b), (b, c), (c, a)]


def _longest_edge_first(vertices: Vector, face: _Face) -> _Face:
    """Corners of a face, rotated so that the ends of its longest edge come first."""
    lengths = [float(np.linalg.norm(vertices[b] - vertices[a])) for a, b in _edges(face)]
    first = int(np.argmax(lengths))
    a, b, c = (face[(first + k) % 3] for k in range(3))
    return a, b, c


def _weld_corners(arrays: Arrays, current: Quality) -> Repaired:
    """Weld corners that lie a little apart, with the smallest distance that closes the mesh."""
    if current.closed:
        return None
    size = mesh.extent(arrays[0])
    for share in _APART:
        welded = _welded(*arrays, digits=int(np.floor(-np.log10(share * size))))
        faces = without_slivers(np.asarray(welded.vertices, float), np.asarray(welded.faces, np.int64))
        result = np.asarray(welded.vertices, float), faces
        if len(faces) and quality(*result).closed:
            return result, f"corners up to {1e3 * share * size:.2g} mm apart welded"
    return None


def _fill_holes(arrays: Arrays, current: Quality) -> Repaired:
    """Fill holes by triangles, and turn all triangles outward."""
    from trimesh import repair

    if current.closed:
        return None
    result = _welded(*arrays)
    before = len(result.faces)
    repair.fill_holes(result)
    if not result.is_watertight:
        try:
            fan = repair.stitch(result)  # of holes with more than four corners
            result = _mesh(np.asarray(result.vertices, float), np.vstack([result.faces, fan]))
        except (ValueError, IndexError):  # there is no loop of open edges
            pass
    added = result.faces[before:]
    if len(added) == 0 or not all(map(_is_flat, _mesh(result.vertices, added).split(only_watertight=False))):
        return None
    repair.fix_normals(result, multibody=True)
    return _arrays(result), f"holes filled by {len(added)} triangles"


def _is_flat(patch: Any) -> bool:
    """Whether the triangles that fill a hole are nearly flat; others would connect far sides of the mesh."""
    return bool(np.linalg.norm(mesh.areas(patch.triangles).sum(axis=0)) > _FLAT * patch.area)


def _turn_outward(arrays: Arrays, current: Quality) -> Repaired:
    """Turn all triangles outward."""
    from trimesh import repair

    if current.outward:
        return None
    result = _welded(*arrays)
    repair.fix_normals(result, multibody=True)
    return _arrays(result), "triangles turned outward"


def _unite_parts(arrays: Arrays, current: Quality) -> Repaired:
    """Unite the parts of a mesh to one body without inner surfaces; None if they can't be united."""
    from trimesh import repair

    if current.faults:
        return None
    try:
        from trimesh import boolean

        parts = _welded(*arrays).split(only_watertight=True)
        for part in parts:
            repair.fix_normals(part)
        united = boolean.union(parts, engine="manifold") if len(parts) > 1 else None
    except (ImportError, ValueError):  # manifold3d is not installed, or refuses the parts
        return None
    if united is None or len(united.faces) == 0 or not _is_sound(quality(*_arrays(united))):
        return None
    return _arrays(united), f"its {len(parts)} parts made one"


# ---- trimesh ----


def _welded(vertices: Vector, faces: Faces, digits: int | None = None) -> Any:
    """Mesh of trimesh with corners at the same place welded.

    digits: decimal digits of a metre that have to agree; None: places as in `geometry.mesh.joined`.
    """
    result = _mesh(vertices, faces)
    if digits is None:
        low = vertices.min(axis=0)
        welded_faces = mesh.joined(vertices, faces)
        welded_vertices = np.zeros((int(welded_faces.max()) + 1, 3)) + low
        welded_vertices[welded_faces.ravel()] = vertices[faces.ravel()]
        return _mesh(welded_vertices, welded_faces)
    result.merge_vertices(merge_tex=True, merge_norm=True, digits_vertex=digits)
    return result


def _mesh(vertices: Vector, faces: Faces) -> Any:
    import trimesh

    return trimesh.Trimesh(vertices, faces, process=False)


def _arrays(trimesh_mesh: Any) -> Arrays:
    return np.asarray(trimesh_mesh.vertices, float), np.asarray(trimesh_mesh.faces, np.int64)
