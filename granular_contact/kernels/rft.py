"""Resistive force theory in the plane (Li, Zhang and Goldman 2013).

An element lies at the angle beta to the horizontal and moves at the angle gamma below it; both are folded to
[-pi/2, pi/2], with beta > 0 where the leading face looks down. Stress per depth, against the motion and upward:

    alpha_z = A00 + A10 cos 2b + B11 sin(2b + g) + B01 sin g + B-11 sin(-2b + g)
    alpha_x = C11 cos(2b + g) + C01 cos g + C-11 cos(-2b + g) + D10 sin 2b

With the tangent t = (cos b, sin b) and the direction of motion u = (cos g, -sin g) all folds drop out, also that of
motion to the left: with c2 = t_x^2 - t_y^2 and s2 = 2 t_x t_y

    S_x = -[C01 + (C11 + C-11) c2] u_x - (C11 - C-11) s2 u_y - D10 s2
    S_y = A00 + A10 c2 + (B11 - B-11) s2 u_x - [B01 + (B11 + B-11) c2] u_y

which is even in t, and affine in u. The record holds the sums and differences, in N/m^3.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from granular_contact.kernels import law, plates, strips
from granular_contact.kernels.planar_friction import radial_return

TERMS = ("static",)
COEFFICIENTS = ("A00", "A10", "B01", "B_sum", "B_difference", "C01", "C_sum", "C_difference", "D10")
FRICTION = [("friction", "i8"), ("u_y", "f8"), ("tau", "f8"), ("v_eps", "f8")]
RECORD = np.dtype([(name, "f8") for name in COEFFICIENTS] + FRICTION)


@njit(cache=True)
def stress(tx, ty, ux, uy, m):
    """S (N/m^3) of the law; as `plates.stress`."""
    c2, s2 = tx * tx - ty * ty, 2.0 * tx * ty
    return (
        -(m.C01 + m.C_sum * c2) * ux - m.C_difference * s2 * uy - m.D10 * s2,
        m.A00 + m.A10 * c2 + m.B_difference * s2 * ux - (m.B01 + m.B_sum * c2) * uy,
    )


law.provide(plates.stress, "m", RECORD)(stress)
law.provide(law.strip_force, "m", RECORD)(plates.static_force)
law.provide(law.drag_anchor, "m", RECORD)(radial_return)
strips.line_law(RECORD, caps=False)
