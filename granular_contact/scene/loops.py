"""Kinematic loops at the start: whether they close, the state of dependent joints, redundant constraints."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from granular_contact.config import schema
from granular_contact.errors import Fault, scene_fault
from granular_contact.scene.homes import other_homes, solved
from granular_contact.scene.layout import FREEDOMS, JointState, Pose, direction, is_rigid, point, pose
from granular_contact.scene.parts import rotation, turned
from granular_contact.scene.start import Start, home
from granular_contact.scene.types import Drive, Vector

Mask = NDArray[np.bool_]
# A loop may gape by this much (m, rad) as the config writes it down, without a word; it is then closed to round-off.
LARGEST_GAP, LARGEST_TILT = 1e-4, math.radians(0.01)
RANK_TOLERANCE = 1e-9  # of the largest singular value
_CONTINUATION_STEPS = 8  # in which a loop is led from home to where the run wants it


class Loops:
    """The loops of a model, as equations of the states of its tree of joints; in the plane `PlanarLoops`.

    freedoms: how many displacements and turns each type of joint leaves free, which are its coordinates in this order.
    States are those of the layout, in the plane or in space.
    """

    def __init__(self, model: Any, freedoms: Mapping[str, tuple[int, int]]) -> None:
        self.model, self.freedoms = model, freedoms
        sizes = {kind: sum(both) for kind, both in freedoms.items()}
        self.joints = {name: joint for name, joint in model.all_joints.items() if sizes[joint.type] > 0}
        ends = np.cumsum([0, *(sizes[joint.type] for joint in self.joints.values())])
        self.places = {name: slice(a, b) for name, a, b in zip(self.joints, ends, ends[1:], strict=False)}
        self.size = int(ends[-1])

    def pose(self, states: Mapping[str, Any]) -> Any:
        """Pose of the mechanism."""
        raise NotImplementedError

    def gaps(self, name: str, placed: Any) -> Vector:
        """Residual of a closure (m, rad)."""
        raise NotImplementedError

    def gap_rates(self, name: str, placed: Any) -> Vector:
        """Rates of a closed loop's residual."""
        raise NotImplementedError

    def apart(self, name: str, gap: Vector) -> tuple[float, float]:
        """Distance (m) and angle (rad) in the residual of a closure."""
        raise NotImplementedError

    def mask(self, names: frozenset[str]) -> Mask:
        """Which degrees of freedom (size,) belong to these joints."""
        found = np.zeros(self.size, bool)
        for name in names:
            found[self.places[name]] = True
        return found

    def rates(self, states: Mapping[str, Any]) -> Vector:
        """Rates (size,) of the joints."""
        return np.concatenate([np.zeros(0), *(states[name].rates for name in self.joints)])

    def moving(self, states: Mapping[str, Any], rates: Vector) -> dict[str, Any]:
        """The same states with other rates (size,)."""
        return {name: replace(states[name], rates=rates[at]) for name, at in self.places.items()}

    def jacobian(self, states: Mapping[str, Any]) -> dict[str, Vector]:
        """Constraint Jacobian (rows, size) of every closure, in a closed pose."""
        still = self.pose(states)
        slopes = {name: np.zeros((len(self.gaps(name, still)), self.size)) for name in self.model.closures}
        for i, unit in enumerate(np.eye(self.size)):
            placed = self.pose(self.moving(states, unit))
            for name, slope in slopes.items():
                slope[:, i] = self.gap_rates(name, placed)
        return slopes

    def close(self, states: dict[str, Any], movable: Mask) -> dict[str, Any]:
        """States near these that close all loops, or as far as Newton's method gets; only the movable change."""
        for _ in range(20 if movable.any() else 0):
            placed = self.pose(states)
            gap = np.concatenate([self.gaps(name, placed) for name in self.model.closures])
            if np.abs(gap).max() < 1e-14:
                break
            slope = np.concatenate(list(self.jacobian(states).values()))[:, movable]
            change = np.zeros(self.size)
            change[movable] = -np.linalg.lstsq(slope, gap, rcond=1e-10)[0]
            states = {name: states[name].displaced(change[at]) for name, at in self.places.items()}
        return states


class PlanarLoops(Loops):
    """The loops of a model in the plane; what is welded to the ground is turned by ground_angle (rad)."""

    def __init__(self, model: schema.Model, ground_angle: float) -> None:
        super().__init__(model, FREEDOMS)
        self.ground_angle = ground_angle

    def pose(self, states: Mapping[str, JointState]) -> Pose:
        """Pose of the mechanism."""
        return pose(self.model, states, self.ground_angle)

    def gaps(self, name: str, placed: Pose) -> Vector:
        """Residual of the closure of one loop: (2,) m of a hinge, (m, rad) of a slider, (m, m, rad) of a weld."""
        joint = self.model.closures[name]
        parent, child = placed[joint.parent], placed[joint.child]
        gap = child.world(point(joint.child_point_m)) - parent.world(point(joint.parent_point_m))
        turn = child.angle - parent.angle - turned(getattr(joint, "home_deg", 0.0))
        return _held(joint, parent.angle, gap, turn - 2.0 * math.pi * round(turn / (2.0 * math.pi)))

    def gap_rates(self, name: str, placed: Pose) -> Vector:
        """Velocity residual of a closed loop."""
        joint = self.model.closures[name]
        parent, child = placed[joint.parent], placed[joint.child]
        pin = child.world(point(joint.child_point_m))
        return _held(joint, parent.angle, child.speed_at(pin) - parent.speed_at(pin), child.rate - parent.rate)

    def apart(self, name: str, gap: Vector) -> tuple[float, float]:
        """Distance (m) and angle (rad) in the residual of a closure."""
        if FREEDOMS[self.model.closures[name].type][1]:
            return float(np.linalg.norm(gap)), 0.0
        return float(np.linalg.norm(gap[:-1])), abs(float(gap[-1]))


def _held(joint: schema.Closure, angle: float, gap: Vector, turn: float) -> Vector:
    """What a closure holds of a gap (2,) and a turn; angle (rad): of its parent."""
    displacements, turns = FREEDOMS[joint.type]
    if displacements:
        along = rotation(angle) @ direction(joint)
        gap = np.array([np.array([-along[1], along[0]]) @ gap])
    return gap if turns else np.array([*gap, turn])


def closed(loops: Loops, begun: Start, faults: list[Fault], notes: list[Fault]) -> dict[str, Any]:
    """Joint states that close all loops in position and velocity; joints not given follow. Faults are appended.

    Where loops gape in the reference configuration as it is written, the nearest in which they close is taken, and told
    in a note.
    """
    if not loops.model.closures:
        return begun.states
    moving = {name: joint for name, joint in loops.joints.items() if joint.type in ("hinge", "slider")}
    written = begun.states | {name: begun.states[name].at(home(joint)) for name, joint in moving.items()}
    gapes = bool(_open(loops, written, ""))
    states = solved(loops, written) if gapes else written
    faults += _open(loops, states, ", whatever its joints; at best")
    if faults:
        return begun.states
    states = loops.close(states, np.ones(loops.size, dtype=bool))
    notes += other_homes(loops, written, states) if gapes else []
    if begun.placed:
        free = ~loops.mask(begun.placed)
        first = {name: states[name].coordinate for name in begun.placed & moving.keys()}
        states |= {name: begun.states[name] for name in begun.placed - moving.keys()}
        for share in np.linspace(0.0, 1.0, _CONTINUATION_STEPS + 1)[1:] if first else (1.0,):
            for name, at in first.items():
                states[name] = states[name].at(at + float(share) * (begun.states[name].coordinate - at))
            states = loops.close(states, free)
        faults += _open(loops, states, " at the start:")
    given = loops.mask(begun.moved), loops.rates(begun.states)
    return loops.moving(states, dependent_rates(loops.jacobian(states), *given, faults))


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


def _open(loops: Loops, states: Mapping[str, Any], when: str) -> list[Fault]:
    """A fault for every loop that does not close."""
    faults, placed = [], loops.pose(states)
    for name, joint in loops.model.closures.items():
        distance, turn = loops.apart(name, loops.gaps(name, placed))
        if distance > LARGEST_GAP or turn > LARGEST_TILT:
            words = f"the loop does not close{when} {joint.parent} and {joint.child} are {distance:.4g} m"
            words += f" and {math.degrees(turn):.4g} deg" if turn > LARGEST_TILT else ""
            words += f" apart there; allowed are {LARGEST_GAP:g} m"
            words += f" and {math.degrees(LARGEST_TILT):g} deg" if turn else ""
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
    loops = PlanarLoops(model, ground_angle)
    rows = {("closures", name): slope for name, slope in loops.jacobian(states).items() if not _gives_way(model, name)}
    for drive in drives:
        if drive.kind == "motion" and drive.joint in loops.places:
            rows["drives", drive.joint] = np.eye(loops.size)[loops.places[drive.joint]]
    held, rank, faults = np.zeros((0, loops.size)), 0, []
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
