"""Schema of the laws for thin round bars."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from granular_contact.config.schema.provenance import MediumBase
from granular_contact.values.strict import NotNegative, Positive, Strict


class VerticalStatic(Strict):
    """Vertical static resistance, eta_v (z/d)^lambda per weight of displaced medium at depth z."""

    eta_v: NotNegative
    lambda_: Annotated[float, Field(alias="lambda", ge=0, le=5)]
    """`lambda` in YAML."""


class LeeMarghitu(MediumBase):
    """Drag quadratic in speed, static resistance that grows with depth; all coefficients are dimensionless."""

    law: Literal["lee_marghitu"]
    density_kg_m3: Positive
    """Density of the medium as its law uses it."""
    eta_d: NotNegative
    """Drag."""
    eta_h: NotNegative
    """Horizontal static resistance."""
    plunging: VerticalStatic
    """Where the link moves down."""
    withdrawing: VerticalStatic | None = None
    """Where the link moves up; null: as plunging."""


class Albert(MediumBase):
    """Horizontal resistance eta_h g rho H^2 d; nothing else."""

    law: Literal["albert"]
    density_kg_m3: Positive
    eta_h: NotNegative


class Hill(MediumBase):
    """Vertical resistance eta (z/l)^lambda g rho V; nothing else."""

    law: Literal["hill"]
    density_kg_m3: Positive | None
    """null: not stated by the source; a run needs it."""
    length_scale_m: Positive | None = None
    """l; null: the diameter."""
    plunging: VerticalStatic
    withdrawing: VerticalStatic
