"""Law of Allen, Mayfield and Morrison for a ball: F = A v^2 + B v + C."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from granular_contact.laws.gravity import INERTIA
from granular_contact.laws.scalar import VISCOSITY, YIELD, ScalarLaw
from granular_contact.values.strict import NotNegative


class Allen(ScalarLaw):
    """Force A v^2 + B v + C against the motion of a ball (Allen, Mayfield and Morrison).

    Parameters
    ----------
    drag : float
        A (kg/m), 0 or more.
    viscosity : float
        B (N s/m), 0 or more.
    constant_force : float
        C (N), 0 or more.
    """

    law: Literal["allen"]
    drag: Annotated[NotNegative, INERTIA] = Field(alias="drag_kg_m")
    viscosity: Annotated[NotNegative, VISCOSITY] = Field(alias="viscosity_N_s_m")
    constant_force: Annotated[NotNegative, YIELD] = Field(alias="constant_force_N")

    equation = "F = A v^2 + B v + C"
    terms = ("constant", "viscous", "drag")

    def force_constants(self) -> dict[str, float]:
        """Constants of the force; see `ScalarLaw.force_constants`."""
        return {"F0": self.constant_force, "b": self.viscosity, "c": self.drag}
