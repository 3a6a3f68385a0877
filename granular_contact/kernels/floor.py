"""Stiff contact with the floor of a bed: a spring and a damper per unit of length, normal to a level floor.

    dF_y/ds = k delta max(0, 1 - d v_y)

with the depth delta below the floor and the vertical velocity v_y at mid-strip. The damping grows with the depth, so
the force is continuous at the touch, and it never pulls. On a ball k acts over its diameter.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from granular_contact.kernels import balls, law, strips
from granular_contact.kernels.immersion import part_integrals

TERMS = ("floor",)
# N/m^2, s/m. The order makes two types of them, one for strips and one for balls.
STRIP_RECORD = np.dtype([("floor_stiffness", "f8"), ("floor_damping", "f8")])
BALL_RECORD = np.dtype([("floor_damping", "f8"), ("floor_stiffness", "f8")])


@law.provide(law.strip_force, "m", STRIP_RECORD)
@njit(cache=True)
def strip_force(a, b, z0, z1, cx, cy, v0x, v0y, v1x, v1y, e0x, e0y, e1x, e1y, run, m, f):
    """Add the end forces of a strip; z0, z1 are depths below the floor, else as in `law.strip_force`."""
    share = max(0.0, 1.0 - m.floor_damping * 0.5 * (v0y + v1y))
    k = m.floor_stiffness * share * math.hypot(cx, cy)
    j0, j1 = part_integrals(a, b, z0, z1, 1.0)
    f[0, 0, 1] += k * j0
    f[0, 1, 1] += k * j1


@law.provide(law.ball_force, "m", BALL_RECORD)
@njit(cache=True)
def ball_force(z, vx, vy, ex, ey, run, m, f):
    """Add the force of a ball, z being the depth of its lowest point below the floor; as in `law.ball_force`."""
    f[0, 1] += m.floor_stiffness * run.width * z * max(0.0, 1.0 - m.floor_damping * vy)


@law.provide(law.drag_anchor, "m", STRIP_RECORD)
@law.provide(law.drag_anchor, "m", BALL_RECORD)
@njit(cache=True)
def drag_anchor(px, py, ax, ay, m):
    """A floor has no bristles."""
    return ax, ay


strips.line_law(STRIP_RECORD, caps=False)
balls.ball_law(BALL_RECORD)
