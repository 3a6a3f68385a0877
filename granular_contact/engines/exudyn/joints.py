"""Joints in Exudyn: constraints, springs and dampers, forces of laws and drives, and prescribed motions."""

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
    """Add a joint in the plane to the system, with its spring, damper, stops, friction and drive.

    ground: number of the ground object.
    """
    _constrain(system, ground, joint)
    if not joint.has_coordinate:
        return
    drive = system.scene.drive(joint.name)
    is_rigid_hinge = joint.kind == "hinge" and not {joint.parent, joint.child} & system.links.keys()
    if is_rigid_hinge and drive is not None and drive.kind == "motion":
        _add_hinge_motion(system, joint, drive)
        drive = None
    if drive is None and joint.law.is_idle:
        return
    if is_rigid_hinge and drive is None and joint.law.is_linear:
        _add_spring(system, joint)
        return
    from granular_contact.mechanics.coordinates import coordinate

    add_actions(system, joint, drive, partial(coordinate, system, joint, system.origin))


def add_actions(system: System, joint: Any, drive: Drive | None, coordinate: Callable[..., Coordinate]) -> None:
    """Add what acts along the coordinate of a joint, in the plane or in space: drive, spring, damper, stops, friction.

    A prescribed motion becomes a constraint in `system.motions`, all else a load in `system.loads`. coordinate: makes
    the coordinate, as `mechanics.coordinates.coordinate` does.
    """
    from granular_contact.mechanics.joint_loads import JointLoad

    if drive is not None and drive.kind == "motion":
        # The coordinates at markers of nodes include the reference values.
        system.motions[joint.name] = _add_motion(system, coordinate(), system.nodes_of(joint), drive)
        drive = None
    if drive is not None or not joint.is_idle:
        joint_coordinate = coordinate(reference=EngineCoordinates(system.mbs).reference)
        system.loads[joint.name] = JointLoad(joint_coordinate, system.nodes_of(joint), joint.law, drive)


def _constrain(system: System, ground: Any, joint: Joint) -> None:
    """Add the constraint of a joint in the plane; a free joint has none."""
    if joint.kind == "free":
        return
    mbs = system.mbs
    ends = (
        _joint_end(system, ground, joint.parent, joint.parent_point),
        _joint_end(system, ground, joint.child, joint.child_point),
    )
    if joint.kind == "hinge":
        markers = [mbs.AddMarker(items.MarkerBodyPosition(bodyNumber=n, localPosition=p)) for n, p in ends]
        mbs.AddObject(items.ObjectJointRevolute2D(markerNumbers=markers))
        return
    # The markers on both bodies must have the same axes in the initial state: the joint keeps the initial angle between
    # the bodies.
    angles = (_angle(system, joint.child) - _angle(system, joint.parent), 0.0)
    marker_axes = [np.eye(3), np.eye(3)]
    for axes, angle in zip(marker_axes, angles, strict=True):
        axes[:2, :2] = rotation(angle)
    markers = [rigid_marker(mbs, *end, axes) for end, axes in zip(ends, marker_axes, strict=True)]
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


def rigid_marker(mbs: Any, body: Any, point: ArrayLike, axes: Vector) -> Any:
    """Add a marker to a body; point (3,) m and axes (3, 3), as columns: its origin and axes in the body's frame."""
    return mbs.AddMarker(items.MarkerBodyRigid(bodyNumber=body, localHT=exu.HT(rotation=axes, translation=point)))


def _joint_end(system: System, ground: Any, name: str | None, point: Vector) -> tuple[Any, list[float]]:
    """Object of a body and local position (3,) m of an end of a joint; name: None for the ground."""
    if name is None:
        return ground, [*(point - system.origin), 0.0]
    if name in system.rigid:
        return system.rigid[name].object, [*point, 0.0]
    handle = system.links[name]
    if handle.end(point):
        return handle.elements[-1], [handle.link.length / handle.link.elements, 0.0, 0.0]
    return handle.elements[0], [0.0, 0.0, 0.0]


def _angle(system: System, name: str | None) -> float:
    """Initial angle (rad) of a body; name: None for the ground."""
    return 0.0 if name is None else system.scene.body(name).motion.angle


# ---- springs, dampers and prescribed motions ----


def _add_spring(system: System, joint: Joint) -> None:
    """Add linear spring and damper of a hinge of rigid bodies, as the engine's connector between their angles."""
    mbs, law = system.mbs, joint.law
    ends = [_angle_marker(system, body) for body in (joint.child, joint.parent)]
    mbs.AddObject(
        items.ObjectConnectorCoordinateSpringDamper(
            markerNumbers=ends,
            stiffness=law.stiffness,
            damping=law.damping,
            # The engine counts angles from the initial state.
            offset=law.rest - joint.start,
        )
    )


def _angle_marker(system: System, body: str | None) -> Any:
    """Add a marker of the angle of a rigid body; body: its name, None for the ground."""
    mbs = system.mbs
    node = mbs.AddNode(items.NodePointGround()) if body is None else system.rigid[body].node
    return mbs.AddMarker(items.MarkerNodeCoordinate(nodeNumber=node, coordinate=0 if body is None else 2))


def _add_hinge_motion(system: System, joint: Joint, drive: Drive) -> None:
    """Add the prescribed motion of a hinge of rigid bodies, as the engine's constraint between their angles."""
    ends = [_angle_marker(system, body) for body in (joint.child, joint.parent)]
    number = int(system.mbs.AddObject(items.ObjectConnectorCoordinate(markerNumbers=ends)))
    system.turning.append(HingeMotion(number, drive.signal, joint.start))
    system.motions[joint.name] = number


def _add_motion(system: System, s: Coordinate, nodes: list[int], drive: Drive) -> int:
    """Add the constraint s(q) = signal(t) of a coordinate s; returns its object number.

    nodes: those of parent and child, or of the child alone if the parent is the ground.
    """
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
                # From the number of rows the engine takes the number of equations.
                scalingMarker0=np.zeros((1, sizes[0] or 3)),
                scalingMarker1=np.zeros((1, sizes[1])),
                constraintUserFunction=constraint,
                jacobianUserFunction=jacobian,
            )
        )
    )


class _CachedCoordinate:
    """Coordinate s of a joint and setpoint of its drive, evaluated once per state: the engine calls for each twice.

    gradient (1, n): ds/dq by all coordinates that the engine passes.
    """

    def __init__(self, s: Coordinate) -> None:
        from granular_contact.mechanics.kernels.joint_loads import MOST

        self._s, self._q, self._v, self._value_and_rate = s, [math.nan], [math.nan], (0.0, 0.0)
        self._t, self._setpoint = math.nan, (0.0, 0.0)
        self._ds_dq, self.gradient = np.zeros(MOST), np.zeros((1, 0))

    def __call__(self, q: Numbers, v: Numbers) -> tuple[float, float]:
        """Value and rate of the coordinate; coordinates of a ground node come first in q and v, and have no effect."""
        if q != self._q or v != self._v:
            count, size = len(q), self._s.size
            if self.gradient.shape[1] != count:
                self.gradient = np.zeros((1, count))
            self._value_and_rate = self._s.now(q[count - size :], v[count - size :], self._ds_dq)
            self.gradient[0, count - size :] = self._ds_dq[:size]
            self._q, self._v = q, v
        return self._value_and_rate

    def setpoint(self, signal: Signal, t: float) -> tuple[float, float]:
        """Value and rate of a signal; before t = 0 the signal is constant."""
        if t != self._t:
            self._t, self._setpoint = t, (signal.value(max(t, 0.0)), signal.rate(t) if t >= 0.0 else 0.0)
        return self._setpoint


def _motion_functions(s: Coordinate, drive: Drive) -> tuple[Callable[..., Numbers], Callable[..., Any]]:
    """User functions of a constraint s(q) = signal(t): its residual, by position or by velocity, and its Jacobian."""
    signal, coordinate, container = drive.signal, _CachedCoordinate(s), exu.MatrixContainer()

    def constraint(mbs: Any, t: float, item: int, q: Numbers, v: Numbers, by_velocity: bool) -> Numbers:  # noqa: ARG001
        value, rate = coordinate(q, v)
        setpoint, setpoint_rate = coordinate.setpoint(signal, t)
        return [rate - setpoint_rate] if by_velocity else [value - setpoint]

    def jacobian(mbs: Any, t: float, item: int, q: Numbers, v: Numbers, by_velocity: bool) -> Any:  # noqa: ARG001
        coordinate(q, v)
        container.SetWithDenseMatrix(coordinate.gradient, useDenseMatrix=True)
        return container

    return constraint, jacobian
