"""What surrounds the forces of a step that are held over it, call by call.

An engine's step takes some ten microseconds, and a call from Python one; so what is done to a few bodies is done in
few calls. See `added_mass` for the equations, for arguments and for the clock (3,).

    begin     the step that ended here is accepted; poses now, and where this one would end
    guess     the loads of the step before are written; with them the engine makes the step
    correct   the loads that the step gets, from the rates with which it ended; the engine takes it back
    again     where it ended far from where it was foreseen: a step that is foreseen to end there
"""

from __future__ import annotations

from granular_contact.engines.mujoco.kernels.added_mass import (
    BEGINS,
    PASSED,
    STEP,
    add_to_matrix,
    blank,
    correct_loads,
    end_step,
    extrapolated,
    farthest,
    find_base,
    foresee,
    foreseen_load,
    gather_twists,
    load_error,
    place_bodies,
    solve_symmetric,
    to_freedoms,
    write_loads,
)
from granular_contact.jit.compiled import kernel
from granular_contact.jit.memory import clear, copy


@kernel(nogil=True)
def begin(
    last, parents, axes, v, numbers, tops, positions, rotations, inertial, centres, turn, applied, written, brought,
    base, sizes, slow, clock, loads, start, slopes, works, drifts, gained, seen, twists, later, past, arms, poses,
    then, wrench, added,
):  # fmt: skip
    """Begin of a step; slow (m/s): see `foresee`.

    start (bodies, 6) are the loads at its begin, so that a second look at it ends as the first did; drifts (bodies,) J:
    as works, of slopes, see `extrapolated`.

    Filled are poses and arms; `then` with the velocities that are foreseen, whose gain is past; wrench and added are
    emptied, and seen where anchors will follow.
    """
    gather_twists(last, parents, axes, v, later)
    place_bodies(numbers, tops, positions, rotations, centres, later, turn, poses, arms)
    passed, begins = clock[PASSED], clock[BEGINS] > 0.0
    if passed > 0.0:
        end_step(numbers, tops, inertial, centres, slopes, twists, later, passed, drifts, gained)
        end_step(numbers, tops, inertial, centres, loads, twists, later, passed, works, gained)
    elif begins:
        works[:] = 0.0
        drifts[:] = 0.0
        loads[:] = 0.0
        gained[:] = 0.0
    if passed > 0.0 or begins:
        blank(seen)
        copy(start, loads)
    else:
        copy(loads, start)
    find_base(applied, numbers, written, brought, base)
    foresee(poses, sizes, slow, twists, gained, past, later, wrench, added)
    place_bodies(numbers, tops, positions, rotations, centres, later, turn, then, arms)


@kernel(nogil=True)
def guess(turn, numbers, wrench, arms, added, past, clock, foreseen, loads, slopes, applied, base, written):
    """Write the loads of the step before, as a first guess of this one's; whether there is any resistance.

    Without any, loads of 0 are written, and are those of the step.
    """
    some = foreseen_load(turn, wrench, arms, added, past, clock[STEP], foreseen)
    if not some:
        loads[:] = 0.0
        slopes[:] = 0.0
    write_loads(applied, numbers, base, loads, written)
    return some


@kernel(nogil=True)
def correct(
    last, parents, axes, v, numbers, tops, inertial, centres, added, twists, past, change, ends, clock, foreseen, error,
    loads, applied, base, written, matrix, x, slopes,
):  # fmt: skip
    """Newton's correction of the loads, from the rates v (m,) at the end of a step of the engine with those written.

    matrix (m, m): how the engine's forces grow with its accelerations, to which the added inertia comes; change
    (bodies, 6) is filled with how the correction changes the twists at the end of the step, ends (bodies, 6) with what
    they gain in it, slopes as of `extrapolated`.
    """
    gather_twists(last, parents, axes, v, change)
    for b in range(twists.shape[0]):
        for k in range(6):
            change[b, k] -= twists[b, k]
    copy(ends, change)
    step = clock[STEP]
    load_error(numbers, tops, inertial, centres, added, change, foreseen, step, loads, error)
    to_freedoms(last, parents, axes, error, x)
    add_to_matrix(last, parents, axes, added, matrix)
    solve_symmetric(matrix, x)
    x *= step
    gather_twists(last, parents, axes, x, change)
    for b in range(ends.shape[0]):
        for k in range(6):
            ends[b, k] += change[b, k]
    correct_loads(numbers, tops, inertial, centres, added, change, step, error, loads)
    write_loads(applied, numbers, base, loads, written)
    extrapolated(numbers, tops, inertial, centres, added, past, foreseen, step, loads, slopes)


@kernel(nogil=True)
def again(
    numbers, tops, positions, rotations, centres, turn, sizes, close, clock, twists, ends, past, later, then, arms,
    wrench, added,
):  # fmt: skip
    """Foresee a step to end as it did, if some body came farther than `close` (m) from where it was foreseen; whether.

    Arguments as of `begin` and `correct`; sizes (bodies,): how far bodies reach from their reference points (m).
    """
    if not farthest(sizes, arms, ends, past) * clock[STEP] > close:
        return False
    for b in range(ends.shape[0]):
        for k in range(6):
            past[b, k] = ends[b, k]
            later[b, k] = twists[b, k] + ends[b, k]
    clear(wrench)
    clear(added)
    place_bodies(numbers, tops, positions, rotations, centres, later, turn, then, arms)
    return True
