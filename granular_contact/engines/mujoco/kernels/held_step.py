"""What surrounds the forces of a step that are held over it, call by call.

An engine's step takes some ten microseconds, and a call from Python one; so what is done to a few bodies is done in
few calls. See `added_mass` for the equations, `held_bodies` for the records of bodies, held (bodies,), and bed (1,).

    begin     the step that ended here is accepted; poses now, and where this one would end
    guess     the loads of the step before are written; with them the engine makes the step
    correct   the loads that the step gets, from the rates with which it ended; the engine takes it back
    again     where it ended far from where it was foreseen: a step that is foreseen to end there

Arrays of MuJoCo, all in the world frame: parents (m,) and axes (m, 6): of degrees of freedom; v (m,): their rates;
positions (all, 3) m and rotations (all, 9) of bodies, inertial (all, 3) m: their centres of mass, centres (all, 3) m:
those of their mechanisms; applied (all, 6): forces and moments on them.
"""

from __future__ import annotations

from granular_contact.engines.mujoco.kernels.added_mass import (
    add_to_matrix,
    correct_load,
    find_error,
    find_target,
    solve_symmetric,
    to_freedoms,
)
from granular_contact.engines.mujoco.kernels.held_bodies import (
    blank,
    end_step,
    farthest,
    find_base,
    foresee,
    gather_twist,
    place,
    write_loads,
)
from granular_contact.jit.compiled import kernel, part
from granular_contact.jit.memory import clear, copy


@kernel(nogil=True)
def begin(held, bed, parents, axes, v, positions, rotations, inertial, centres, applied):
    """Begin of a step: loads and works of the one that ended here, poses now and with the velocities foreseen.

    `start` are the loads at its begin, so that a second look at it ends as the first did. wrench and added are emptied,
    and seen where anchors will follow.
    """
    passed, begins, turn = bed[0].passed, bed[0].begins, bed[0].turn
    for b in range(held.shape[0]):
        body = held[b]
        x, R, c, m = positions[body.number], rotations[body.number], centres[body.top], inertial[body.number]
        gather_twist(body.last, parents, axes, v, body.ahead)
        place(body, x, R, c, body.ahead, turn, body.pose)
        if passed > 0.0:
            accept(body, m[0] - c[0], m[1] - c[1], m[2] - c[2], passed)
        elif begins:
            body.work = body.drift = 0.0
            clear(body.load)
            clear(body.gained)
        if passed > 0.0 or begins:
            blank(body.seen)
            blank(body.seen_of_floor)
            copy(body.start, body.load)
        else:
            copy(body.load, body.start)
        find_base(body, applied[body.number])
        foresee(body, bed[0].slow)
        place(body, x, R, c, body.ahead, turn, body.then)


@part
def accept(body, x, y, z, passed):
    """End of a step that took a time (s), with the twist `ahead`: works and what the twist gained; x, y, z as there."""
    body.drift += end_step(body, x, y, z, body.slope, body.ahead, passed)
    body.work += end_step(body, x, y, z, body.load, body.ahead, passed)
    for k in range(6):
        body.gained[k] = body.ahead[k] - body.twist[k]


@kernel(nogil=True)
def guess(held, bed, applied):
    """Write the loads of the step before, as a first guess of this one's; whether there is any resistance.

    Without any, loads of 0 are written, and are those of the step.
    """
    some = False
    for b in range(held.shape[0]):
        some = find_target(held[b], bed[0].turn, bed[0].step) or some
    if not some:
        for b in range(held.shape[0]):
            clear(held[b].load)
            clear(held[b].slope)
    write_loads(held, applied)
    return some


@kernel(nogil=True)
def correct(held, bed, parents, axes, v, inertial, centres, applied, matrix, x):
    """Newton's correction of the loads, from the rates v (m,) at the end of a step of the engine with those written.

    matrix (m, m): how the engine's forces grow with its accelerations, to which the added inertia comes; x (m,) to work
    in. Filled are reached, with what twists gain by the correction as well, and slope.
    """
    step = bed[0].step
    for b in range(held.shape[0]):
        body = held[b]
        gather_twist(body.last, parents, axes, v, body.reached)
        for k in range(6):
            body.reached[k] -= body.twist[k]
        find_error(body, centres[body.top], inertial[body.number], step)
    to_freedoms(held, parents, axes, x)
    add_to_matrix(held, parents, axes, matrix)
    solve_symmetric(matrix, x)
    x *= step
    for b in range(held.shape[0]):
        body = held[b]
        gather_twist(body.last, parents, axes, x, body.change)
        for k in range(6):
            body.reached[k] += body.change[k]
        correct_load(body, centres[body.top], inertial[body.number], step)
    write_loads(held, applied)


@kernel(nogil=True)
def again(held, bed, positions, rotations, centres):
    """Foresee a step to end as it did, if a body came farther than `close` (m) from where it was foreseen; whether."""
    if not farthest(held) * bed[0].step > bed[0].close:
        return False
    for b in range(held.shape[0]):
        body = held[b]
        for k in range(6):
            body.foreseen[k] = body.reached[k]
            body.ahead[k] = body.twist[k] + body.reached[k]
        clear(body.wrench)
        clear(body.added)
        x, R, c = positions[body.number], rotations[body.number], centres[body.top]
        place(body, x, R, c, body.ahead, bed[0].turn, body.then)
    return True
