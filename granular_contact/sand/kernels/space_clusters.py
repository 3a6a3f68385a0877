"""How deep clusters of elements may be, whether they may touch the surface, and anchors of those that do not.

Arguments as of `space_bodies` and `space_law`; one: a cluster; near (2,) or more: of proximity.
"""

from __future__ import annotations

import math

from granular_contact.jit.compiled import part
from granular_contact.jit.memory import room1
from granular_contact.sand.kernels import space_law as law
from granular_contact.sand.kernels.ground import PLANE, surface_at
from granular_contact.sand.kernels.proximity import APPROACH, DEEPEST
from granular_contact.sand.kernels.vectors import axes, dot, seen, turned


@part
def depth_of(x, y, z, pose, ground, medium):
    """Depth (m) of a point (3,) m of a body, and where it is from the body's reference point, frame of the bed."""
    rx, ry, rz = turned(axes(pose), (x, y, z))
    height = surface_at(pose[3, 0] + rx, pose[3, 1] + ry, ground, medium, room1(PLANE))
    return height - pose[3, 2] - rz, rx, ry, rz


@part
def bound(x, y, z, radius, pose, ground, medium, near):
    """Fill near[DEEPEST] and near[APPROACH] with bounds for all that lies in a sphere (m) of a body."""
    depth, x, y, z = depth_of(x, y, z, pose, ground, medium)
    vx = pose[4, 0] + pose[5, 1] * z - pose[5, 2] * y
    vy = pose[4, 1] + pose[5, 2] * x - pose[5, 0] * z
    vz = pose[4, 2] + pose[5, 0] * y - pose[5, 1] * x
    w = pose[5, 0], pose[5, 1], pose[5, 2]
    spin = math.sqrt(dot(w, w))
    near[DEEPEST] = depth + radius * ground[3]
    near[APPROACH] = (math.sqrt(vx * vx + vy * vy + vz * vz) + spin * radius) * ground[3]


@part
def bound_cluster(one, pose, ground, medium, near):
    """`bound` for all that lies in a cluster, whose box may reach less deep than its sphere."""
    bound(one.x, one.y, one.z, one.radius, pose, ground, medium, near)
    near[DEEPEST] = min(near[DEEPEST], reach_below(one, pose, ground, medium))


@part
def reach_below(one, pose, ground, medium):
    """Bound for the depth (m) of a cluster.

    Of a plane surface that of the deepest corner of its box; of a map of heights that of its sphere, where the surface
    is steepest.
    """
    depth = depth_of(one.x, one.y, one.z, pose, ground, medium)[0]
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
        E = elements[i]
        for k in range(3):
            anchors[i, k] = pose[3, k] + pose[k, 0] * E[0] + pose[k, 1] * E[1] + pose[k, 2] * E[2]
    if medium.begin != 0:
        law.begin(medium, (anchors, cluster.first, cluster.last, anew))
