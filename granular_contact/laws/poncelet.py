"""Poncelet medium, for a ball: a constant force and a force quadratic in speed, F = F0 + c v^2."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from granular_contact.laws.gravity import INERTIA
from granular_contact.laws.scalar import YIELD, ScalarLaw
from granular_contact.values.strict import NotNegative


class Poncelet(ScalarLaw):
    """Force F0 + c v^2 against the motion of a ball.

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

    def force_constants(self) -> dict[str, float]:
        """Constants of the force; see `ScalarLaw.force_constants`."""
        return {"F0": self.constant_force, "c": self.drag}
