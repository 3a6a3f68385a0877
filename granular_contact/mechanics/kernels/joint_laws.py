"""Forces along the coordinate of a joint: spring, damper, stops, dry friction and drive.

joint: its record, see `joint_loads.JOINT`, with the numbers of `scene.joint_law.JointLaw` and of its drive. s:
coordinate (rad clockwise, or m), rate: its rate. Forces are torques (N m) or forces (N) along s.
"""

from __future__ import annotations

import math

import numpy as np

from granular_contact.jit.compiled import kernel, part

# Kinds of drives: none, a torque or force over time, a control of the coordinate, a control of its rate.
NO_DRIVE, LOAD, CONTROL, RATE_CONTROL = 0, 1, 2, 3


@part
def stop(joint, s, rate):
    """Elastic part of the force of the stops, and the whole force, after Hunt and Crossley (1975); never adhesive."""
    to_stop = joint.upper - s if s > joint.upper else joint.lower - s if s < joint.lower else 0.0
    elastic = joint.stop_stiffness * to_stop
    # The damping force grows with the depth and the rate; the sum is cut off where it would pull.
    return elastic, elastic * max(0.0, 1.0 - joint.dissipation * math.copysign(1.0, to_stop) * rate)


@part
def friction(joint, s, rate, anchor):
    """Dry friction by a bristle with a fixed end `anchor`: linear in its deflection up to `slip`, constant beyond."""
    strain = (s - anchor + joint.damping_time * rate) / joint.slip
    return -joint.friction * min(1.0, max(-1.0, strain))


@part
def follow(joint, s, anchor):
    """Return mapping: anchor of the bristle after a step that ended at s."""
    return min(max(anchor, s - joint.slip), s + joint.slip)


@part
def drive_force(joint, target, target_rate, s, rate):
    """Force of a drive: the target itself for a load; PD control of target and target_rate, limited, for a control."""
    if joint.drive == LOAD:
        return target
    force = joint.rate_gain * (target_rate - rate)
    if joint.drive == CONTROL:
        force += joint.gain * (target - s)
    return min(joint.limit, max(-joint.limit, force))


@part
def total(joint, s, rate, anchor, target, target_rate):
    """Sum of all forces along the coordinate."""
    force = -joint.stiffness * (s - joint.rest) - joint.damping * rate
    if joint.stop_stiffness > 0.0:
        force += stop(joint, s, rate)[1]
    if joint.friction > 0.0:
        force += friction(joint, s, rate, anchor)
    if joint.drive != NO_DRIVE:
        force += drive_force(joint, target, target_rate, s, rate)
    return force


# ---- for all rows of a history ----


@kernel(allocates=True)
def stops(joint, s, rate):
    """Elastic part and sum of the forces of the stops, (2, n), at coordinates s (n,) and rates (n,)."""
    forces = np.zeros((2, s.shape[0]))
    for i in range(s.shape[0]):
        forces[0, i], forces[1, i] = stop(joint[0], s[i], rate[i])
    return forces


@kernel(allocates=True)
def frictions(joint, s, rate, anchor):
    """Dry friction (n,); the anchor is updated after each row."""
    forces = np.zeros(s.shape[0])
    for i in range(s.shape[0]):
        forces[i] = friction(joint[0], s[i], rate[i], anchor)
        anchor = follow(joint[0], s[i], anchor)
    return forces


@kernel(allocates=True)
def drive_forces(joint, targets, s, rate):
    """Force (n,) of a drive; targets (n, 2): target and target_rate of each row."""
    forces = np.zeros(s.shape[0])
    for i in range(s.shape[0]):
        forces[i] = drive_force(joint[0], targets[i, 0], targets[i, 1], s[i], rate[i])
    return forces
