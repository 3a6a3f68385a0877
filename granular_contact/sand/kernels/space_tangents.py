"""Tangent of the forces on a body in space by its coordinates and rates: two forms of `space_law.tangent`."""

from __future__ import annotations

from granular_contact.jit.compiled import part
from granular_contact.jit.memory import clear, room1, room2, rows
from granular_contact.sand.kernels import space_law as law
from granular_contact.sand.kernels.law import TERMS
from granular_contact.sand.kernels.lines import difference
from granular_contact.sand.kernels.space_bodies import place
from granular_contact.sand.kernels.space_clusters import reach_below


@part
def by_differences(q, v, body, w, medium, fq, fv, K, W):
    """`space_law.tangent` by differences of the forces on a body, see `lines.differences`."""
    at_state, moved, pose, other = room1(7), room1(7), room2(6, 3), room2(TERMS, 6)
    if not law.body_forces(medium, (q, v, body, w, pose, W, at_state)):
        return False
    d = difference(rows(q, 0, body.size), fq, fv)
    for j in range(body.size):
        q_j, v_j = q[j], v[j]
        q[j] += d * fq
        v[j] += d * fv
        law.body_forces(medium, (q, v, body, w, pose, other, moved))
        q[j], v[j] = q_j, v_j
        for i in range(body.size):
            K[i, j] = (moved[i] - at_state[i]) / d
    return True


@part
def by_elements(q, v, body, w, medium, fq, fv, K, W):
    """`space_law.tangent` by the tangents S (6, 6) of the wrench on each cluster: T^T S T, with (x, t) = T q."""
    turn, clusters, active, ground = w.turn, w.clusters, w.active, w.ground
    elements, anchors = w.elements, w.anchors
    pose, G, S, T, loaded = room2(6, 3), room2(3, 4), room2(6, 6), room2(6, 7), False
    place(q, v, body, turn, medium, pose, G)
    clear(S)
    clear(W)
    for c in range(body.first, body.last):
        if active[c] and reach_below(clusters[c], pose, ground, medium) > 0.0:
            s, n = clusters[c].first, clusters[c].last - clusters[c].first
            law.slopes(medium, (rows(elements, s, n), rows(anchors, s, n), clusters[c], pose, ground, fq, fv, S, W))
            loaded = True
    clear(T)
    for i in range(3):
        for j in range(3):
            T[i, j] = turn[i, j]
            for k in range(body.size - 3):
                T[3 + i, 3 + k] += turn[i, j] * G[j, k]
    for i in range(body.size):
        for j in range(body.size):
            K[i, j] = 0.0
            for a in range(6):
                along = 0.0
                for b in range(6):
                    along += S[a, b] * T[b, j]
                K[i, j] += T[a, i] * along
    return loaded
