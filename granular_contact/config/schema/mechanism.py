"""Schema of the bodies of a mechanism, and of a chain of many equal links. SI units, named in the keys."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any, Literal

from pydantic import Field

from granular_contact.config.schema.joints import Hinge, HingeFriction, HingeSpring, HingeStops
from granular_contact.config.schema.shapes import Shape, section_faults
from granular_contact.values.strict import Faults, Listed, NotNegative, Point, Positive, Strict, Tagged, Text, by_type

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


def modulus_faults(bending: float | None, modulus: float | None) -> Faults:
    """Of a link that bends whose stiffness E I (N m2) and modulus E (Pa) are both given, or neither."""
    given = (bending is not None) + (modulus is not None)
    if given != 1:
        got = "both" if given else "neither"
        yield (), f"got {got} of bending_stiffness_N_m2 and youngs_modulus_Pa; exactly one is allowed"


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
    yield_stress_Pa: Positive | None = None
    """Stress above which the material stays bent: a run that passes it says so. null: not looked at."""

    def _faults(self) -> Faults:
        return modulus_faults(self.bending_stiffness_N_m2, self.youngs_modulus_Pa)


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


MOST_LINKS = 4096


def names(prefix: Any, count: Any) -> list[str]:
    """`prefix_1` to `prefix_count`; none for what is not text or no allowed number, which has its own fault."""
    if not isinstance(prefix, str) or type(count) is not int or not 1 <= count <= MOST_LINKS:
        return []
    return [f"{prefix}_{i}" for i in range(1, count + 1)]


class ChainLink(Strict):
    """One of the links: a straight uniform cylinder."""

    length_m: Positive
    diameter_m: Positive
    density_kg_m3: Positive
    flexible: Flexible | None = None
    """null: the links are rigid."""


class ChainHinge(Strict):
    """What every hinge of the chain has."""

    home_deg: float = 0.0
    """Angle at the start of all hinges but the first, unless the run says otherwise; clockwise, from link to link."""
    spring: HingeSpring | None = None
    damping_Nm_s_per_rad: NotNegative = 0.0
    stops: HingeStops | None = None
    friction: HingeFriction | None = None


class Chain(Strict):
    """Links `link_1` to `link_n`, joined tip to root by hinges `hinge_1` to `hinge_n`; the first is on the parent."""

    count: Annotated[int, Field(ge=1, le=MOST_LINKS)]
    link: ChainLink
    hinge: ChainHinge = ChainHinge()
    parent: str = "ground"
    """A body, or `ground`."""
    parent_point_m: Point = (0.0, 0.0)
    """Where the first hinge sits in the frame of the parent."""
    root_home_deg: float = 0.0
    """Angle of the first hinge at the start, unless the run says otherwise."""
    link_name: Text = "link"
    hinge_name: Text = "hinge"

    def expanded(self) -> tuple[dict[str, Link], dict[str, Hinge]]:
        """Bodies and joints of the chain."""
        link = Link(type="link", **self.link.model_dump())
        links, hinges = names(self.link_name, self.count), names(self.hinge_name, self.count)
        return dict.fromkeys(links, link), {
            name: Hinge(type="hinge", **given)
            for name, given in zip(hinges, self.hinges(links, (self.link.length_m, 0.0)), strict=True)
        }

    def hinges(self, links: list[str], tip: tuple[float, ...]) -> Iterator[dict[str, Any]]:
        """Values of the hinges, one for each of the links, whose tips are at a place (m) in their frames."""
        values = {name: getattr(self.hinge, name) for name in ChainHinge.model_fields}
        for i, child in enumerate(links):
            first = {"parent": self.parent, "parent_point_m": self.parent_point_m, "home_deg": self.root_home_deg}
            yield values | {"child": child} | ({"parent": links[i - 1], "parent_point_m": tip} if i else first)
