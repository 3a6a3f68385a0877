"""Equations of motion of the modal pendulum: M(q) q'' = h(q, q') + Q, with the coordinates of `modal`.

With the modal mass m (int Phi_i Phi_j dm = m delta_ij), c_i = int along Phi_i dm, p_i = int Phi_i dm, the static
moments S_e = int along dm and S_n = int across dm of the whole undeformed pendulum, and the distance b of the link's
axis from the pivot:

    M_11 = J + 2 b sum p_i q_{1+i} + m sum q_{1+i}^2,      M_1i = c_i,      M_ij = m delta_ij
    h_1  = -M_11' q_1' + g (S_e cos q_1 - (S_n + sum p_i q_{1+i}) sin q_1)
    h_i  = q_1'^2 (b p_i + m q_{1+i}) + g p_i cos q_1 - k_i q_{1+i} - d_i q_{1+i}'

J is the moment of inertia of the undeformed pendulum about the pivot; k_i and d_i are the stiffness and the internal
damping of mode i. Limit: the kinematics neglect the shortening of the axis by bending, so that the centrifugal force
softens the link and nothing stiffens it.
"""

from __future__ import annotations

import math

from granular_contact.engines.modal.kernels.modal import MOST_MODES
from granular_contact.jit.compiled import part
from granular_contact.jit.records import fields, record_dtype

# Units: J kg m2; S_e, S_n kg m; b m; m kg; c kg m; p kg; k N/m; d N s/m; g m/s2. true_sign: whether the static law is
# that of `slip`; still: greatest speed (m/s, without modes rad/s) that counts as standing still there; rates, margins,
# hold: addresses, see `modal_calls`.
PENDULUM = record_dtype(
    [
        ("modes", "i8"),
        ("true_sign", "?"),
        *fields("f8", "still", "J", "S_e", "S_n", "b", "m", "g"),
        ("c", "f8", (MOST_MODES,)),
        ("p", "f8", (MOST_MODES,)),
        ("k", "f8", (MOST_MODES,)),
        ("d", "f8", (MOST_MODES,)),
        *fields("i8", "rates", "margins", "hold"),
    ]
)


@part(inline=True)
def inertia(q, pendulum):
    """M_11 (kg m2): moment of inertia of the deflected pendulum about the pivot."""
    total = pendulum.J
    for i in range(pendulum.modes):
        total += (2.0 * pendulum.b * pendulum.p[i] + pendulum.m * q[1 + i]) * q[1 + i]
    return total


@part(inline=True)
def momentum(q, v, pendulum):
    """Angular momentum about the pivot (kg m2/s), clockwise."""
    total = inertia(q, pendulum) * v[0]
    for i in range(pendulum.modes):
        total += pendulum.c[i] * v[1 + i]
    return total


@part(inline=True)
def own_forces(q, v, pendulum, h):
    """Fill h (n + 1,): generalised forces of inertia, gravity, elasticity and internal damping."""
    own_forces_at(math.cos(q[0]), math.sin(q[0]), q, v, pendulum, h)


@part(inline=True)
def own_forces_at(cos, sin, q, v, pendulum, h):
    """`own_forces`, given the cosine and the sine of q_1."""
    growth, static = 0.0, pendulum.S_n
    for i in range(pendulum.modes):
        x, x_t, p = q[1 + i], v[1 + i], pendulum.p[i]
        growth += 2.0 * (pendulum.b * p + pendulum.m * x) * x_t
        static += p * x
        h[1 + i] = v[0] * v[0] * (pendulum.b * p + pendulum.m * x) + pendulum.g * p * cos
        h[1 + i] -= pendulum.k[i] * x + pendulum.d[i] * x_t
    h[0] = -growth * v[0] + pendulum.g * (pendulum.S_e * cos - static * sin)


@part(inline=True)
def accelerate(q, f, pendulum):
    """Replace generalised forces f (n + 1,) by the accelerations M^-1 f; M is an arrow matrix, so the cost is O(n)."""
    reduced, rest = inertia(q, pendulum), f[0]
    for i in range(pendulum.modes):
        share = pendulum.c[i] / pendulum.m
        reduced -= share * pendulum.c[i]
        rest -= share * f[1 + i]
    f[0] = rest / reduced
    for i in range(pendulum.modes):
        f[1 + i] = (f[1 + i] - pendulum.c[i] * f[0]) / pendulum.m


@part(inline=True)
def damping_power(v, pendulum):
    """Power of the internal damping (W), never positive."""
    power = 0.0
    for i in range(pendulum.modes):
        power -= pendulum.d[i] * v[1 + i] * v[1 + i]
    return power
