"""Poncelet medium: a constant force and one quadratic in speed, F0 + c v^2, on a ball."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from granular_contact.laws.gravity import INERTIA
from granular_contact.laws.scalar import YIELD, ScalarLaw
from granular_contact.values.strict import NotNegative


class Poncelet(ScalarLaw):
    """F0 + c v^2, against the motion of a ball.

    Parameters
    ----------
    constant_force : float
        F0 (N), 0 or more.
    drag : float
        c (kg/m), 0 or more.
    """

    law: Literal["poncelet"]
    constant_force: Annotated[NotNegative, YIELD] = Field(alias="constant_force_N")
    drag: Annotated[NotNegative, INERTIA] = Field(alias="drag_kg_m")

    equation = "F = F0 + c v^2"
    terms = ("constant", "drag")

    def own(self) -> dict[str, float]:
        """As `ScalarLaw.own`."""
        return {"F0": self.constant_force, "c": self.drag}
