"""Schema of a mechanism in space: bodies, the tree of joints, loop closures, and a chain."""

from __future__ import annotations

from itertools import cycle
from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import Field

from granular_contact.config.schema.mechanism import Chain, ChainHinge, ChainLink, names
from granular_contact.config.schema.model import Model
from granular_contact.config.schema.space.bodies import SpatialBody, SpatialFlexible, SpatialLink
from granular_contact.config.schema.space.joints import SpatialClosure, SpatialHinge, SpatialJoint
from granular_contact.config.schema.space.turned import ORIGIN, Axis, Point3
from granular_contact.values.strict import Listed, Positive, allow


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


class SpatialModel(Model):
    """A mechanism in space, x ahead, y left and z up, before it is placed and set in motion."""

    in_space: Annotated[Literal[True], allow("true, or false for a model in the plane")]  # type: ignore[assignment]
    """false: a model in the plane, whose keys are others."""
    bodies: dict[str, SpatialBody] = Field(default_factory=dict)  # type: ignore[assignment]
    joints: dict[str, SpatialJoint] = Field(default_factory=dict)  # type: ignore[assignment]
    closures: dict[str, SpatialClosure] = Field(default_factory=dict)  # type: ignore[assignment]
    chain: SpatialChain | None = None
    if TYPE_CHECKING:
        all_bodies: dict[str, SpatialBody]  # type: ignore[assignment]
        all_joints: dict[str, SpatialJoint]  # type: ignore[assignment]
