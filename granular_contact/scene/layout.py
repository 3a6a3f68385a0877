"""Where the bodies of a model are at the start: frames, reach, groups of welded bodies, initial motion."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from granular_contact.config import schema
from granular_contact.scene.types import Motion, Tether, Vector, rotation

GROUND = "ground"
ZERO = np.zeros(2)


@dataclass(frozen=True)
class Frame:
    """Where a body's frame lies at the start: origin (2,) m in the world, angle rad."""

    origin: Vector
    angle: float

    def world(self, point: Vector) -> Vector:
        """World position of a point (2,) m of the body."""
        moved: Vector = self.origin + rotation(self.angle) @ point
        return moved

    def local(self, point: Vector) -> Vector:
        """Body-frame position of a world point (2,) m."""
        moved: Vector = rotation(-self.angle) @ (point - self.origin)
        return moved


def point(xy: tuple[float, float]) -> Vector:
    """Point of a config as an array (2,) m."""
    return np.array(xy, dtype=float)


def _joints_outward(model: schema.Model) -> Iterator[tuple[str, schema.Joint]]:
    """Joints in an order in which every parent is placed before its children."""
    placed, waiting = {GROUND}, dict(model.joints)
    while waiting:
        name = next(n for n, joint in waiting.items() if joint.parent in placed)
        placed.add(waiting[name].child)
        yield name, waiting.pop(name)


def _frames(model: schema.Model, impact_angle: float) -> dict[str, Frame]:
    """Frames of all bodies, undeformed; what hangs on the ground points impact_angle (rad) below the horizontal."""
    frames = {GROUND: Frame(ZERO, -impact_angle)}
    for _, joint in _joints_outward(model):
        parent = frames[joint.parent]
        angle = parent.angle + math.radians(joint.angle_deg if isinstance(joint, schema.Weld) else 0.0)
        pin = point(joint.parent_point_m) if joint.parent == GROUND else parent.world(point(joint.parent_point_m))
        frames[joint.child] = Frame(pin - rotation(angle) @ point(joint.child_point_m), angle)
    return frames


def _tethers(model: schema.Model) -> dict[str, Tether]:
    """How far from the ground joint each body can get, whatever the joints do in between."""
    tethers = {GROUND: Tether(ZERO, 0.0)}
    for _, joint in _joints_outward(model):
        length = tethers[joint.parent].reach(point(joint.parent_point_m))
        tethers[joint.child] = Tether(point(joint.child_point_m), length)
    return tethers


def _is_rigid(model: schema.Model, name: str) -> bool:
    if name == GROUND:
        return True
    body = model.bodies[name]
    return not (isinstance(body, schema.Link) and body.flexible is not None)


def _weld_groups(model: schema.Model) -> list[list[str]]:
    """Rigid bodies (and the ground) grouped by the welds between them: each group moves as one."""
    groups = {name: [name] for name in (GROUND, *model.bodies) if _is_rigid(model, name)}
    for _, joint in _joints_outward(model):
        if isinstance(joint, schema.Weld) and joint.parent in groups and joint.child in groups:
            merged = groups[joint.parent]
            merged += groups[joint.child]
            for name in groups[joint.child]:
                groups[name] = merged
    distinct = {id(group): group for group in groups.values()}
    return list(distinct.values())


@dataclass(frozen=True)
class Spin:
    """Initial motion: everything turns about one axis (2,) m at one rate (rad/s, counter-clockwise)."""

    axis: Vector
    rate: float

    def motion(self, frame: Frame) -> Motion:
        """Pose and velocity of a frame that turns along."""
        arm = frame.origin - self.axis
        return Motion(frame.origin, frame.angle, self.rate * np.array([-arm[1], arm[0]]), self.rate)


def _axis(model: schema.Model) -> Vector:
    hinges = (j for j in model.joints.values() if isinstance(j, schema.Hinge) and j.parent == GROUND)
    hinge = next(hinges, None)
    return ZERO if hinge is None else point(hinge.parent_point_m)


@dataclass(frozen=True)
class Layout:
    """A model laid out: frame and tether of every body, groups of rigid bodies that are welded together, the motion."""

    model: schema.Model
    frames: dict[str, Frame]
    tethers: dict[str, Tether]
    groups: list[list[str]]
    spin: Spin

    def is_free(self, name: str, end: Vector) -> bool:
        """Whether nothing is joined to a body at this end (2,) m of it."""
        joints = self.model.joints.values()
        points = [point(j.parent_point_m) for j in joints if j.parent == name]
        points += [point(j.child_point_m) for j in joints if j.child == name]
        return not any(np.allclose(at, end, rtol=0.0, atol=1e-9) for at in points)


def lay_out(model: schema.Model, impact_angle: float, impact_speed: float) -> Layout:
    """Lay out a model that points impact_angle (rad) below the horizontal and turns down at impact_speed (rad/s)."""
    return Layout(
        model=model,
        frames=_frames(model, impact_angle),
        tethers=_tethers(model),
        groups=_weld_groups(model),
        spin=Spin(_axis(model), -impact_speed),
    )
