"""What the scalar laws of a ball share: a force against its motion, of its speed v and the depth z of its lowest point.

    F = -s (F0 + k z^p) u - (b + c |v|) v

with the direction u and the share s of `planar_friction`. Bingham has F0 and b; Poncelet F0 and c; Allen et al. all
three; the linear static law k with p = 1; Tsimring and Volfson c, k and p; Katsuragi and Durian k, p = 1 and
c = m / d1, with the mass m of the ball and d1 given (m) or as a multiple of the diameter.

What does not grow with depth by itself grows from nothing to its full value over the first SHALLOW diameters [ours], so
that the force is continuous at the touch.
"""

from __future__ import annotations

from granular_contact.laws.gravity import measured, not_known
from granular_contact.laws.law import Law
from granular_contact.sand import kernels

STATIC, VISCOUS = 0, 1  # terms; where the quadratic one goes is the record's `quadratic`
SHALLOW = 1e-3

WITH_DEPTH = measured(
    1,
    "bodies settle as deep at 0.4 g to 1.2 g, in times as g^-1/2 (Altshuler et al. 2014); friction is loaded by the "
    "weight of the grains, which air through the bed made less (Brzinski, Mayor and Durian 2013)",
)
YIELD = not_known("a force that does not grow with depth is fitted over all depths of a test")
OF_SPEED = not_known("nothing viscous was found in dry grains; it is a fit")


class ScalarLaw(Law):
    """A law that gives some of the constants; the last of its terms takes what is quadratic in speed."""

    takes = frozenset({"ball"})
    # N, N/m^p, -, N s/m, kg/m, m (0: none), - (0: none), index of a term
    constants = ("F0", "k", "p", "b", "c", "d1", "d1_per_diameter", "quadratic")

    def own(self) -> dict[str, float]:
        """Constants that the law has."""
        raise NotImplementedError

    def numbers(self, gravity: float) -> dict[str, float]:
        """As `Law.numbers`; gravity is in the coefficients."""
        return {"p": 1.0, "quadratic": len(self.terms) - 1.0, **self.own()}

    @staticmethod
    def ball_force(z, v, e, line, m, f):
        """Add the force of a ball to f[term, xy]; arguments as in `sand.kernels.law.ball_force`."""
        u, share = kernels.planar_friction.mobilised(kernels.planar_friction.drive(e, v, m), m)
        resist(z, u, share, v, line, m, f)

    @staticmethod
    def space_ball_force(z, v, e, cluster, m, f):
        """Add the force of a ball in space to f[term, xyz]; arguments as in `sand.kernels.space_law.ball_force`."""
        u, share = kernels.space_friction.mobilised(kernels.space_friction.drive(e, v, m), m)
        resist(z, u, share, v, cluster, m, f)


def resist(z, u, share, v, shape, m, f):
    """Add the force at a depth z (m) to f[term, axis]: share of the static part against u, the rest against v (m/s)."""
    static, viscous, quadratic = resistance(z, kernels.vectors.norm(v), shape, m)
    last = int(m.quadratic)
    for i in range(len(v)):
        f[STATIC, i] -= share * static * u[i]
        f[VISCOUS, i] -= viscous * v[i]
        f[last, i] -= quadratic * v[i]


def resistance(z, speed, line, m):
    """Resistance at a depth z (m): bound of the static part (N), and factors of the velocity (N s/m) in the others."""
    there = min(1.0, z / (SHALLOW * line.width))  # of the terms without depth
    static = there * m.F0 + (m.k * z if m.p == 1.0 else m.k * z**m.p)
    return static, there * m.b, there * coefficient(line, m) * speed


def coefficient(line, m):
    """Coefficient c (kg/m) of the quadratic term."""
    d1 = m.d1 + m.d1_per_diameter * line.width
    return m.c + (line.mass / d1 if d1 > 0.0 else 0.0)
