"""Joints, what acts in them, and prescribed motions, in Exudyn."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any

import exudyn as exu
import numpy as np
from exudyn import itemInterface as items
from numpy.typing import ArrayLike

from granular_contact.engines.exudyn.joint_actions import HingeMotion
from granular_contact.engines.exudyn.views import EngineCoordinates
from granular_contact.mechanics.system import System
from granular_contact.scene.parts import rotation
from granular_contact.scene.types import Drive, Joint, Vector

if TYPE_CHECKING:
    from granular_contact.mechanics.coordinates import Coordinate, Numbers
    from granular_contact.scene.signals import Signal


def add_joint(system: System, ground: Any, joint: Joint) -> None:
    """Put a joint into the system, with its spring, damper, stops, friction and drive."""
    _constrain(system, ground, joint)
    if not joint.has_coordinate:
        return
    drive = system.scene.drive(joint.name)
    turns = joint.kind == "hinge" and not {joint.parent, joint.child} & system.links.keys()
    if turns and drive is not None and drive.kind == "motion":
        _add_turning(system, joint, drive)
        drive = None
    if drive is None and joint.law.is_idle:
        return
    if turns and drive is None and joint.law.is_linear:
        _add_spring(system, joint)
        return
    from granular_contact.mechanics.coordinates import coordinate

    let_act(system, joint, drive, partial(coordinate, system, joint, system.origin))


def let_act(system: System, joint: Any, drive: Drive | None, coordinate: Callable[..., Coordinate]) -> None:
    """Let a drive, spring, damper, stops and friction act along a coordinate, in the plane or in space.

    coordinate: makes one, as of `mechanics.coordinates`.
    """
    from granular_contact.mechanics.joint_loads import JointLoad

    if drive is not None and drive.kind == "motion":
        # Markers of nodes have the reference values already.
        system.motions[joint.name] = _add_motion(system, coordinate(), system.nodes_of(joint), drive)
        drive = None
    if drive is not None or not joint.is_idle:
        made = coordinate(reference=EngineCoordinates(system.mbs).reference)
        system.loads[joint.name] = JointLoad(made, system.nodes_of(joint), joint.law, drive)


def _constrain(system: System, ground: Any, joint: Joint) -> None:
    if joint.kind == "free":
        return
    mbs = system.mbs
    ends = (
        _seat(system, ground, joint.parent, joint.parent_point),
        _seat(system, ground, joint.child, joint.child_point),
    )
    if joint.kind == "hinge":
        markers = [mbs.AddMarker(items.MarkerBodyPosition(bodyNumber=n, localPosition=p)) for n, p in ends]
        mbs.AddObject(items.ObjectJointRevolute2D(markerNumbers=markers))
        return
    # Both bodies must see the joint along the same direction: it keeps the angle that they start with.
    angles = (_angle(system, joint.child) - _angle(system, joint.parent), 0.0)
    turns = [np.eye(3), np.eye(3)]
    for turn, angle in zip(turns, angles, strict=True):
        turn[:2, :2] = rotation(angle)
    markers = [rigid_marker(mbs, *end, turn) for end, turn in zip(ends, turns, strict=True)]
    if joint.kind == "weld":
        mbs.AddObject(items.ObjectJointGeneric(markerNumbers=markers, constrainedAxes=[1, 1, 0, 0, 0, 1]))
        return
    assert joint.axis is not None
    axis = rotation(-angles[0]) @ joint.axis
    mbs.AddObject(
        items.ObjectJointPrismatic2D(
            markerNumbers=markers, axisMarker0=[*axis, 0.0], normalMarker1=[-axis[1], axis[0], 0.0]
        )
    )


def rigid_marker(mbs: Any, body: Any, point: ArrayLike, turn: Vector) -> Any:
    """Marker of a frame of a body: its place (3,) m and axes (3, 3) in the body's."""
    return mbs.AddMarker(items.MarkerBodyRigid(bodyNumber=body, localHT=exu.HT(rotation=turn, translation=point)))


def _seat(system: System, ground: Any, name: str | None, point: Vector) -> tuple[Any, list[float]]:
    """Exudyn body and local position of a joint's end."""
    if name is None:
        return ground, [*(point - system.origin), 0.0]
    if name in system.rigid:
        return system.rigid[name].object, [*point, 0.0]
    handle = system.links[name]
    if handle.end(point):
        return handle.elements[-1], [handle.link.length / handle.link.elements, 0.0, 0.0]
    return handle.elements[0], [0.0, 0.0, 0.0]


def _angle(system: System, name: str | None) -> float:
    return 0.0 if name is None else system.scene.body(name).motion.angle


# ---- what acts in them ----


def _add_spring(system: System, joint: Joint) -> None:
    """Linear spring and damper of a hinge of rigid bodies: the engine's own, between their angles."""
    mbs, law = system.mbs, joint.law
    ends = [_angle_marker(system, body) for body in (joint.child, joint.parent)]
    mbs.AddObject(
        items.ObjectConnectorCoordinateSpringDamper(
            markerNumbers=ends,
            stiffness=law.stiffness,
            damping=law.damping,
            # The engine counts angles from the start.
            offset=law.rest - joint.start,
        )
    )


def _angle_marker(system: System, body: str | None) -> Any:
    """Marker of the angle of a rigid body, or of the ground's."""
    mbs = system.mbs
    node = mbs.AddNode(items.NodePointGround()) if body is None else system.rigid[body].node
    return mbs.AddMarker(items.MarkerNodeCoordinate(nodeNumber=node, coordinate=0 if body is None else 2))


def _add_turning(system: System, joint: Joint, drive: Drive) -> None:
    """Motion of a hinge of rigid bodies: the engine's own constraint between their angles."""
    ends = [_angle_marker(system, body) for body in (joint.child, joint.parent)]
    number = int(system.mbs.AddObject(items.ObjectConnectorCoordinate(markerNumbers=ends)))
    system.turning.append(HingeMotion(number, drive.signal, joint.start))
    system.motions[joint.name] = number


def _add_motion(system: System, s: Coordinate, nodes: list[int], drive: Drive) -> int:
    """Constraint s(q) = signal(t) of a coordinate; nodes: of parent and child, without the ground's."""
    system.turns.append(s.last_angles)
    mbs = system.mbs
    sizes = [int(s.record[end][0]) for end in ("parent", "child")]
    if len(nodes) == 1:
        nodes = [mbs.AddNode(items.NodePointGround()), *nodes]
    markers = [mbs.AddMarker(items.MarkerNodeCoordinates(nodeNumber=node)) for node in nodes]
    constraint, jacobian = _motion_functions(s, drive)
    return int(
        mbs.AddObject(
            items.ObjectConnectorCoordinateVector(
                markerNumbers=markers,
                # One row each: how the engine learns the number of equations.
                scalingMarker0=np.zeros((1, sizes[0] or 3)),
                scalingMarker1=np.zeros((1, sizes[1])),
                constraintUserFunction=constraint,
                jacobianUserFunction=jacobian,
            )
        )
    )


class _Last:
    """A coordinate that remembers its last state, and a signal its last instant: the engine asks for each twice.

    row (1, n): its gradient by all coordinates that the engine hands over.
    """

    def __init__(self, s: Coordinate) -> None:
        from granular_contact.mechanics.kernels.joint_loads import MOST

        self._s, self._q, self._v, self._found = s, [math.nan], [math.nan], (0.0, 0.0)
        self._t, self._setpoint = math.nan, (0.0, 0.0)
        self._slope, self.row = np.zeros(MOST), np.zeros((1, 0))

    def __call__(self, q: Numbers, v: Numbers) -> tuple[float, float]:
        """Coordinate and rate; the coordinates of a ground node come first, and are not asked for."""
        if q != self._q or v != self._v:
            count, size = len(q), self._s.size
            if self.row.shape[1] != count:
                self.row = np.zeros((1, count))
            self._found = self._s.now(q[count - size :], v[count - size :], self._slope)
            self.row[0, count - size :] = self._slope[:size]
            self._q, self._v = q, v
        return self._found

    def setpoint(self, signal: Signal, t: float) -> tuple[float, float]:
        """Value and rate of a signal; before the start it is held."""
        if t != self._t:
            self._t, self._setpoint = t, (signal.value(max(t, 0.0)), signal.rate(t) if t >= 0.0 else 0.0)
        return self._setpoint


def _motion_functions(s: Coordinate, drive: Drive) -> tuple[Callable[..., Numbers], Callable[..., Any]]:
    signal, at, container = drive.signal, _Last(s), exu.MatrixContainer()

    def constraint(mbs: Any, t: float, item: int, q: Numbers, v: Numbers, by_velocity: bool) -> Numbers:  # noqa: ARG001
        value, rate = at(q, v)
        setpoint, rate_asked = at.setpoint(signal, t)
        return [rate - rate_asked] if by_velocity else [value - setpoint]

    def jacobian(mbs: Any, t: float, item: int, q: Numbers, v: Numbers, by_velocity: bool) -> Any:  # noqa: ARG001
        at(q, v)
        container.SetWithDenseMatrix(at.row, useDenseMatrix=True)
        return container

    return constraint, jacobian
