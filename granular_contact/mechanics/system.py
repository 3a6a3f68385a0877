"""A mechanism in the generalised coordinates of an engine, and the trajectory of a solve."""

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
    """Numbering of the coordinates q of a system by nodes: a rigid body has one node, a flexible link several."""

    @property
    def size(self) -> int:
        """Number m of coordinates."""

    def places(self, node: int) -> list[int]:
        """Indices in q of the coordinates of a node: 3 of a rigid body (7 in space), 4 of a node of a flexible link."""


@dataclass(frozen=True)
class RigidHandle(Generic[AnyBody]):
    """A rigid body, with the engine's numbers of its node and object."""

    body: AnyBody
    node: int
    object: int


@dataclass(frozen=True)
class LinkHandle:
    """A flexible link, with the engine's numbers of its nodes and elements."""

    link: FlexibleLink
    nodes: tuple[int, ...]
    elements: tuple[int, ...]

    def end(self, point: Vector) -> int:
        """Index of the end node and element nearer to a point (2,) m of the link: 0 for the first, -1 for the last."""
        return -1 if point[0] > 0.5 * self.link.length else 0


@dataclass(frozen=True)
class System:
    """A scene in the generalised coordinates of an engine.

    coordinates: their numbering. bed: the granular load as coupled to the engine, with its `load` and the `nodes` it
    acts on; None without one. loads: forces in joints, by name of the joint; joints: the engine's object for all of
    them, None without any. motions: constraint objects of prescribed motions, by joint; turning: those of them that are
    constraints between the angles of rigid bodies. turns: angles (rad) at the last evaluation of constraints and
    observers, by which these count whole turns.

    mbs, container: the engine's own objects, which mechanics does not read. origin (2,) m, world frame: origin of the
    engine's coordinates, near the mechanism. Strains are differences of positions: a kilometre away from the origin
    their round-off would be a residual that no iteration reduces.
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
        levers = np.zeros(self.coordinates.size)
        for rigid in self.rigid.values():
            levers[self.coordinates.places(rigid.node)] = rigid.body.levers(self.scene.radius(rigid.body))
        for link in self.links.values():
            for node in link.nodes:
                levers[self.coordinates.places(node)] = 1.0, 1.0, 0.0, 0.0
        return levers

    @property
    def held(self) -> list[Vector]:
        """Arrays with the joint state outside the engine, each once; their addresses stay after the first forces."""
        return [*([] if self.joints is None else [self.joints.states]), *self.turns]

    @property
    def building_s(self) -> float:
        """Wall time (s) for building the contact geometry."""
        return 0.0 if self.bed is None else float(self.bed.load.building_s)

    def sensors(self) -> Sensors:
        """Sensors that read the state in the pauses of a solve."""
        from granular_contact.mechanics.sensors import Sensors

        return Sensors(self, None if self.bed is None else self.bed.load)

    def kinematics(self, trajectory: Trajectory) -> Kinematics:
        """Kinematics of the system along a trajectory."""
        from granular_contact.mechanics.kinematics import Kinematics

        return Kinematics(self, trajectory)

    def observe(self, trajectory: Trajectory) -> Observation:
        """Observation of a run, from which its results are made."""
        from granular_contact.mechanics.observe import observe

        return observe(self, trajectory)

    def node_at(self, body: str, point: Vector) -> int:
        """Node of a point (2,) m of a body: the node of a rigid body, or the nearer end node of a flexible link."""
        return self.rigid[body].node if body in self.rigid else self.links[body].nodes[self.links[body].end(point)]

    def nodes_of(self, joint: Any) -> list[int]:
        """Nodes of the parent and the child of a joint, in the plane or in space; the ground has none."""
        ends = ((joint.parent, joint.parent_point), (joint.child, joint.child_point))
        return [self.node_at(body, point) for body, point in ends if body is not None]

    def places(self, body: str, point: Vector) -> list[int]:
        """Indices of the coordinates of the node at a point of a body, see `Coordinates.places`."""
        return self.coordinates.places(self.node_at(body, point))


@dataclass(frozen=True)
class Trajectory:
    """Accepted steps of a solve, the start included.

    time (n,) s; q, v (n, m): coordinates (reference values included) and rates of the whole system; load: history of
    the bed, None without one; mass (m, m): mass matrix, constant, sparse if large. multipliers: Lagrange multipliers
    (N m, N) of prescribed motions, (n,) each, by joint; a (n, m): accelerations that belong to them, None without such
    motions; set_to: targets of drives that are set from outside, (n,) each, by joint; strip_error: see `strip_error`,
    None where it was not computed; mode_residuals (N m): moments (n, 3) by which the joints within links in a few
    modes are not in equilibrium, by joint, along its axes. notices: sentences on what the engine could not do as usual,
    and what was done instead.
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
    mode_residuals: dict[str, Vector] = field(default_factory=dict)


def at_one(system: System, time: Vector, q: Vector, v: Vector) -> Trajectory:
    """Trajectory of one instant, time (1,), q, v (1, m), for positions and velocities alone."""
    cost = Cost(solve_s=0.0, steps=0, newton_iterations=0, jacobians=0, load_calls=0)
    status = paused(float(time[0]), system.scene.solver)
    return Trajectory(status, cost, time, q, v, load=None, mass=None)
