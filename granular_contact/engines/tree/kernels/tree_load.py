"""Forces on a tree of rigid bodies in the medium, with all that acts in its joints, and how they follow its motion."""

from __future__ import annotations

import math

from granular_contact.engines.tree.kernels.tree import inertias, place
from granular_contact.engines.tree.kernels.tree_arrays import (
    BODY,
    EFFORT,
    FORCE,
    GRAVITY,
    KNOTS,
    LAWS,
    NODES,
    PIECES,
    RATES,
    S2,
    SIGNALS,
    STATE,
    STIFFNESS,
    TRIPLETS,
    WANTED,
    S,
    blocks,
    laws_of,
    nodes_of,
    numbers,
    row,
    rows,
)
from granular_contact.engines.tree.kernels.tree_calls import sand_accept, sand_force, sand_tangent
from granular_contact.jit.compiled import part
from granular_contact.jit.memory import clear
from granular_contact.jit.memory import rows as rows_of
from granular_contact.mechanics.kernels.joint_laws import CONTROL, LOAD, RATE_CONTROL, follow, total
from granular_contact.mechanics.kernels.joint_loads import ANCHOR, RATE, VALUE
from granular_contact.mechanics.kernels.signal_tables import look_up
from granular_contact.sand.kernels.lines import difference


@part
def follow_signals(t, w):
    """Let drives want what their signals say at t (s)."""
    wanted, laws, state, signals = rows(w, WANTED), laws_of(w, LAWS), rows(w, STATE), numbers(w, SIGNALS)
    if wanted.shape[0] == 0:
        return
    look_up(t, row(w, KNOTS), blocks(w, PIECES), wanted)
    for i in range(signals.shape[0]):
        k = signals[i]
        if k < 0:
            continue
        value, rate, kind = wanted[k, 0], wanted[k, 1], laws[i].drive
        if kind == LOAD:
            state[i, VALUE] = value
        elif kind == CONTROL:
            state[i, VALUE], state[i, RATE] = value, rate
        elif kind == RATE_CONTROL:
            state[i, VALUE], state[i, RATE] = value, value


@part
def prescribe(of_v, w):
    """Put coordinates that are prescribed where their signals want them.

    Their accelerations are those by which the scheme comes to their rates: where one jumps within a step, all that they
    move would else get half of the jump for the whole step. of_v: see `tree_newton`; 0 at a start.
    """
    nodes, wanted, signals = nodes_of(w, NODES), rows(w, WANTED), numbers(w, SIGNALS)
    s, rates, s2 = row(w, S), row(w, RATES), row(w, S2)
    if wanted.shape[0] == 0:
        return
    for i in range(nodes.shape[0]):
        if nodes[i].prescribed:
            k = signals[i]
            s2[i] = s2[i] + (wanted[k, 1] - rates[i]) / of_v if of_v > 0.0 else wanted[k, 2]
            s[i], rates[i] = wanted[k, 0], wanted[k, 1]


@part
def along(i, s, rate, w):
    """Torque (N m) or force (N) of all that acts along coordinate i."""
    state = rows(w, STATE)
    return total(laws_of(w, LAWS)[i], s, rate, state[i, ANCHOR], state[i, VALUE], state[i, RATE])


@part
def act(w):
    """Place the nodes, and fill the forces on them and along their coordinates."""
    nodes, force, effort, s, rates = nodes_of(w, NODES), rows(w, FORCE), row(w, EFFORT), row(w, S), row(w, RATES)
    place(w)
    clear(force)
    sand_force(w)
    gravity = row(w, GRAVITY)[0]
    for i in range(nodes.shape[0]):
        force[i, 1] -= gravity * nodes[i].mass
        effort[i] = along(i, s[i], rates[i], w) if nodes[i].acts else 0.0


@part
def tangent(fq, fv, w):
    """Fill B and c of `tree` where `act` was called last; by differences, see `lines.differences`."""
    nodes, body, stiffness, triplets = nodes_of(w, NODES), rows(w, BODY), row(w, STIFFNESS), rows(w, TRIPLETS)
    s, rates = row(w, S), row(w, RATES)
    inertias(w)
    for k in range(sand_tangent(fq, fv, w)):
        line, column = int(triplets[k, 0]), int(triplets[k, 1])
        i = line // 3
        body[i, 3 * (line - 3 * i) + column - 3 * i] -= triplets[k, 2]
    for i in range(nodes.shape[0]):
        if nodes[i].acts and not nodes[i].prescribed:
            d = difference(rows_of(s, i, 1), fq, fv)
            stiffness[i] = (along(i, s[i], rates[i], w) - along(i, s[i] + d * fq, rates[i] + d * fv, w)) / d


@part
def accept(w, history, begins):
    """End of a step: anchors follow, forces of the medium and depth go into a history row.

    begins: whether a motion begins here instead, without any stretched bristle.
    """
    nodes, laws, state, s = nodes_of(w, NODES), laws_of(w, LAWS), rows(w, STATE), row(w, S)
    place(w)
    sand_accept(w, history, begins)
    for i in range(nodes.shape[0]):
        if nodes[i].acts and laws[i].friction > 0.0:
            state[i, ANCHOR] = follow(laws[i], s[i], state[i, ANCHOR])


@part
def fastest(change, nodes):
    """Greatest size of changes (n, 3) as those of points: of a centre of mass, or of the rim about it.

    Of twists a speed (m/s). Not finite where one is no number.
    """
    most = 0.0
    for i in range(nodes.shape[0]):
        if nodes[i].mass == 0.0:
            continue
        for k in range(3):
            size = abs(change[i, k]) * (nodes[i].radius if k == 2 else 1.0)
            if not size <= most:
                most = size if size < math.inf else math.inf
    return most
