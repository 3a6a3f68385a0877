"""What surrounds the forces of a step that are held over it, in three calls: its begin, a trial of it, its loads.

An engine's step takes some ten microseconds, and a call from Python one; so what is done to a few bodies is done in
few calls. See `added_mass` for the equations, for arguments and for the clock (3,).

    begin     the step that ended here is accepted; poses now, and where this one would end
    burden    the loads of a trial step are written, and inertia is added; the engine then makes it
    relieve   the loads that the step gets, from the rates with which its trial ended; the trial is taken back
"""

from __future__ import annotations

from granular_contact.kernels.added_mass import (
    BEGINS,
    PASSED,
    STEP,
    add_to_mass,
    blank,
    end_step,
    find_base,
    foresee,
    gather_twists,
    keep,
    load_trial,
    place_bodies,
    settle,
    write_loads,
)
from granular_contact.kernels.compiled import part


@part
def begin(
    last, parents, axes, v, numbers, tops, positions, rotations, inertial, centres, turn, applied, written, brought,
    base, sizes, slow, clock, loads, works, gained, seen, twists, later, past, arms, poses, then, wrench,
    added,
):  # fmt: skip
    """Begin of a step; slow (m/s): see `foresee`.

    Filled are poses and arms; `then` with the velocities that are foreseen, whose gain is past; wrench and added are
    emptied, and seen where anchors will follow.
    """
    gather_twists(last, parents, axes, v, later)
    place_bodies(numbers, tops, positions, rotations, centres, later, turn, poses, arms)
    passed, begins = clock[PASSED], clock[BEGINS] > 0.0
    if passed > 0.0:
        end_step(numbers, tops, inertial, centres, loads, twists, later, passed, works, gained)
    elif begins:
        works[:] = 0.0
        loads[:] = 0.0
        gained[:] = 0.0
    if passed > 0.0 or begins:
        blank(seen)
    find_base(applied, numbers, written, brought, base)
    foresee(poses, sizes, slow, twists, gained, past, later, wrench, added)
    place_bodies(numbers, tops, positions, rotations, centres, later, turn, then, arms)


@part
def burden(
    turn, numbers, tops, inertial, centres, wrench, arms, added, past, clock, loads, applied, base, written, last,
    parents, starts, axes, q, v, act, warm, mass, q_kept, v_kept, act_kept, warm_kept, mass_kept,
):  # fmt: skip
    """Write the loads of a trial step; whether it needs one: then the engine's state is kept and inertia is added."""
    some = load_trial(turn, numbers, tops, inertial, centres, wrench, arms, added, past, clock[STEP], loads)
    write_loads(applied, numbers, base, loads, written)
    if some:
        keep(q, v, act, warm, mass, q_kept, v_kept, act_kept, warm_kept, mass_kept)
        add_to_mass(last, parents, starts, axes, added, mass)
    return some


@part
def relieve(
    last, parents, axes, numbers, tops, inertial, centres, added, twists, later, clock, loads, applied, base, written,
    q, v, act, warm, mass, q_kept, v_kept, act_kept, warm_kept, mass_kept,
):  # fmt: skip
    """Settle the loads from the rates v at the end of a trial step, write them, and take the trial back."""
    gather_twists(last, parents, axes, v, later)
    for b in range(twists.shape[0]):
        for k in range(6):
            later[b, k] -= twists[b, k]
    settle(numbers, tops, inertial, centres, added, later, clock[STEP], loads)
    keep(q_kept, v_kept, act_kept, warm_kept, mass_kept, q, v, act, warm, mass)
    write_loads(applied, numbers, base, loads, written)
