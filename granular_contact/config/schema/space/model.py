"""Schema of a mechanism in space: bodies, the tree of joints, loop closures, and a chain."""

from __future__ import annotations

from functools import cached_property
from itertools import cycle
from typing import Annotated, Literal

from pydantic import Field

from granular_contact.config.schema.mechanism import Chain, ChainHinge, ChainLink, names
from granular_contact.config.schema.model import mechanism_faults
from granular_contact.config.schema.space.bodies import SpatialBody, SpatialFlexible, SpatialLink
from granular_contact.config.schema.space.joints import SpatialClosure, SpatialHinge, SpatialJoint
from granular_contact.config.schema.space.turned import ORIGIN, Axis, Point3
from granular_contact.values.strict import Faults, Listed, Positive, Strict, Text, allow


class SpatialChainLink(ChainLink):
    """One of the links: a straight uniform round bar."""

    flexible: SpatialFlexible | None = None  # type: ignore[assignment]
    """null: the links are rigid."""
    facet_size_m: Positive | None = None
    """Greatest edge of its facets, for laws of surfaces; null: by its error, of links that bend a fourth
    of an element, or their thickness if that is more."""


class SpatialChainHinge(ChainHinge):
    """What every hinge of the chain has."""

    axes: Annotated[tuple[Axis, ...], Listed, Field(min_length=1)] = ((0.0, 0.0, 1.0),)
    """Directions of the axes in the frames of the links, taken in turn from hinge to hinge."""
    home_deg: float = 0.0
    """Angle at the start of all hinges but the first, unless the run says otherwise."""


class SpatialChain(Chain):
    """Links `link_1` to `link_n`, joined tip to root by hinges `hinge_1` to `hinge_n`; the first is on the parent."""

    link: SpatialChainLink
    hinge: SpatialChainHinge = SpatialChainHinge()
    parent_point_m: Point3 = ORIGIN  # type: ignore[assignment]
    """Where the first hinge sits in the frame of the parent."""

    def expanded(self) -> tuple[dict[str, SpatialLink], dict[str, SpatialHinge]]:  # type: ignore[override]
        """Bodies and joints of the chain."""
        link = SpatialLink(type="link", **self.link.model_dump())
        links, hinges = names(self.link_name, self.count), names(self.hinge_name, self.count)
        given = zip(hinges, self.hinges(links, (self.link.length_m, 0.0, 0.0)), cycle(self.hinge.axes), strict=False)
        return dict.fromkeys(links, link), {
            name: SpatialHinge(type="hinge", **values, axis=axis) for name, values, axis in given
        }


class SpatialModel(Strict):
    """A mechanism in space, x ahead, y left and z up, before it is placed and set in motion."""

    in_space: Annotated[Literal[True], allow("true, or false for a model in the plane")]
    name: Text
    description: Text = ""
    bodies: dict[str, SpatialBody] = Field(default_factory=dict)
    joints: dict[str, SpatialJoint] = Field(default_factory=dict)
    """The tree of joints: each body is the child of one, and the ground is the root."""
    closures: dict[str, SpatialClosure] = Field(default_factory=dict)
    """Joints that close loops, between bodies that the tree already connects to the ground."""
    chain: SpatialChain | None = None
    """Many equal links in a row, besides the bodies and joints."""

    @cached_property
    def all_bodies(self) -> dict[str, SpatialBody]:
        """Bodies by name, the links of the chain at the end."""
        return self.bodies | (self.chain.expanded()[0] if self.chain is not None else {})

    @cached_property
    def all_joints(self) -> dict[str, SpatialJoint]:
        """Joints of the tree by name, the hinges of the chain at the end."""
        return self.joints | (self.chain.expanded()[1] if self.chain is not None else {})

    def _faults(self) -> Faults:
        return mechanism_faults(self)
