"""Schema of the scalar laws: a force on a ball against its motion, by speed v and depth z of its lowest point."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from granular_contact.config.schema.provenance import MediumBase
from granular_contact.values.strict import NotNegative, Positive, refusal


class Bingham(MediumBase):
    """F0 + b v."""

    law: Literal["bingham"]
    yield_force_N: NotNegative
    """F0."""
    viscosity_N_s_m: NotNegative
    """b."""


class Poncelet(MediumBase):
    """F0 + c v^2."""

    law: Literal["poncelet"]
    constant_force_N: NotNegative
    """F0."""
    drag_kg_m: NotNegative
    """c."""


class Allen(MediumBase):
    """A v^2 + B v + C."""

    law: Literal["allen"]
    drag_kg_m: NotNegative
    """A."""
    viscosity_N_s_m: NotNegative
    """B."""
    constant_force_N: NotNegative
    """C."""


class LinearDepth(MediumBase):
    """k z."""

    law: Literal["linear_depth"]
    stiffness_N_m: NotNegative
    """k."""


class TsimringVolfson(MediumBase):
    """k z^p + c v^2."""

    law: Literal["tsimring_volfson"]
    drag_kg_m: NotNegative
    """c."""
    friction_N: NotNegative
    """k z_1^p at the depth z_1 = 1 m."""
    exponent: Annotated[float, Field(gt=0, le=5)]
    """p."""


class KatsuragiDurian(MediumBase):
    """k z + m v^2 / d1 with the mass m of the ball itself."""

    law: Literal["katsuragi_durian"]
    stiffness_N_m: NotNegative | None
    """k; null: not stated by the source, a run needs it."""
    drag_length_m: Positive | None = None
    """d1; give this or drag_length_diameters."""
    drag_length_diameters: Positive | None = None
    """d1 over the diameter of the ball."""

    @model_validator(mode="after")
    def _one_length(self) -> KatsuragiDurian:
        given = (self.drag_length_m is not None) + (self.drag_length_diameters is not None)
        if given != 1:
            got = "both" if given else "neither"
            raise refusal([((), f"got {got} of drag_length_m and drag_length_diameters; exactly one is allowed")])
        return self
