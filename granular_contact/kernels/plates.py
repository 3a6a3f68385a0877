"""Laws of a surface element: a stress that grows with depth and depends on how the element lies and moves.

A strip is a plate of width b normal to the plane; with its unit tangent t, the direction u in which it moves and the
depth z, a law gives the stress z S(t, u) (Pa), S in N/m^3. The direction is taken at mid-strip and regularised as in
`planar_friction` (share s); the depth is integrated exactly from the surface crossing:

    f_e = s g b |c| S(t, u) int z N_e dxi.

Both faces of a plate are in S, so S(-t, u) = S(t, u). A round bar counts as a plate of width d [ours]. On a one-sided
outline with the outward normal n only elements with n . v > 0 are loaded; as S does not vanish where n . v does, the
stress is faded in over the first EDGE of n . u, g = clip(n . u / EDGE, 0, 1), to keep forces continuous [ours].
"""

from __future__ import annotations

import math

from numba import njit

from granular_contact.kernels.immersion import pressure_integral_gradients, pressure_integrals
from granular_contact.kernels.planar_friction import by_stretch, mobilised, mobilised_slopes

STATIC = 0
EDGE = 0.05  # sine of the angle between an element and its motion up to which the stress is faded in: 2.9 degrees


def stress(tx, ty, ux, uy, m):
    """Stress per depth (S_x, S_y), N/m^3, on an element along t that moves in the direction u, unit vectors."""
    raise NotImplementedError


def stress_slopes(tx, ty, ux, uy, m):
    """S and its derivatives: (S_x, S_y, S_x,tx, S_x,ty, S_y,tx, S_y,ty, S_x,ux, S_x,uy, S_y,ux, S_y,uy)."""
    raise NotImplementedError


@njit(cache=True)
def leading(tx, ty, ux, uy, side):
    """Factor g in [0, 1] of an element of an outline; 1 on a thin plate (side 0)."""
    if side == 0:
        return 1.0
    return min(1.0, max(0.0, side * (tx * uy - ty * ux) / EDGE))


@njit(cache=True)
def static_force(z0, z1, cx, cy, v0x, v0y, v1x, v1y, ex, ey, run, m, f):
    """Add the static term of a strip to f[STATIC]; arguments as in `law.strip_force`."""
    ux, uy, share = mobilised(ex, ey, 0.5 * (v0x + v1x), 0.5 * (v0y + v1y), m)
    if share == 0.0:
        return
    length = math.hypot(cx, cy)
    if length == 0.0:  # has no surface
        return
    tx, ty = cx / length, cy / length
    k = share * leading(tx, ty, ux, uy, run.side) * run.width * length
    if k == 0.0:
        return
    sx, sy = stress(tx, ty, ux, uy, m)
    j0, j1 = pressure_integrals(z0, z1)
    f[STATIC, 0, 0] += k * j0 * sx
    f[STATIC, 0, 1] += k * j0 * sy
    f[STATIC, 1, 0] += k * j1 * sx
    f[STATIC, 1, 1] += k * j1 * sy


@njit(cache=True)
def static_tangent(z0, z1, cx, cy, v0x, v0y, v1x, v1y, ex, ey, run, m, kp, kz, kv):
    """Add the derivatives of `static_force`; arguments as in `law.strip_tangent`."""
    vx, vy = 0.5 * (v0x + v1x), 0.5 * (v0y + v1y)
    ux, uy, share = mobilised(ex, ey, vx, vy, m)
    if share == 0.0:
        return
    length = math.hypot(cx, cy)
    if length == 0.0:  # has no surface
        return
    tx, ty = cx / length, cy / length
    g = leading(tx, ty, ux, uy, run.side)
    if g == 0.0:
        return
    sx, sy, xtx, xty, ytx, yty, xux, xuy, yux, yuy = stress_slopes(tx, ty, ux, uy, m)
    if g < 1.0:
        rise = run.side / EDGE  # g = rise (tx uy - ty ux)
        xtx, xty, ytx, yty = (
            g * xtx + sx * rise * uy, g * xty - sx * rise * ux, g * ytx + sy * rise * uy, g * yty - sy * rise * ux,
        )  # fmt: skip
        xux, xuy, yux, yuy = (
            g * xux - sx * rise * ty, g * xuy + sx * rise * tx, g * yux - sy * rise * ty, g * yuy + sy * rise * tx,
        )  # fmt: skip
        sx, sy = g * sx, g * sy
    s_q, s_over_q, q_v = mobilised_slopes(ex, ey, vx, vy, m)
    j0, j1 = pressure_integrals(z0, z1)
    g00, g01, g10, g11 = pressure_integral_gradients(z0, z1)
    for i, s_i, it_x, it_y, iu_x, iu_y in ((0, sx, xtx, xty, xux, xuy), (1, sy, ytx, yty, yux, yuy)):
        # d(|c| S(t)) / dc = S t^T + S_t (I - t t^T), and d(s S(u)) / dq likewise.
        along_t = s_i - it_x * tx - it_y * ty
        by_cx, by_cy = share * (it_x + along_t * tx), share * (it_y + along_t * ty)
        along_u = s_q * s_i - s_over_q * (iu_x * ux + iu_y * uy)
        by_qx, by_qy = length * (s_over_q * iu_x + along_u * ux), length * (s_over_q * iu_y + along_u * uy)
        by_ex, by_ey = by_stretch(by_qx, by_qy, ex, ey, m)
        for end, j, gz0, gz1 in ((0, j0, g00, g01), (2, j1, g10, g11)):
            row = end + i
            k = run.width * j
            half_e, half_v = 0.5 * k, 0.5 * k * q_v
            kp[row, 0] += half_e * by_ex - k * by_cx
            kp[row, 1] += half_e * by_ey - k * by_cy
            kp[row, 2] += half_e * by_ex + k * by_cx
            kp[row, 3] += half_e * by_ey + k * by_cy
            kv[row, 0] += half_v * by_qx
            kv[row, 1] += half_v * by_qy
            kv[row, 2] += half_v * by_qx
            kv[row, 3] += half_v * by_qy
            kz[row, 0] += run.width * length * share * s_i * gz0
            kz[row, 1] += run.width * length * share * s_i * gz1
