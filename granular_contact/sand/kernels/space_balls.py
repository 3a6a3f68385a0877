"""A ball in space: one force at its centre, as in `balls`. Its row of `elements` is the centre (m)."""

from __future__ import annotations

from granular_contact.jit.compiled import part
from granular_contact.jit.memory import clear, room2
from granular_contact.sand.kernels import space_law as law
from granular_contact.sand.kernels.bars import add, station
from granular_contact.sand.kernels.law import TERMS
from granular_contact.sand.kernels.vectors import at, minus, norm, put


@part
def space_ball_forces(elements, anchors, cluster, pose, ground, medium, W):
    """`space_law.forces` of a ball; its depth is the depth of its lowest point, as in the plane."""
    x = pose[law.POSITION]
    p, v, z = station(elements[0], pose, ground, medium)
    z += 0.5 * cluster.width
    if z <= 0.0:
        return
    f = room2(TERMS, 3)
    clear(f)
    law.ball_force(medium, (z, v, minus(p, anchors[0]), cluster, f))
    for term in range(TERMS):
        add(f[term], minus(p, x), W, term)


@part
def follow_ball(elements, anchors, cluster, pose, ground, medium, row):
    """`space_law.follow` of a ball."""
    p, v, z = station(elements[0], pose, ground, medium)
    z += 0.5 * cluster.width
    row[law.DEPTH] = max(row[law.DEPTH], z)
    if z > 0.0:
        row[law.SPEED] = max(row[law.SPEED], norm(v))
        row[law.LOWEST] = min(row[law.LOWEST], p[2] - 0.5 * cluster.width)
        p = law.drag_anchor(medium, (p, at(anchors, 0, 0)))
    put(p, anchors, 0, 0)
