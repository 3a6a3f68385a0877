"""Whether the greatest torques and forces of drives are resolved by the steps."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from granular_contact.results.accuracy import AccuracyWarning, remedy, share
from granular_contact.results.strides import Driving
from granular_contact.scene.types import Scene, Vector

ALONE = 0.1  # of the greatest force: by so much it is above that of the steps before and after it
STEEP = 0.5  # of the greatest force: a controller that gains or loses so much within a step is faster than the steps


def drive_warnings(scene: Scene, driven: Mapping[str, Driving]) -> Iterator[AccuracyWarning]:
    """Sentences on drives whose greatest force the steps do not resolve, so that shorter ones may find another one.

    Either it is that of one step alone, or a controller comes to it or leaves it within one step. A given force is
    looked at as a signal (see `accuracy`), and at its limit a controller's greatest force is known.
    """
    for drive in scene.drives:
        force = driven[drive.joint].force
        top = int(np.abs(force).argmax())
        if drive.kind == "load" or drive.sets or not 0 < top < len(force) - 1:
            continue
        greatest = float(force[top])
        if driven[drive.joint].largest > abs(greatest):  # at a jump of what is prescribed, where it is known
            continue
        if not 0.0 < abs(greatest) < (1.0 - 1e-9) * drive.limit:
            continue
        if why := _unresolved(drive.kind, force[[top - 1, top + 1]] / greatest):
            unit = "N" if scene.joint(drive.joint).kind == "slider" else "N m"
            said = f"the greatest force of the drive of {drive.joint}, {abs(greatest):.3g} {unit}, is not resolved"
            yield AccuracyWarning(f"{said}: {why}; {remedy(scene)}")


def _unresolved(kind: str, beside: Vector) -> str:
    """Why a greatest force is not resolved, beside which (2,) of it act a step before and after; empty where it is.

    What prescribes a motion is known at every instant, however fast it changes; of a controller it follows from a
    motion, which the steps have to show.
    """
    alone, steep = 1.0 - float(beside.max()), 1.0 - float(beside.min())
    if alone > ALONE:
        return f"it is that of one step alone, {share(alone)} above those beside it"
    if kind == "control" and steep > STEEP:
        return (
            f"within one step it changes by {share(steep)} of itself, so that the controller is faster than the steps"
        )
    return ""
