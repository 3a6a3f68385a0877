"""Strips that are too long: the error of a run by them (`bed.strip_error`), a warning, a scene with shorter ones.

Where motions are prescribed, their drives make up for an error of the power. Of what floats, the error of the resultant
counts too. A resistance by components is left out there: it holds a component that is all but at rest by whatever that
takes, so that the difference of two resultants says nothing of the motion.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

from granular_contact.bed.strip_error import Pace, by_moment, by_power, by_resultant
from granular_contact.multibody.kinematics import Kinematics
from granular_contact.results import FINISHED
from granular_contact.results.accuracy import AccuracyWarning
from granular_contact.scene.types import Load, Scene

ERROR = 5e-3  # of the distance, that is reported
ROLLING = 6.0  # times the estimate by the moment: other faces meet the sand as a body rolls over (3.6 in random scenes)
MOST = 128, 32  # strips of a rigid part and of an element, to which they are chosen


def strip_error(observer: Kinematics, moments: bool = False) -> float:
    """Estimated error of positions by the strips, as a part of the distance that the fastest point travels.

    moments: whether the moment on a single floating body counts. It finds errors of bodies that roll over, but bristles
    and creep often make up for what a moment is off by: enough to shorten strips for, not to warn of.
    """
    t = observer.trajectory
    if t.load is None or len(t.time) < 3 or observer.scene.in_space:  # where facets are of the size asked for
        return 0.0
    scene, error = observer.scene, 0.0
    pace = Pace.of(t.load.time, t.v, t.mass, observer.speeds)
    if not any(drive.kind == "motion" for drive in scene.drives):
        error = by_power(t.load, pace)
    if scene.floating is not None and not any(medium.by_component for medium in scene.media):
        error = max(error, by_resultant(t.load, pace, scene.mass))
        if moments and len(scene.rigid) == 1 and not scene.links:
            (body,) = scene.rigid
            center, _ = observer.center(body.name)
            error = max(error, ROLLING * by_moment(t.load, pace, center, body.inertia, scene.radius(body)))
    return error / max(observer.path_length, scene.least_path)


def finer(observer: Kinematics) -> Scene | None:
    """The scene with shorter strips, where its steps are chosen by their error and its strips are off by more."""
    scene = observer.scene
    accuracy, t = scene.solver.accuracy, observer.trajectory
    if accuracy is None or t.status.code not in FINISHED:
        return None
    # Each strip longer than a grain has a draw of its own: other strips would be another sand of the same kind, and a
    # seed no motion that finer steps converge to.
    if any(medium.scatters for medium in scene.media):
        return None
    error = strip_error(observer, moments=True)
    load = shorter(scene.load, error / accuracy)
    if not error > accuracy or load == scene.load:
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
    allowed = ERROR if scene.solver.accuracy is None else max(ERROR, scene.solver.accuracy)
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
