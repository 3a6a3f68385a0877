"""Schema of a chain: many equal links in a row, written once."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import Field

from granular_contact.config.schema.joints import Hinge, HingeFriction, HingeSpring, HingeStops
from granular_contact.config.schema.mechanism import Flexible, Link
from granular_contact.values.strict import NotNegative, Point, Positive, Strict, Text

MOST_LINKS = 4096


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


def names(prefix: Any, count: Any) -> list[str]:
    """`prefix_1` to `prefix_count`; none for what is not text or no allowed number, which has its own fault."""
    if not isinstance(prefix, str) or type(count) is not int or not 1 <= count <= MOST_LINKS:
        return []
    return [f"{prefix}_{i}" for i in range(1, count + 1)]


def expand(chain: Chain) -> tuple[dict[str, Link], dict[str, Hinge]]:
    """Bodies and joints of a chain."""
    link = Link(type="link", **chain.link.model_dump())
    links, hinges = names(chain.link_name, chain.count), names(chain.hinge_name, chain.count)
    parents, tip = [chain.parent, *links[:-1]], (chain.link.length_m, 0.0)
    laws: dict[str, Any] = {name: getattr(chain.hinge, name) for name in ChainHinge.model_fields}
    joints = {}
    for i, (hinge, parent, child) in enumerate(zip(hinges, parents, links, strict=True)):
        seat, more = (tip, laws) if i else (chain.parent_point_m, laws | {"home_deg": chain.root_home_deg})
        joints[hinge] = Hinge(type="hinge", parent=parent, child=child, parent_point_m=seat, **more)
    return dict.fromkeys(links, link), joints
