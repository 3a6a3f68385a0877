"""Whether the greatest torques and forces of drives are resolved by the steps."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from granular_contact.results.accuracy import AccuracyWarning, remedy, share
from granular_contact.results.strides import Driving
from granular_contact.scene.types import Scene

ALONE = 0.1  # of the greatest force: by so much it is above that of the steps before and after it


def drive_warnings(scene: Scene, driven: Mapping[str, Driving]) -> Iterator[AccuracyWarning]:
    """Sentences on drives whose greatest force is that of one step alone, so that shorter ones may find a greater one.

    A given force is looked at as a signal (see `accuracy`), and at its limit a controller's greatest force is known.
    """
    for drive in scene.drives:
        force = driven[drive.joint].force
        top = int(np.abs(force).argmax())
        if drive.kind == "load" or drive.sets or not 0 < top < len(force) - 1:
            continue
        greatest = float(force[top])
        if driven[drive.joint].largest > abs(greatest):  # at a jump of what is prescribed, where it is known
            continue
        beside = float((force[[top - 1, top + 1]] / greatest).max()) if greatest else 1.0
        if 1.0 - beside > ALONE and abs(greatest) < (1.0 - 1e-9) * drive.limit:
            unit = "N" if scene.joint(drive.joint).kind == "slider" else "N m"
            said = f"the greatest force of the drive of {drive.joint}, {abs(greatest):.3g} {unit}, is that of one step"
            said += f" alone, {share(1.0 - beside)} above those beside it: it is not resolved"
            yield AccuracyWarning(f"{said}; {remedy(scene)}")
