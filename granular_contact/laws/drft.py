"""Dynamic resistive force theory (Agarwal et al. 2021): the stress of `rft`, and the inertia of the grains pushed away.

    traction = z S(t, u) - lam rho v_n |v_n| n

with the true velocity v and its part v_n normal to the element; on a one-sided outline only where n . v > 0. The free
surface may be lowered by delta_h. Behind the axle of a turning wheel it is lowered by r (r omega^2 / g), as the source
has it for driven wheels [1]; see `sand.kernels.wheels`. In space n is the normal of a facet. With w = t x v = v_n and
n = (-t_y, t_x), the inertial term of a straight strip is a cubic in xi on either side of the zero of w, which two Gauss
points integrate exactly.
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from granular_contact.laws.gravity import BULK, INERTIA, derived, not_known
from granular_contact.laws.law import Law
from granular_contact.laws.rft import CONSTANTS, FACTOR, GENERIC, WITH_GRAVITY, Rft, RftCoefficients
from granular_contact.sand import kernels
from granular_contact.values.strict import NotNegative, Positive

INERTIAL = 1  # term


class Drft(Law):
    """The stress of rft, and the inertia -lambda rho v_n^2 n of the grains pushed away (Agarwal et al. 2021).

    Parameters
    ----------
    coefficients : RftCoefficients
        Left out: the generic set, for which zeta is the medium's.
    density : float
        Of the medium (kg/m3), above 0.
    lam : float
        Factor of the inertia, 0 or more; `lambda` in YAML.
    zeta : float
        Factor of the coefficients, above 0.
    surface_drop : float
        delta_h (m), by which the free surface is lowered.
    wheel_drop : float
        Behind the axle of a turning `wheel` the surface is lowered by so many times r (r omega^2 / g); 0: it is
        not.
    """

    law: Literal["drft"]
    coefficients: Annotated[RftCoefficients, WITH_GRAVITY] = Field(GENERIC, alias="alpha_N_cm3")
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
        """As `Law.numbers`."""
        static = self.coefficients.numbers(self.zeta)
        return static | {"lam_rho": self.lam * self.density, "delta_h": self.surface_drop}

    stress = staticmethod(Rft.stress)

    @staticmethod
    def strip_force(strip, line, m, f):
        """Add the static and the inertial term; arguments as in `sand.kernels.law.strip_force`."""
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
        """Inertial traction; as `sand.kernels.facet_blocks.inertia`."""
        w = n[0] * v[0] + n[1] * v[1] + n[2] * v[2]
        inertial = 0.0 if side * w < 0.0 else pressure(w, m.lam_rho)
        return -inertial * n[0], -inertial * n[1], -inertial * n[2]


def pressure(w, lam_rho):
    """Inertia lam rho w |w| (Pa) of the grains before an element with the velocity w (m/s) along its normal."""
    return lam_rho * w * abs(w)


def inertial_force(strip, k, line, f):
    """Add the inertial term to f[INERTIAL]; k = lam rho b (kg/m2)."""
    length = kernels.vectors.norm(strip.c)
    k *= length
    chord = strip.c[0] / length, strip.c[1] / length
    (v0x, v0y), (v1x, v1y) = strip.v0, strip.v1
    t0x, t0y = kernels.plates.tangent_at(chord, line.turn, 0.0)
    t1x, t1y = kernels.plates.tangent_at(chord, line.turn, 1.0)
    turn = kernels.immersion.sign_change(strip.a, strip.b, t0x * v0y - t0y * v0x, t1x * v1y - t1y * v1x)
    for start, end in ((strip.a, turn), (turn, strip.b)):
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
