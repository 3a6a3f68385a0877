"""Dynamic resistive force theory (Agarwal et al. 2021): the stress of `rft`, and the inertia of displaced grains.

    traction = z S(t, u) - lam rho v_n |v_n| n

v is the true velocity and v_n its component normal to the element. On a one-sided outline the inertial term acts only
where n . v > 0. The free surface may be lowered by delta_h. Behind the axle of a turning wheel it is lowered by r (r
omega^2 / g), which the source states for driven wheels [1]; see `sand.kernels.wheels`. In space n is the normal of a
facet. With n = (-t_y, t_x) and w = t x v = v_n, the integrand of the inertial term of a straight strip is a cubic in xi
on either side of the zero of w. Two Gauss points integrate it exactly.
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from granular_contact.laws.gravity import BULK, INERTIA, derived, not_known
from granular_contact.laws.law import Law
from granular_contact.laws.rft import CONSTANTS, FACTOR, FRICTIONAL_STRESS, GENERIC, Rft, RftCoefficients
from granular_contact.sand import kernels
from granular_contact.values.strict import NotNegative, Positive

INERTIAL = 1  # term


class Drft(Law):
    """The stress of rft, and the inertia -lambda rho v_n^2 n of displaced grains (Agarwal et al. 2021).

    Parameters
    ----------
    coefficients : RftCoefficients
        Coefficients of the stress; by default the generic set, which the zeta of the medium scales.
    density : float
        Bulk density of the medium (kg/m3), above 0.
    lam : float
        Factor of the inertial term, 0 or more; `lambda` in YAML.
    zeta : float
        Factor of the coefficients, above 0.
    surface_drop : float
        delta_h (m), by which the free surface is lowered.
    wheel_drop : float
        Factor of r (r omega^2 / g), by which the surface behind the axle of a turning `wheel` is lowered; 0: not at
        all.
    """

    law: Literal["drft"]
    coefficients: Annotated[RftCoefficients, FRICTIONAL_STRESS] = Field(GENERIC, alias="alpha_N_cm3")
    density: Annotated[Positive, BULK] = Field(alias="density_kg_m3")
    lam: Annotated[NotNegative, INERTIA] = Field(alias="lambda")
    zeta: Annotated[Positive, FACTOR] = 1.0
    surface_drop: Annotated[NotNegative, not_known("a length found by trial")] = Field(0.0, alias="surface_drop_m")
    wheel_drop: Annotated[NotNegative, derived(0, "a factor of r omega^2 / g, which has the gravity")] = 1.0

    equation = "stress = zeta alpha(beta, gamma) z - lambda rho v_n |v_n| n"
    terms = ("static", "inertial")
    takes = frozenset({"round", "flat", "outline"})
    constants = ("lam_rho", "delta_h", *CONSTANTS)

    def numbers(self, gravity: float) -> dict[str, float]:
        """Constants of the forces; see `Law.numbers`."""
        static = self.coefficients.numbers(self.zeta)
        return static | {"lam_rho": self.lam * self.density, "delta_h": self.surface_drop}

    stress = staticmethod(Rft.stress)

    @staticmethod
    def strip_force(strip, line, m, f):
        """Add the static and the inertial term of a strip in the plane; arguments as in `laws.law`."""
        z0, z1 = strip.z0 - m.delta_h, strip.z1 - m.delta_h
        low, high = kernels.immersion.immersed_interval(z0, z1)
        a, b = max(strip.a, low), min(strip.b, high)
        if a >= b or kernels.vectors.norm(strip.c) == 0.0:
            return
        lowered = kernels.strip.Strip(a, b, z0, z1, strip.c, strip.v0, strip.v1, strip.e0, strip.e1)
        kernels.plates.static_force(lowered, line, m, f)
        inertial_force(lowered, m.lam_rho * line.width, line, f)

    @staticmethod
    def facet_inertia(n, v, side, m):
        """Inertial traction (3,) Pa on a facet; arguments as in `laws.law`."""
        w = n[0] * v[0] + n[1] * v[1] + n[2] * v[2]
        inertial = 0.0 if side * w < 0.0 else pressure(w, m.lam_rho)
        return -inertial * n[0], -inertial * n[1], -inertial * n[2]


def pressure(w, lam_rho):
    """Inertial pressure lam rho w |w| of the displaced grains on an element.

    Parameters
    ----------
    w : float
        Velocity of the element along its normal (m/s).
    lam_rho : float
        lambda rho (kg/m3).

    Returns
    -------
    float
        Pressure (Pa), with the sign of w.
    """
    return lam_rho * w * abs(w)


def inertial_force(strip, k, line, f):
    """Add the inertial term of a strip to f[INERTIAL].

    Parameters
    ----------
    strip : Strip
        The immersed part of the strip and its motion.
    k : float
        lam rho b (kg/m2), b being the width.
    line : record
        The contact line.
    f : (terms, 2, 2) array
        End forces (N), x and y.
    """
    length = kernels.vectors.norm(strip.c)
    k *= length
    chord = strip.c[0] / length, strip.c[1] / length
    (v0x, v0y), (v1x, v1y) = strip.v0, strip.v1
    t0x, t0y = kernels.plates.tangent_at(chord, line.turn, 0.0)
    t1x, t1y = kernels.plates.tangent_at(chord, line.turn, 1.0)
    split = kernels.immersion.sign_change(strip.a, strip.b, t0x * v0y - t0y * v0x, t1x * v1y - t1y * v1x)
    for start, end in ((strip.a, split), (split, strip.b)):
        if start == end:
            continue
        for gauss in (kernels.immersion.GAUSS_LOW, kernels.immersion.GAUSS_HIGH):
            xi = start + (end - start) * gauss
            sx, sy = kernels.plates.tangent_at(chord, line.turn, xi)
            w = sx * ((1.0 - xi) * v0y + xi * v1y) - sy * ((1.0 - xi) * v0x + xi * v1x)
            if line.side * w < 0.0:
                continue
            density = 0.5 * (end - start) * pressure(w, k)
            f[INERTIAL, 0, 0] += (1.0 - xi) * density * sy
            f[INERTIAL, 0, 1] -= (1.0 - xi) * density * sx
            f[INERTIAL, 1, 0] += xi * density * sy
            f[INERTIAL, 1, 1] -= xi * density * sx
