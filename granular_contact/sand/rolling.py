"""Start of a single-wheel test: as deep as a steady motion needs, with the medium as that motion leaves it.

At a given slip the sinkage h of a wheel that rolls steadily under the load W is the root of

    F(h; v, omega) = W,

F the upward force of the medium, its mean over a pitch of grousers or over a strip, after the wheel rolled at that
depth until all that is in contact got into the medium while it rolled. No equation of motion is integrated: poses are
prescribed and accepted one after the other, which stretches bristles and counts shear displacements as a run does.
The root is bracketed from the surface down and found by the method of Illinois. A wheel that a torque drives has no
sinkage of its own before it turns: it is pressed straight in, to its static balance.

Of the steps STEPS take the wheel through the contact and the last of them is divided in FINE, each shorter than a
bristle yields in, so that bristles point along the motion of the end. A locked wheel is dragged by FAR radii.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from granular_contact.errors import scene_fault
from granular_contact.sand.contact_lines import Body
from granular_contact.sand.load import GranularLoad
from granular_contact.sand.of_scene import lines_of, load_of
from granular_contact.scene.parts import Wheel
from granular_contact.scene.types import Scene
from granular_contact.scene.wheel_test import WheelTest
from granular_contact.scene.workspace import immersible

Vector = NDArray[np.float64]

STEPS, FINE, FAR = 180, 60, 4.0
LEAST = 6  # instants in a pitch
PRESSING = 1e-3  # m/s, of a wheel that is pressed in
SHALLOWEST, DEEPEST, DEPTHS = 0.02, 2.0, 8  # of the radius, and in how many ratios a sinkage is looked for
CLOSE, MOST = 1e-5, 50  # of the radius, to which it is found, and in how many trials at most


def sunk(scene: Scene) -> Scene:
    """The scene with its wheel as deep as a steady motion needs, or with a note that no depth bears the load."""
    test = scene.wheel_test
    if test is None or not test.begins:
        return scene
    mean = scene.without_scatter()
    rim = _wheel(scene, test).rim

    def lacks(depth: float) -> float:
        return test.load - _rolled(mean, test, depth)[1]

    depths = (rim * np.geomspace(SHALLOWEST, DEEPEST, DEPTHS)).tolist()
    low, lacking = depths[0], lacks(depths[0])
    for high in depths[1:]:
        if (left := lacks(high)) <= 0.0:
            depth = low if lacking <= 0.0 else _root(lacks, (low, high), (lacking, left), CLOSE * rim)
            return _lowered(scene, test, depth - _depth(scene, test))
        low, lacking = high, left
    words = f"{test.load:.4g} N are borne at no depth down to {DEEPEST:g} radii, so the run does not start steadily"
    notes = (*scene.notes, scene_fault("wheel", words))
    return replace(scene, wheel_test=replace(test, begins=False), notes=notes)


def roll_in(scene: Scene, load: GranularLoad) -> None:
    """Bring the medium of a solve to where the motion before the start leaves it; the load has been started."""
    test = scene.wheel_test
    if test is None or not test.begins:
        return
    before, _ = _rolled(scene, test, _depth(scene, test))
    for batch, other in zip(load.batches, before.batches, strict=True):
        batch.anchors[:] = other.anchors
        batch.forget()


def _wheel(scene: Scene, test: WheelTest) -> Wheel:
    return next(body.wheel for body in scene.rigid if body.name == test.body and body.wheel is not None)


def _depth(scene: Scene, test: WheelTest) -> float:
    """Depth (m) of the rim at the start of a scene, negative above the surface."""
    wheel, body = _wheel(scene, test), scene.body(test.body)
    assert scene.surface is not None
    return scene.surface - float(body.motion.world(wheel.axle)[1]) + wheel.rim


def _lowered(scene: Scene, test: WheelTest, by: float) -> Scene:
    """The scene with all that hangs on the upright joint lower by some m."""
    carried = scene.carried(scene.joint(test.upright))
    down = np.array([0.0, by])
    rigid = list(scene.rigid)
    for i, body in enumerate(rigid):
        if body.name in carried:
            rigid[i] = replace(body, motion=replace(body.motion, position=body.motion.position - down))
    joints = tuple(
        replace(joint, start=joint.start - test.upward * by) if joint.name == test.upright else joint
        for joint in scene.joints
    )
    return replace(scene, rigid=tuple(rigid), joints=joints)


def _root(of: Callable[[float], float], ends: tuple[float, float], values: tuple[float, float], close: float) -> float:
    """A zero of a continuous function between two ends with values of different sign, by the method of Illinois.

    It is a regula falsi that halves the value at an end that stays: of an order of 1.44 and never out of the bracket.
    """
    (a, b), (fa, fb) = ends, values
    for _ in range(MOST):
        x = b - fb * (b - a) / (fb - fa)
        if abs(x - b) < close or fb == 0.0:
            break
        fx = of(x)
        a, fa = (b, fb) if fx * fb < 0.0 else (a, 0.5 * fa)
        b, fb = x, fx
    return b


def _rolled(scene: Scene, test: WheelTest, depth: float) -> tuple[GranularLoad, float]:
    """The load after the motion at a depth (m), and the upward force (N) on the wheel, over its last pitch the mean."""
    load = load_of(scene)
    places = {body.name: 3 * i + np.arange(3) for i, body in enumerate(scene.rigid)}
    assert scene.bed is not None
    for body, shape in immersible(scene.bed, scene.rigid):
        load.add(lines_of(Body(body.name, places[body.name]), shape, scene.load.strips_per_rigid_part))
    wheel, at, found = _wheel(scene, test), places[test.body][1], []
    strips = max(len(line.stations) - 1 for line in load.lines if line.body.name == test.body)
    times, counts = _instants(test, wheel, wheel.pitch or 2.0 * math.pi / strips, depth)
    places_of_all, rates_of_all = _motion(scene, test, depth, times)
    load.start(places_of_all[0])
    for t, counted, q, v in zip(times, counts, places_of_all, rates_of_all, strict=True):
        load.accept(float(t), q, v)
        if counted:
            found.append(load.force(q, v, np.zeros_like(q))[at])
    return load, float(np.mean(found))


def _motion(scene: Scene, test: WheelTest, depth: float, times: Vector) -> tuple[Vector, Vector]:
    """Poses and velocities (n, 3 bodies) of all bodies at times (n,) s, with the wheel at a depth (m) at the time 0."""
    axle = next(joint.child_point for joint in scene.joints if joint.child == test.body)
    along = np.array([0.0, -PRESSING] if test.rate is None else [test.speed, 0.0])
    down = np.array([0.0, depth - _depth(scene, test)])
    q, v = np.zeros((2, len(times), len(scene.rigid), 3))
    for i, body in enumerate(scene.rigid):
        rate, (x, y) = (test.rate or 0.0, axle) if body.name == test.body else (0.0, np.zeros(2))
        angle = body.motion.angle + rate * times
        c, s = np.cos(angle), np.sin(angle)
        arm = np.column_stack([s * y - c * x, -s * x - c * y])  # from the axle to the origin of the body
        q[:, i, :2] = body.motion.world(np.array([x, y])) - down + along * times[:, None] + arm
        v[:, i, :2] = along + rate * np.column_stack([-arm[:, 1], arm[:, 0]])
        q[:, i, 2], v[:, i, 2] = angle, rate
    return q.reshape(len(times), -1), v.reshape(len(times), -1)


def _instants(test: WheelTest, wheel: Wheel, pitch: float, depth: float) -> tuple[Vector, NDArray[np.bool_]]:
    """Instants (n,) s up to 0, and at which of them the force counts; pitch (rad): over which it is to be a mean."""
    lasts, sampled = depth / PRESSING, 0
    if test.rate is not None:
        lasts = min(math.pi / max(abs(test.rate), 1e-300), FAR * wheel.rim / test.speed)
        if abs(test.rate) * lasts > pitch:
            sampled = max(LEAST, round(STEPS * pitch / (abs(test.rate) * lasts)))
            lasts = STEPS * pitch / (abs(test.rate) * sampled)
    counts = np.zeros(STEPS + FINE, bool)
    counts[STEPS - sampled : STEPS] = True
    counts[-1] = sampled == 0
    return np.concatenate([np.arange(-STEPS, -1), np.arange(-FINE, 1) / FINE]) * (lasts / STEPS), counts
