from typing import Literal

from pydantic import Field

from granular_contact import Law
from granular_contact.sand import kernels


class Power(Law):
    """Force k (z / 1 m)^n on a sphere, against its motion."""

    law: Literal["power"]
    stiffness: float = Field(alias="stiffness_N", ge=0)
    """k."""
    exponent: float = Field(gt=0, le=5)
    """n."""

    equation = "F = k (z / 1 m)^n"
    terms = ("static",)
    takes = frozenset({"ball"})
    constants = ("k", "n")

    def numbers(self, gravity):
        return {"k": self.stiffness, "n": self.exponent}

    @staticmethod
    def ball_force(z, v, e, line, m, f):
        u, share = kernels.planar_friction.mobilised(kernels.planar_friction.drive(e, v, m), m)
        f[0, 0] -= share * size(z, m) * u[0]
        f[0, 1] -= share * size(z, m) * u[1]


def size(z, m):
    return m.k * z**m.n
