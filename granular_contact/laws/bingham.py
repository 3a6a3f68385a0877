"""Bingham medium: a yield force and a viscous one, F0 + b v, on a ball."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from granular_contact.laws.scalar import ScalarLaw
from granular_contact.values.strict import NotNegative


class Bingham(ScalarLaw):
    """F0 + b v."""

    law: Literal["bingham"]
    yield_force: NotNegative = Field(alias="yield_force_N")
    """F0."""
    viscosity: NotNegative = Field(alias="viscosity_N_s_m")
    """b."""

    equation = "F = F0 + b v"
    terms = ("yield", "viscous")

    def own(self) -> dict[str, float]:
        """As `ScalarLaw.own`."""
        return {"F0": self.yield_force, "b": self.viscosity}
