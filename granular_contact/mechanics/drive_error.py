"""Whether the greatest torques, forces and powers of drives are resolved by the steps."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from granular_contact.results.accuracy import AccuracyWarning, remedy, share
from granular_contact.results.summary import Driving
from granular_contact.scene.types import Scene

# Of the greatest force, what it falls by in the steps before and after it together; of chosen steps times the accuracy.
SHARP, ASKED = 0.1, 20.0
LITTLE = 1e-3  # of the forces, torques and powers of a run: what is smaller is no result of it, round-off mostly
RISING = 0.02  # of the greatest power, what it grows by in the last step


def drive_warnings(
    scene: Scene, driven: Mapping[str, Driving], energy: float = 0.0, lasted: float = 1.0
) -> Iterator[AccuracyWarning]:
    """Sentences on drives whose greatest force the steps do not resolve, so that shorter ones may find another one.

    A smooth force is greater than that of any step by an eighth of what is allowed at most; one that comes and goes
    faster, as a controller's that is faster than the steps, or where sand lets go, is known worse. A given force is
    looked at as a signal (see `accuracy`), and at its limit a controller's greatest force is known.

    energy (J), lasted (s): the greatest energy that moved or was given to the medium, and the time of the run.
    """
    allowed = max(SHARP, ASKED * (scene.solver.accuracy or 0.0))
    powers = [float(np.abs(one.power).max()) for one in driven.values()]
    yield from _powers(scene, driven, LITTLE * max([energy / lasted if lasted > 0.0 else 0.0, *powers]))
    least = {kind: LITTLE * size for kind, size in _sizes(scene, driven).items()}
    for drive in scene.drives:
        force = driven[drive.joint].force
        top = int(np.abs(force).argmax())
        if drive.kind == "load" or drive.sets or not 0 < top < len(force) - 1:
            continue
        greatest = float(force[top])
        if driven[drive.joint].largest > abs(greatest):  # at a jump of what is prescribed, where it is known
            continue
        if not least[scene.joint(drive.joint).kind] < abs(greatest) < (1.0 - 1e-9) * drive.limit:
            continue
        falls = 2.0 - float((force[[top - 1, top + 1]] / greatest).sum())
        if falls > allowed:
            what, unit = ("force", "N") if scene.joint(drive.joint).kind == "slider" else ("torque", "N m")
            said = f"the greatest {what} of the drive of {drive.joint}, {abs(greatest):.3g} {unit}, is not resolved:"
            said += f" one step before and one step after it the {what} is lower, by {share(falls)} in sum"
            yield AccuracyWarning(f"{said}; {remedy(scene)}")


def _sizes(scene: Scene, driven: Mapping[str, Driving]) -> dict[str, float]:
    """Size of the forces (N) of sliders and of the torques (N m) of hinges: of drives, and of weights and impacts."""
    found = {"slider": scene.force_scale, "hinge": scene.force_scale * scene.length}
    for joint, one in driven.items():
        kind = scene.joint(joint).kind
        found[kind] = max(found[kind], one.largest)
    return found


def _powers(scene: Scene, driven: Mapping[str, Driving], least: float) -> Iterator[AccuracyWarning]:
    """Sentences on drives whose greatest power is that at the end of a run by fixed steps, and still rises.

    What comes within a step, as sand that lets go, is known to a step, and so is how far such a rise gets. Before a
    greatest power within the run it only shifts its instant. Not of powers (W) up to the least: the drive brakes, or
    holds still.
    """
    if scene.solver.accuracy is not None:
        return
    for drive in scene.drives:
        power = driven[drive.joint].power
        rises = float(power[-1] - power[-2]) if len(power) > 1 else 0.0
        if power[-1] == power.max() > least and rises > RISING * power[-1]:
            said = (
                f"the greatest power of the drive of {drive.joint}, {power[-1]:.3g} W, is that at the end of the run,"
            )
            said += f" where it rises by {share(rises / float(power[-1]))} in a step, and is known no better"
            yield AccuracyWarning(f"{said}; {remedy(scene)}")
