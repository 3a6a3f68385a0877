"""Linear static law for a ball: F = k z."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from granular_contact.laws.scalar import DEPTH_FORCE, ScalarLaw
from granular_contact.values.strict import NotNegative


class LinearDepth(ScalarLaw):
    """Force k z against the motion of a ball whose lowest point is at the depth z.

    Parameters
    ----------
    stiffness : float
        k (N/m), 0 or more.
    """

    law: Literal["linear_depth"]
    stiffness: Annotated[NotNegative, DEPTH_FORCE] = Field(alias="stiffness_N_m")

    equation = "F = k z"
    terms = ("static",)

    def force_constants(self) -> dict[str, float]:
        """Constants of the force; see `ScalarLaw.force_constants`."""
        return {"k": self.stiffness}
