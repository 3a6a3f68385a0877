"""Bounds for the depth and the speed of approach of clusters of elements, and release of their anchors.

Arguments as in `space_bodies` and `space_law`. ball: record with a bounding sphere, of a cluster or of a body; near
(2,) or more: DEEPEST and APPROACH of `proximity`.
"""

from __future__ import annotations

from granular_contact.jit.compiled import part
from granular_contact.jit.memory import room1
from granular_contact.sand.kernels import space_law as law
from granular_contact.sand.kernels.ground import GROWTH, PLANE, RISE_X, RISE_Y, surface_at
from granular_contact.sand.kernels.proximity import APPROACH, DEEPEST
from granular_contact.sand.kernels.vectors import axes, norm, plus, plus_cross, put, turned, turned_back, xyz


@part
def depth_of(ball, pose, ground, medium):
    """Depth (m) of the centre of a bounding sphere, and its position (3,) m from the reference point of the body."""
    r = turned(axes(pose), (ball.x, ball.y, ball.z))
    x, y, z = plus(pose[law.POSITION], r)
    return surface_at(x, y, ground, medium, room1(PLANE)) - z, r


@part
def bound(ball, pose, ground, medium, near):
    """Fill near[DEEPEST] and near[APPROACH] with upper bounds for all points in a bounding sphere."""
    depth, r = depth_of(ball, pose, ground, medium)
    w = xyz(pose[law.SPIN])
    near[DEEPEST] = depth + ball.radius * ground[GROWTH]
    near[APPROACH] = (norm(plus_cross(pose[law.VELOCITY], w, r)) + norm(w) * ball.radius) * ground[GROWTH]


@part
def bound_cluster(cluster, pose, ground, medium, near):
    """`bound` of a cluster, by its box where the box reaches less deep than the sphere."""
    bound(cluster, pose, ground, medium, near)
    near[DEEPEST] = min(near[DEEPEST], reach_below(cluster, pose, ground, medium))


@part
def reach_below(cluster, pose, ground, medium):
    """Upper bound of the depth (m) of a cluster.

    Below a plane surface: depth of the deepest corner of its box. Below a map of heights: bound by its sphere and the
    steepest slope of the map.
    """
    depth = depth_of(cluster, pose, ground, medium)[0]
    if medium.heights != 0:
        return depth + cluster.radius * ground[GROWTH]
    dx, dy, dz = turned_back(axes(pose), (ground[RISE_X], ground[RISE_Y], -1.0))
    return depth + abs(dx) * cluster.along_x + abs(dy) * cluster.along_y + abs(dz) * cluster.along_z


@part
def release(elements, anchors, cluster, pose, medium, anew):
    """Put the anchors of a cluster at its elements; anew: the paths of its elements begin here, too.

    The path through the air counts as a straight line, so that it does not matter when the cluster became active.
    """
    for i in range(cluster.first, cluster.last):
        put(plus(pose[law.POSITION], turned(axes(pose), elements[i])), anchors, i, 0)
    if medium.begin != 0:
        law.begin(medium, (anchors, cluster.first, cluster.last, anew))
