"""A ball in the medium: one force at its centre, by a law of its depth and velocity.

Kernels of lines treat it as a strip without length: two stations at its centre, of which the first takes the force.
"""

from __future__ import annotations

from granular_contact.jit.compiled import part
from granular_contact.jit.memory import clear, room2
from granular_contact.sand.kernels import law
from granular_contact.sand.kernels.law import TERMS
from granular_contact.sand.kernels.path_length import path_length
from granular_contact.sand.kernels.scatter import factor
from granular_contact.sand.kernels.surface import height


@part
def ball_forces(P, V, anchors, line, profile, medium, F, totals):
    """`law.forces` of a ball."""
    clear(F)
    x, y = P[0, 0], P[0, 1]
    z = height(profile, x)[0] - y + line.drop
    if z <= 0.0:
        return
    f = room2(TERMS, 2)
    clear(f)
    v, e = (V[0, 0], V[0, 1]), (x - anchors[0, 0], y - anchors[0, 1])
    law.ball_force(z, v, e, line, medium, f)
    share = factor(path_length(P, anchors, 0), line.place, line.width, line) if line.scatter > 0.0 else 1.0
    for term in range(TERMS):
        k = share if (line.static >> term) & 1 else 1.0
        fx, fy = k * f[term, 0], k * f[term, 1]
        F[0, 0] += fx
        F[0, 1] += fy
        totals[term, 0] += fx
        totals[term, 1] += fy
        totals[term, 2] += x * fy - y * fx
