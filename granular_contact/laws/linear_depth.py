"""Linear static medium: a force k z on a ball."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from granular_contact.laws.scalar import WITH_DEPTH, ScalarLaw
from granular_contact.values.strict import NotNegative


class LinearDepth(ScalarLaw):
    """k z, against the motion of a ball whose lowest point is at the depth z.

    Parameters
    ----------
    stiffness : float
        k (N/m), 0 or more.
    """

    law: Literal["linear_depth"]
    stiffness: Annotated[NotNegative, WITH_DEPTH] = Field(alias="stiffness_N_m")

    equation = "F = k z"
    terms = ("static",)

    def own(self) -> dict[str, float]:
        """As `ScalarLaw.own`."""
        return {"k": self.stiffness}
