"""Base class of the scalar laws of a ball: a force against its motion, from its speed and its depth.

    F = -s (F0 + k z^p) u - (b + c |v|) v

with the velocity v, the depth z of the lowest point of the ball, and the direction u and the mobilised share s of
`planar_friction`. Bingham has F0 and b; Poncelet F0 and c; Allen et al. all three; the linear static law k with p = 1;
Tsimring and Volfson c, k and p; Katsuragi and Durian k, p = 1 and c = m / d1, with the mass m of the ball and the
length d1, which is given in m or as a multiple of the diameter.

Terms that do not grow with depth by themselves grow from 0 to their full value over the first SHALLOW diameters of
depth [ours], so that the force is continuous at the touch.
"""

from __future__ import annotations

from granular_contact.laws.gravity import measured, not_known
from granular_contact.laws.law import Law
from granular_contact.sand import kernels

STATIC, VISCOUS = 0, 1  # terms; that of the quadratic part is `quadratic` of the record
SHALLOW = 1e-3  # depth, in diameters, over which the terms without depth grow to their full value

DEPTH_FORCE = measured(
    1,
    "bodies settle as deep at 0.4 g to 1.2 g, in times as g^-1/2 (Altshuler et al. 2014); friction is loaded by the "
    "weight of the grains, which air through the bed made less (Brzinski, Mayor and Durian 2013)",
)
YIELD = not_known("a force that does not grow with depth is fitted over all depths of a test")
VISCOSITY = not_known("nothing viscous was found in dry grains; it is a fit")


class ScalarLaw(Law):
    """Law that uses some of the constants of the general form. Its last term takes the part quadratic in speed."""

    takes = frozenset({"ball"})
    # Units: N, N/m^p, -, N s/m, kg/m, m (0: none), - (0: none), index of a term
    constants = ("F0", "k", "p", "b", "c", "d1", "d1_per_diameter", "quadratic")

    def force_constants(self) -> dict[str, float]:
        """Constants of the general form that the law uses; the others are 0.

        Returns
        -------
        dict
            Values of some of `constants`, in SI units.
        """
        raise NotImplementedError

    def numbers(self, gravity: float) -> dict[str, float]:
        """Constants of the force; see `Law.numbers`. Gravity is already in the coefficients."""
        return {"p": 1.0, "quadratic": len(self.terms) - 1.0, **self.force_constants()}

    @staticmethod
    def ball_force(z, v, e, line, m, f):
        """Add the force on a ball in the plane; arguments as in `laws.law`."""
        u, share = kernels.planar_friction.mobilised(kernels.planar_friction.drive(e, v, m), m)
        resist(z, u, share, v, line, m, f)

    @staticmethod
    def space_ball_force(z, v, e, cluster, m, f):
        """Add the force on a ball in space; arguments as in `laws.law`."""
        u, share = kernels.space_friction.mobilised(kernels.space_friction.drive(e, v, m), m)
        resist(z, u, share, v, cluster, m, f)


def resist(z, u, share, v, shape, m, f):
    """Add the force on a ball to f[term, axis], in the plane or in space.

    Parameters
    ----------
    z : float
        Depth of its lowest point (m), above 0.
    u : tuple of float
        Direction that the static part opposes, a unit vector or 0.
    share : float
        Mobilised share of the static part.
    v : tuple of float
        Velocity (m/s), which the other parts oppose.
    shape : record
        Contact line or cluster of the ball, with its diameter `width` (m) and its `mass` (kg).
    m : record
        Constants of the law.
    f : (terms, axes) array
        Force of each term (N).
    """
    static, viscous, quadratic = resistance(z, kernels.vectors.norm(v), shape, m)
    last = int(m.quadratic)
    for i in range(len(v)):
        f[STATIC, i] -= share * static * u[i]
        f[VISCOUS, i] -= viscous * v[i]
        f[last, i] -= quadratic * v[i]


def resistance(z, speed, line, m):
    """Magnitudes of the three parts of the force.

    Parameters
    ----------
    z : float
        Depth of the lowest point (m), above 0.
    speed : float
        Speed (m/s).
    line : record
        Contact line or cluster of the ball.
    m : record
        Constants of the law.

    Returns
    -------
    tuple of float
        Limit of the static part (N), and the factors of the velocity in the viscous and the quadratic part (N s/m).
    """
    onset = min(1.0, z / (SHALLOW * line.width))  # factor of the parts that do not depend on depth
    static = onset * m.F0 + (m.k * z if m.p == 1.0 else m.k * z**m.p)
    return static, onset * m.b, onset * drag_coefficient(line, m) * speed


def drag_coefficient(line, m):
    """Coefficient of the quadratic part, c or m / d1.

    Parameters
    ----------
    line : record
        Contact line or cluster of the ball, with its diameter `width` (m) and its `mass` (kg).
    m : record
        Constants of the law.

    Returns
    -------
    float
        kg/m.
    """
    d1 = m.d1 + m.d1_per_diameter * line.width
    return m.c + (line.mass / d1 if d1 > 0.0 else 0.0)
