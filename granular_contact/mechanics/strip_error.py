"""Strips that are too long: the error of a run by them (`strip_departure`), a warning, a scene with shorter ones.

Steps of a run with `solver.accuracy` are chosen so that positions are as exact. So are its strips: where they are off
by more, the scene is solved once more with shorter ones, to the end, unless they are short enough already.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

from granular_contact.mechanics.kinematics import Kinematics
from granular_contact.results import FINISHED
from granular_contact.results.accuracy import AccuracyWarning
from granular_contact.scene.types import Load, Scene

ERROR = 5e-3  # of the distance, that is reported
DOUBTFUL = 0.1  # of what is allowed: where a first estimate is above it, it is made more exact
SAFE = 3.0  # errors near what is asked for are up to four times the estimate
MOST = 128, 32  # strips of a rigid part and of an element, to which they are chosen
STALLED = 0.8  # part of the error before that is left where it is not of the strips; by theirs of first order 2/3 is


def strip_error(observer: Kinematics, allowed: float | None = None) -> float:
    """Estimated error of positions by the strips, as a part of the distance that the fastest point travels.

    allowed: by default what the steps are asked for, or `ERROR`. Where it is far below that it is less exact.
    """
    t, scene = observer.trajectory, observer.scene
    if t.strip_error is not None:
        return t.strip_error
    if t.load is None or len(t.time) < 3 or scene.in_space or not (t.load.depth > 0.0).any():
        return 0.0  # in space facets are of the size asked for
    from granular_contact.mechanics.strip_departure import estimate  # here, as the compiler comes with it

    return estimate(observer, DOUBTFUL * (allowed or scene.solver.accuracy or ERROR))


def finer(observer: Kinematics, before: float = math.inf) -> Scene | None:
    """The scene with shorter strips, where its steps are chosen by their error and its strips are off by more.

    before: the error with the strips before; where nearly as much is left, it is not of the strips.
    """
    scene = observer.scene
    accuracy, t = scene.solver.accuracy, observer.trajectory
    if accuracy is None or t.status.code not in FINISHED:
        return None
    # Each strip longer than a grain has a draw of its own: other strips would be another sand of the same kind, and a
    # seed no motion that finer steps converge to.
    if any(medium.scatters for medium in scene.media):
        return None
    error = SAFE * strip_error(observer)
    load = shorter(scene.load, error / accuracy)
    if not error > accuracy or load == scene.load or error > STALLED * SAFE * before:
        return None
    left = None if scene.solver.max_wall_s is None else max(1e-3, scene.solver.max_wall_s - t.cost.solve_s)
    return replace(scene, load=load, solver=scene.solver.model_copy(update={"max_wall_s": left}))


def shorter(load: Load, factor: float) -> Load:
    """Strips with which an error of second order is smaller by twice a factor."""
    more = math.sqrt(2.0 * max(1.0, factor))
    parts, elements = load.strips_per_rigid_part, load.strips_per_element
    finer = {
        "strips_per_rigid_part": max(parts, min(MOST[0], math.ceil(more * parts / 8) * 8)),
        "strips_per_element": max(elements, min(MOST[1], math.ceil(more * elements / 2) * 2)),
    }
    return load.model_copy(update=finer)


def strip_warnings(observer: Kinematics) -> Iterator[AccuracyWarning]:
    """A sentence where the strips are too long."""
    scene = observer.scene
    allowed = max(ERROR, scene.solver.accuracy or 0.0)
    if not (error := strip_error(observer)) > allowed:
        return
    load, now = shorter(scene.load, error / allowed), scene.load
    keys = [f"load.strips_per_rigid_part: {load.strips_per_rigid_part} (now {now.strips_per_rigid_part})"]
    if observer.system.links:
        keys.append(f"load.strips_per_element: {load.strips_per_element} (now {now.strips_per_element})")
    yield AccuracyWarning(
        f"the strips on which the medium acts are too long: the error of the motion is about {error:.1%} of its "
        f"path; take {' and '.join(keys)}",
        error,
    )
