"""Accuracy warnings for drives: whether the steps resolve their greatest torques, forces and powers."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from granular_contact.results.accuracy import AccuracyWarning, remedy, share
from granular_contact.results.summary import Driving
from granular_contact.scene.types import Scene

# Allowed decrease of the force in the steps before and after its maximum together, over the maximum: SHARP, or ASKED
# times the accuracy of step-size control.
SHARP, ASKED = 0.1, 20.0
LITTLE = 1e-3  # of the forces, torques and powers of a run: smaller ones are no result, mostly round-off
RISING = 0.02  # of the greatest power: allowed increase in the last step


def drive_warnings(
    scene: Scene, driven: Mapping[str, Driving], energy: float = 0.0, duration: float = 1.0
) -> Iterator[AccuracyWarning]:
    """Yield sentences on drives whose greatest force the steps do not resolve: shorter steps may give another one.

    The maximum of a smooth force is above that of the steps by at most an eighth of the allowed decrease. A force that
    comes and goes faster is known less exactly, as with a controller faster than the steps, or where sand breaks away.
    Loads are checked as signals (see `accuracy`), and the greatest force of a controller at its limit is known.

    energy (J): greatest kinetic energy, or work on the medium; duration (s): of the run.
    """
    allowed = max(SHARP, ASKED * (scene.solver.accuracy or 0.0))
    powers = [float(np.abs(drive.power).max()) for drive in driven.values()]
    yield from _powers(scene, driven, LITTLE * max([energy / duration if duration > 0.0 else 0.0, *powers]))
    least = {kind: LITTLE * size for kind, size in _sizes(scene, driven).items()}
    for drive in scene.drives:
        force = driven[drive.joint].force
        top = int(np.abs(force).argmax())
        if drive.kind == "load" or drive.sets or not 0 < top < len(force) - 1:
            continue
        greatest = float(force[top])
        if driven[drive.joint].largest > abs(greatest):  # at a jump of a prescribed acceleration, where it is known
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
    """Scale of the forces (N) of sliders and of the torques (N m) of hinges: of drives, weights and impacts."""
    scales = {"slider": scene.force_scale, "hinge": scene.force_scale * scene.length}
    for joint, drive in driven.items():
        kind = scene.joint(joint).kind
        scales[kind] = max(scales[kind], drive.largest)
    return scales


def _powers(scene: Scene, driven: Mapping[str, Driving], least: float) -> Iterator[AccuracyWarning]:
    """Yield sentences on drives whose power is greatest at the end of a run by fixed steps, and still rises.

    Events within a step, as sand that breaks away, are known to a step, and so is the height of such a rise. Before a
    maximum within the run they only shift its instant. Powers up to `least` (W) are left out: the drive brakes, or
    stands still.
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
