"""Three-dimensional resistive force theory (Agarwal, Goldman and Kamrin 2023).

An element has two normals; n is the one that does not look up. The element moves in the direction u, and g points down.
With x1 = u . g = sin gamma, x2 = n . g = cos beta, x3 = n . u and the cubic polynomials f_i of the source in them, its
generic response is

    alpha = f1 n + f2 u + f3 g

With the horizontal direction of motion r, and theta normal to it, u = cos gamma r - sin gamma z and n = sin beta (cos
psi r + sin psi theta) - cos beta z. Then the components of alpha are alpha_r, alpha_theta and alpha_z of the source,
and x3 = cos psi cos gamma sin beta + sin gamma cos beta. In the plane psi is 0 or 180 degrees. The stress per depth is

    S = xi_n [alpha_n + min(mu_surf |alpha_n| / |alpha_t|, 1) alpha_t],
    xi_n = rho_c g (894 mu_int^3 - 386 mu_int^2 + 89 mu_int)

with the components alpha_n normal and alpha_t tangential to the element.

Published copies of the polynomials agree in 58 of their 60 coefficients, and one public code has the same n, x_i and
alpha. Values at other psi than 0 and 180 degrees were checked against these formulas only, not against published
numbers.

Two things are [ours]. Where an element turns through the vertical, n jumps to its opposite, and the polynomials differ
by up to 0.05. For |x2| < UPRIGHT both values are averaged, with weights that go from one to the other. The source has a
jump there: a plate that is swept broadside stops after 0.250 mm if it leans by 2 degrees to one side, and after 0.230
mm if it leans to the other. With a quarter of this width, shipped configs and upright plates and cylinders move alike
within 1.2e-4 of their path, and a plate that leans by half a degree moves 3 to 7 % less or more far. But the force on a
wheel of 64 strips in the plane then ripples by 7e-4 as it turns; with this width it ripples by 4e-4. The ripple falls
with the power 1.6 of the number of strips, not 2. So the width stays.

In 143 of 32761 states of a 1 degree grid at psi = 0 (upward faces at small angles to the motion) the published
polynomials would drive the element, by up to 0.005. There the component of S along u is dropped.
"""

from __future__ import annotations

import math
from typing import Annotated, Literal

from pydantic import Field

from granular_contact.laws.gravity import BULK, FRICTION
from granular_contact.laws.law import Law
from granular_contact.values.strict import NotNegative, Positive

UPRIGHT = 0.02  # cosine of beta: 1.1 degrees off the vertical

# Rows: 1, x1, x2, x3, x1^2, x2^2, x3^2, x1 x2, x2 x3, x3 x1, x1^3, x2^3, x3^3, x1 x2^2, x2 x1^2, x2 x3^2, x3 x2^2,
# x3 x1^2, x1 x3^2, x1 x2 x3; columns f1, f2, f3. In two of the 60 the published copies differ (.02730 and .18589).
C = (
    (0.00212, -0.06796, -0.02634),
    (-0.02320, -0.10941, -0.03436),
    (-0.20890, 0.04725, 0.45256),
    (-0.43083, -0.06914, 0.00835),
    (-0.00259, -0.05835, 0.02553),
    (0.48872, -0.65880, -1.31290),
    (-0.00415, -0.11985, -0.05532),
    (0.07204, -0.25739, 0.06790),
    (-0.02750, -0.26834, -0.16404),
    (-0.08772, 0.02692, 0.02287),
    (0.01992, -0.00736, 0.02927),
    (-0.45961, 0.63758, 0.95406),
    (0.40799, 0.08997, -0.00131),
    (-0.10107, 0.21069, -0.11028),
    (-0.06576, 0.04748, 0.01487),
    (0.05664, 0.20406, -0.02730),
    (-0.09269, 0.18589, 0.10911),
    (0.01892, 0.04934, -0.04097),
    (0.01033, 0.13527, 0.07881),
    (0.15120, -0.33207, -0.27519),
)
F1, F2, F3 = (tuple(row[k] for row in C) for k in range(3))


class Rft3d(Law):
    """Three-dimensional resistive force theory, which needs density and friction only (Agarwal et al. 2023).

    Parameters
    ----------
    density : float
        Bulk density (kg/m3), above 0.
    mu_int : float
        Internal friction coefficient of the medium, above 0.
    mu_surf : float
        Friction coefficient between the medium and the surface of a body, 0 or more.
    """

    law: Literal["rft3d"]
    density: Annotated[Positive, BULK] = Field(alias="density_kg_m3")
    mu_int: Annotated[Positive, FRICTION]
    mu_surf: Annotated[NotNegative, FRICTION]

    equation = "stress = xi_n [alpha_n + min(mu_surf |alpha_n| / |alpha_t|, 1) alpha_t] z"
    terms = ("static",)
    takes = frozenset({"round", "flat", "outline"})
    constants = ("xi_n", "mu_surf")

    def stiffness(self, gravity: float) -> float:
        """Factor xi_n of the generic response.

        Parameters
        ----------
        gravity : float
            Gravity (m/s2); its sign does not matter.

        Returns
        -------
        float
            xi_n (N/m3).
        """
        mu = self.mu_int
        return self.density * abs(gravity) * (894.0 * mu**3 - 386.0 * mu**2 + 89.0 * mu)

    def numbers(self, gravity: float) -> dict[str, float]:
        """Constants of the stress; see `Law.numbers`."""
        return {"xi_n": self.stiffness(gravity), "mu_surf": self.mu_surf}

    @staticmethod
    def stress(t, u, m):
        """Stress per depth S (2,) N/m^3 in the plane; arguments as in `laws.law`."""
        ax, _, ay = response((t[1], 0.0, -t[0]), (u[0], 0.0, u[1]))
        sx, sy = limited_in_plane((ax, ay), t, u, m)
        return m.xi_n * sx, m.xi_n * sy

    @staticmethod
    def facet_stress(n, u, m):
        """Stress per depth S (3,) N/m^3 in space; arguments as in `laws.law`."""
        return limited(response(n, u), n, u, m)


def response(n, u):
    """Generic response of an element, averaged near the vertical as the module says.

    With f_i = even_i + odd_i in n, the response for -n has f_i = even_i - odd_i. So the mean of both with the weights
    (1 + b) / 2 and (1 - b) / 2 is (b even_1 + odd_1) n + (even_2 + b odd_2) u + (even_3 + b odd_3) g.

    Parameters
    ----------
    n : tuple of float
        Unit normal (3,), of either sign, z up.
    u : tuple of float
        Unit direction of motion (3,).

    Returns
    -------
    tuple of float
        Response (3,), dimensionless.
    """
    (nx, ny, nz), (ux, uy, uz) = n, u
    x1, x2, x3 = -uz, -nz, nx * ux + ny * uy + nz * uz
    b = min(1.0, max(-1.0, x2 / UPRIGHT))
    even1, odd1 = cubic(x1, x2, x3, F1)
    even2, odd2 = cubic(x1, x2, x3, F2)
    even3, odd3 = cubic(x1, x2, x3, F3)
    f1, f2, f3 = b * even1 + odd1, even2 + b * odd2, even3 + b * odd3
    return f1 * nx + f2 * ux, f1 * ny + f2 * uy, f1 * nz + f2 * uz - f3


def cubic(x1, x2, x3, c):
    """Value of a polynomial f_i, split into its parts even and odd in x2 and x3 together.

    Parameters
    ----------
    x1, x2, x3 : float
        Arguments, see the module.
    c : tuple of float
        Coefficients (20,), a column of `C`.

    Returns
    -------
    tuple of float
        Even and odd part.
    """
    even = c[0] + x1 * (c[1] + x1 * (c[4] + x1 * c[10])) + x2 * x2 * (c[5] + x1 * c[13])
    even += x3 * (x3 * (c[6] + x1 * c[18]) + x2 * (c[8] + x1 * c[19]))
    odd = x2 * (c[2] + x1 * (c[7] + x1 * c[14]) + x2 * x2 * c[11]) + x3 * (c[3] + x1 * (c[9] + x1 * c[17]))
    return even, odd + x3 * (x3 * (x3 * c[12] + x2 * c[15]) + x2 * x2 * c[16])


def alpha(n, u):
    """Generic response by the published polynomials, without average near the vertical; n must not look up."""
    (nx, ny, nz), (ux, uy, uz) = n, u
    x1, x2, x3 = -uz, -nz, nx * ux + ny * uy + nz * uz
    f1, f2, f3 = (sum(cubic(x1, x2, x3, c)) for c in (F1, F2, F3))
    return f1 * nx + f2 * ux, f1 * ny + f2 * uy, f1 * nz + f2 * uz - f3


def limited(alpha, n, u, m):
    """Stress per depth from the generic response, with the limit of surface friction and without a driving component.

    Parameters
    ----------
    alpha : tuple of float
        Generic response (3,).
    n, u : tuple of float
        Unit normal and unit direction of motion (3,).
    m : record
        Constants of the law.

    Returns
    -------
    tuple of float
        S (3,) N/m^3.
    """
    (ax, ay, az), (nx, ny, nz), (ux, uy, uz) = alpha, n, u
    normal = ax * nx + ay * ny + az * nz
    tx, ty, tz = ax - normal * nx, ay - normal * ny, az - normal * nz
    limit, along = m.mu_surf * abs(normal), math.sqrt(tx * tx + ty * ty + tz * tz)
    share = limit / along if along > limit else 1.0
    ax, ay, az = normal * nx + share * tx, normal * ny + share * ty, normal * nz + share * tz
    power = max(0.0, ax * ux + ay * uy + az * uz)
    return m.xi_n * (ax - power * ux), m.xi_n * (ay - power * uy), m.xi_n * (az - power * uz)


def limited_in_plane(alpha, t, u, m):
    """S / xi_n in the plane, as by `limited`. The known tangent t saves a square root, a tenth of the time of a strip.

    Parameters
    ----------
    alpha : tuple of float
        Generic response (2,).
    t, u : tuple of float
        Unit tangent and unit direction of motion (2,).
    m : record
        Constants of the law.

    Returns
    -------
    tuple of float
        S / xi_n (2,).
    """
    (ax, ay), (tx, ty), (ux, uy) = alpha, t, u
    normal, along = ax * ty - ay * tx, ax * tx + ay * ty
    limit = m.mu_surf * abs(normal)
    excess = along - min(limit, max(-limit, along))
    ax, ay = ax - excess * tx, ay - excess * ty
    power = max(0.0, ax * ux + ay * uy)
    return ax - power * ux, ay - power * uy
