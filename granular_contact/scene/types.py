"""The scene that the engine gets: bodies, joints, medium and numbers, as frozen plain data.

World frame: x horizontal, y up. A body's frame has its x axis along the body. Angles of bodies turn counter-clockwise
here; those of hinges turn clockwise, as configs and results have them: on the ground, below the horizontal.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import ClassVar, Literal

import numpy as np

# A run's settings are the scenario's own, as they were validated.
from granular_contact.config.schema import AnyMethod, Scenario
from granular_contact.config.schema import Load as Load
from granular_contact.config.schema import Minimal as Minimal
from granular_contact.config.schema import Reduced as Reduced
from granular_contact.config.schema import Solver as Solver
from granular_contact.errors import Fault
from granular_contact.laws.law import Law
from granular_contact.laws.static_friction import Elastoplastic, Smooth
from granular_contact.scene.bed import Bed
from granular_contact.scene.joint_law import IDLE, JointLaw
from granular_contact.scene.parts import FlexibleLink, RigidBody
from granular_contact.scene.parts import Vector as Vector
from granular_contact.scene.signals import Signal
from granular_contact.scene.steps import Steps
from granular_contact.scene.wheel_test import WheelTest

FASTEST = 1e8  # m/s or rad/s, in any coordinate: from there on a run has run away


@dataclass(frozen=True)
class Joint:
    """Joint of two bodies at a point of each, (2,) m in their frames; parent None is the ground.

    axis: of a slider, unit vector (2,) in the parent's frame. offset: a hinge's coordinate less the difference of the
    parent's and the child's angle (rad). start, rate: coordinate of a hinge or slider (rad clockwise, or m) and its
    rate at the start. closes: whether it closes a loop.
    """

    name: str
    kind: str  # the type of the config
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

    @property
    def has_coordinate(self) -> bool:
        """Whether it is a hinge or a slider."""
        return self.kind in ("hinge", "slider")

    @property
    def is_idle(self) -> bool:
        """Whether nothing acts in it but a drive."""
        return self.law.is_idle


@dataclass(frozen=True)
class Drive:
    """What acts at a hinge or slider over time, in its coordinate: N m, rad, rad/s or N, m, m/s.

    load: the signal is the torque or force. motion: the coordinate follows the signal. control: gain times the error of
    the coordinate and rate_gain times that of its rate, within the limit; of_rate: the signal is the reference rate.
    sets: of a drive that is set from outside during the run what is set, as the config names it (`torque_Nm`), and the
    signal is what acts until then; empty for all others. bounds: between which it can be set.
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
    """All that a solver needs. gravity m/s2, downward; bed: None in vacuum.

    tip: the farthest end of what is hinged or welded to the ground, the lowest end of what is not, as body and point.
    load, solver, method: as the scenario has them, but for `auto`; method: None for the engine. settle: find rest
    first. body_columns: report the motion of every body. stiff: links of the scenario that bend too little to show, and
    are rigid here. notes: what is doubtful about the model, by the key of the config. wheel_test: of a
    run of one wheel. travel: unit vector along which distances are reported, without what is upward; None for the path
    seen from above. scenario: what `build` made the
    scene of; None of a scene that was put together or changed otherwise, as by `dataclasses.replace`. like: a scene of
    the same parts, which strike another medium or otherwise, see `again`; None where none is known.
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
    like: Scene | None = field(default=None, init=False, repr=False, compare=False)

    in_space: ClassVar[bool] = False

    def __repr__(self) -> str:
        media = " and ".join(medium.name or medium.law for medium in self.media) or "vacuum"
        parts = f"{len(self.rigid)} rigid and {len(self.links)} flexible bodies"
        return f"<scene {self.name}: {parts}, {self.mass:.4g} kg, in {media}>"

    @cached_property
    def surface(self) -> float | None:
        """Height of the free surface at x = 0 (m), everywhere if it is level; None without one."""
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
        """Body of this name."""
        return next(body for body in self.bodies if body.name == name)

    @property
    def bends(self) -> bool:
        """Whether there are links that bend."""
        return bool(self.links)

    def link_length(self, name: str) -> float:
        """Length (m) of a link that bends."""
        return next(link.length for link in self.links if link.name == name)

    def joint(self, name: str) -> Joint:
        """Joint of this name."""
        return next(joint for joint in self.joints if joint.name == name)

    def carried(self, joint: Joint) -> set[str]:
        """Names of the bodies that move with the child of a joint: it, and all that hangs on it."""
        found = {joint.child}
        for _ in self.joints:
            found |= {one.child for one in self.joints if one.parent in found}
        return found

    def radius(self, body: RigidBody) -> float:
        """Distance (m) from a rigid body's centre of mass to the farthest point of its shapes and joints; without such
        its radius of gyration, so that its turning counts.
        """
        joints = [c.child_point for c in self.joints if c.child == body.name]
        joints += [c.parent_point for c in self.joints if c.parent == body.name]
        shapes = [float(np.linalg.norm(shape.points, axis=1).max()) + shape.drop for shape in body.shapes]
        farthest = max([*shapes, *(float(np.linalg.norm(point)) for point in joints)], default=0.0)
        return farthest or math.sqrt(body.inertia / body.mass)

    @cached_property
    def tip_position(self) -> Vector:
        """Initial world position (2,) m of the tip."""
        name, point = self.tip
        return self.body(name).motion.world(point)

    @cached_property
    def length(self) -> float:
        """Size (m) of the mechanism at the start: from the pivot to the tip, or from the tip to the farthest body.

        At least the radius of every rigid body: the tip of a ball is its centre.
        """
        tip = self.tip_position
        far = [tip - body.motion.position for body in self.bodies]
        if self.pivot is not None:
            far = [tip - self.pivot.parent_point]
        return max(*(math.hypot(*arm) for arm in far), *map(self.radius, self.rigid), 0.0)

    @cached_property
    def least_path(self) -> float:
        """Path length (m) below which nothing counts as moved: 1e-4 of the size, or ten yield displacements.

        A body that lies in sand moves by some yield displacements without slipping.
        """
        static = self.static
        return max(1e-4 * self.length, 10.0 * static.yield_displacement if isinstance(static, Elastoplastic) else 0.0)

    @cached_property
    def speed(self) -> float:
        """Greatest speed (m/s) at the start: of the tip, and of bodies that slide or fly."""
        motion = self.body(self.tip[0]).motion
        arm = self.tip_position - motion.position
        of_tip = math.hypot(*(motion.velocity + motion.rate * np.array([-arm[1], arm[0]])))
        if self.pivot is not None:
            return of_tip
        return max(of_tip, *(math.hypot(*body.motion.velocity) for body in self.bodies))

    @cached_property
    def force_scale(self) -> float:
        """Scale of the forces (N): the weight, at 1 g at least, and the momentum of the impact.

        A mechanism of mass m that enters at tip speed v, and stops over a depth of its length L, needs m v^2 / L.
        """
        return self.mass * (max(abs(self.gravity), 9.81) + self.speed * self.speed / max(self.length, 1e-3))

    @property
    def rest_time(self) -> float | None:
        """Time (s) at rest after which a run ends; None where rest ends none, as of what drives move on."""
        return None if self.drives else self.solver.rest_time_s

    @cached_property
    def pivot(self) -> Joint | None:
        """First hinge to the ground of a mechanism that hangs on it by hinges and welds alone."""
        on_ground = [c for c in self.joints if c.parent is None]
        if any(c.kind not in ("hinge", "weld") for c in on_ground) or any(c.closes for c in self.joints):
            return None
        return next((c for c in on_ground if c.kind == "hinge"), None)

    @cached_property
    def pendulum(self) -> Joint | None:
        """The pivot of a mechanism that turns about it as one: nothing else of it moves but links that bend."""
        moving = [joint for joint in self.joints if joint.kind != "weld"]
        return self.pivot if moving == [self.pivot] else None

    @cached_property
    def floating(self) -> Joint | None:
        """The joint of a mechanism that flies free: its only joint to the ground, with three degrees of freedom."""
        on_ground = [c for c in self.joints if c.parent is None]
        return on_ground[0] if len(on_ground) == 1 and on_ground[0].kind == "free" else None

    def without_scatter(self) -> Scene:
        """The same with media that do not scatter."""
        if self.bed is None:
            return self
        none = {"scatter": None}
        layers = tuple(replace(one, medium=one.medium.model_copy(update=none)) for one in self.bed.layers)
        return replace(self, bed=replace(self.bed, layers=layers))

    def drive(self, joint: str) -> Drive | None:
        """Drive of a joint."""
        return next((drive for drive in self.drives if drive.joint == joint), None)


def link_of(body: str) -> str:
    """Name under which a body is reported: of an element of a link that bends in space that of the link."""
    return body.split(".")[0]
