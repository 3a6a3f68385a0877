"""Schema of a granular medium: one class a law, named by the key `law`. A new law is a class and a line in `LAWS`."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from granular_contact.config.schema.base import NotNegative, Point, Positive, Strict, Tagged, Text


class Range(Strict):
    """What the coefficients were found from, least and greatest; null: not known."""

    speed_m_s: Point | None = None
    depth_m: Point | None = None
    size_m: Point | None = None
    """Diameter of bars."""


class _Medium(Strict):
    name: Text | None = None
    density_kg_m3: Positive
    """Density of the medium as its law uses it."""
    source: Text | None = None
    """Where the coefficients come from."""
    provenance: Text | None = None
    """How they were found, as `fitted`."""
    range: Range | None = None


class VerticalStatic(Strict):
    """Vertical static resistance, eta_v (z/d)^lambda per weight of displaced medium at depth z."""

    eta_v: NotNegative
    lambda_: Annotated[float, Field(alias="lambda", ge=0, le=5)]
    """`lambda` in YAML."""


class LeeMarghitu(_Medium):
    """Drag quadratic in speed, static resistance that grows with depth; all coefficients are dimensionless."""

    law: Literal["lee_marghitu"]
    eta_d: NotNegative
    """Drag."""
    eta_h: NotNegative
    """Horizontal static resistance."""
    plunging: VerticalStatic
    """Where the link moves down."""
    withdrawing: VerticalStatic | None = None
    """Where the link moves up; null: as plunging."""


LAWS: dict[str, type[_Medium]] = {"lee_marghitu": LeeMarghitu}
# For the type checker this is the union of all laws; at run time `LAWS` decides.
Medium = Annotated[LeeMarghitu, Tagged("law", LAWS)]
