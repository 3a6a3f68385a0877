"""Generalised forces of all joints of a system in one call: springs, dampers, stops, dry friction, drives.

The record type of a joint, JOINT in the plane and `space_joints.JOINT` in space, selects its `coordinate` and `act`.

Arguments that the functions share:

    system_q, system_v  coordinates (without reference values) and rates of the whole system
    joints              (k,) records
    states              (k,) records of STATE
    places              (k, n, 2) indices of the coordinates of a joint's nodes, the parent's first, in the system and
                        in the overlay
"""

from __future__ import annotations

from granular_contact.jit.chosen import chosen_by, provide
from granular_contact.jit.compiled import kernel, part
from granular_contact.jit.memory import copy, flat, room1, rows
from granular_contact.jit.records import fields, record_dtype
from granular_contact.mechanics.kernels import joint_coordinates
from granular_contact.mechanics.kernels.joint_coordinates import COORDINATE, HINGE
from granular_contact.mechanics.kernels.joint_laws import follow, total
from granular_contact.sand.kernels.lines import difference

_STOPS, _FRICTION = ("lower", "upper", "stop_stiffness", "dissipation"), ("friction", "slip", "damping_time")
LAW = ("stiffness", "rest", "damping", *_STOPS, *_FRICTION)
DRIVE = ("gain", "rate_gain", "limit")
JOINT = record_dtype([*COORDINATE, ("drive", "i8"), *fields("f8", *LAW, *DRIVE)])
# anchor: of the bristle of dry friction; target, target_rate: coordinate and rate that a control aims at, target of a
# load: its force; last_angles (2,) rad: of the joint's ends at the last accepted state, see `joint_coordinates`.
STATE = record_dtype([*fields("f8", "anchor", "target", "target_rate"), ("last_angles", "f8", (2,))])
MOST = 14  # coordinates of two nodes in space; in the plane at most 8


@chosen_by("joint")
def coordinate(joint, last_angles, q, v, gradient):
    """Coordinate of a joint (rad or m) and its rate; fills gradient (MOST,) and updates last_angles (2,)."""


@chosen_by("joint")
def act(joint, state, q, v, out):
    """Fill out (MOST,) with the generalised forces of a joint."""


@part
def gather(system_q, system_v, places, count, q, v):
    """Fill q and v with the coordinates and rates of a joint's nodes."""
    for i in range(count):
        q[i], v[i] = system_q[places[i, 0]], system_v[places[i, 0]]


@part
def _act(joint, state, q, v, out):
    """`act` in the plane."""
    angles = room1(2)
    copy(angles, flat(state.last_angles))  # iterates, which may run away, must not count turns
    s, rate = joint_coordinates.coordinate(joint, angles, q, v, out)
    tau = total(joint, s, rate, state.anchor, state.target, state.target_rate)
    for i in range(MOST):
        out[i] *= tau


@kernel
def force(joints, states, places, system_q, system_v, out):
    """Add the generalised forces of all joints to out, which is numbered as the overlay."""
    q, v, f = room1(MOST), room1(MOST), room1(MOST)
    for k in range(joints.shape[0]):
        joint = joints[k]
        count = joint.parent + joint.child
        gather(system_q, system_v, places[k], count, q, v)
        act(joint, states[k], q, v, f)
        for i in range(count):
            out[places[k, i, 1]] += f[i]


@kernel
def tangent(system_q, system_v, joints, states, places, fq, fv, triplets):
    """Fill triplets with the tangent fq df/dq + fv df/dv as rows (row, column, value), and return their number.

    By finite differences, see `lines.differences`. Rows and columns are coordinates of the overlay; zeros are left out.
    """
    q, v, f, f_moved = room1(MOST), room1(MOST), room1(MOST), room1(MOST)
    number = 0
    for k in range(joints.shape[0]):
        joint = joints[k]
        count = joint.parent + joint.child
        gather(system_q, system_v, places[k], count, q, v)
        act(joint, states[k], q, v, f)
        d = difference(rows(q, 0, count), fq, fv)
        for j in range(count):
            q_j, v_j = q[j], v[j]
            q[j] += d * fq
            v[j] += d * fv
            act(joint, states[k], q, v, f_moved)
            q[j], v[j] = q_j, v_j
            for i in range(count):
                if f_moved[i] != f[i]:
                    triplets[number, 0], triplets[number, 1] = places[k, i, 1], places[k, j, 1]
                    triplets[number, 2] = (f_moved[i] - f[i]) / d
                    number += 1
    return number


@kernel
def accept(system_q, system_v, joints, states, places):
    """Update last_angles and the anchors of dry friction at the end of a step, the latter by `joint_laws.follow`."""
    q, v, gradient = room1(MOST), room1(MOST), room1(MOST)
    for k in range(joints.shape[0]):
        joint, state = joints[k], states[k]
        if joint.kind == HINGE or joint.friction > 0.0:
            gather(system_q, system_v, places[k], joint.parent + joint.child, q, v)
            s, _ = coordinate(joint, flat(state.last_angles), q, v, gradient)
            if joint.friction > 0.0:
                state.anchor = follow(joint, s, state.anchor)


@kernel
def single(joint, last_angles, q, v, gradient):
    """Result of `coordinate` for one joint, record (1,), for callers in Python."""
    return coordinate(joint[0], last_angles, q, v, gradient)


provide(coordinate, JOINT, joint_coordinates.coordinate)
provide(act, JOINT, _act)
