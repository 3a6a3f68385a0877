"""Kinematic loops at the start: whether they close, the state of dependent joints, redundant constraints."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from granular_contact.config import schema
from granular_contact.errors import Fault, scene_fault
from granular_contact.scene.layout import JointState, Pose, direction, is_rigid, point, pose
from granular_contact.scene.start import Start
from granular_contact.scene.types import Drive, Vector, rotation, turned

Mask = NDArray[np.bool_]
# A loop may gape by this much (m, rad) as the config writes it down; it is then closed to round-off.
LARGEST_GAP, LARGEST_TILT = 1e-4, math.radians(0.01)
RANK_TOLERANCE = 1e-9  # of the largest singular value
_CONTINUATION_STEPS = 8  # in which a loop is led from home to where the run wants it


class Loops:
    """The loops of a model, as equations C(x) = 0 of the coordinates x of its tree of joints."""

    def __init__(self, model: schema.Model, ground_angle: float) -> None:
        self.model, self.ground_angle = model, ground_angle
        self.joints = [name for name, joint in model.all_joints.items() if not isinstance(joint, schema.Weld)]
        self.sizes = [3 if isinstance(model.all_joints[name], schema.Free) else 1 for name in self.joints]

    def states(self, x: Vector, rates: Vector) -> dict[str, JointState]:
        """Joint states of coordinates (n,) and their rates (n,)."""
        if not self.joints:
            return {}
        ends = np.cumsum(self.sizes)[:-1]
        split = zip(self.joints, np.split(x, ends), np.split(rates, ends), strict=True)
        return {name: JointState(value, rate) for name, value, rate in split}

    def vector(self, states: Mapping[str, JointState]) -> tuple[Vector, Vector]:
        """Coordinates (n,) and their rates (n,) of joint states."""
        values = [states[name].value for name in self.joints]
        rates = [states[name].rate for name in self.joints]
        return np.concatenate([np.zeros(0), *values]), np.concatenate([np.zeros(0), *rates])

    def mask(self, names: frozenset[str]) -> Mask:
        """Which coordinates (n,) belong to these joints."""
        return np.repeat(np.array([name in names for name in self.joints], dtype=bool), self.sizes)

    def at(self, x: Vector, rates: Vector) -> Pose:
        """Pose of the mechanism."""
        return pose(self.model, self.states(x, rates), self.ground_angle)

    def gaps(self, name: str, placed: Pose) -> Vector:
        """Residual of the closure of one loop: (2,) m of a hinge, (m, rad) of a slider, (m, m, rad) of a weld."""
        joint = self.model.closures[name]
        parent, child = placed.frames[joint.parent], placed.frames[joint.child]
        gap = child.world(point(joint.child_point_m)) - parent.world(point(joint.parent_point_m))
        if isinstance(joint, schema.HingeClosure):
            return gap
        turn = child.angle - parent.angle - turned(joint.home_deg)
        turn -= 2.0 * math.pi * round(turn / (2.0 * math.pi))
        if isinstance(joint, schema.SliderClosure):
            return np.array([_across(joint, parent.angle) @ gap, turn])
        return np.array([*gap, turn])

    def gap_rates(self, name: str, placed: Pose) -> Vector:
        """Velocity residual of a closed loop."""
        joint = self.model.closures[name]
        parent, child = placed.twists[joint.parent], placed.twists[joint.child]
        pin = placed.frames[joint.child].world(point(joint.child_point_m))
        gap = child.at(pin) - parent.at(pin)
        if isinstance(joint, schema.HingeClosure):
            return gap
        turn = child.rate - parent.rate
        if isinstance(joint, schema.SliderClosure):
            return np.array([_across(joint, placed.frames[joint.parent].angle) @ gap, turn])
        return np.array([*gap, turn])

    def all_gaps(self, x: Vector) -> Vector:
        """All gaps (m,)."""
        placed = self.at(x, np.zeros_like(x))
        return np.concatenate([self.gaps(name, placed) for name in self.model.closures])

    def jacobian(self, x: Vector) -> dict[str, Vector]:
        """Constraint Jacobian of every closure, (rows, n) each, in a closed pose."""
        still = self.at(x, np.zeros_like(x))
        slopes = {name: np.zeros((len(self.gaps(name, still)), len(x))) for name in self.model.closures}
        for i, unit in enumerate(np.eye(len(x))):
            moving = self.at(x, unit)
            for name, slope in slopes.items():
                slope[:, i] = self.gap_rates(name, moving)
        return slopes

    def close(self, x: Vector, movable: Mask) -> Vector:
        """Coordinates near x that close all loops, or as far as Newton's method gets; only the movable (n,) change."""
        if not movable.any():
            return x
        for _ in range(20):
            gap = self.all_gaps(x)
            if np.abs(gap).max() < 1e-14:
                break
            slope = np.concatenate(list(self.jacobian(x).values()))[:, movable]
            x = x.copy()
            x[movable] -= np.linalg.lstsq(slope, gap, rcond=1e-10)[0]
        return x


def _across(joint: schema.SliderClosure, angle: float) -> Vector:
    along = rotation(angle) @ direction(joint)
    return np.array([-along[1], along[0]])


def closed(scenario: schema.Scenario, begun: Start, ground_angle: float, faults: list[Fault]) -> dict[str, JointState]:
    """Joint states that close all loops in position and velocity; joints not given follow. Faults are appended."""
    model = scenario.model
    if not model.closures:
        return begun.states
    loops = Loops(model, ground_angle)
    target, rates = loops.vector(begun.states)
    home = _home(loops, begun)
    faults += _open(loops, home, "at home")
    if faults:
        return begun.states
    placed = loops.mask(begun.placed)
    x = loops.close(home, np.ones(len(home), dtype=bool))
    if placed.any():
        first = x
        for share in np.linspace(0.0, 1.0, _CONTINUATION_STEPS + 1)[1:]:
            x = np.where(placed, first + share * (target - first), x)
            x = loops.close(x, ~placed)
        faults += _open(loops, x, "at the start")
    return loops.states(x, dependent_rates(loops.jacobian(x), loops.mask(begun.moved), rates, faults))


def dependent_rates(jacobian: Mapping[str, Vector], moved: Mask, rates: Vector, faults: list[Fault]) -> Vector:
    """Rates (n,) that keep loops closed: those that are given (moved), and those that follow. A fault where none do."""
    slopes = np.concatenate(list(jacobian.values()))
    rates = np.where(moved, rates, 0.0)
    if not moved.all():
        rates[~moved] = np.linalg.lstsq(slopes[:, ~moved], -slopes @ rates, rcond=1e-10)[0]
    opening = float(np.abs(slopes @ rates).max(initial=0.0))
    if opening > 1e-6 * max(1.0, float(np.abs(rates).max(initial=0.0))):
        words = f"the joint rates violate a loop closure by {opening:.3g} m/s or rad/s: give fewer of them"
        faults.append(scene_fault("initial.joints", words))
    return rates


def _home(loops: Loops, begun: Start) -> Vector:
    """Reference coordinates, in which the loops have to close; free bodies are where the run has them."""
    home = []
    for name in loops.joints:
        joint = loops.model.all_joints[name]
        if isinstance(joint, schema.Hinge):
            home.append(math.radians(joint.home_deg))
        elif isinstance(joint, schema.Slider):
            home.append(joint.home_m)
        else:
            home += begun.states[name].value.tolist()
    return np.array(home)


def _open(loops: Loops, x: Vector, when: str) -> list[Fault]:
    """A fault for every loop that does not close."""
    faults = []
    placed = loops.at(x, np.zeros_like(x))
    for name, joint in loops.model.closures.items():
        gap = loops.gaps(name, placed)
        turn = 0.0 if isinstance(joint, schema.HingeClosure) else abs(float(gap[-1]))
        distance = float(np.linalg.norm(gap if isinstance(joint, schema.HingeClosure) else gap[:-1]))
        if distance > LARGEST_GAP or turn > LARGEST_TILT:
            words = f"the loop does not close {when}: {joint.parent} and {joint.child} are {distance:.4g} m"
            words += f" and {math.degrees(turn):.4g} deg" if turn > LARGEST_TILT else ""
            words += f" apart there; allowed are {LARGEST_GAP:g} m" + (
                f" and {math.degrees(LARGEST_TILT):g} deg" if turn else ""
            )
            faults.append(scene_fault(f"model.closures.{name}", words))
    return faults


def redundant(
    model: schema.Model, states: Mapping[str, JointState], ground_angle: float, drives: tuple[Drive, ...]
) -> list[Fault]:
    """Redundant closures and prescribed motions, by the rank of the constraint Jacobian at the start.

    A loop through a flexible link is never redundant.
    """
    if not model.closures:
        return []
    loops = Loops(model, ground_angle)
    x, _ = loops.vector(states)
    rows = {("closures", name): slope for name, slope in loops.jacobian(x).items() if not _gives_way(model, name)}
    begins = dict(zip(loops.joints, np.cumsum([0, *loops.sizes]), strict=False))
    for drive in drives:
        if drive.kind == "motion" and drive.joint in begins:
            rows["drives", drive.joint] = np.eye(len(x))[[begins[drive.joint]]]
    held, rank, faults = np.zeros((0, len(x))), 0, []
    scale = max((float(np.abs(slope).max(initial=0.0)) for slope in rows.values()), default=1.0)
    for (kind, name), slope in rows.items():
        tried = np.vstack([held, slope])
        gained = int(np.linalg.matrix_rank(tried, tol=RANK_TOLERANCE * max(scale, 1.0))) - rank
        if gained == len(slope):
            held, rank = tried, rank + gained
            continue
        spare = len(slope) - gained
        verb = "is" if spare == 1 else "are"
        words = f"{spare} of the {len(slope)} constraint{'s' * (len(slope) > 1)} of {name} {verb} redundant with the"
        words += " other joints: leave it out, or choose a type with fewer constraints"
        faults.append(scene_fault(f"{'model.' * (kind == 'closures')}{kind}.{name}", words))
    return faults


def _gives_way(model: schema.Model, closure: str) -> bool:
    """Whether the loop of a closure has a flexible link in it."""
    joint_of = {joint.child: joint for joint in model.all_joints.values()}

    def path(body: str) -> list[str]:
        bodies = [body]
        while bodies[-1] in joint_of:
            bodies.append(joint_of[bodies[-1]].parent)
        return bodies

    ends = model.closures[closure]
    one, other = path(ends.parent), path(ends.child)
    loop = set(one) ^ set(other) | {ends.parent, ends.child}
    return any(not is_rigid(model, body) for body in loop)
