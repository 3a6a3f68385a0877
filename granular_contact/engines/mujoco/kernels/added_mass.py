"""Forces that an engine holds over a step, made implicit: the end of the step is felt as mass that bodies gain.

An engine that asks for forces once a step would need steps far below u_y / v for bristles as stiff as F / u_y. So the
force on an element is taken where the step will end, and straight from there to where its bristle is not stretched:

    F_1 = F - K (q_1 - q),    q_1 - q = (s h + tau) (v_1 - v),
    K = |F| / |q| (1 - n n^T) + |F| / (n . q) n n^T

with F and q (see `planar_friction.drive`) at the place p + h v that the element would reach in the step h with a
velocity v that is foreseen, s = 1 below the yield and u_y / |stretch| beyond it. The slope is that of the bristle below
the yield and the secant beyond it: never too small and never opposite to the motion, so that no step is too long to
stand. Along the normal n of an element of which one side alone is loaded the force ends where n . q does. As
v_1 - v = h a for the v at the start,

    F_1 = F - M a,    M = h (s h + tau) K,

the step with F and with an inertia M at each element, in addition to the body's own, ends where F_1 acts. With a
foreseen change of v what the added inertia takes up is that of the difference alone.

What is kept of a body: `held_bodies.HELD`. Its added inertia, added (6, 6), is for twists about the point about which
MuJoCo has them: angular, then linear; world frame.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from granular_contact.engines.mujoco.kernels.held_bodies import BED, HELD
from granular_contact.jit.compiled import kernel, part
from granular_contact.jit.memory import room1
from granular_contact.jit.records import record_dtype
from granular_contact.sand.kernels.vectors import axes, cross, moving, seen, vector

# The constants of `friction`, and whether a law opposes components of the motion one by one.
_NUMBERS = [("u_y", "f8"), ("tau", "f8"), ("v_eps", "f8"), ("pressed", "f8")]
BRISTLE = record_dtype([*_NUMBERS, ("friction", "i8"), ("parted", "?")])
# What a step of every batch has, see `held_bodies`; of_bed: places of its bodies, or of those of its lines, in held.
OF_STEP: dict[str, tuple[Any, int]] = {
    "of_bed": (np.int64, 1),
    "bristle": (BRISTLE, 1),
    "held": (HELD, 1),
    "bed": (BED, 1),
}


@part
def add_inertia(mass, nx, ny, nz, x, y, z, added):
    """Add a mass (kg) at a place (m) that is felt along n alone to the upper triangle of an added inertia (6, 6)."""
    n = nx, ny, nz
    twist = *cross((x, y, z), n), nx, ny, nz
    for i in range(6):
        for j in range(i, 6):
            added[i, j] += mass * twist[i] * twist[j]


@part
def add_point(mass, x, y, z, added):
    """Add a mass (kg) at a place (m) to the upper triangle of an added inertia (6, 6)."""
    mx, my, mz = mass * x, mass * y, mass * z
    added[0, 0] += my * y + mz * z
    added[1, 1] += mx * x + mz * z
    added[2, 2] += mx * x + my * y
    added[0, 1] -= mx * y
    added[0, 2] -= mx * z
    added[1, 2] -= my * z
    added[0, 4] -= mz
    added[0, 5] += my
    added[1, 3] += mz
    added[1, 5] -= mx
    added[2, 3] -= my
    added[2, 4] += mx
    added[3, 3] += mass
    added[4, 4] += mass
    added[5, 5] += mass


@part
def momentum(added, twist, out):
    """Set out (6,) to the momentum of an added inertia with a twist (6,): force-like first, then about its point."""
    for i in range(6):
        k = 0.0
        for j in range(6):
            k += added[i, j] * twist[j]
        out[i - 3 if i >= 3 else i + 3] = k


@part
def add_to_matrix(held, parents, axes, matrix):
    """Add what bodies gained to the mass matrix (m, m) of a tree, its lower triangle; see `held_bodies.HELD`."""
    y = room1(6)
    for b in range(held.shape[0]):
        added = held[b].added
        if added[5, 5] == 0.0 and added[3, 3] == 0.0 and added[4, 4] == 0.0:
            continue
        i = held[b].last
        while i >= 0:
            for k in range(6):
                y[k] = 0.0
                for c in range(6):
                    y[k] += added[k, c] * axes[i, c]
            j = i
            while j >= 0:
                for k in range(6):
                    matrix[i, j] += axes[j, k] * y[k]
                j = parents[j]
            i = parents[i]


@kernel(nogil=True)
def add_damping(starts, counts, columns, derivatives, damping, shares, matrix):
    """Add to a mass matrix (m, m) what is implicit of other forces: shares (2,), of derivatives and of damping (m,).

    derivatives: by rates, sparse: row i has counts[i] of them from starts[i] on, in these columns.
    """
    for i in range(damping.shape[0]):
        matrix[i, i] += shares[1] * damping[i]
        if shares[0] != 0.0:
            for k in range(starts[i], starts[i] + counts[i]):
                matrix[i, columns[k]] += shares[0] * derivatives[k]


@part
def solve_symmetric(matrix, x):
    """Solve A y = x, y in place of x (m,), for a positive definite A (m, m); its lower triangle is overwritten.

    As A = L^T D L, from the last row to the first (Featherstone, Rigid Body Dynamics Algorithms, 2008, section 6.5):
    of a tree, whose freedoms stand after those that carry them, no zero fills in, and zeros are passed over.
    """
    m = x.shape[0]
    for k in range(m - 1, -1, -1):
        for i in range(k - 1, -1, -1):
            if matrix[k, i] == 0.0:
                continue
            share = matrix[k, i] / matrix[k, k]
            for j in range(i + 1):
                matrix[i, j] -= share * matrix[k, j]
            matrix[k, i] = share
            x[i] -= share * x[k]
        x[k] /= matrix[k, k]
    for k in range(m):
        for i in range(k):
            x[k] -= matrix[k, i] * x[i]


@part
def find_target(body, turn, step):
    """Fill target from the wrench where the step is foreseen to end; whether there is any wrench.

    It has what the added inertia takes up of the gain that was foreseen.
    """
    p, w = room1(6), body.wrench
    f = seen(axes(turn), vector(w, 0))
    load = *f, *moving(seen(axes(turn), vector(w, 3)), body.arm, f)
    momentum(body.added, body.foreseen, p)
    some = False
    for k in range(6):
        body.target[k] = load[k] + p[k] / step
        some = some or w[k] != 0.0
    return some


@part
def about(w, x, y, z, out):
    """Set a wrench (6,) to be about a point at x, y, z (m) from the point that w (6,) is about."""
    out[0], out[1], out[2] = w[0], w[1], w[2]
    out[3] = w[3] - y * w[2] + z * w[1]
    out[4] = w[4] - z * w[0] + x * w[2]
    out[5] = w[5] - x * w[1] + y * w[0]


@part
def find_error(body, c, inertial, step):
    """Fill error with what the load of a step lacks where it ended, at the gain of the twist that was reached.

    c (3,) m: the point of twists, inertial (3,) m: the centre of mass.
    """
    p, q = room1(6), room1(6)
    about(body.load, c[0] - inertial[0], c[1] - inertial[1], c[2] - inertial[2], q)
    momentum(body.added, body.reached, p)
    for k in range(6):
        body.error[k] = body.target[k] - p[k] / step - q[k]


@part
def to_freedoms(held, parents, axes, out):
    """Fill out (m,) with the errors of bodies as forces along degrees of freedom, see `held_bodies.gather_twist`."""
    out[:] = 0.0
    for b in range(held.shape[0]):
        error, i = held[b].error, held[b].last
        while i >= 0:
            for k in range(6):
                out[i] += axes[i, k] * error[k - 3 if k >= 3 else k + 3]
            i = parents[i]


@part
def less_taken_up(body, load, change, c, inertial, step, q):
    """Fill q (6,) with a load (6,) less what the added inertia takes up of a change (6,) of the twist.

    q is about the centre of mass, inertial (3,) m; load, added and twists are about c (3,) m.
    """
    p = room1(6)
    momentum(body.added, change, p)
    for k in range(6):
        p[k] = load[k] - p[k] / step
    about(p, inertial[0] - c[0], inertial[1] - c[1], inertial[2] - c[2], q)


@part
def correct_load(body, c, inertial, step):
    """Add to load its error less what the added inertia takes up of `change`; and find slope."""
    q = room1(6)
    less_taken_up(body, body.error, body.change, c, inertial, step, q)
    for k in range(6):
        body.load[k] += q[k]
    less_taken_up(body, body.target, body.foreseen, c, inertial, step, q)
    for k in range(6):
        body.slope[k] = body.load[k] - q[k]
