"""Three-dimensional resistive force theory (Agarwal, Goldman and Kamrin 2023), used in the plane (psi = 0).

An element has the normal n, the one of its two that does not look up, and moves in the direction u; g points down.
With x1 = u . g = sin gamma, x2 = n . g = cos beta, x3 = n . u and the cubic polynomials f_i of the source in them

    alpha = f1 n + f2 u + f3 g

is its generic response, by components alpha_r (along the horizontal part of u) and alpha_z (up). Stress per depth

    S = xi_n [alpha_n + min(mu_surf |alpha_n| / |alpha_t|, 1) alpha_t],
    xi_n = rho_c g (894 mu_int^3 - 386 mu_int^2 + 89 mu_int)

with the parts of alpha normal and tangential to the element. Two things are [ours]. Where an element turns through the
vertical n jumps to its opposite, and the polynomials differ by up to 0.05: over |x2| < UPRIGHT both are averaged, with
weights from one to the other. In 143 of 32761 states of a 1 degree grid (upward faces at small angles to the motion)
the published polynomials would drive the element, by up to 0.005: there the part of S along u is dropped.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from granular_contact.kernels import law, plates, rft, strips
from granular_contact.kernels.planar_friction import radial_return

TERMS = ("static",)
RECORD = np.dtype([("xi_n", "f8"), ("mu_surf", "f8"), *rft.FRICTION])
UPRIGHT = 0.02  # cosine of beta: 1.1 degrees off the vertical

# Rows: 1, x1, x2, x3, x1^2, x2^2, x3^2, x1 x2, x2 x3, x3 x1, x1^3, x2^3, x3^3, x1 x2^2, x2 x1^2, x2 x3^2, x3 x2^2,
# x3 x1^2, x1 x3^2, x1 x2 x3; columns f1, f2, f3. In two of the 60 the published copies differ (.02730 and .18589).
C = np.array(
    [
        [0.00212, -0.06796, -0.02634],
        [-0.02320, -0.10941, -0.03436],
        [-0.20890, 0.04725, 0.45256],
        [-0.43083, -0.06914, 0.00835],
        [-0.00259, -0.05835, 0.02553],
        [0.48872, -0.65880, -1.31290],
        [-0.00415, -0.11985, -0.05532],
        [0.07204, -0.25739, 0.06790],
        [-0.02750, -0.26834, -0.16404],
        [-0.08772, 0.02692, 0.02287],
        [0.01992, -0.00736, 0.02927],
        [-0.45961, 0.63758, 0.95406],
        [0.40799, 0.08997, -0.00131],
        [-0.10107, 0.21069, -0.11028],
        [-0.06576, 0.04748, 0.01487],
        [0.05664, 0.20406, -0.02730],
        [-0.09269, 0.18589, 0.10911],
        [0.01892, 0.04934, -0.04097],
        [0.01033, 0.13527, 0.07881],
        [0.15120, -0.33207, -0.27519],
    ]
)


@njit(cache=True)
def cubic(x1, x2, x3, k):
    """Polynomial f_(k+1) and its derivatives by x1, x2, x3."""
    f = C[0, k] + x1 * (C[1, k] + x1 * (C[4, k] + x1 * C[10, k])) + x2 * (C[2, k] + x2 * (C[5, k] + x2 * C[11, k]))
    f += x3 * (C[3, k] + x3 * (C[6, k] + x3 * C[12, k]))
    f += x1 * x2 * (C[7, k] + x2 * C[13, k] + x1 * C[14, k]) + x2 * x3 * (C[8, k] + x3 * C[15, k] + x2 * C[16, k])
    f += x3 * x1 * (C[9, k] + x1 * C[17, k] + x3 * C[18, k] + x2 * C[19, k])
    d1 = C[1, k] + x1 * (2.0 * C[4, k] + 3.0 * x1 * C[10, k]) + x2 * (C[7, k] + x2 * C[13, k] + 2.0 * x1 * C[14, k])
    d1 += x3 * (C[9, k] + 2.0 * x1 * C[17, k] + x3 * C[18, k] + x2 * C[19, k])
    d2 = C[2, k] + x2 * (2.0 * C[5, k] + 3.0 * x2 * C[11, k]) + x1 * (C[7, k] + 2.0 * x2 * C[13, k] + x1 * C[14, k])
    d2 += x3 * (C[8, k] + x3 * C[15, k] + 2.0 * x2 * C[16, k] + x1 * C[19, k])
    d3 = C[3, k] + x3 * (2.0 * C[6, k] + 3.0 * x3 * C[12, k]) + x2 * (C[8, k] + 2.0 * x3 * C[15, k] + x2 * C[16, k])
    d3 += x1 * (C[9, k] + x1 * C[17, k] + 2.0 * x3 * C[18, k] + x2 * C[19, k])
    return f, d1, d2, d3


@njit(cache=True)
def alpha(nx, ny, ux, uy):
    """Generic response (alpha_x, alpha_y) of an element with normal n that moves in the direction u, unit vectors."""
    x1, x2, x3 = -uy, -ny, nx * ux + ny * uy
    f1, f2, f3 = cubic(x1, x2, x3, 0)[0], cubic(x1, x2, x3, 1)[0], cubic(x1, x2, x3, 2)[0]
    return f1 * nx + f2 * ux, f1 * ny + f2 * uy - f3


@njit(cache=True)
def alpha_slopes(nx, ny, ux, uy):
    """Response (2,) of `alpha` and its derivatives by n_x, n_y, u_x, u_y: two rows of four."""
    x1, x2, x3 = -uy, -ny, nx * ux + ny * uy
    f1, a1, b1, c1 = cubic(x1, x2, x3, 0)
    f2, a2, b2, c2 = cubic(x1, x2, x3, 1)
    f3, a3, b3, c3 = cubic(x1, x2, x3, 2)
    # By x1, x2, x3 of alpha, then on to n and u by the chain rule.
    x_1, x_2, x_3 = a1 * nx + a2 * ux, b1 * nx + b2 * ux, c1 * nx + c2 * ux
    y_1, y_2, y_3 = a1 * ny + a2 * uy - a3, b1 * ny + b2 * uy - b3, c1 * ny + c2 * uy - c3
    return (
        f1 * nx + f2 * ux, f1 * ny + f2 * uy - f3,
        f1 + x_3 * ux, x_3 * uy - x_2, f2 + x_3 * nx, x_3 * ny - x_1,
        y_3 * ux, f1 + y_3 * uy - y_2, y_3 * nx, f2 + y_3 * ny - y_1,
    )  # fmt: skip


@njit(cache=True)
def limited(ax, ay, tx, ty, ux, uy, m):
    """S / xi_n from alpha: its tangential part limited by the friction of the surface, what would drive dropped."""
    normal, along = ax * ty - ay * tx, ax * tx + ay * ty
    most = m.mu_surf * abs(normal)
    excess = along - min(most, max(-most, along))
    ax, ay = ax - excess * tx, ay - excess * ty
    power = max(0.0, ax * ux + ay * uy)
    return ax - power * ux, ay - power * uy


@njit(cache=True)
def stress(tx, ty, ux, uy, m):
    """S (N/m^3) of the law; as `plates.stress`."""
    if tx < 0.0:
        tx, ty = -tx, -ty
    ax, ay = alpha(ty, -tx, ux, uy)
    if tx < UPRIGHT:
        bx, by = alpha(-ty, tx, ux, uy)
        w = 0.5 * (1.0 + tx / UPRIGHT)
        ax, ay = w * ax + (1.0 - w) * bx, w * ay + (1.0 - w) * by
    sx, sy = limited(ax, ay, tx, ty, ux, uy, m)
    return m.xi_n * sx, m.xi_n * sy


@njit(cache=True)
def stress_slopes(tx, ty, ux, uy, m):
    """S and its derivatives; as `plates.stress_slopes`."""
    turned = -1.0 if tx < 0.0 else 1.0
    tx, ty = turned * tx, turned * ty
    # n = (ty, -tx)
    ax, ay, xnx, xny, xux, xuy, ynx, yny, yux, yuy = alpha_slopes(ty, -tx, ux, uy)
    xtx, xty, ytx, yty = -xny, xnx, -yny, ynx
    if tx < UPRIGHT:
        bx, by, pnx, pny, pux, puy, qnx, qny, qux, quy = alpha_slopes(-ty, tx, ux, uy)
        w, w_tx = 0.5 * (1.0 + tx / UPRIGHT), 0.5 / UPRIGHT
        o = 1.0 - w
        xtx, ytx = w * xtx + o * pny + w_tx * (ax - bx), w * ytx + o * qny + w_tx * (ay - by)
        xty, yty = w * xty - o * pnx, w * yty - o * qnx
        xux, xuy, yux, yuy = w * xux + o * pux, w * xuy + o * puy, w * yux + o * qux, w * yuy + o * quy
        ax, ay = w * ax + o * bx, w * ay + o * by
    normal, along = ax * ty - ay * tx, ax * tx + ay * ty
    most = m.mu_surf * abs(normal)
    if abs(along) > most:
        # S = normal n + sign(along) mu |normal| t, so S = normal (n + k t).
        k = m.mu_surf if normal * along > 0.0 else -m.mu_surf
        lx, ly = ty + k * tx, -tx + k * ty
        normal_tx, normal_ty = xtx * ty - ytx * tx - ay, xty * ty - yty * tx + ax
        normal_ux, normal_uy = xux * ty - yux * tx, xuy * ty - yuy * tx
        ax, ay = normal * lx, normal * ly
        xtx, xty = normal_tx * lx + normal * k, normal_ty * lx + normal
        ytx, yty = normal_tx * ly - normal, normal_ty * ly + normal * k
        xux, xuy, yux, yuy = normal_ux * lx, normal_uy * lx, normal_ux * ly, normal_uy * ly
    power = ax * ux + ay * uy
    if power > 0.0:
        power_tx, power_ty = xtx * ux + ytx * uy, xty * ux + yty * uy
        power_ux, power_uy = xux * ux + yux * uy + ax, xuy * ux + yuy * uy + ay
        ax, ay = ax - power * ux, ay - power * uy
        xtx, xty, ytx, yty = xtx - power_tx * ux, xty - power_ty * ux, ytx - power_tx * uy, yty - power_ty * uy
        xux, xuy = xux - power_ux * ux - power, xuy - power_uy * ux
        yux, yuy = yux - power_ux * uy, yuy - power_uy * uy - power
    x, t = m.xi_n, m.xi_n * turned
    return x * ax, x * ay, t * xtx, t * xty, t * ytx, t * yty, x * xux, x * xuy, x * yux, x * yuy


law.provide(plates.stress, "m", RECORD)(stress)
law.provide(plates.stress_slopes, "m", RECORD)(stress_slopes)
law.provide(law.strip_force, "m", RECORD)(plates.static_force)
law.provide(law.strip_tangent, "m", RECORD)(plates.static_tangent)
law.provide(law.drag_anchor, "m", RECORD)(radial_return)
strips.line_law(RECORD, caps=False)
