"""Scene in space -> Tree: joints from the ground outward, as nodes of one coordinate, and the granular load."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from granular_contact.engines.tree.kernels import space_ball_joints, space_load, space_modes
from granular_contact.engines.tree.kernels.space_tree import BALL, HINGE, LAST, SLIDER
from granular_contact.engines.tree.kernels.tree_arrays import SPACE_NODE as NODE
from granular_contact.engines.tree.kernels.tree_arrays import room
from granular_contact.engines.tree.tree import BodyCoordinates, Tree, acting, joint_loads, levers, load_arrays, outward
from granular_contact.geometry import rotations
from granular_contact.mechanics.equilibrium import Equilibrium
from granular_contact.mechanics.joint_loads import fill
from granular_contact.mechanics.space.sensors import SpatialSensors
from granular_contact.mechanics.space.system import SpatialSystem
from granular_contact.mechanics.system import RigidHandle
from granular_contact.sand.contact_lines import Body
from granular_contact.sand.space.from_scene import add_part, load_from_scene
from granular_contact.sand.space.load import SpatialLoad
from granular_contact.scene.joint_law import JointLaw
from granular_contact.scene.space import modes
from granular_contact.scene.space.types import SpatialJoint, SpatialMotion, SpatialRigidBody, SpatialScene, Vector

POSE = 7  # coordinates of a body
NONE, STRAIGHT = (0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0)
Numbers = Vector | tuple[float, ...]
STILL = SpatialMotion(np.zeros(3), np.eye(3), np.zeros(3), np.zeros(3))  # the ground


class TreeSensors(SpatialSensors):
    """As `SpatialSensors`, with the coordinates of joints from the march."""

    def __init__(self, tree: SpatialTree, march: Any) -> None:
        self._march, self._nodes_of = march, tree.joints
        super().__init__(tree.system, tree.load)

    def _find_joints(self, joints: list[Any]) -> None:
        self._nodes = [self._nodes_of[joint.name] for joint in joints]

    @property
    def follows(self) -> bool:
        """Always False: coordinates of hinges already count whole turns."""
        return False

    def joints(self, q: Vector, v: Vector) -> tuple[Vector, Vector]:  # noqa: ARG002
        """Coordinates and rates of joints at the present state of the march, see `SpatialSensors.joints`."""
        arrays = self._march.arrays
        return arrays["s"][self._nodes], arrays["rates"][self._nodes]


@dataclass(frozen=True)
class SpatialTree(Tree):
    """As `Tree`, in space."""

    system: SpatialSystem

    kernels: ClassVar[Any] = space_load

    def accelerations(self, q: Vector, body_accelerations: Vector) -> Vector:
        """See `Tree.accelerations`; Euler parameters get G^T w' / 4, the part that turns the body."""
        count = len(self.bodies)
        e, body = q.reshape(-1, count, POSE)[..., 3:], body_accelerations.reshape(-1, count, 6)
        second = rotations.quaternion_rates(e, body[..., 3:])
        second_rates: Vector = np.concatenate([body[..., :3], second], axis=-1).reshape(len(q), -1)
        return second_rates

    def sensors(self, march: Any) -> TreeSensors:
        """See `Tree.sensors`."""
        return TreeSensors(self, march)


@dataclass(frozen=True)
class ReducedTree(SpatialTree):
    """As `SpatialTree`, with links that bend in a few modes."""

    kernels: ClassVar[Any] = space_modes

    def mode_residuals(self, residuals: Vector) -> dict[str, Vector]:
        """See `Tree.mode_residuals`."""
        scene, moments = self.system.scene, {}
        for joint in (scene.joint(name) for beam in scene.beams for name in beam.joints):
            last = self.bodies[self.system.rigid[joint.child].node]
            moments[joint.name] = residuals[:, last - LAST : last + 1] @ joint.parent_turn
        return moments


@dataclass(frozen=True)
class _Node:
    """A node as `kernels.space_tree` has it.

    body: None for a massless frame; joint: joint of which it has the only coordinate, if any; ball: ball joint of which
    it is the last node, if that joint has a law; law: of the stretch of a link.
    """

    parent: int
    kind: int
    body: SpatialRigidBody | None = None
    joint: SpatialJoint | None = None
    which: int = 0
    on_parent: Numbers = NONE
    point: Numbers = NONE
    axis: Numbers = NONE
    before: Numbers = STRAIGHT
    after: Numbers = STRAIGHT
    start: float = 0.0
    rate: float = 0.0
    ball: SpatialJoint | None = None
    law: JointLaw | None = None


def tree(scene: SpatialScene, rest: Equilibrium | None = None) -> SpatialTree:
    """Make the tree of a scene that `scene.methods` allows; rest: static equilibrium from which it begins, if any."""
    nodes, home = _nodes(scene if rest is None else rest.scene)
    places = {node.body.name: i for i, node in enumerate(nodes) if node.body is not None}
    joints = {node.joint.name: i for i, node in enumerate(nodes) if node.joint is not None}
    bodies = [node.body for node in nodes if node.body is not None]
    handles = {body.name: RigidHandle(body, i, i) for i, body in enumerate(bodies)}
    load, arrays, records = _granular_load(scene, places), room(len(nodes), in_space=True), np.zeros(len(nodes), NODE)
    elements = () if load is None else load.lines
    system = SpatialSystem(scene, BodyCoordinates(len(bodies), POSE), handles, {}, None, elements=elements)
    system.loads.update(joint_loads(scene, rest))
    for record, node in zip(records, nodes, strict=True):
        _fill(record, scene, node)
    arrays["s"][:], arrays["rates"][:] = [node.start for node in nodes], [node.rate for node in nodes]
    arrays["home"][:] = STRAIGHT
    for i, turn in home.items():
        arrays["home"][i] = turn
    arrays |= {"nodes": records} | acting(system, joints, len(nodes)) | load_arrays(load, POSE * len(nodes))
    for i, node in enumerate(nodes):
        if node.ball is not None and node.ball.is_sprung:
            fill(arrays["laws"][i : i + 1], node.ball.law, None)
        if node.law is not None:
            fill(arrays["laws"][i : i + 1], node.law, None)
            arrays["acts"][i] = 1
    arrays["lever"] = levers(records, 6)
    sprung = space_ball_joints if records["acts"].any() else None
    tree_type = SpatialTree if scene.modes is None else ReducedTree
    if scene.modes is not None:
        arrays |= _in_modes(scene, places, arrays)
    return tree_type(system, load, arrays, list(places.values()), joints, sprung, rest)


def _in_modes(scene: SpatialScene, places: dict[str, int], arrays: dict[str, Any]) -> dict[str, NDArray[Any]]:
    """Arrays of `space_modes`; marks the charts of the joints of links, which stay at home. places: nodes of bodies."""
    single, columns, count = arrays["prescribed"] == 0, [], len(arrays["nodes"])
    for beam in scene.beams:
        joints, S = modes.shapes(scene, beam)
        link_columns = np.zeros((count, S.shape[2]))
        for joint, of_joint in zip(joints, S, strict=True):
            last = places[joint.child]
            three = slice(last - LAST, last + 1)
            link_columns[three], single[three] = joint.parent_turn @ of_joint, False
            arrays["nodes"]["stays"][last] = True
        columns.append(link_columns)
    Phi = np.concatenate([np.eye(count)[:, single], *columns], axis=1)
    m = Phi.shape[1]
    return {"shapes": np.ascontiguousarray(Phi.T), "inverse": np.zeros((m, m)), "projected": np.zeros(m)}


def _granular_load(scene: SpatialScene, places: dict[str, int]) -> SpatialLoad | None:
    """Load on all parts in the sand, None if there are none; places: nodes of bodies."""
    parts = [(body, part) for body in scene.rigid for part in body.parts if part.in_sand]
    if scene.bed is None or not scene.media or not parts:
        return None
    load = load_from_scene(scene)
    for body, part in parts:
        add_part(load, Body(body.name, POSE * places[body.name] + np.arange(POSE)), part, scene, body.mass)
    load.close()
    return load if load.lines else None


def _nodes(scene: SpatialScene) -> tuple[list[_Node], dict[int, Vector]]:
    """Nodes in an order in which every parent comes before its children, and home orientations of ball joints."""
    nodes: list[_Node] = []
    of_body: dict[str | None, int] = {None: -1}
    home: dict[int, Vector] = {}
    named = {body.name: body for body in scene.rigid}
    joint: SpatialJoint
    for joint in outward(scene.joints):
        body, first, parent = named[joint.child], len(nodes), of_body[joint.parent]
        if joint.kind in ("hinge", "slider"):
            nodes.append(_carried(joint, body, parent))
        elif joint.kind == "free":
            nodes += [*_sliders(body, first), *_balls(body, first + 3, first + 2, NONE, NONE, body.motion.rate)]
            home[len(nodes) - 1] = rotations.quaternion_of(body.motion.rotation)
        else:
            held = STILL if joint.parent is None else named[joint.parent].motion
            R, spin = held.rotation, held.rate
            after = rotations.quaternion_of(joint.child_turn @ joint.parent_turn.T)
            turning, at = R.T @ (body.motion.rate - spin), joint.parent_point
            if joint.kind == "stretching":
                offset = R.T @ (body.motion.world(joint.child_point) - held.world(joint.parent_point))
                nodes.append(_stretch(joint, parent, float(joint.parent_turn[:, 0] @ offset)))
                first, parent, at = first + 1, first, np.zeros(3)
            nodes += _balls(body, first, parent, at, joint.child_point, turning)
            nodes[-1] = replace(
                nodes[-1],
                before=rotations.quaternion_of(joint.parent_turn),
                after=after,
                ball=joint if joint.acts else None,
            )
            home[len(nodes) - 1] = rotations.quaternion_of(R.T @ body.motion.rotation)
        of_body[body.name] = len(nodes) - 1
    return nodes, home


def _carried(joint: SpatialJoint, body: SpatialRigidBody, parent: int) -> _Node:
    """Node of a body on a hinge or slider."""
    before = joint.parent_turn @ joint.child_turn.T if joint.kind == "slider" else joint.parent_turn
    return _Node(
        parent,
        SLIDER if joint.kind == "slider" else HINGE,
        body,
        joint,
        on_parent=joint.parent_point,
        point=joint.child_point,
        axis=joint.parent_turn[:, 2],
        before=rotations.quaternion_of(before),
        after=rotations.quaternion_of(joint.child_turn.T),
        start=joint.start,
        rate=joint.rate,
    )


def _stretch(joint: SpatialJoint, parent: int, start: float) -> _Node:
    """Massless node that slides along a link, between two of its elements; start (m): its coordinate at the start."""
    assert joint.elastic is not None
    assert joint.elastic.axial is not None
    stiffness, damping = joint.elastic.axial
    law = JointLaw(stiffness=stiffness, damping=damping)
    return _Node(parent, SLIDER, on_parent=joint.parent_point, axis=joint.parent_turn[:, 0], start=start, law=law)


def _sliders(body: SpatialRigidBody, first: int) -> Iterator[_Node]:
    """Three sliders along the axes of the world, from the origin to the centre of mass of a body that flies free."""
    motion = body.motion
    ways = zip(np.eye(3), motion.position.tolist(), motion.velocity.tolist(), strict=True)
    for i, (axis, at, speed) in enumerate(ways):
        yield _Node(first + i - 1 if i else -1, SLIDER, axis=axis, start=at, rate=speed)


def _balls(
    body: SpatialRigidBody, first: int, parent: int, on_parent: Numbers, point: Numbers, spin: Vector
) -> Iterator[_Node]:
    """Three nodes, from index `first` on, of a body on a ball joint; spin (3,) rad/s: in the parent's frame."""
    yield _Node(parent, BALL, on_parent=on_parent, rate=spin[0])
    yield _Node(first, BALL, which=1, rate=spin[1])
    yield _Node(first + 1, BALL, body, which=LAST, point=point, rate=spin[2])


def _fill(record: NDArray[np.void], scene: SpatialScene, node: _Node) -> None:
    """Write a node into its record of SPACE_NODE."""
    record["parent"], record["kind"], record["which"] = node.parent, node.kind, node.which
    if node.ball is not None:
        record["acts"] = space_ball_joints.SPRUNG
        if (elastic := node.ball.elastic) is not None:
            record["acts"] = space_ball_joints.ELASTIC
            record["bends"], record["damps"] = elastic.stiffness, elastic.damping
    for name in ("on_parent", "point", "axis", "before", "after"):
        record[name] = getattr(node, name)
    if node.body is not None:
        record["mass"], record["inertia"] = node.body.mass, node.body.inertia.ravel()
        record["radius"] = scene.radius(node.body)
