"""Kernels of a step whose loads MuJoCo holds, one for each call from Python.

A step of MuJoCo takes some ten microseconds, and a call from Python takes one; so each step makes few calls. See
`added_mass` for the equations, and `held_bodies` for the records of the bodies, held (bodies,), and of the bed (1,).

    begin           accept the step that ended here; find the present poses, and predict the end of the next step
    guess           write the loads of the last step, with which MuJoCo makes a trial step
    correct         correct the loads by Newton's method, from the rates at the end of the trial step
    predict_again   if the trial step ended far from the predicted end, take its end as the prediction

Arrays of MuJoCo, in the world frame: parents (m,) and axes (m, 6) of the degrees of freedom, see
`held_bodies.gather_twist`; v (m,): their rates; positions (all, 3) m and rotations (all, 9) of the frames of all
bodies; inertial (all, 3) m: their centres of mass; centres (all, 3) m: the centre of mass of the subtree of each body;
applied (all, 6): forces (N) and moments (N m) on the bodies.
"""

from __future__ import annotations

from granular_contact.engines.mujoco.kernels.added_mass import (
    add_inertia_to_matrix,
    correct_load,
    find_residual,
    find_zero_gain_load,
    generalised_residual,
    solve_symmetric,
)
from granular_contact.engines.mujoco.kernels.held_bodies import (
    clear_immersion,
    find_other_load,
    gather_twist,
    largest_deviation,
    predict,
    set_pose,
    step_work,
    write_loads,
)
from granular_contact.jit.compiled import kernel, part
from granular_contact.jit.memory import clear, copy


@kernel(nogil=True)
def begin(held, bed, parents, axes, v, positions, rotations, inertial, centres, applied):
    """Begin a step: accept the step that ended here, and fill the present and the predicted poses.

    If neither a step ended nor a motion starts, `previous_load` is taken as first guess again, so that a repeated call
    gives the same loads. wrench and added_inertia are cleared; so is immersion where anchors will follow.
    """
    elapsed, starts, turn = bed[0].elapsed, bed[0].starts, bed[0].turn
    for b in range(held.shape[0]):
        body = held[b]
        x, R, c, m = positions[body.number], rotations[body.number], centres[body.root], inertial[body.number]
        gather_twist(body.last_dof, parents, axes, v, body.end_twist)
        set_pose(body, x, R, c, body.end_twist, turn, body.pose)
        if elapsed > 0.0:
            accept(body, m[0] - c[0], m[1] - c[1], m[2] - c[2], elapsed)
        elif starts:
            body.work = body.extrapolated_work = 0.0
            clear(body.load)
            clear(body.previous_gain)
        if elapsed > 0.0 or starts:
            clear_immersion(body.immersion)
            clear_immersion(body.floor_immersion)
            copy(body.previous_load, body.load)
        else:
            copy(body.load, body.previous_load)
        find_other_load(body, applied[body.number])
        predict(body, bed[0].slow_speed)
        set_pose(body, x, R, c, body.end_twist, turn, body.predicted_pose)


@part
def accept(body, x, y, z, elapsed):
    """Accept a step that took `elapsed` (s) and ended with `end_twist`: add its work, and note the gain of the twist.

    x, y, z (m): from the point of twists to the centre of mass.
    """
    body.extrapolated_work += step_work(body, x, y, z, body.extrapolated, body.end_twist, elapsed)
    body.work += step_work(body, x, y, z, body.load, body.end_twist, elapsed)
    for k in range(6):
        body.previous_gain[k] = body.end_twist[k] - body.twist[k]


@kernel(nogil=True)
def guess(held, bed, applied):
    """Write the loads of the last step as a first guess; returns whether the sand resists any body.

    If it resists none, the loads of the step are zero, and are written.
    """
    resists = False
    for b in range(held.shape[0]):
        resists = find_zero_gain_load(held[b], bed[0].turn, bed[0].step) or resists
    if not resists:
        for b in range(held.shape[0]):
            clear(held[b].load)
            clear(held[b].extrapolated)
    write_loads(held, applied)
    return resists


@kernel(nogil=True)
def correct(held, bed, parents, axes, v, inertial, centres, applied, matrix, x):
    """Correct the loads by Newton's method, from the rates v (m,) at the end of a trial step with the loads written.

    matrix (m, m): derivative of the engine's generalised forces by its accelerations; the added inertia is added to it,
    and it is overwritten. x (m,): work space. `reached_gain` (the correction included) and `extrapolated` are filled.
    """
    step = bed[0].step
    for b in range(held.shape[0]):
        body = held[b]
        gather_twist(body.last_dof, parents, axes, v, body.reached_gain)
        for k in range(6):
            body.reached_gain[k] -= body.twist[k]
        find_residual(body, centres[body.root], inertial[body.number], step)
    generalised_residual(held, parents, axes, x)
    add_inertia_to_matrix(held, parents, axes, matrix)
    solve_symmetric(matrix, x)
    x *= step
    for b in range(held.shape[0]):
        body = held[b]
        gather_twist(body.last_dof, parents, axes, x, body.correction)
        for k in range(6):
            body.reached_gain[k] += body.correction[k]
        correct_load(body, centres[body.root], inertial[body.number], step)
    write_loads(held, applied)


@kernel(nogil=True)
def predict_again(held, bed, positions, rotations, centres):
    """Predict that the step ends as the trial step did, if a body deviates more than `tolerance` (m) from prediction.

    Returns whether a body does.
    """
    if not largest_deviation(held) * bed[0].step > bed[0].tolerance:
        return False
    for b in range(held.shape[0]):
        body = held[b]
        for k in range(6):
            body.predicted_gain[k] = body.reached_gain[k]
            body.end_twist[k] = body.twist[k] + body.reached_gain[k]
        clear(body.wrench)
        clear(body.added_inertia)
        x, R, c = positions[body.number], rotations[body.number], centres[body.root]
        set_pose(body, x, R, c, body.end_twist, bed[0].turn, body.predicted_pose)
    return True
