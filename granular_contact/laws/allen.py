"""Medium of Allen, Mayfield and Morrison: A v^2 + B v + C on a ball."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from granular_contact.laws.scalar import ScalarLaw
from granular_contact.values.strict import NotNegative


class Allen(ScalarLaw):
    """A v^2 + B v + C."""

    law: Literal["allen"]
    drag: NotNegative = Field(alias="drag_kg_m")
    """A."""
    viscosity: NotNegative = Field(alias="viscosity_N_s_m")
    """B."""
    constant_force: NotNegative = Field(alias="constant_force_N")
    """C."""

    equation = "F = A v^2 + B v + C"
    terms = ("constant", "viscous", "drag")

    def own(self) -> dict[str, float]:
        """As `ScalarLaw.own`."""
        return {"F0": self.constant_force, "b": self.viscosity, "c": self.drag}
