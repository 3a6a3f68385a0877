"""Scalar laws of a ball: a force against its motion, of its speed v and the depth z of its lowest point.

    F = -s (F0 + k z^p) u - (b + c |v|) v

with the direction u and the share s of `planar_friction`. Bingham has F0 and b; Poncelet F0 and c; Allen et al. all
three; the linear static law k with p = 1; Tsimring and Volfson c, k and p; Katsuragi and Durian k, p = 1 and
c = m / d1, with the mass m of the ball in the run and d1 given (m) or as a multiple of the diameter.

What does not grow with depth by itself grows from nothing to its full value over the first SHALLOW diameters [ours], so
that the force is continuous at the touch.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from granular_contact.kernels import balls, law
from granular_contact.kernels.planar_friction import drive, mobilised, radial_return

STATIC, VISCOUS = 0, 1  # terms; where the quadratic one goes is the record's `quadratic`
SHALLOW = 1e-3

RECORD = np.dtype(
    [
        ("F0", "f8"),  # N
        ("k", "f8"),  # N/m^p
        ("p", "f8"),
        ("b", "f8"),  # N s/m
        ("c", "f8"),  # kg/m
        ("d1", "f8"),  # m; 0: none
        ("d1_per_diameter", "f8"),  # 0: none
        ("quadratic", "i8"),
        ("friction", "i8"),
        ("u_y", "f8"),
        ("tau", "f8"),
        ("v_eps", "f8"),
    ]
)


@njit(cache=True)
def coefficient(run, m):
    """Coefficient c (kg/m) of the quadratic term."""
    d1 = m.d1 + m.d1_per_diameter * run.width
    return m.c + (run.mass / d1 if d1 > 0.0 else 0.0)


@law.provide(law.ball_force, "m", RECORD)
@njit(cache=True)
def ball_force(z, vx, vy, ex, ey, run, m, f):
    """Add the force of a ball to f[term, xy]; arguments as in `law.ball_force`."""
    there = min(1.0, z / (SHALLOW * run.width))  # of the terms without depth
    qx, qy = drive(ex, ey, vx, vy, m)
    ux, uy, share = mobilised(qx, qy, m)
    static = share * (there * m.F0 + (m.k * z if m.p == 1.0 else m.k * z**m.p))
    f[STATIC, 0] -= static * ux
    f[STATIC, 1] -= static * uy
    viscous, quadratic = there * m.b, there * coefficient(run, m) * math.hypot(vx, vy)
    f[VISCOUS, 0] -= viscous * vx
    f[VISCOUS, 1] -= viscous * vy
    f[m.quadratic, 0] -= quadratic * vx
    f[m.quadratic, 1] -= quadratic * vy


law.provide(law.drag_anchor, "m", RECORD)(radial_return)
balls.ball_law(RECORD)
