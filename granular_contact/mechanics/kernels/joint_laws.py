"""Forces along the coordinate of a joint: stops, dry friction and drives, as a solve and its history need them.

What of a joint they read are the fields of its record, see `joint_loads.JOINT`: those of `scene.types.JointLaw`, and
of its drive. s: coordinate (rad clockwise, or m), rate: its rate. Forces are torques (N m) or forces (N) along s.
"""

from __future__ import annotations

import math

import numpy as np

from granular_contact.jit.compiled import kernel, part

# What a drive is: none, a torque or force over time, a control of the coordinate, a control of its rate.
NO_DRIVE, LOAD, CONTROL, RATE_CONTROL = 0, 1, 2, 3


@part
def stop(joint, s, rate):
    """Elastic part of the force of the stops, and the whole force. It pushes only."""
    back = joint.upper - s if s > joint.upper else joint.lower - s if s < joint.lower else 0.0
    elastic = joint.stop_stiffness * back
    # Hunt and Crossley: the faster it gets deeper, the harder; what would pull back is left out.
    return elastic, elastic * max(0.0, 1.0 - joint.dissipation * math.copysign(1.0, back) * rate)


@part
def friction(joint, s, rate, anchor):
    """Dry friction of a bristle that is held at its anchor."""
    strain = (s - anchor + joint.damping_time * rate) / joint.slip
    return -joint.friction * min(1.0, max(-1.0, strain))


@part
def follow(joint, s, anchor):
    """Anchor of the bristle after a step that ended at s."""
    return min(max(anchor, s - joint.slip), s + joint.slip)


@part
def drive_force(joint, value, value_rate, s, rate):
    """Force of a drive that wants a value and a rate."""
    if joint.drive == LOAD:
        return value
    force = joint.rate_gain * (value_rate - rate)
    if joint.drive == CONTROL:
        force += joint.gain * (value - s)
    return min(joint.limit, max(-joint.limit, force))


@part
def total(joint, s, rate, anchor, value, value_rate):
    """All that acts along the coordinate."""
    force = -joint.stiffness * (s - joint.rest) - joint.damping * rate
    if joint.stop_stiffness > 0.0:
        force += stop(joint, s, rate)[1]
    if joint.friction > 0.0:
        force += friction(joint, s, rate, anchor)
    if joint.drive != NO_DRIVE:
        force += drive_force(joint, value, value_rate, s, rate)
    return force


# ---- over all rows of a history ----


@kernel(allocates=True)
def stops(joint, s, rate):
    """Elastic part and whole of the force of the stops, (2, n), at coordinates s (n,) and rates (n,)."""
    forces = np.zeros((2, s.shape[0]))
    for i in range(s.shape[0]):
        forces[0, i], forces[1, i] = stop(joint[0], s[i], rate[i])
    return forces


@kernel(allocates=True)
def frictions(joint, s, rate, anchor):
    """Dry friction (n,), its anchor led along from row to row."""
    forces = np.zeros(s.shape[0])
    for i in range(s.shape[0]):
        forces[i] = friction(joint[0], s[i], rate[i], anchor)
        anchor = follow(joint[0], s[i], anchor)
    return forces


@kernel(allocates=True)
def drive_forces(joint, targets, s, rate):
    """Force (n,) of a drive towards values and rates, targets (n, 2)."""
    forces = np.zeros(s.shape[0])
    for i in range(s.shape[0]):
        forces[i] = drive_force(joint[0], targets[i, 0], targets[i, 1], s[i], rate[i])
    return forces
