"""Scene -> Tree: joints from the ground outward, all that acts in them, and all that the medium meets, for kernels."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from granular_contact.engines.tree.kernels.tree import HINGE, SLIDER
from granular_contact.engines.tree.kernels.tree_arrays import NODE, room
from granular_contact.mechanics.coordinates import coordinate
from granular_contact.mechanics.joint_loads import JointLoad
from granular_contact.mechanics.kernels.joint_loads import JOINT
from granular_contact.mechanics.stepping import signals_of
from granular_contact.mechanics.system import RigidHandle, System
from granular_contact.sand.contact_lines import Body
from granular_contact.sand.load import GranularLoad
from granular_contact.sand.of_scene import lines_of, load_of
from granular_contact.sand.rolling import sunk
from granular_contact.scene.parts import RigidBody
from granular_contact.scene.signal_tables import tabulate
from granular_contact.scene.types import Joint, Scene, Vector
from granular_contact.scene.workspace import immersible


class BodyCoordinates:
    """Coordinates that observers read: x and y of the centre of mass and the angle of body i, at 3 i to 3 i + 2."""

    def __init__(self, bodies: int) -> None:
        self.size = 3 * bodies

    def places(self, node: int) -> list[int]:
        """Places of the coordinates of a body."""
        return [3 * node, 3 * node + 1, 3 * node + 2]

    def reference(self, node: int) -> list[float]:  # noqa: ARG002
        """Nothing is left out of them."""
        return [0.0, 0.0, 0.0]


@dataclass(frozen=True)
class Tree:
    """A scene in minimal coordinates.

    system: for observers; load: None where the medium meets nothing; arrays: what kernels have of its nodes at the
    start, by the names of `kernels.tree_arrays`; coordinates (3 bodies,): where those of the system are among the
    nodes'; prescribed: drives of prescribed motions with their nodes; set_from_outside: nodes of joints whose drives
    are, by joint.
    """

    system: System
    load: GranularLoad | None
    arrays: dict[str, NDArray[Any]]
    coordinates: NDArray[np.int64]
    prescribed: dict[str, int]
    set_from_outside: dict[str, int]

    @property
    def scene(self) -> Scene:
        """The scene."""
        return self.system.scene


@dataclass(frozen=True)
class _Node:
    """A node of the tree: its joint, or what of a free joint is its own; body: None of a massless frame."""

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


def tree(scene: Scene) -> Tree:
    """Set up a scene that `scene.methods` allows."""
    scene = sunk(scene)
    nodes = _nodes(scene)
    places = {node.body.name: i for i, node in enumerate(nodes) if node.body is not None}
    joints = {node.joint.name: i for i, node in enumerate(nodes) if node.joint.has_coordinate}
    bodies = [node.body for node in nodes if node.body is not None]
    handles = {body.name: RigidHandle(body, i, i) for i, body in enumerate(bodies)}
    system = System(scene, BodyCoordinates(len(bodies)), handles, {}, None)
    system.loads.update({name: made for name in joints if (made := _joint_load(system, scene.joint(name)))})
    load = _granular_load(scene, places)
    coordinates = np.concatenate([3 * i + np.arange(3) for i in places.values()])
    motions = {drive.joint: joints[drive.joint] for drive in scene.drives if drive.kind == "motion"}
    external = {drive.joint: joints[drive.joint] for drive in scene.drives if drive.sets}
    arrays = _arrays_of(system, nodes, joints, load)
    return Tree(system, load, arrays, coordinates, motions, external)


def _granular_load(scene: Scene, places: dict[str, int]) -> GranularLoad | None:
    """Load on all shapes that can reach the surface, of bodies with their nodes; None when there are none."""
    if scene.bed is None or not scene.media:
        return None
    load, strips = load_of(scene), scene.load.strips_per_rigid_part
    for body, shape in immersible(scene.bed, scene.rigid):
        load.add(lines_of(Body(body.name, 3 * places[body.name] + np.arange(3)), shape, strips))
    load.close()
    return load if load.lines else None


def _nodes(scene: Scene) -> list[_Node]:
    """Nodes in an order in which every parent comes before its children."""
    nodes: list[_Node] = []
    of_body: dict[str | None, int] = {None: -1}
    for joint in outward(scene.joints):
        body = next(body for body in scene.rigid if body.name == joint.child)
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


def outward(joints: tuple[Joint, ...]) -> list[Joint]:
    """Joints in an order in which every parent comes before its children."""
    of_parent: dict[str | None, list[Joint]] = {}
    for joint in joints:
        of_parent.setdefault(joint.parent, []).append(joint)
    ordered, waiting = [], of_parent.pop(None, [])[::-1]
    while waiting:
        ordered.append(waiting.pop())
        waiting += of_parent.pop(ordered[-1].child, [])[::-1]
    return ordered


def _joint_load(system: System, joint: Joint) -> JointLoad | None:
    """What acts along the coordinate of a joint, a prescribed motion aside; None where nothing does."""
    drive = system.scene.drive(joint.name)
    if drive is not None and drive.kind == "motion":
        drive = None
    if drive is None and joint.law.is_idle:
        return None
    return JointLoad(coordinate(system, joint, np.zeros(2), whole=True), [], joint.law, drive)


def _arrays_of(
    system: System, nodes: Sequence[_Node], joints: dict[str, int], load: GranularLoad | None
) -> dict[str, NDArray[Any]]:
    scene, loads, arrays = system.scene, system.loads, room(len(nodes))
    arrays["s"][:], arrays["rates"][:] = [node.start for node in nodes], [node.rate for node in nodes]
    laws, state, records = np.zeros(len(nodes), JOINT), np.zeros((len(nodes), 5)), np.zeros(len(nodes), NODE)
    for name, one in loads.items():
        i = joints[name]
        laws[i], state[i] = one.record[0], one.state
        one.state = state[i]  # from now on a row of one table
    for record, node in zip(records, nodes, strict=True):
        _fill(record, scene, node)
    records["acts"][[joints[name] for name in loads]] = True
    for drive in scene.drives:
        records["prescribed"][joints[drive.joint]] = drive.kind == "motion"
    sand, triplets = np.zeros((0, 0), np.int64), np.zeros((1, 3))
    if load is not None:
        sand, triplets = load.places(None, np.zeros(3 * len(nodes))), load.room_for_tangents
    own = {"nodes": records, "laws": laws, "state": state, "gravity": np.array([scene.gravity])}
    return arrays | own | {"sand": sand, "triplets": triplets} | _signals(scene, joints, len(nodes))


def _signals(scene: Scene, joints: dict[str, int], nodes: int) -> dict[str, NDArray[Any]]:
    """Signals of drives as tables, and which coordinate follows which."""
    signals, follows = signals_of(scene), np.full(nodes, -1)
    for drive in scene.drives:
        if not drive.sets:
            follows[joints[drive.joint]] = signals.index(drive.signal)
    knots, pieces = tabulate(signals, scene.solver.end_time_s)
    return {"signals": follows, "knots": knots, "pieces": pieces, "wanted": np.zeros((len(signals), 3))}


def _fill(record: np.void, scene: Scene, node: _Node) -> None:
    """Write a node into its record, as `kernels.tree` has it."""
    record["parent"], record["kind"], record["turn"] = node.parent, node.kind, node.turn
    record["on_parent"], record["point"], record["axis"] = node.on_parent, node.point, node.axis
    if node.body is not None:
        record["mass"], record["inertia"] = node.body.mass, node.body.inertia
        record["radius"] = scene.radius(node.body)
