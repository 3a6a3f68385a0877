"""The scene that an engine gets: bodies, joints, medium and numbers, as frozen plain data.

World frame: x horizontal, y up. The x axis of a body's frame lies along the body. Angles of bodies are positive
counter-clockwise here. Angles of hinges are positive clockwise, as in configs and results: a positive angle of a hinge
on the ground is below the horizontal.
"""

from __future__ import annotations

import math
from collections.abc import Collection
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, ClassVar, Literal, TypeVar

import numpy as np

# The settings of a run are those of the validated scenario.
from granular_contact.config.schema import AnyMethod, Scenario
from granular_contact.config.schema import Load as Load
from granular_contact.config.schema import Minimal as Minimal
from granular_contact.config.schema import Reduced as Reduced
from granular_contact.config.schema import Solver as Solver
from granular_contact.errors import Fault, unknown_name
from granular_contact.laws.law import Law
from granular_contact.laws.static_friction import Elastoplastic, Smooth
from granular_contact.scene.bed import Bed
from granular_contact.scene.joint_law import IDLE, JointLaw
from granular_contact.scene.parts import FlexibleLink, RigidBody
from granular_contact.scene.parts import Vector as Vector
from granular_contact.scene.signals import Signal
from granular_contact.scene.steps import Steps
from granular_contact.scene.wheel_test import WheelTest

Named = TypeVar("Named", bound=Any)  # a part with a `name`
FASTEST = 1e8  # m/s or rad/s, of any coordinate: a run that gets this fast has diverged


def with_name(parts: Collection[Named], name: str, noun: str) -> Named:
    """Return the part with this name; raises KeyError, with similar names, if there is none. noun: for the message."""
    for part in parts:
        if part.name == name:
            return part
    raise KeyError(unknown_name(noun, name, [part.name for part in parts]))


@dataclass(frozen=True)
class Joint:
    """Joint between two bodies at one point of each, (2,) m in the frame of that body; parent None is the ground.

    axis: of a slider, unit vector (2,) in the parent's frame. offset (rad): coordinate of a hinge minus the angle of
    the parent, plus the angle of the child. start, rate: coordinate of a hinge or slider (rad clockwise, or m) and its
    rate at the start. closes: whether the joint closes a loop. effort_limit, rate_limit: of its actuator
    (N m or N; rad/s or m/s).
    """

    name: str
    kind: str  # the type in the config
    parent: str | None
    parent_point: Vector
    child: str
    child_point: Vector
    axis: Vector | None = None
    offset: float = 0.0
    start: float = 0.0
    rate: float = 0.0
    closes: bool = False
    law: JointLaw = IDLE
    effort_limit: float = math.inf
    rate_limit: float = math.inf

    @property
    def has_coordinate(self) -> bool:
        """Whether the joint is a hinge or a slider."""
        return self.kind in ("hinge", "slider")

    @property
    def is_idle(self) -> bool:
        """Whether the joint has no spring, damper, stops or friction; it may have a drive."""
        return self.law.is_idle


@dataclass(frozen=True)
class Drive:
    """Drive of a hinge or slider, in the units of its coordinate: N m, rad, rad/s or N, m, m/s.

    kind: `load`: the signal is the torque or force; `motion`: the coordinate follows the signal; `control`: the torque
    or force is gain times the error of the coordinate plus rate_gain times the error of its rate, within the limit.
    of_rate: the signal is the reference rate. sets: key of the config (`torque_Nm`) of a drive that a controller sets
    during the run, empty for other drives; its signal acts until the controller sets a value. bounds: range of the
    values that a controller may set.
    """

    joint: str
    kind: Literal["load", "motion", "control"]
    signal: Signal
    gain: float = 0.0
    rate_gain: float = 0.0
    limit: float = math.inf
    of_rate: bool = False
    sets: str = ""
    bounds: tuple[float, float] = (-math.inf, math.inf)


@dataclass(frozen=True)
class Scene:
    """Everything that a solver needs. gravity: m/s2, downward; bed: None in vacuum.

    tip: body and point (2,) m: the farthest end of a mechanism that is hinged or welded to the ground, the lowest end
    of any other. load, solver, method: as in the scenario, with `auto` replaced; method: None for Exudyn. settle: find
    the static equilibrium first. body_columns: report the motion of every body. stiff: names of flexible links of the
    scenario that are rigid here, as they bend too little to show. notes: doubts about the model, each with its key of
    the config. wheel_test: of a run of one wheel. travel: horizontal unit vector along which distances are reported;
    None: the length of the path seen from above. scenario: the scenario that `build` got; None for a scene that was put
    together or changed in another way, as by `dataclasses.replace`. variant_of: the scene that this one was derived
    from (`scene.variants`): the same parts, with another medium or another impact; None for all others.
    """

    name: str
    rigid: tuple[RigidBody, ...]
    links: tuple[FlexibleLink, ...]
    joints: tuple[Joint, ...]
    gravity: float
    bed: Bed | None
    load: Load
    solver: Steps
    tip: tuple[str, Vector]
    output_interval: float | None
    method: AnyMethod | None = None
    drives: tuple[Drive, ...] = ()
    settle: bool = False
    body_columns: bool = False
    stiff: tuple[str, ...] = ()
    notes: tuple[Fault, ...] = ()
    wheel_test: WheelTest | None = None
    travel: tuple[float, ...] | None = (1.0,)
    scenario: Scenario | None = field(default=None, init=False, repr=False, compare=False)
    variant_of: Scene | None = field(default=None, init=False, repr=False, compare=False)

    in_space: ClassVar[bool] = False

    def __repr__(self) -> str:
        media = " and ".join(medium.name or medium.law for medium in self.media) or "vacuum"
        parts = f"{len(self.rigid)} rigid and {len(self.links)} flexible bodies"
        return f"<scene {self.name}: {parts}, {self.mass:.4g} kg, in {media}>"

    @cached_property
    def surface(self) -> float | None:
        """Height (m) of the free surface at x = 0, and everywhere if it is level; None without a surface."""
        return None if self.bed is None else float(self.bed.height(np.zeros(1))[0])

    @property
    def static(self) -> Elastoplastic | Smooth:
        """Static friction of the medium."""
        return self.load.friction

    @cached_property
    def media(self) -> tuple[Law, ...]:
        """All media of the bed, from the top; none in vacuum."""
        return () if self.bed is None else self.bed.media

    @cached_property
    def bodies(self) -> list[RigidBody | FlexibleLink]:
        """All bodies, the rigid ones first."""
        return [*self.rigid, *self.links]

    @cached_property
    def mass(self) -> float:
        """Moving mass (kg)."""
        return sum(body.mass for body in self.bodies)

    def body(self, name: str) -> RigidBody | FlexibleLink:
        """Body with this name.

        Parameters
        ----------
        name : str
            Name of a body of the scene. Welded bodies of the config are one body here.

        Returns
        -------
        RigidBody or FlexibleLink

        Raises
        ------
        KeyError
            The scene has no such body.
        """
        return with_name(self.bodies, name, "body")

    @property
    def bends(self) -> bool:
        """Whether the scene has links that bend."""
        return bool(self.links)

    def link_length(self, name: str) -> float:
        """Length of a link that bends.

        Parameters
        ----------
        name : str
            Name of the link.

        Returns
        -------
        float
            m.

        Raises
        ------
        KeyError
            The scene has no such link that bends.
        """
        return with_name(self.links, name, "link that bends").length

    def joint(self, name: str) -> Joint:
        """Joint with this name.

        Parameters
        ----------
        name : str
            Name of a joint of the scene.

        Returns
        -------
        Joint

        Raises
        ------
        KeyError
            The scene has no such joint.
        """
        return with_name(self.joints, name, "joint")

    def carried(self, joint: Joint) -> set[str]:
        """Names of the child of a joint and of all bodies outward of it, which move with the child.

        Parameters
        ----------
        joint : Joint
            A joint of the scene.

        Returns
        -------
        set of str
        """
        bodies = {joint.child}
        for _ in self.joints:
            bodies |= {outer.child for outer in self.joints if outer.parent in bodies}
        return bodies

    def radius(self, body: RigidBody) -> float:
        """Distance from a rigid body's centre of mass to the farthest point of its shapes and joints.

        Parameters
        ----------
        body : RigidBody
            A rigid body of the scene.

        Returns
        -------
        float
            m. A body without such points gets its radius of gyration, so that its rotation counts.
        """
        joint_points = [joint.child_point for joint in self.joints if joint.child == body.name]
        joint_points += [joint.parent_point for joint in self.joints if joint.parent == body.name]
        shapes = [float(np.linalg.norm(shape.points, axis=1).max()) + shape.drop for shape in body.shapes]
        farthest = max([*shapes, *(float(np.linalg.norm(point)) for point in joint_points)], default=0.0)
        return farthest or math.sqrt(body.inertia / body.mass)

    @cached_property
    def tip_position(self) -> Vector:
        """Initial world position (2,) m of the tip."""
        name, point = self.tip
        return self.body(name).motion.world(point)

    @cached_property
    def length(self) -> float:
        """Size (m) of the mechanism at the start: from the pivot to the tip, or from the tip to the farthest body.

        It is at least the radius of every rigid body, as the tip of a ball is its centre.
        """
        tip = self.tip_position
        arms = [tip - body.motion.position for body in self.bodies]
        if self.pivot is not None:
            arms = [tip - self.pivot.parent_point]
        return max(*(math.hypot(*arm) for arm in arms), *map(self.radius, self.rigid), 0.0)

    @cached_property
    def least_path(self) -> float:
        """Path length (m) below which a body counts as not moved: 1e-4 of the size, or ten yield displacements if more.

        A body that lies in sand moves by some yield displacements without slipping.
        """
        static = self.static
        return max(1e-4 * self.length, 10.0 * static.yield_displacement if isinstance(static, Elastoplastic) else 0.0)

    @cached_property
    def speed(self) -> float:
        """Greatest speed (m/s) at the start: of the tip, and without a pivot also of the origins of the bodies."""
        motion = self.body(self.tip[0]).motion
        arm = self.tip_position - motion.position
        tip_speed = math.hypot(*(motion.velocity + motion.rate * np.array([-arm[1], arm[0]])))
        if self.pivot is not None:
            return tip_speed
        return max(tip_speed, *(math.hypot(*body.motion.velocity) for body in self.bodies))

    @cached_property
    def force_scale(self) -> float:
        """Scale of the forces (N): the weight, by at least 9.81 m/s2, plus the force that stops the impact.

        To stop a mechanism of mass m and tip speed v over a depth equal to its length L takes m v^2 / L.
        """
        return self.mass * (max(abs(self.gravity), 9.81) + self.speed * self.speed / max(self.length, 1e-3))

    @property
    def rest_time(self) -> float | None:
        """Time (s) at rest after which a run ends; None with drives, which may move a resting mechanism again."""
        return None if self.drives else self.solver.rest_time_s

    @cached_property
    def pivot(self) -> Joint | None:
        """First hinge on the ground; None if the ground has other joints than hinges and welds, or with loops."""
        on_ground = [joint for joint in self.joints if joint.parent is None]
        others = any(joint.kind not in ("hinge", "weld") for joint in on_ground)
        if others or any(joint.closes for joint in self.joints):
            return None
        return next((joint for joint in on_ground if joint.kind == "hinge"), None)

    @cached_property
    def pendulum(self) -> Joint | None:
        """The pivot, if it is the only joint that can move; links may bend."""
        moving = [joint for joint in self.joints if joint.kind != "weld"]
        return self.pivot if moving == [self.pivot] else None

    @cached_property
    def floating(self) -> Joint | None:
        """The free joint of a floating mechanism, if it is the only joint on the ground."""
        on_ground = [joint for joint in self.joints if joint.parent is None]
        return on_ground[0] if len(on_ground) == 1 and on_ground[0].kind == "free" else None

    def without_scatter(self) -> Scene:
        """The same scene with media that do not scatter."""
        if self.bed is None:
            return self
        none = {"scatter": None}
        layers = tuple(replace(layer, medium=layer.medium.model_copy(update=none)) for layer in self.bed.layers)
        return replace(self, bed=replace(self.bed, layers=layers))

    def drive(self, joint: str) -> Drive | None:
        """Drive of a joint.

        Parameters
        ----------
        joint : str
            Name of the joint.

        Returns
        -------
        Drive or None
            None for a joint without a drive.
        """
        return next((drive for drive in self.drives if drive.joint == joint), None)


def link_of(body: str) -> str:
    """Name under which a body is reported: an element of a spatial link that bends is reported as the link."""
    return body.split(".")[0]
