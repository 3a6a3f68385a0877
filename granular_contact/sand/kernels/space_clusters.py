"""How deep clusters of elements may be, whether they may touch the surface, and anchors of those that do not.

Arguments as of `space_bodies` and `space_law`; one: a cluster; near (2,) or more: of proximity.
"""

from __future__ import annotations

from granular_contact.jit.compiled import part
from granular_contact.jit.memory import room1
from granular_contact.sand.kernels import space_law as law
from granular_contact.sand.kernels.ground import PLANE, surface_at
from granular_contact.sand.kernels.proximity import APPROACH, DEEPEST
from granular_contact.sand.kernels.vectors import axes, moving, norm, plus, put, seen, turned, vector


@part
def depth_of(one, pose, ground, medium):
    """Depth (m) of the middle of a cluster, or of a body, and where it is (3,) m from the body's reference point."""
    r = turned(axes(pose), (one.x, one.y, one.z))
    x, y, z = plus(pose[3], r)
    return surface_at(x, y, ground, medium, room1(PLANE)) - z, r


@part
def bound(one, pose, ground, medium, near):
    """Fill near[DEEPEST] and near[APPROACH] with bounds for all that lies in the sphere of a cluster, or of a body."""
    depth, r = depth_of(one, pose, ground, medium)
    w = vector(pose[5], 0)
    near[DEEPEST] = depth + one.radius * ground[3]
    near[APPROACH] = (norm(moving(pose[4], w, r)) + norm(w) * one.radius) * ground[3]


@part
def bound_cluster(one, pose, ground, medium, near):
    """`bound` for all that lies in a cluster, whose box may reach less deep than its sphere."""
    bound(one, pose, ground, medium, near)
    near[DEEPEST] = min(near[DEEPEST], reach_below(one, pose, ground, medium))


@part
def reach_below(one, pose, ground, medium):
    """Bound for the depth (m) of a cluster.

    Of a plane surface that of the deepest corner of its box; of a map of heights that of its sphere, where the surface
    is steepest.
    """
    depth = depth_of(one, pose, ground, medium)[0]
    if medium.heights != 0:
        return depth + one.radius * ground[3]
    dx, dy, dz = seen(axes(pose), (ground[1], ground[2], -1.0))
    return depth + abs(dx) * one.along_x + abs(dy) * one.along_y + abs(dz) * one.along_z


@part
def release(elements, anchors, cluster, pose, medium, anew):
    """Put the anchors of a cluster where its elements are; anew: their paths begin here, too.

    The path through the air counts in a straight line, so that it does not matter when what flies became active.
    """
    for i in range(cluster.first, cluster.last):
        put(plus(pose[3], turned(axes(pose), elements[i])), anchors, i, 0)
    if medium.begin != 0:
        law.begin(medium, (anchors, cluster.first, cluster.last, anew))
