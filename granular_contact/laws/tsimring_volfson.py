"""Medium of Tsimring and Volfson (2005): drag quadratic in speed and friction that grows with depth, on a ball.

    F = k z^p + c v^2

Only the form is known to us, and not the power of the depth: p is the user's.
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from granular_contact.laws.gravity import INERTIA, SHAPE
from granular_contact.laws.scalar import WITH_DEPTH, ScalarLaw
from granular_contact.values.strict import NotNegative


class TsimringVolfson(ScalarLaw):
    """k z^p + c v^2, against the motion of a ball (Tsimring and Volfson 2005).

    Parameters
    ----------
    drag : float
        c (kg/m), 0 or more.
    friction : float
        k z_1^p (N) at the depth z_1 = 1 m, 0 or more.
    exponent : float
        p, above 0, at most 5.
    """

    law: Literal["tsimring_volfson"]
    drag: Annotated[NotNegative, INERTIA] = Field(alias="drag_kg_m")
    friction: Annotated[NotNegative, WITH_DEPTH] = Field(alias="friction_N")
    exponent: Annotated[float, SHAPE] = Field(gt=0, le=5)

    equation = "F = k z^p + c v^2"
    terms = ("friction", "drag")

    def own(self) -> dict[str, float]:
        """As `ScalarLaw.own`."""
        return {"k": self.friction, "p": self.exponent, "c": self.drag}
