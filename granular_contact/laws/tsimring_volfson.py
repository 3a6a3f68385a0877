"""Law of Tsimring and Volfson (2005) for a ball: quadratic drag, and friction that grows with depth.

    F = k z^p + c v^2

We know only the form of the law, not the power p of the depth: the user gives it.
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from granular_contact.laws.gravity import INERTIA, SHAPE
from granular_contact.laws.scalar import DEPTH_FORCE, ScalarLaw
from granular_contact.values.strict import NotNegative


class TsimringVolfson(ScalarLaw):
    """Force k z^p + c v^2 against the motion of a ball (Tsimring and Volfson 2005).

    Parameters
    ----------
    drag : float
        c (kg/m), 0 or more.
    friction : float
        Value of k z^p (N) at the depth z = 1 m, 0 or more.
    exponent : float
        p, above 0, at most 5.
    """

    law: Literal["tsimring_volfson"]
    drag: Annotated[NotNegative, INERTIA] = Field(alias="drag_kg_m")
    friction: Annotated[NotNegative, DEPTH_FORCE] = Field(alias="friction_N")
    exponent: Annotated[float, SHAPE] = Field(gt=0, le=5)

    equation = "F = k z^p + c v^2"
    terms = ("friction", "drag")

    def force_constants(self) -> dict[str, float]:
        """Constants of the force; see `ScalarLaw.force_constants`."""
        return {"k": self.friction, "p": self.exponent, "c": self.drag}
