"""Schema of the bodies of a mechanism. SI units, named in the keys."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from granular_contact.config.schema.base import Listed, NotNegative, Point, Positive, Strict, Tagged, refusal


class DiscShape(Strict):
    """A cylinder seen from its end: its axis is normal to the plane of motion."""

    type: Literal["disc"]
    diameter_m: Positive
    thickness_m: Positive
    """Extent along the axis."""
    center_m: Point = (0.0, 0.0)
    """In the frame of the body."""


class CylinderShape(Strict):
    """A cylinder whose axis lies in the plane of motion, from `start_m` to `end_m` in the frame of the body."""

    type: Literal["cylinder"]
    diameter_m: Positive
    start_m: Point = (0.0, 0.0)
    end_m: Point

    @model_validator(mode="after")
    def _has_a_length(self) -> CylinderShape:
        if self.start_m == self.end_m:
            raise refusal([(("end_m",), f"got {list(self.end_m)}, the same as start_m; the two must differ")])
        return self


SHAPES: dict[str, type[Strict]] = {"disc": DiscShape, "cylinder": CylinderShape}
Shape = Annotated[DiscShape | CylinderShape, Tagged("type", SHAPES)]


class Rigid(Strict):
    """A rigid body made of shapes of one density."""

    type: Literal["rigid"]
    density_kg_m3: Positive
    shapes: Annotated[tuple[Shape, ...], Listed, Field(min_length=1)]


class Flexible(Strict):
    """Elasticity of a link, discretised with cable elements. The bending stiffness is given, or follows from Young."""

    bending_stiffness_N_m2: Positive | None = None
    """E I; give this or youngs_modulus_Pa."""
    youngs_modulus_Pa: Positive | None = None
    axial_stiffness_N: Positive | None = None
    """E A; null: follows from the same modulus as the bending stiffness."""
    elements: Annotated[int, Field(ge=1, le=1024)] = 4
    bending_damping_N_m2_s: NotNegative = 0.0
    """Bending moment per rate of curvature."""
    axial_damping_N_s: NotNegative = 0.0
    """Axial force per rate of strain."""

    @model_validator(mode="after")
    def _one_stiffness(self) -> Flexible:
        given = (self.bending_stiffness_N_m2 is not None) + (self.youngs_modulus_Pa is not None)
        if given != 1:
            got = "both" if given else "neither"
            raise refusal([((), f"got {got} of bending_stiffness_N_m2 and youngs_modulus_Pa; exactly one is allowed")])
        return self


class Link(Strict):
    """A straight uniform cylinder along the x axis of its frame, from the root at the origin to the tip."""

    type: Literal["link"]
    length_m: Positive
    diameter_m: Positive
    density_kg_m3: Positive
    flexible: Flexible | None = None
    """null: the link is rigid."""


BODIES: dict[str, type[Strict]] = {"rigid": Rigid, "link": Link}
Body = Annotated[Rigid | Link, Tagged("type", BODIES)]
