"""Forces that MuJoCo holds over a step, made implicit in the step by an added mass of the bodies.

If an engine evaluates forces once a step, explicit forces need steps far below u_y / v, as the stiffness of bristles is
F / u_y. So the force on an element is evaluated at the predicted end of the step and linearised there:

    F_1 = F - K (q_1 - q),    q_1 - q = (s h + tau) (v_1 - v),
    K = |F| / |q| (1 - n n^T) + |F| / (n . q) n n^T

with F and q (see `planar_friction.drive`) at the position p + h v that the element reaches in the step h with a
predicted velocity v; s = 1 below the yield and u_y / |stretch| beyond it; tau: damping time of the bristle. K is the
tangent stiffness of the bristle below the yield, and its secant stiffness beyond it. The secant is never too small and
never negative, so that a step of any length is stable for a body at rest. Along the normal n of an element that is
loaded from one side alone, the force reaches zero where n . q does. As v_1 - v = h a for the v at the start,

    F_1 = F - M a,    M = h (s h + tau) K:

a step with the force F, and with the inertia M at each element in addition to the inertia of the body, ends with the
force F_1. With a predicted change of v, M acts on the difference between the real and the predicted change alone.

Records of bodies: `held_bodies.HELD`. The added inertia (6, 6) of a body is for twists about the point of twists:
angular, then linear; world frame.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from granular_contact.engines.mujoco.kernels.held_bodies import BED, HELD
from granular_contact.jit.compiled import kernel, part
from granular_contact.jit.memory import room1
from granular_contact.jit.records import record_dtype
from granular_contact.sand.kernels.vectors import axes, cross, plus_cross, turned_back, vector

# Constants of `friction`; by_component: whether the law opposes each component of the motion by itself.
_CONSTANTS = [("u_y", "f8"), ("tau", "f8"), ("v_eps", "f8"), ("pressed", "f8")]
BRISTLE = record_dtype([*_CONSTANTS, ("friction", "i8"), ("by_component", "?")])
# Arrays that kernels of every batch take, see `held_bodies`; held_places: places in held of the bodies of the batch, or
# of the bodies of its lines.
STEP_ARRAYS: dict[str, tuple[Any, int]] = {
    "held_places": (np.int64, 1),
    "bristle": (BRISTLE, 1),
    "held": (HELD, 1),
    "bed": (BED, 1),
}


@part
def add_inertia(mass, nx, ny, nz, x, y, z, added):
    """Add a mass (kg) at x, y, z (m) that acts along n alone to the upper triangle of an added inertia (6, 6)."""
    n = nx, ny, nz
    direction = *cross((x, y, z), n), nx, ny, nz
    for i in range(6):
        for j in range(i, 6):
            added[i, j] += mass * direction[i] * direction[j]


@part
def add_point(mass, x, y, z, added):
    """Add a point mass (kg) at x, y, z (m) to the upper triangle of an added inertia (6, 6)."""
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
    """Set out (6,) to the momentum of an added inertia (6, 6) with a twist (6,): linear, then angular momentum."""
    for i in range(6):
        k = 0.0
        for j in range(6):
            k += added[i, j] * twist[j]
        out[i - 3 if i >= 3 else i + 3] = k


@part
def add_inertia_to_matrix(held, parents, axes, matrix):
    """Add the added inertia of all bodies to the lower triangle of the mass matrix (m, m) of a tree.

    parents, axes: see `held_bodies.gather_twist`.
    """
    y = room1(6)
    for b in range(held.shape[0]):
        added = held[b].added_inertia
        if added[5, 5] == 0.0 and added[3, 3] == 0.0 and added[4, 4] == 0.0:
            continue
        i = held[b].last_dof
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
    """Add the implicit part of other forces to a mass matrix (m, m).

    shares (2,): factors of the derivatives and of the damping (m,), which belongs to the diagonal.
    derivatives: of forces by rates, a sparse matrix; row i has counts[i] entries from starts[i] on, in these columns.
    """
    for i in range(damping.shape[0]):
        matrix[i, i] += shares[1] * damping[i]
        if shares[0] != 0.0:
            for k in range(starts[i], starts[i] + counts[i]):
                matrix[i, columns[k]] += shares[0] * derivatives[k]


@part
def solve_symmetric(matrix, x):
    """Solve A y = x for a symmetric positive definite A (m, m), y in place of x (m,); A is given by its lower triangle.

    By the factorisation A = L^T D L, from the last row to the first (Featherstone, Rigid Body Dynamics Algorithms,
    2008, section 6.5). In a tree each degree of freedom has a higher number than its parent, so that zeros stay zero;
    they are skipped. The lower triangle is overwritten.
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
def find_zero_gain_load(body, turn, step):
    """Fill `zero_gain_load` from the wrench at the predicted end of the step; returns whether there is any wrench.

    The wrench belongs to the predicted gain: M predicted_gain / h is added to extrapolate it to a gain of zero.
    """
    p, w = room1(6), body.wrench
    f = turned_back(axes(turn), vector(w, 0))
    load = *f, *plus_cross(turned_back(axes(turn), vector(w, 3)), body.arm, f)
    momentum(body.added_inertia, body.predicted_gain, p)
    has_wrench = False
    for k in range(6):
        body.zero_gain_load[k] = load[k] + p[k] / step
        has_wrench = has_wrench or w[k] != 0.0
    return has_wrench


@part
def shift_wrench(w, x, y, z, out):
    """Set out (6,) to the wrench w (6,) about another point, at x, y, z (m) from the point of w."""
    out[0], out[1], out[2] = w[0], w[1], w[2]
    out[3] = w[3] - y * w[2] + z * w[1]
    out[4] = w[4] - z * w[0] + x * w[2]
    out[5] = w[5] - x * w[1] + y * w[0]


@part
def find_residual(body, c, inertial, step):
    """Fill `residual`: the extrapolated load at the gain that the trial step reached, less the load in that step.

    c (3,) m: the point of twists; inertial (3,) m: the centre of mass.
    """
    p, q = room1(6), room1(6)
    shift_wrench(body.load, c[0] - inertial[0], c[1] - inertial[1], c[2] - inertial[2], q)
    momentum(body.added_inertia, body.reached_gain, p)
    for k in range(6):
        body.residual[k] = body.zero_gain_load[k] - p[k] / step - q[k]


@part
def generalised_residual(held, parents, axes, out):
    """Fill out (m,) with the residuals of all bodies as generalised forces; see `held_bodies.gather_twist`."""
    out[:] = 0.0
    for b in range(held.shape[0]):
        residual, i = held[b].residual, held[b].last_dof
        while i >= 0:
            for k in range(6):
                out[i] += axes[i, k] * residual[k - 3 if k >= 3 else k + 3]
            i = parents[i]


@part
def extrapolate(body, load, gain, c, inertial, step, q):
    """Fill q (6,) with load - M gain / h: a load (6,) extrapolated to a gain (6,) of the twist by the added inertia M.

    q is about the centre of mass, inertial (3,) m; load, M and gain are about the point of twists, c (3,) m.
    """
    p = room1(6)
    momentum(body.added_inertia, gain, p)
    for k in range(6):
        p[k] = load[k] - p[k] / step
    shift_wrench(p, inertial[0] - c[0], inertial[1] - c[1], inertial[2] - c[2], q)


@part
def correct_load(body, c, inertial, step):
    """Correct `load` by its residual and Newton's correction of the twist, and fill `extrapolated`.

    `extrapolated` is what the load differs by from the load at the predicted end of the step.
    """
    q = room1(6)
    extrapolate(body, body.residual, body.correction, c, inertial, step, q)
    for k in range(6):
        body.load[k] += q[k]
    extrapolate(body, body.zero_gain_load, body.predicted_gain, c, inertial, step, q)
    for k in range(6):
        body.extrapolated[k] = body.load[k] - q[k]
