"""Scene -> Tree: joints from the ground outward, their laws and drives, and the granular load, for the kernels."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from granular_contact.engines.tree.kernels import tree_load
from granular_contact.engines.tree.kernels.tree import HINGE, SLIDER
from granular_contact.engines.tree.kernels.tree_arrays import NODE, room
from granular_contact.mechanics.equilibrium import Equilibrium
from granular_contact.mechanics.joint_loads import JointLoad
from granular_contact.mechanics.kernels.joint_loads import JOINT, STATE
from granular_contact.mechanics.kernels.signal_tables import SIGNAL
from granular_contact.mechanics.sensors import Sensors
from granular_contact.mechanics.stepping import signals_of
from granular_contact.mechanics.system import RigidHandle, System
from granular_contact.sand.contact_lines import Body
from granular_contact.sand.from_scene import lines_from_shape, load_from_scene
from granular_contact.sand.load import GranularLoad
from granular_contact.sand.rolling import at_steady_sinkage
from granular_contact.scene.parts import RigidBody
from granular_contact.scene.signal_tables import tabulate
from granular_contact.scene.types import Joint, Scene, Vector, with_name
from granular_contact.scene.workspace import immersible

AnyJoint = TypeVar("AnyJoint", bound=Any)  # of the plane or of space


class BodyCoordinates:
    """Coordinates of the bodies of a system, as observers read them.

    each: number of coordinates of a body: 3 in the plane (x, y of the centre of mass, angle), 7 in space.
    """

    def __init__(self, bodies: int, each: int = 3) -> None:
        self.each, self.size = each, each * bodies

    def places(self, node: int) -> list[int]:
        """Indices of the coordinates of body `node`."""
        return list(range(self.each * node, self.each * node + self.each))


@dataclass(frozen=True)
class Tree:
    """A scene in minimal coordinates.

    system: for observers; load: None if no shape can reach the medium; arrays: arrays of its nodes at the start, by the
    names of `kernels.tree_arrays`; bodies: nodes of the bodies of the system; joints: nodes of the joints that have a
    coordinate, by name; rest: static equilibrium from which it begins, if any.
    """

    system: System
    load: GranularLoad | None
    arrays: dict[str, NDArray[Any]]
    bodies: list[int]
    joints: dict[str, int]

    kernels: ClassVar[Any] = tree_load  # module of the forces on it
    joint_kernels: Any = None  # module of the laws of ball joints, if any has one
    rest: Equilibrium | None = None

    @property
    def sand_kernels(self) -> Any:
        """Module of the kernels of the medium; without a load they are never called."""
        return self.kernels.sand if self.load is None else self.load.kernels

    @property
    def scene(self) -> Scene:
        """The scene."""
        return self.system.scene

    @property
    def prescribed(self) -> dict[str, int]:
        """Nodes of joints with a prescribed motion, by joint."""
        return {drive.joint: self.joints[drive.joint] for drive in self.scene.drives if drive.kind == "motion"}

    @property
    def set_from_outside(self) -> dict[str, int]:
        """Nodes of joints whose drives are set from outside, by joint."""
        return {drive.joint: self.joints[drive.joint] for drive in self.scene.drives if drive.sets}

    def state_indices(self, name: str) -> NDArray[np.int64]:
        """Indices of the entries of the system's bodies in the flattened array of this name."""
        width = self.arrays[name].shape[1]
        return np.concatenate([width * i + np.arange(width) for i in self.bodies])

    def accelerations(self, q: Vector, body_accelerations: Vector) -> Vector:  # noqa: ARG002
        """Accelerations of the coordinates q (n, m) of the system, from the accelerations of its bodies."""
        return body_accelerations

    def mode_residuals(self, residuals: Vector) -> dict[str, Vector]:  # noqa: ARG002
        """`mode_residuals` of a `Trajectory`, from the residuals (n, nodes); none for links with all their elements."""
        return {}

    def sensors(self, march: Any) -> Sensors:  # noqa: ARG002
        """Sensors that read the state of a march of the tree."""
        return Sensors(self.system, self.load)


@dataclass(frozen=True)
class _Node:
    """A node of the tree: its joint, or one coordinate of a free joint; body: None for a massless frame."""

    joint: Joint
    parent: int
    body: RigidBody | None
    kind: int
    on_parent: Vector
    point: Vector
    start: float
    rate: float
    axis: Vector
    turn: float = 0.0


def tree(scene: Scene, rest: Equilibrium | None = None) -> Tree:
    """Make the tree of a scene that `scene.methods` allows; rest: static equilibrium from which it begins, if any."""
    scene = at_steady_sinkage(scene)
    nodes = _nodes(scene if rest is None else rest.scene)
    places = {node.body.name: i for i, node in enumerate(nodes) if node.body is not None}
    joints = {node.joint.name: i for i, node in enumerate(nodes) if node.joint.has_coordinate}
    bodies = [node.body for node in nodes if node.body is not None]
    handles = {body.name: RigidHandle(body, i, i) for i, body in enumerate(bodies)}
    system = System(scene, BodyCoordinates(len(bodies)), handles, {}, None)
    system.loads.update(joint_loads(scene, rest))
    load, arrays = _granular_load(scene, places), room(len(nodes))
    records = np.zeros(len(nodes), NODE)
    for record, node in zip(records, nodes, strict=True):
        _fill(record, scene, node)
    arrays["s"][:], arrays["rates"][:] = [node.start for node in nodes], [node.rate for node in nodes]
    arrays |= {"nodes": records} | acting(system, joints, len(nodes)) | load_arrays(load, 3 * len(nodes))
    return Tree(system, load, arrays | {"lever": levers(records, 3)}, list(places.values()), joints, rest=rest)


def _granular_load(scene: Scene, places: dict[str, int]) -> GranularLoad | None:
    """Load on all shapes that can reach the surface, None if there are none; places: nodes of bodies."""
    if scene.bed is None or not scene.media:
        return None
    load, strips = load_from_scene(scene), scene.load.strips_per_rigid_part
    for body, shape in immersible(scene.bed, scene.rigid):
        load.add(lines_from_shape(Body(body.name, 3 * places[body.name] + np.arange(3)), shape, strips))
    load.close()
    return load if load.lines else None


def _nodes(scene: Scene) -> list[_Node]:
    """Nodes in an order in which every parent comes before its children."""
    nodes: list[_Node] = []
    of_body: dict[str | None, int] = {None: -1}
    for joint in outward(scene.joints):
        body = with_name(scene.rigid, joint.child, "body")
        nodes += _free(joint, body, len(nodes)) if joint.kind == "free" else [_carried(scene, joint, body, of_body)]
        of_body[body.name] = len(nodes) - 1
    return nodes


def _carried(scene: Scene, joint: Joint, body: RigidBody, of_body: dict[str | None, int]) -> _Node:
    """Node of a body on a hinge or slider."""
    turn, axis = joint.offset, np.zeros(2)
    if joint.kind == "slider":
        assert joint.axis is not None
        turned = 0.0 if joint.parent is None else scene.body(joint.parent).motion.angle
        turn, axis = body.motion.angle - turned, joint.axis
    kind = SLIDER if joint.kind == "slider" else HINGE
    points = joint.parent_point, joint.child_point
    return _Node(joint, of_body[joint.parent], body, kind, *points, joint.start, joint.rate, axis, turn)


def _free(joint: Joint, body: RigidBody, first: int) -> list[_Node]:
    """Nodes of a body that flies free: two sliders and a hinge, at its centre of mass."""
    nothing, motion = np.zeros(2), body.motion
    ways = zip(np.eye(2), motion.position.tolist(), motion.velocity.tolist(), strict=True)
    frames = [
        _Node(joint, first + i - 1 if i else -1, None, SLIDER, nothing, nothing, at, speed, axis)
        for i, (axis, at, speed) in enumerate(ways)
    ]
    turning = _Node(joint, first + 1, body, HINGE, nothing, nothing, -motion.angle, -motion.rate, nothing)
    return [*frames, turning]


def outward(joints: Sequence[AnyJoint]) -> list[AnyJoint]:
    """Joints in an order in which every parent comes before its children."""
    of_parent: dict[str | None, list[AnyJoint]] = {}
    for joint in joints:
        of_parent.setdefault(joint.parent, []).append(joint)
    ordered, waiting = [], of_parent.pop(None, [])[::-1]
    while waiting:
        ordered.append(waiting.pop())
        waiting += of_parent.pop(ordered[-1].child, [])[::-1]
    return ordered


class _Along(NamedTuple):
    """Coordinate of a joint that is a coordinate of the tree, in the form that `JointLoad` needs."""

    joint: Any
    record: NDArray[np.void]
    last_angles: tuple[float, float] = (0.0, 0.0)


def joint_loads(scene: Any, rest: Equilibrium | None) -> dict[str, JointLoad]:
    """Laws and drives along the coordinates of joints, by joint; without prescribed motions, and idle laws.

    rest: static equilibrium that has the anchors of their dry friction at the start, if any.
    """
    loads = {}
    for joint in scene.joints:
        drive = scene.drive(joint.name)
        if drive is not None and drive.kind == "motion":
            drive = None
        if joint.has_coordinate and not (drive is None and joint.law.is_idle):
            along: Any = _Along(joint, np.zeros(1, JOINT))
            loads[joint.name] = load = JointLoad(along, [], joint.law, drive)
            if rest is not None and joint.law.friction > 0.0:
                load.first_anchor = load.state["anchor"] = rest.anchors[joint.name]
    return loads


def acting(system: System, joints: dict[str, int], nodes: int) -> dict[str, NDArray[Any]]:
    """Arrays of the laws and drives along the coordinates of a system's joints, and of gravity; joints: their nodes."""
    laws, state = np.zeros(nodes, JOINT), np.zeros(nodes, STATE)
    prescribed, acts = np.zeros((2, nodes), np.int64)
    for name, load in system.loads.items():
        i = joints[name]
        laws[i], state[i], acts[i] = load.record[0], load.state, True
        load.state = state[i]  # from now on a view of the table
    for drive in system.scene.drives:
        prescribed[joints[drive.joint]] = drive.kind == "motion"
    arrays = {"laws": laws, "state": state, "prescribed": prescribed, "acts": acts}
    return arrays | _signals(system.scene, joints, nodes) | {"gravity": np.array([system.scene.gravity])}


def load_arrays(load: GranularLoad | None, coordinates: int) -> dict[str, NDArray[Any]]:
    """Addresses of the arrays of a load on nodes with so many coordinates in all, and a work array for its tangent."""
    if load is None:
        return {"sand": np.zeros((0, 0), np.int64), "triplets": np.zeros((1, 3))}
    return {"sand": load.addresses(None, np.zeros(coordinates)), "triplets": load.room_for_tangents}


def levers(nodes: NDArray[np.void], width: int) -> Vector:
    """Factors (n width,) from twists to speeds of points; the last width // 2 numbers of a twist are angular."""
    factors = np.ones((len(nodes), width))
    factors[:, width - width // 2 :] = nodes["radius"][:, None]
    return np.ravel(factors * (nodes["mass"] > 0.0)[:, None])


def _signals(scene: Scene, joints: dict[str, int], nodes: int) -> dict[str, NDArray[Any]]:
    """Tables of the signals of drives, and the index of the signal that each coordinate follows."""
    signals, follows = signals_of(scene), np.full(nodes, -1)
    for drive in scene.drives:
        if not drive.sets:
            follows[joints[drive.joint]] = signals.index(drive.signal)
    knots, pieces = tabulate(signals, scene.solver.end_time_s)
    return {"signals": follows, "knots": knots, "pieces": pieces, "wanted": np.zeros(len(signals), SIGNAL)}


def _fill(record: np.void, scene: Scene, node: _Node) -> None:
    """Write a node into its record of NODE."""
    record["parent"], record["kind"], record["turn"] = node.parent, node.kind, node.turn
    record["on_parent"], record["point"], record["axis"] = node.on_parent, node.point, node.axis
    if node.body is not None:
        record["mass"], record["inertia"] = node.body.mass, node.body.inertia
        record["radius"] = scene.radius(node.body)
