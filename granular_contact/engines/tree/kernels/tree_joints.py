"""Efforts along the coordinates of a tree, in the plane or in space: drives, prescribed motions, laws of joints."""

from __future__ import annotations

from granular_contact.jit.compiled import part
from granular_contact.jit.memory import rows as rows_of
from granular_contact.mechanics.kernels import joint_laws
from granular_contact.mechanics.kernels.joint_laws import CONTROL, LOAD, RATE_CONTROL, total
from granular_contact.mechanics.kernels.signal_tables import look_up
from granular_contact.sand.kernels.lines import difference


@part
def evaluate_signals(t, w):
    """Set the targets of the drives to the values of their signals at t (s)."""
    wanted, laws, state, signals = w.wanted, w.laws, w.state, w.signals
    if wanted.shape[0] == 0:
        return
    look_up(t, w.knots, w.pieces, wanted)
    for i in range(signals.shape[0]):
        k = signals[i]
        if k < 0:
            continue
        value, rate, kind = wanted[k].value, wanted[k].rate, laws[i].drive
        if kind == LOAD:
            state[i].target = value
        elif kind == CONTROL:
            state[i].target, state[i].target_rate = value, rate
        elif kind == RATE_CONTROL:
            state[i].target, state[i].target_rate = value, value


@part
def prescribe(of_v, w):
    """Set prescribed coordinates and their rates to the values of their signals.

    Their accelerations are those by which the time scheme reaches these rates. Where a rate jumps within a step, other
    accelerations would put half of the jump, for the whole step, on all bodies that the coordinate moves. of_v: see
    `tree_newton`; 0 at the start of a motion.
    """
    prescribed, wanted, signals = w.prescribed, w.wanted, w.signals
    s, rates, s2 = w.s, w.rates, w.s2
    if wanted.shape[0] == 0:
        return
    for i in range(prescribed.shape[0]):
        if prescribed[i]:
            k = signals[i]
            s2[i] = s2[i] + (wanted[k].rate - rates[i]) / of_v if of_v > 0.0 else wanted[k].acceleration
            s[i], rates[i] = wanted[k].value, wanted[k].rate


@part
def effort(i, s, rate, w):
    """Torque (N m) or force (N) of the law and the drive of coordinate i, at its value s and its rate."""
    state = w.state[i]
    return total(w.laws[i], s, rate, state.anchor, state.target, state.target_rate)


@part
def coordinate_efforts(w):
    """Fill the efforts along all coordinates."""
    acts, efforts, s, rates = w.acts, w.effort, w.s, w.rates
    for i in range(acts.shape[0]):
        efforts[i] = effort(i, s[i], rates[i], w) if acts[i] else 0.0


@part
def joint_stiffness(fq, fv, w):
    """Fill c of `tree` where an effort acts; by finite differences, see `lines.differences`."""
    acts, prescribed, stiffness = w.acts, w.prescribed, w.stiffness
    s, rates = w.s, w.rates
    for i in range(acts.shape[0]):
        if acts[i] and not prescribed[i]:
            d = difference(rows_of(s, i, 1), fq, fv)
            stiffness[i] = (effort(i, s[i], rates[i], w) - effort(i, s[i] + d * fq, rates[i] + d * fv, w)) / d


@part
def move_anchors(w):
    """End of a step: move the anchors of dry friction (return mapping)."""
    acts, laws, state, s = w.acts, w.laws, w.state, w.s
    for i in range(acts.shape[0]):
        if acts[i] and laws[i].friction > 0.0:
            state[i].anchor = joint_laws.follow(laws[i], s[i], state[i].anchor)
