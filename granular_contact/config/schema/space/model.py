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
    """Properties that all links of the chain share: each is a straight uniform round bar."""

    flexible: SpatialFlexible | None = None  # type: ignore[assignment]
    """Elasticity. null: the links are rigid."""
    facet_size_m: Positive | None = None
    """Longest edge of the facets on which laws of surfaces act. null: chosen by the estimated error of the motion; for
    flexible links a quarter of an element, or the diameter if that is larger."""


class SpatialChainHinge(ChainHinge):
    """Properties that all hinges of the chain share."""

    axes: Annotated[tuple[Axis, ...], Listed, Field(min_length=1)] = ((0.0, 0.0, 1.0),)
    """Directions of the hinge axes in the frame of the child link, used in turn from hinge to hinge."""
    home_deg: float = 0.0
    """Angle in the reference configuration, right-handed about the axis; for all hinges but the first. A run starts
    there unless `initial` gives another angle."""


class SpatialChain(Chain):
    """A row of equal links `link_1` to `link_n` on hinges `hinge_1` to `hinge_n`.

    The first hinge connects link_1 to the parent; each other hinge connects the root of a link to the tip of the link
    before it.
    """

    link: SpatialChainLink
    """Properties of the links."""
    hinge: SpatialChainHinge = SpatialChainHinge()
    """Properties of the hinges."""
    parent_point_m: Point3 = ORIGIN  # type: ignore[assignment]
    """Position of the first hinge, x, y and z in the frame of the parent."""
    root_home_deg: float = 0.0
    """Angle of the first hinge in the reference configuration, right-handed about its axis. A run starts there unless
    `initial` gives another angle."""

    def expanded(self) -> tuple[dict[str, SpatialLink], dict[str, SpatialHinge]]:  # type: ignore[override]
        """Bodies and joints of the chain, by name."""
        link = SpatialLink(type="link", **self.link.model_dump())
        links, hinges = names(self.link_name, self.count), names(self.hinge_name, self.count)
        rows = zip(hinges, self.hinges(links, (self.link.length_m, 0.0, 0.0)), cycle(self.hinge.axes), strict=False)
        return dict.fromkeys(links, link), {
            name: SpatialHinge(type="hinge", **values, axis=axis) for name, values, axis in rows
        }


class SpatialModel(Model):
    """A mechanism in space, x ahead, y left and z up, without its initial state."""

    in_space: Annotated[Literal[True], allow("true, or false for a model in the plane")]  # type: ignore[assignment]
    """true: a model in space; false: a model in the plane, which has other keys."""
    bodies: dict[str, SpatialBody] = Field(default_factory=dict)  # type: ignore[assignment]
    joints: dict[str, SpatialJoint] = Field(default_factory=dict)  # type: ignore[assignment]
    closures: dict[str, SpatialClosure] = Field(default_factory=dict)  # type: ignore[assignment]
    chain: SpatialChain | None = None
    if TYPE_CHECKING:
        all_bodies: dict[str, SpatialBody]  # type: ignore[assignment]
        all_joints: dict[str, SpatialJoint]  # type: ignore[assignment]
