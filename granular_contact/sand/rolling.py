"""Start of a single-wheel test: the wheel at the sinkage of steady rolling, with the friction state of that motion.

At a given slip, the sinkage h of a wheel that rolls steadily under the load W is the root of

    F(h; v, omega) = W

F is the upward force of the medium, its mean over one pitch of the grousers or over one strip. It is evaluated after
the wheel has rolled at that depth until everything that is in contact has entered the medium while rolling. No equation
of motion is integrated: poses are prescribed and accepted one after the other. Bristles and shear displacements follow
as in a run. The root is bracketed from the surface downward, and found by the Illinois method. A wheel that is driven
by a torque has no sinkage of its own before it turns: it is pressed straight in, to static equilibrium.

STEPS steps take the wheel through the contact, and the last of them is divided into FINE parts. Each part is shorter
than the yield displacement of a bristle, so that the bristles point along the final motion. A locked wheel is dragged
by FAR radii.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from granular_contact.errors import scene_fault
from granular_contact.sand.contact_lines import Body
from granular_contact.sand.from_scene import lines_from_shape, load_from_scene
from granular_contact.sand.load import GranularLoad
from granular_contact.scene.parts import Wheel
from granular_contact.scene.types import Scene
from granular_contact.scene.wheel_test import WheelTest
from granular_contact.scene.workspace import immersible

Vector = NDArray[np.float64]

STEPS, FINE, FAR = 180, 60, 4.0
LEAST = 6  # least number of instants in a pitch
PRESSING = 1e-3  # speed (m/s) of a wheel that is pressed in
SHALLOWEST, DEEPEST, DEPTHS = 0.02, 2.0, 8  # range of depths of the bracket, in radii, and their number
CLOSE, MOST = 1e-5, 50  # tolerance of the sinkage, in radii, and greatest number of iterations


def at_steady_sinkage(scene: Scene) -> Scene:
    """Scene with its wheel at the sinkage of steady motion.

    Parameters
    ----------
    scene : Scene
        A scene; only a single-wheel test is changed.

    Returns
    -------
    Scene
        With a note if no depth bears the load. Then the test does not start in steady motion.
    """
    test = scene.wheel_test
    if test is None or not test.begins:
        return scene
    mean = scene.without_scatter()
    rim = _wheel(scene, test).rim

    def deficit(depth: float) -> float:
        return test.load - _load_after_rolling(mean, test, depth)[1]

    depths = (rim * np.geomspace(SHALLOWEST, DEEPEST, DEPTHS)).tolist()
    low, low_deficit = depths[0], deficit(depths[0])
    for high in depths[1:]:
        if (high_deficit := deficit(high)) <= 0.0:
            depth = low if low_deficit <= 0.0 else _root(deficit, (low, high), (low_deficit, high_deficit), CLOSE * rim)
            return _lowered(scene, test, depth - _depth(scene, test))
        low, low_deficit = high, high_deficit
    reason = f"{test.load:.4g} N are borne at no depth down to {DEEPEST:g} radii, so the run does not start steadily"
    notes = (*scene.notes, scene_fault("wheel", reason))
    return replace(scene, wheel_test=replace(test, begins=False), notes=notes)


def take_rolled_state(scene: Scene, load: GranularLoad) -> None:
    """Give a load the friction state that the motion before the start leaves.

    Parameters
    ----------
    scene : Scene
        The scene.
    load : GranularLoad
        Its load, which has been started. It is changed.
    """
    test = scene.wheel_test
    if test is None or not test.begins:
        return
    before, _ = _load_after_rolling(scene, test, _depth(scene, test))
    for batch, other in zip(load.batches, before.batches, strict=True):
        batch.anchors[:] = other.anchors
        batch.forget()


def _wheel(scene: Scene, test: WheelTest) -> Wheel:
    """The wheel of a single-wheel test."""
    return next(body.wheel for body in scene.rigid if body.name == test.body and body.wheel is not None)


def _depth(scene: Scene, test: WheelTest) -> float:
    """Depth (m) of the lowest point of the rim at the start of a scene, negative above the surface."""
    wheel, body = _wheel(scene, test), scene.body(test.body)
    assert scene.surface is not None
    return scene.surface - float(body.motion.world(wheel.axle)[1]) + wheel.rim


def _lowered(scene: Scene, test: WheelTest, distance: float) -> Scene:
    """Scene with everything that the upright joint carries lowered by a distance (m)."""
    carried = scene.carried(scene.joint(test.upright))
    down = np.array([0.0, distance])
    rigid = list(scene.rigid)
    for i, body in enumerate(rigid):
        if body.name in carried:
            rigid[i] = replace(body, motion=replace(body.motion, position=body.motion.position - down))
    joints = tuple(
        replace(joint, start=joint.start - test.upward * distance) if joint.name == test.upright else joint
        for joint in scene.joints
    )
    return replace(scene, rigid=tuple(rigid), joints=joints)


def _root(f: Callable[[float], float], ends: tuple[float, float], values: tuple[float, float], close: float) -> float:
    """Root of a continuous function between two ends with values of different sign, by the Illinois method.

    This is the regula falsi that halves the value at an end that stays. Its order is 1.44, and it never leaves the
    bracket.
    """
    (a, b), (fa, fb) = ends, values
    for _ in range(MOST):
        x = b - fb * (b - a) / (fb - fa)
        if abs(x - b) < close or fb == 0.0:
            break
        fx = f(x)
        a, fa = (b, fb) if fx * fb < 0.0 else (a, 0.5 * fa)
        b, fb = x, fx
    return b


def _load_after_rolling(scene: Scene, test: WheelTest, depth: float) -> tuple[GranularLoad, float]:
    """Load after the motion at a depth (m), and the upward force (N) on the wheel, as a mean over the last pitch."""
    load = load_from_scene(scene)
    places = {body.name: 3 * i + np.arange(3) for i, body in enumerate(scene.rigid)}
    assert scene.bed is not None
    for body, shape in immersible(scene.bed, scene.rigid):
        load.add(lines_from_shape(Body(body.name, places[body.name]), shape, scene.load.strips_per_rigid_part))
    wheel, row, forces = _wheel(scene, test), places[test.body][1], []
    strips = max(len(line.stations) - 1 for line in load.lines if line.body.name == test.body)
    times, counts = _instants(test, wheel, wheel.pitch or 2.0 * math.pi / strips, depth)
    poses, velocities = _motion(scene, test, depth, times)
    load.start(poses[0])
    for t, counts_here, q, v in zip(times, counts, poses, velocities, strict=True):
        load.accept(float(t), q, v)
        if counts_here:
            forces.append(load.force(q, v, np.zeros_like(q))[row])
    return load, float(np.mean(forces))


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
    """Instants (n,) s up to 0, and which of them count for the mean force; pitch (rad): angle of that mean."""
    duration, samples = depth / PRESSING, 0
    if test.rate is not None:
        duration = min(math.pi / max(abs(test.rate), 1e-300), FAR * wheel.rim / test.speed)
        if abs(test.rate) * duration > pitch:
            samples = max(LEAST, round(STEPS * pitch / (abs(test.rate) * duration)))
            duration = STEPS * pitch / (abs(test.rate) * samples)
    counts = np.zeros(STEPS + FINE, bool)
    counts[STEPS - samples : STEPS] = True
    counts[-1] = samples == 0
    return np.concatenate([np.arange(-STEPS, -1), np.arange(-FINE, 1) / FINE]) * (duration / STEPS), counts
