"""How far strips that are too long put the motion off, estimated from the accepted steps of a run.

At every accepted step the power P and the resultant F of the medium are also computed with the strips joined in pairs,
from the same bristles. Forces converge with the square of the strip, so that a third of the difference is what they are
off by. An error of the power is one of the speed, in the sense of the mass: dv / v = dP dt / (2 T) with the kinetic
energy T. It fades with v / a, the time that the motion lasts; such errors are added without their sign. Where motions
are prescribed, their drives make up for it. Of what floats, an error of the resultant is one of the momentum, which the
power does not see across the motion. A resistance by components is left out there: it holds a component that is all but
at rest by whatever that takes, so that the difference of two resultants says nothing of the motion.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from granular_contact.multibody.observe import Observer
from granular_contact.results import FINISHED
from granular_contact.results.accuracy import Doubt
from granular_contact.scene.types import Load, Scene, Vector

ERROR = 5e-3  # of the distance, that is told
SLOW = 0.02  # m/s: below it bristles carry what the strips are off by, and nothing of it moves on
MOST = 128, 32  # strips of a rigid part and of an element, to which they are chosen


def strip_error(observer: Observer) -> float:
    """Estimated error of positions by the strips, as a part of the distance that the fastest point travels."""
    t = observer.trajectory
    if t.load is None or len(t.time) < 3:
        return 0.0
    steps, change = np.diff(t.time), t.load.coarser[1:] / 3.0
    momentum = t.v @ t.mass
    twice = np.sum(momentum * t.v, axis=1)[1:]  # 2 T (J)
    mean = np.diff(t.v, axis=0) / steps[:, None]
    moving = twice > 0.0
    kick = np.divide(steps * np.abs(change[:, 0]), twice, out=np.zeros_like(twice), where=moving) * observer.speeds[1:]
    rate = np.sqrt(np.divide(np.sum((mean @ t.mass) * mean, axis=1), twice, out=np.zeros_like(twice), where=moving))
    fade = np.exp(-steps * rate)
    fast = observer.speeds[1:] >= SLOW
    fade[~fast] = 0.0
    scene, error = observer.scene, 0.0
    if not any(drive.kind == "motion" for drive in scene.drives):
        error = _travelled(steps, (kick * fast)[:, None], fade)
    if scene.floating is not None and not any(medium.by_component for medium in scene.media):
        push = steps[:, None] * change[:, 1:] / scene.mass * fast[:, None]
        error = max(error, _travelled(steps, push, fade))
    return error / max(observer.way, scene.least_way)


def _travelled(steps: Vector, kicks: Vector, fade: Vector) -> float:
    """Greatest displacement (m) by changes of the velocity (n, k) m/s, each of which fades from step to step."""
    velocity, off, most = np.zeros(kicks.shape[1]), np.zeros(kicks.shape[1]), 0.0
    for step, kick, factor in zip(steps, kicks, fade, strict=True):
        velocity = velocity * factor + kick
        off = off + step * velocity
        most = max(most, float(np.linalg.norm(off)))
    return most


def finer(observer: Observer) -> Scene | None:
    """The scene with shorter strips, where its steps are chosen by their error and its strips are off by more."""
    scene = observer.scene
    accuracy, t = scene.solver.accuracy, observer.trajectory
    if accuracy is None or t.status.code not in FINISHED:
        return None
    error = strip_error(observer)
    load = shorter(scene.load, error / accuracy)
    if not error > accuracy or load == scene.load:
        return None
    left = None if scene.solver.max_wall is None else max(1e-3, scene.solver.max_wall - t.cost.solve_s)
    return replace(scene, load=load, solver=replace(scene.solver, max_wall=left))


def shorter(load: Load, factor: float) -> Load:
    """Strips with which an error of second order is smaller by twice a factor."""
    more = math.sqrt(2.0 * max(1.0, factor))
    parts, elements = load.strips_per_rigid_part, load.strips_per_element
    return replace(
        load,
        strips_per_rigid_part=max(parts, min(MOST[0], math.ceil(more * parts / 8) * 8)),
        strips_per_element=max(elements, min(MOST[1], math.ceil(more * elements / 2) * 2)),
    )


def strip_doubts(observer: Observer) -> Iterator[Doubt]:
    """A sentence where the strips are too long."""
    scene = observer.scene
    allowed = ERROR if scene.solver.accuracy is None else max(ERROR, scene.solver.accuracy)
    if not (error := strip_error(observer)) > allowed:
        return
    load, now = shorter(scene.load, error / allowed), scene.load
    keys = [f"load.strips_per_rigid_part: {load.strips_per_rigid_part} (now {now.strips_per_rigid_part})"]
    if observer.system.links:
        keys.append(f"load.strips_per_element: {load.strips_per_element} (now {now.strips_per_element})")
    yield Doubt(
        f"the strips on which the medium acts are too long: they put the motion off by about {error:.1%} of its "
        f"distance; take {' and '.join(keys)}",
        error,
    )
