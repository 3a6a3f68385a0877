"""`space_sand` for a bed with walls: the history also has the extent of the immersed elements."""

from __future__ import annotations

from granular_contact.jit.compiled import kernel, part
from granular_contact.jit.memory import piece, room1, room2, rows
from granular_contact.sand.kernels import space_law as law
from granular_contact.sand.kernels import space_sand
from granular_contact.sand.kernels.facet_records import COLUMNS, RIM, TRIANGLE, as_facets
from granular_contact.sand.kernels.ground import PLANE, surface_at
from granular_contact.sand.kernels.lines import LEFT
from granular_contact.sand.kernels.space_bodies import view
from granular_contact.sand.kernels.space_sand import force, soonest, tangent, update_active
from granular_contact.sand.kernels.vectors import at, axes, plus, turned

__all__ = ["accept", "force", "soonest", "tangent", "update_active"]


@kernel
def accept(sand, system_q, system_v, row, begins):
    """`space_sand.accept`; unless a solve begins, also update the extent of the immersed elements in the row."""
    space_sand.accept(sand, system_q, system_v, row, begins)
    if begins:
        return
    for b in range(sand.shape[0]):
        w = view(piece(sand, b, sand.shape[1]))
        reach(w, rows(row, LEFT, 4))


@part
def reach(w, row):
    """Update row (4,): least x, least y, greatest x, greatest y (m) of immersed elements; w: a view of `space_bodies`.

    Facets reach to their immersed corners, bars half a diameter around their immersed stations, balls to their equator.
    """
    plane, points = room1(PLANE), room2(4, 3)
    bodies, clusters, elements, active = w.bodies, w.clusters, w.elements, w.active
    ground, medium, poses = w.ground, w.medium, w.poses
    for b in range(bodies.shape[0]):
        pose = poses[b]
        for c in range(bodies[b].first, bodies[b].last):
            if not active[c]:
                continue
            cluster = clusters[c]
            beside = 0.5 * cluster.width
            drop = beside if cluster.mass > 0.0 else 0.0
            for i in range(cluster.first, cluster.last):
                for p in range(corners(elements, i, points)):
                    x, y, z = plus(at(pose, law.POSITION, 0), turned(axes(pose), points[p]))
                    if surface_at(x, y, ground, medium[0], plane) - z + drop > 0.0:
                        row[0], row[1] = min(row[0], x - beside), min(row[1], y - beside)
                        row[2], row[3] = max(row[2], x + beside), max(row[3], y + beside)


@part
def corners(elements, i, points):
    """Fill points (4, 3) m, frame of the body, with the corners of element i, and return their number."""
    if elements.shape[1] != COLUMNS:
        points[0, 0], points[0, 1], points[0, 2] = elements[i, 0], elements[i, 1], elements[i, 2]
        return 1
    facet = as_facets(elements)[i]
    if facet.form == RIM:
        return 0
    four = facet.form != TRIANGLE
    for k in range(3):
        x, a, b = facet.centroid[k], facet.a[k], facet.b[k]
        points[0, k], points[1, k], points[2, k] = x + a, x + b, x - a - b
        if four:
            points[0, k], points[1, k], points[3, k] = x + a + b, x + a - b, x - a + b
    return 4 if four else 3
