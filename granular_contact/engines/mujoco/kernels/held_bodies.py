"""Records of the bodies in the sand of a MuJoCo model, and the motion of a body within a step.

A twist (6,) is the angular velocity (rad/s) of a body, then the velocity (m/s) of its material point at the point of
twists: the centre of mass of its mechanism, about which MuJoCo has twists. A gain is a change of a twist. A load (6,)
is a force (N), then a moment (N m) about the centre of mass of the body. Twists and loads are in the world frame; poses
and the wrench are in the frame of the bed.
"""

from __future__ import annotations

import math

import numpy as np

from granular_contact.jit.compiled import kernel, part
from granular_contact.jit.memory import clear
from granular_contact.jit.records import fields, record_dtype
from granular_contact.sand.kernels.vectors import column, cross, dot, minus, norm, plus, plus_cross, times, vector, xyz

# Record of a body in sand, whose load MuJoCo holds over a step:
#
# number             number of the body in the model
# root               number of the first body of its mechanism
# last_dof           last degree of freedom that moves the body, -1 if none does
# radius             largest distance (m) of its shapes from the reference point, the origin of its frame
# work               work (J) of load so far
# extrapolated_work  work (J) of extrapolated so far
# facing             see `planar_added_mass`
# arm                from the point of twists to the reference point (m), world frame
# immersion          see `space_law.DEPTH`; floor_immersion: the same for a floor
# twist              at the start of the step
# previous_gain      gain in the last step
# predicted_gain     gain that is predicted for this step
# reached_gain       gain of the trial step, with Newton's correction
# end_twist          predicted twist at the end of the step; when the step has ended, its real twist
# correction         Newton's correction of the twist at the end of the step
# load               load in this step
# previous_load      load in the last step
# extrapolated       part of load that was extrapolated from the predicted end of the step by the added inertia
# zero_gain_load     load extrapolated to a gain of zero, about the point of twists
# residual           load extrapolated to the gain of the trial step, less load; about the point of twists
# other_load         load that others apply to the body
# written_row        row of `xfrc_applied` that was written last
# restored_row       row of `xfrc_applied` that MuJoCo may restore with a state of its own
# wrench             force (N) and moment (N m) about the reference point, at the predicted end of the step
# pose               see `space_law`
# predicted_pose     pose with the velocities predicted for the end of the step
# added_inertia      see `added_mass`
HELD = record_dtype(
    [
        *fields("i8", "number", "root", "last_dof"),
        *fields("f8", "radius", "work", "extrapolated_work"),
        *((name, "f8", (3,)) for name in ("facing", "arm", "immersion", "floor_immersion")),
        *((name, "f8", (6,)) for name in ("twist", "previous_gain", "predicted_gain", "reached_gain")),
        *((name, "f8", (6,)) for name in ("end_twist", "correction", "load", "previous_load", "extrapolated")),
        *((name, "f8", (6,)) for name in ("zero_gain_load", "residual", "other_load", "written_row", "restored_row")),
        ("wrench", "f8", (6,)),
        *((name, "f8", (6, 3)) for name in ("pose", "predicted_pose")),
        ("added_inertia", "f8", (6, 6)),
    ]
)
# Fields of HELD that belong to a state of the bed.
STATE = (
    *("load", "previous_load", "extrapolated", "other_load", "twist", "previous_gain"),
    *("immersion", "work", "extrapolated_work"),
)
# Record of a bed and its clock:
#
# turn        rotation from the world to the frame of the bed
# slow_speed  speed (m/s), see `predict`
# tolerance   deviation (m) from a prediction, see `held_step.predict_again`
# step        length (s) of the step
# elapsed     length (s) of the step that ended here, 0 if none did
# starts      whether a motion starts here, with unstretched bristles
BED = record_dtype(
    [("turn", "f8", (3, 3)), *fields("f8", "slow_speed", "tolerance", "step", "elapsed"), ("starts", "?")]
)


@part
def gather_twist(last_dof, parents, axes, v, twist):
    """Fill the twist (6,) of a body from the rates v (m,) of the degrees of freedom of a tree.

    last_dof: last degree of freedom that moves the body, -1 if none does. parents (m,): the parent of each degree of
    freedom in the tree, -1 for none. axes (m, 6): twist by the unit rate of each.
    """
    for k in range(6):
        twist[k] = 0.0
    i = last_dof
    while i >= 0:
        for k in range(6):
            twist[k] += axes[i, k] * v[i]
        i = parents[i]


@part
def set_pose(body, x, R, c, twist, turn, pose):
    """Fill the pose (6, 3) of a body with a given twist, and its arm, from MuJoCo's data in the world frame.

    x (3,) m: origin of the body's frame; R (9,): its rotation, row by row; c (3,) m: point of twists; turn (3, 3):
    rotation to the frame of the bed.
    """
    r, w = minus(x, c), vector(twist, 0)
    v = plus_cross(vector(twist, 3), w, r)
    body.arm[0], body.arm[1], body.arm[2] = r
    for i in range(3):
        to = xyz(turn[i])
        for j in range(3):
            pose[i, j] = dot(to, column(R, j))
        pose[3, i], pose[4, i], pose[5, i] = dot(to, x), dot(to, v), dot(to, w)


@part
def advance(pose, predicted_pose, step, out):
    """Fill out (6, 3) with the pose after a step (s) from `pose`, with the constant velocities of `predicted_pose`."""
    w = times(step, predicted_pose[5])
    angle = norm(w)
    a = math.sin(angle) / angle if angle > 1e-9 else 1.0
    b = (1.0 - math.cos(angle)) / (angle * angle) if angle > 1e-4 else 0.5
    for j in range(3):
        axis = pose[0, j], pose[1, j], pose[2, j]
        c = cross(w, axis)
        out[0, j], out[1, j], out[2, j] = plus(axis, plus(times(a, c), times(b, cross(w, c))))
        out[3, j] = pose[3, j] + step * predicted_pose[4, j]
        out[4, j], out[5, j] = predicted_pose[4, j], predicted_pose[5, j]


@part
def clear_immersion(immersion):
    """Reset the immersion (3,) of a body, see `space_law.DEPTH`."""
    immersion[0], immersion[1], immersion[2] = -np.inf, 0.0, np.inf


@part
def step_work(body, x, y, z, load, end_twist, elapsed):
    """Work (J) of a constant load (6,) in a step that took `elapsed` (s): on the mean of the twists at its two ends.

    x, y, z (m): from the point of twists to the centre of mass.
    """
    power = 0.0
    for twist in (body.twist, end_twist):
        v = plus_cross(vector(twist, 3), vector(twist, 0), (x, y, z))
        power += dot(vector(load, 0), v) + dot(vector(load, 3), vector(twist, 0))
    return 0.5 * elapsed * power


@part
def predict(body, slow_speed):
    """Predict the twist at the end of a step by the gain of the last step; `end_twist` is the present twist before.

    At least half of the twist is left, so that the prediction does not reverse a body that comes to rest. Only a small
    share of the gain is taken below `slow_speed` (m/s), where bristles bear the body without sliding: the gain lags one
    step behind their forces, and would excite the body.
    """
    square, along, speed_squared = 0.0, 0.0, 0.0
    for k in range(6):
        body.twist[k] = body.end_twist[k]
        square += body.twist[k] * body.twist[k]
        along += body.twist[k] * body.previous_gain[k]
    share = min(1.0, -0.5 * square / along) if along < 0.0 else 1.0
    for k in range(3):
        speed_squared += body.pose[4, k] ** 2 + (body.radius * body.pose[5, k]) ** 2
    share *= speed_squared / (speed_squared + slow_speed * slow_speed)
    for k in range(6):
        body.predicted_gain[k] = share * body.previous_gain[k]
        body.end_twist[k] = body.twist[k] + body.predicted_gain[k]
    clear(body.wrench)
    clear(body.added_inertia)


@part
def largest_deviation(held):
    """Upper bound of the velocity (m/s) of any point in the difference between the gains reached and predicted."""
    largest = 0.0
    for b in range(held.shape[0]):
        reached, predicted = held[b].reached_gain, held[b].predicted_gain
        w = minus(vector(reached, 0), vector(predicted, 0))
        v = plus_cross(minus(vector(reached, 3), vector(predicted, 3)), w, held[b].arm)
        largest = max(largest, norm(v) + held[b].radius * norm(w))
    return largest


@part
def find_other_load(body, applied):
    """Update `other_load` from the row (6,) of `xfrc_applied`, where others have changed it.

    A component that differs from the row written last was set by others, unless MuJoCo restored an earlier row.
    """
    for k in range(6):
        value = applied[k]
        if value != body.written_row[k] and (value == 0.0 or value != body.restored_row[k]):
            body.other_load[k] = value


@kernel(nogil=True)
def write_loads(held, applied):
    """Write load + other_load to the rows of the bodies in applied (all, 6), and keep them in `written_row`."""
    for b in range(held.shape[0]):
        body = held[b]
        for k in range(6):
            body.written_row[k] = body.other_load[k] + body.load[k]
            applied[body.number, k] = body.written_row[k]
