"""A ball in space: one force at its centre, as in `balls`. Its row of `elements` is its centre (m)."""

from __future__ import annotations

import math

from granular_contact.jit.compiled import part
from granular_contact.jit.memory import clear, room1, room2, rows
from granular_contact.sand.kernels import space_law as law
from granular_contact.sand.kernels.bars import add, station
from granular_contact.sand.kernels.ground import PLANE, surface_at
from granular_contact.sand.kernels.law import TERMS


@part
def space_ball_forces(elements, anchors, cluster, pose, ground, medium, W):
    """`space_law.forces` of a ball; its depth is that of its lowest point, as in the plane."""
    x = pose[3]
    p, v, f = room1(3), room1(3), room2(TERMS, 3)
    clear(f)
    station(elements[0], x, pose[4], pose[5], rows(pose, 0, 3), p, v)
    z = surface_at(p[0], p[1], ground, medium, room1(PLANE)) - p[2] + 0.5 * cluster.width
    if z <= 0.0:
        return
    e = p[0] - anchors[0, 0], p[1] - anchors[0, 1], p[2] - anchors[0, 2]
    law.ball_force(medium, (z, (v[0], v[1], v[2]), e, cluster, f))
    for term in range(TERMS):
        add(f[term], p[0] - x[0], p[1] - x[1], p[2] - x[2], W, term)


@part
def follow_ball(elements, anchors, cluster, pose, ground, medium, row):
    """`space_law.follow` of a ball."""
    p, v = room1(3), room1(3)
    station(elements[0], pose[3], pose[4], pose[5], rows(pose, 0, 3), p, v)
    px, py, pz = p[0], p[1], p[2]
    z = surface_at(px, py, ground, medium, room1(PLANE)) - pz + 0.5 * cluster.width
    row[law.DEPTH] = max(row[law.DEPTH], z)
    if z > 0.0:
        row[law.SPEED] = max(row[law.SPEED], math.sqrt(v[0] ** 2 + v[1] ** 2 + v[2] ** 2))
        row[law.LOWEST] = min(row[law.LOWEST], pz - 0.5 * cluster.width)
        px, py, pz = law.drag_anchor(medium, ((px, py, pz), (anchors[0, 0], anchors[0, 1], anchors[0, 2])))
    anchors[0, 0], anchors[0, 1], anchors[0, 2] = px, py, pz
