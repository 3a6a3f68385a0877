"""Forces along the coordinate of a joint: stops, dry friction and drives, as a solve and its history need them.

What of a joint they read are the fields of its record, see `joint_loads.JOINT`: those of `scene.types.JointLaw`, and
of its drive. s: coordinate (rad clockwise, or m), rate: its rate. Forces are torques (N m) or forces (N) along s.
"""

from __future__ import annotations

import math

import numpy as np

from granular_contact.kernels.compiled import kernel, part

# What a drive is: none, a torque or force over time, a control of the coordinate, a control of its rate.
NO_DRIVE, LOAD, CONTROL, RATE_CONTROL = 0, 1, 2, 3


@part
def stop(joint, s, rate):
    """Elastic part of the force of the stops; the whole force, and its derivatives by s and rate. It pushes only."""
    depth = s - joint.upper if s > joint.upper else s - joint.lower if s < joint.lower else 0.0
    if depth == 0.0:
        return 0.0, 0.0, 0.0, 0.0
    elastic, sense = -joint.stop_stiffness * depth, math.copysign(1.0, depth)
    # Hunt and Crossley: the faster it gets deeper, the harder; what would pull back is left out.
    factor = 1.0 + joint.dissipation * sense * rate
    if factor <= 0.0:
        return elastic, 0.0, 0.0, 0.0
    return elastic, elastic * factor, -joint.stop_stiffness * factor, elastic * joint.dissipation * sense


@part
def friction(joint, s, rate, anchor):
    """Dry friction of a bristle that is held at its anchor, and its derivatives by s and rate."""
    strain = (s - anchor + joint.damping_time * rate) / joint.slip
    if abs(strain) >= 1.0:
        return -math.copysign(joint.friction, strain), 0.0, 0.0
    slope = -joint.friction / joint.slip
    return -joint.friction * strain, slope, slope * joint.damping_time


@part
def follow(joint, s, anchor):
    """Anchor of the bristle after a step that ended at s."""
    return min(max(anchor, s - joint.slip), s + joint.slip)


@part
def drive_force(joint, value, value_rate, s, rate):
    """Force of a drive that wants a value and a rate, and its derivatives by s and rate."""
    if joint.drive == LOAD:
        return value, 0.0, 0.0
    force, by_place = joint.rate_gain * (value_rate - rate), 0.0
    if joint.drive == CONTROL:
        force += joint.gain * (value - s)
        by_place = -joint.gain
    if abs(force) >= joint.limit:
        return math.copysign(joint.limit, force), 0.0, 0.0
    return force, by_place, -joint.rate_gain


@part
def total(joint, s, rate, anchor, value, value_rate):
    """All that acts along the coordinate, and its derivatives by s and rate."""
    force, by_place, by_rate = 0.0, 0.0, 0.0
    if joint.stiffness > 0.0 or joint.damping > 0.0:
        force = -joint.stiffness * (s - joint.rest) - joint.damping * rate
        by_place, by_rate = -joint.stiffness, -joint.damping
    if joint.stop_stiffness > 0.0:
        _, f, a, b = stop(joint, s, rate)
        force, by_place, by_rate = force + f, by_place + a, by_rate + b
    if joint.friction > 0.0:
        f, a, b = friction(joint, s, rate, anchor)
        force, by_place, by_rate = force + f, by_place + a, by_rate + b
    if joint.drive != NO_DRIVE:
        f, a, b = drive_force(joint, value, value_rate, s, rate)
        force, by_place, by_rate = force + f, by_place + a, by_rate + b
    return force, by_place, by_rate


# ---- over all rows of a history ----


@kernel
def stops(joint, s, rate):
    """Elastic part and whole of the force of the stops, (2, n), at coordinates s (n,) and rates (n,)."""
    forces = np.zeros((2, s.shape[0]))
    for i in range(s.shape[0]):
        forces[0, i], forces[1, i], _, _ = stop(joint[0], s[i], rate[i])
    return forces


@kernel
def frictions(joint, s, rate, anchor):
    """Dry friction (n,), its anchor led along from row to row."""
    forces = np.zeros(s.shape[0])
    for i in range(s.shape[0]):
        forces[i], _, _ = friction(joint[0], s[i], rate[i], anchor)
        anchor = follow(joint[0], s[i], anchor)
    return forces


@kernel
def drive_forces(joint, targets, s, rate):
    """Force (n,) of a drive towards values and rates, targets (n, 2)."""
    forces = np.zeros(s.shape[0])
    for i in range(s.shape[0]):
        forces[i], _, _ = drive_force(joint[0], targets[i, 0], targets[i, 1], s[i], rate[i])
    return forces
