"""Schema of the bodies of a mechanism, and of a chain of many equal links. SI units, named in the keys."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any, Literal

from pydantic import Field

from granular_contact.config.schema.joints import Hinge, HingeForces
from granular_contact.config.schema.shapes import Shape, section_faults
from granular_contact.values.strict import Faults, Listed, NotNegative, Point, Positive, Strict, Tagged, Text, by_type

_MASS = ("mass_kg", "inertia_kg_m2", "center_of_mass_m")


def mass_faults(body: Any) -> Faults:
    """Faults of a rigid body, in the plane or in space: its mass must be given in exactly one way."""
    given = [name for name in _MASS if getattr(body, name) is not None]
    if body.density_kg_m3 is not None:
        yield from (((name,), "stands beside density_kg_m3, from which it follows; give one") for name in given)
        if not body.shapes:
            yield ("shapes",), "are missing; a density needs shapes, or give mass_kg and inertia_kg_m2"
    elif not given:
        allowed = "allowed is a density with shapes, or mass_kg and inertia_kg_m2"
        yield ("density_kg_m3",), f"is missing, so the body has no mass; {allowed}"
    else:
        message = "is missing; a body has density_kg_m3 and shapes, or mass_kg and inertia_kg_m2"
        yield from (((name,), message) for name in _MASS[:2] if name not in given)


class Rigid(Strict):
    """A rigid body. Its mass follows from its shapes and a density, or is given; then shapes only meet the medium."""

    type: Literal["rigid"]
    density_kg_m3: Positive | None = None
    """Density of all shapes. Give this, or mass_kg and inertia_kg_m2."""
    mass_kg: Positive | None = None
    """Mass, if no density is given."""
    inertia_kg_m2: Positive | None = None
    """Moment of inertia about the centre of mass, for rotation in the plane; if no density is given."""
    center_of_mass_m: Point | None = None
    """Centre of mass, x and y in the frame of the body. null: the origin of the frame, or with a density the centroid
    of the shapes."""
    shapes: Annotated[tuple[Shape, ...], Listed] = ()
    """Shapes of the body."""

    def _faults(self) -> Faults:
        return mass_faults(self)


def modulus_faults(bending: float | None, modulus: float | None) -> Faults:
    """A fault of a flexible link unless exactly one of its stiffness E I (N m2) and its modulus E (Pa) is given."""
    given = (bending is not None) + (modulus is not None)
    if given != 1:
        got = "both" if given else "neither"
        yield (), f"got {got} of bending_stiffness_N_m2 and youngs_modulus_Pa; exactly one is allowed"


class Flexible(Strict):
    """Elasticity of a link, which is discretised with cable elements.

    Give the bending stiffness or Young's modulus.
    """

    bending_stiffness_N_m2: Positive | None = None
    """Bending stiffness E I. Give this or youngs_modulus_Pa."""
    youngs_modulus_Pa: Positive | None = None
    """Young's modulus E; the bending stiffness follows from the cross-section."""
    axial_stiffness_N: Positive | None = None
    """Axial stiffness E A. null: it follows from the same modulus as the bending stiffness."""
    elements: Annotated[int, Field(ge=1, le=1024)] = 4
    """Number of cable elements along the link."""
    bending_damping_N_m2_s: NotNegative = 0.0
    """Internal damping: bending moment per rate of curvature."""
    axial_damping_N_s: NotNegative = 0.0
    """Internal damping: axial force per rate of strain."""
    yield_stress_Pa: Positive | None = None
    """Yield stress: a run with a larger stress warns that the material stays bent. null: no check."""

    def _faults(self) -> Faults:
        return modulus_faults(self.bending_stiffness_N_m2, self.youngs_modulus_Pa)


class Link(Strict):
    """A straight uniform bar along the x axis of its frame, from its root at the origin to its tip at x = length."""

    type: Literal["link"]
    length_m: Positive
    """Length from root to tip."""
    diameter_m: Positive | None = None
    """Diameter of a round cross-section. A rectangular one has width_m and thickness_m instead."""
    width_m: Positive | None = None
    """Width of a rectangular cross-section, normal to the plane of motion."""
    thickness_m: Positive | None = None
    """Thickness of a rectangular cross-section, in the plane of motion."""
    density_kg_m3: Positive
    """Density of the material."""
    flexible: Flexible | None = None
    """Elasticity. null: the link is rigid."""

    def _faults(self) -> Faults:
        return section_faults(self.diameter_m, self.width_m, self.thickness_m)


BODIES = by_type(Rigid, Link)
Body = Annotated[Rigid | Link, Tagged("type", BODIES)]


MOST_LINKS = 4096


def names(prefix: Any, count: Any) -> list[str]:
    """Names `prefix_1` to `prefix_count`; none if the prefix is no text or the count is not allowed.

    The schema reports these two faults.
    """
    if not isinstance(prefix, str) or type(count) is not int or not 1 <= count <= MOST_LINKS:
        return []
    return [f"{prefix}_{i}" for i in range(1, count + 1)]


class ChainLink(Strict):
    """Properties that all links of the chain share: each is a straight uniform round bar."""

    length_m: Positive
    """Length from root to tip."""
    diameter_m: Positive
    """Diameter of the round cross-section."""
    density_kg_m3: Positive
    """Density of the material."""
    flexible: Flexible | None = None
    """Elasticity. null: the links are rigid."""


class ChainHinge(HingeForces):
    """Properties that all hinges of the chain share."""

    home_deg: float = 0.0
    """Angle from link to link, clockwise, in the reference configuration; for all hinges but the first. A run starts
    there unless `initial` gives another angle."""


class Chain(Strict):
    """A row of equal links `link_1` to `link_n` on hinges `hinge_1` to `hinge_n`.

    The first hinge connects link_1 to the parent; each other hinge connects the root of a link to the tip of the link
    before it.
    """

    count: Annotated[int, Field(ge=1, le=MOST_LINKS)]
    """Number n of links."""
    link: ChainLink
    """Properties of the links."""
    hinge: ChainHinge = ChainHinge()
    """Properties of the hinges."""
    parent: str = "ground"
    """Name of the parent body of the first hinge, or `ground`."""
    parent_point_m: Point = (0.0, 0.0)
    """Position of the first hinge, x and y in the frame of the parent."""
    root_home_deg: float = 0.0
    """Angle of the first hinge in the reference configuration, clockwise from the x axis of the parent. A run starts
    there unless `initial` gives another angle."""
    link_name: Text = "link"
    """Prefix of the names of the links."""
    hinge_name: Text = "hinge"
    """Prefix of the names of the hinges."""

    def expanded(self) -> tuple[dict[str, Link], dict[str, Hinge]]:
        """Bodies and joints of the chain, by name."""
        link = Link(type="link", **self.link.model_dump())
        links, hinges = names(self.link_name, self.count), names(self.hinge_name, self.count)
        return dict.fromkeys(links, link), {
            name: Hinge(type="hinge", **values)
            for name, values in zip(hinges, self.hinges(links, (self.link.length_m, 0.0)), strict=True)
        }

    def hinges(self, links: list[str], tip: tuple[float, ...]) -> Iterator[dict[str, Any]]:
        """Values of the hinges by key, in order.

        links: names of the links; tip: position (m) of the tip in the frame of a link.
        """
        values = {name: getattr(self.hinge, name) for name in ChainHinge.model_fields}
        for i, child in enumerate(links):
            first = {"parent": self.parent, "parent_point_m": self.parent_point_m, "home_deg": self.root_home_deg}
            yield values | {"child": child} | ({"parent": links[i - 1], "parent_point_m": tip} if i else first)
