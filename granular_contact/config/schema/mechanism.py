"""Schema of the bodies of a mechanism. SI units, named in the keys."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field

from granular_contact.config.schema.shapes import Shape, section_faults
from granular_contact.values.strict import Faults, Listed, NotNegative, Point, Positive, Strict, Tagged, by_type

_MASS = ("mass_kg", "inertia_kg_m2", "center_of_mass_m")


def mass_faults(body: Any) -> Faults:
    """Faults of a rigid body, in the plane or in space, whose mass is not given once."""
    given = [name for name in _MASS if getattr(body, name) is not None]
    if body.density_kg_m3 is not None:
        yield from (((name,), "stands beside density_kg_m3, from which it follows; give one") for name in given)
        if not body.shapes:
            yield ("shapes",), "are missing; a density needs shapes, or give mass_kg and inertia_kg_m2"
    elif not given:
        allowed = "allowed is a density with shapes, or mass_kg and inertia_kg_m2"
        yield ("density_kg_m3",), f"is missing, so the body has no mass; {allowed}"
    else:
        words = "is missing; a body has density_kg_m3 and shapes, or mass_kg and inertia_kg_m2"
        yield from (((name,), words) for name in _MASS[:2] if name not in given)


class Rigid(Strict):
    """A rigid body: shapes with a density, or a given mass and shapes for the medium only."""

    type: Literal["rigid"]
    density_kg_m3: Positive | None = None
    """Of all shapes; give this or the mass."""
    mass_kg: Positive | None = None
    inertia_kg_m2: Positive | None = None
    """Moment of inertia about the centre of mass, in the plane."""
    center_of_mass_m: Point | None = None
    """In the frame of the body; null: its origin."""
    shapes: Annotated[tuple[Shape, ...], Listed] = ()

    def _faults(self) -> Faults:
        return mass_faults(self)


class Flexible(Strict):
    """Elasticity of a link, discretised with cable elements. Give the bending stiffness or Young's modulus."""

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

    def _faults(self) -> Faults:
        given = (self.bending_stiffness_N_m2 is not None) + (self.youngs_modulus_Pa is not None)
        if given != 1:
            got = "both" if given else "neither"
            yield (), f"got {got} of bending_stiffness_N_m2 and youngs_modulus_Pa; exactly one is allowed"


class Link(Strict):
    """A straight uniform bar along the x axis of its frame, from the root at the origin to the tip."""

    type: Literal["link"]
    length_m: Positive
    diameter_m: Positive | None = None
    """Of a round section; a rectangular one has width_m and thickness_m."""
    width_m: Positive | None = None
    """Normal to the plane of motion."""
    thickness_m: Positive | None = None
    """In the plane."""
    density_kg_m3: Positive
    flexible: Flexible | None = None
    """null: the link is rigid."""

    def _faults(self) -> Faults:
        return section_faults(self.diameter_m, self.width_m, self.thickness_m)


BODIES = by_type(Rigid, Link)
Body = Annotated[Rigid | Link, Tagged("type", BODIES)]
