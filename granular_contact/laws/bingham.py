"""Bingham medium, for a ball: a yield force and a viscous force, F = F0 + b v."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from granular_contact.laws.scalar import VISCOSITY, YIELD, ScalarLaw
from granular_contact.values.strict import NotNegative


class Bingham(ScalarLaw):
    """Force F0 + b v against the motion of a ball.

    Parameters
    ----------
    yield_force : float
        F0 (N), 0 or more.
    viscosity : float
        b (N s/m), 0 or more.
    """

    law: Literal["bingham"]
    yield_force: Annotated[NotNegative, YIELD] = Field(alias="yield_force_N")
    viscosity: Annotated[NotNegative, VISCOSITY] = Field(alias="viscosity_N_s_m")

    equation = "F = F0 + b v"
    terms = ("yield", "viscous")

    def force_constants(self) -> dict[str, float]:
        """Constants of the force; see `ScalarLaw.force_constants`."""
        return {"F0": self.yield_force, "b": self.viscosity}
