"""An assembled Exudyn system, and where the parts of the scene are in it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from granular_contact.multibody.joint_loads import JointLoad
from granular_contact.scene.types import FlexibleLink, RigidBody, Scene, Vector

if TYPE_CHECKING:
    from granular_contact.multibody.coupling import Coupling


@dataclass(frozen=True)
class RigidHandle:
    """Exudyn numbers of a rigid body, and its body."""

    body: RigidBody
    node: int
    object: int


@dataclass(frozen=True)
class LinkHandle:
    """Exudyn numbers of a flexible link's nodes and cable elements, and the link."""

    link: FlexibleLink
    nodes: tuple[int, ...]
    elements: tuple[int, ...]

    def end(self, point: Vector) -> int:
        """Index of the first or last node and element, whichever is nearer to a point (2,) m of the link."""
        return -1 if point[0] > 0.5 * self.link.length else 0


@dataclass(frozen=True)
class System:
    """An assembled Exudyn system and where the scene's bodies are in it.

    bed: the granular load in it, None where none is needed. loads: what acts in joints, by name. motions: constraint
    objects of prescribed motions, by joint.
    """

    scene: Scene
    container: Any
    mbs: Any
    rigid: dict[str, RigidHandle]
    links: dict[str, LinkHandle]
    bed: Coupling | None
    loads: dict[str, JointLoad] = field(default_factory=dict)
    motions: dict[str, int] = field(default_factory=dict)

    def node_at(self, body: str, point: Vector) -> int:
        """Node that a point (2,) m of a body belongs to: that of a rigid body, the root or tip of a link."""
        return self.rigid[body].node if body in self.rigid else self.links[body].nodes[self.links[body].end(point)]
