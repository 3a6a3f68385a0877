"""A mechanism as an engine has it: where its parts are among the generalised coordinates; the trajectory of a solve."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Generic, Protocol, TypeVar

import numpy as np

from granular_contact.results import Cost, Status
from granular_contact.results.stopping import paused
from granular_contact.scene.parts import FlexibleLink, RigidBody
from granular_contact.scene.types import Scene, Vector

if TYPE_CHECKING:
    from granular_contact.mechanics.joint_loads import JointLoad
    from granular_contact.mechanics.kinematics import Kinematics
    from granular_contact.mechanics.sensors import Sensors
    from granular_contact.results.observation import Observation
    from granular_contact.sand.history import LoadHistory


AnyBody = TypeVar("AnyBody")


class Coordinates(Protocol):
    """How an engine numbers the coordinates q of a system, by nodes: one of a rigid body, more of a link."""

    @property
    def size(self) -> int:
        """Number m of coordinates."""

    def places(self, node: int) -> list[int]:
        """Places in q of the coordinates of a node: 3 of a rigid body in the plane, 7 in space, 4 of a link's node."""


@dataclass(frozen=True)
class RigidHandle(Generic[AnyBody]):
    """A rigid body, with the numbers that the engine gave to its node and object."""

    body: AnyBody
    node: int
    object: int


@dataclass(frozen=True)
class LinkHandle:
    """A flexible link, with the numbers that the engine gave to its nodes and elements."""

    link: FlexibleLink
    nodes: tuple[int, ...]
    elements: tuple[int, ...]

    def end(self, point: Vector) -> int:
        """Index of the first or last node and element, whichever is nearer to a point (2,) m of the link."""
        return -1 if point[0] > 0.5 * self.link.length else 0


@dataclass(frozen=True)
class System:
    """A scene in the generalised coordinates of an engine.

    coordinates: how they are numbered. bed: the granular load as the engine connects it, with its `load` and the
    `nodes` it acts on, None where none is needed. loads: what acts in joints, by name; joints: all of them, None where
    nothing acts. motions: constraint objects of prescribed motions, by joint; turning: of these those that
    are between the angles of rigid bodies. turns: angles (rad) that constraints and observers found last, by which they
    count whole turns.

    mbs, container: the engine's own system, of which mechanics know nothing. origin (2,) m, world frame: that of the
    engine's coordinates, near the mechanism. Strains are differences of positions: a kilometre from the origin their
    round-off makes forces that no iteration gets below.
    """

    scene: Scene
    coordinates: Coordinates
    rigid: dict[str, RigidHandle[RigidBody]]
    links: dict[str, LinkHandle]
    bed: Any
    loads: dict[str, JointLoad] = field(default_factory=dict)
    motions: dict[str, int] = field(default_factory=dict)
    turning: list[Any] = field(default_factory=list)
    turns: list[Vector] = field(default_factory=list)
    joints: Any = None
    origin: Vector = field(default_factory=lambda: np.zeros(2))
    mbs: Any = None
    container: Any = None

    @property
    def nodes(self) -> list[int]:
        """All nodes of bodies, each with x and y first among its coordinates."""
        rigid = [rigid.node for rigid in self.rigid.values()]
        return rigid + [node for link in self.links.values() for node in link.nodes]

    @property
    def levers(self) -> Vector:
        """Factors (m,) from rates to speeds of points (m/s): 1 for positions, a body's radius for its angle."""
        found = np.zeros(self.coordinates.size)
        for rigid in self.rigid.values():
            found[self.coordinates.places(rigid.node)] = rigid.body.levers(self.scene.radius(rigid.body))
        for link in self.links.values():
            for node in link.nodes:
                found[self.coordinates.places(node)] = 1.0, 1.0, 0.0, 0.0
        return found

    @property
    def held(self) -> list[Vector]:
        """Arrays of what Python keeps of joints, each once; from the first forces on they stay where they are."""
        return [*([] if self.joints is None else [self.joints.states]), *self.turns]

    @property
    def building_s(self) -> float:
        """Wall time (s) that what the medium meets took to be made."""
        return 0.0 if self.bed is None else float(self.bed.load.building_s)

    def sensors(self) -> Sensors:
        """What reads its state in the pauses of a solve."""
        from granular_contact.mechanics.sensors import Sensors

        return Sensors(self, None if self.bed is None else self.bed.load)

    def kinematics(self, trajectory: Trajectory) -> Kinematics:
        """Its motion along a trajectory."""
        from granular_contact.mechanics.kinematics import Kinematics

        return Kinematics(self, trajectory)

    def observe(self, trajectory: Trajectory) -> Observation:
        """What results hold of a run."""
        from granular_contact.mechanics.observe import observe

        return observe(self, trajectory)

    def node_at(self, body: str, point: Vector) -> int:
        """Node that a point (2,) m of a body belongs to: that of a rigid body, the root or tip of a link."""
        return self.rigid[body].node if body in self.rigid else self.links[body].nodes[self.links[body].end(point)]

    def nodes_of(self, joint: Any) -> list[int]:
        """Nodes of the parent and the child of a joint, in the plane or in space, without the ground's."""
        ends = ((joint.parent, joint.parent_point), (joint.child, joint.child_point))
        return [self.node_at(body, point) for body, point in ends if body is not None]

    def places(self, body: str, point: Vector) -> list[int]:
        """Places of the coordinates of the node at a point of a body: 3 of a rigid one, in space 7, 4 of a link."""
        return self.coordinates.places(self.node_at(body, point))


@dataclass(frozen=True)
class Trajectory:
    """Accepted steps of a solve, the start included.

    time (n,) s; q, v (n, m) coordinates (reference values included) and rates of the whole system; load: what the bed
    did, None without one; mass (m, m), sparse if large, constant for the bodies used here. multipliers: of the
    constraints of prescribed motions (N m, N), (n,) each, by joint; a (n, m): the accelerations that belong to them,
    None without such motions; set_to: what drives were set to from outside, as multipliers; strip_error: as found by
    `strip_error`, None where it was not looked for; mode_errors (m): of deflections of links that bend in a few modes.
    notices: what the engine could not do as usual, and what was done instead.
    """

    status: Status
    cost: Cost
    time: Vector
    q: Vector
    v: Vector
    load: LoadHistory | None
    mass: Any
    multipliers: dict[str, Vector] = field(default_factory=dict)
    a: Vector | None = None
    set_to: dict[str, Vector] = field(default_factory=dict)
    strip_error: float | None = None
    notices: tuple[str, ...] = ()
    mode_errors: dict[str, float] = field(default_factory=dict)


def at_one(system: System, time: Vector, q: Vector, v: Vector) -> Trajectory:
    """A trajectory of one instant, time (1,), q, v (1, m), that knows where everything is and no more."""
    nothing = Cost(solve_s=0.0, steps=0, newton_iterations=0, jacobians=0, load_calls=0)
    standing = paused(float(time[0]), system.scene.solver)
    return Trajectory(standing, nothing, time, q, v, load=None, mass=None)
