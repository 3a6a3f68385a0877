"""Energy of a run, whatever solved it: columns of what was stored and done, their balance, and the key numbers."""

from __future__ import annotations

import numpy as np

from granular_contact.results.series import Series
from granular_contact.values.arrays import Vector

SPRING = "spring_J"
IN_JOINTS = {  # columns that a run has if its joints or its bed have such things
    SPRING: "energy in the springs and stops of joints",
    "joint_damping_work_J": "work of dampers and stops in joints so far",
    "friction_work_J": "work of dry friction in joints so far",
    "drive_work_J": "work of the drives so far",
    "floor_work_J": "work of the floor's contact on the mechanism so far",
}
STORED = ("kinetic_J", "gravity_J", "elastic_J", SPRING)
WORKS = ("granular_work_J", "damping_work_J", *(name for name in IN_JOINTS if name != SPRING))
IMBALANCE = "energy_imbalance_J"


def columns(
    kinetic: Vector,
    gravity: Vector,
    elastic: Vector | None,
    work: Vector,
    damping: Vector,
    joints: dict[str, Vector] | None = None,
) -> Series:
    """Energies, and work done by the medium and by internal damping so far, (n,) J each.

    joints: what joints store (`spring_J`), and the work done in them so far, by the names of their columns.
    """
    joints = joints or {}
    total = kinetic + gravity
    series: Series = {
        "kinetic_J": ("kinetic energy", kinetic),
        "gravity_J": ("potential energy of gravity, from the start", gravity),
    }
    if elastic is not None:
        series["elastic_J"] = ("strain energy of the flexible links", elastic)
        total = total + elastic
    if SPRING in joints:
        series[SPRING] = (IN_JOINTS[SPRING], joints[SPRING])
        total = total + joints[SPRING]
    series["granular_work_J"] = ("work of the medium on the mechanism so far", work)
    series["damping_work_J"] = ("work of the links' internal damping so far", damping)
    done = work + damping
    for name in (name for name in IN_JOINTS if name in joints and name != SPRING):
        series[name] = (IN_JOINTS[name], joints[name])
        done = done + joints[name]
    words = "energy less what was done by medium and damping, from the start"
    if joints:
        words = "energy less all work that was done on the mechanism, from the start"
    series[IMBALANCE] = (words, total - done - total[0])
    return series


def key_numbers(series: dict[str, Vector], least: float) -> dict[str, float]:
    """Energy at the start and at the end, works, and the imbalance; of series by column name, (n,) each.

    imbalance_relative: the greatest over the greatest single energy, or over the least (J) that counts.
    """
    there = {name: series[name] for name in (*STORED, *WORKS) if name in series}
    stored = np.sum([values for name, values in there.items() if name in STORED], axis=0)
    scale = max(least, *(float(np.max(np.abs(values))) for values in there.values()))
    imbalance = float(np.max(np.abs(series[IMBALANCE]))) / scale if scale > 0.0 else 0.0
    numbers = {"initial_J": float(stored[0]), "final_J": float(stored[-1])}
    numbers |= {name: float(values[-1]) for name, values in there.items() if name in WORKS}
    return numbers | {"imbalance_relative": imbalance}


# ---- integrals over time ----


def accumulate(time: Vector, rate: Vector) -> Vector:
    """Trapezoidal integral of a rate from the first instant on, (instants,); of no instants nothing."""
    return np.concatenate([np.zeros(min(len(time), 1)), np.cumsum(0.5 * (rate[1:] + rate[:-1]) * np.diff(time))])


def work(time: Vector, force: Vector, rate: Vector) -> Vector:
    """Work (instants,) J of forces along rates, (instants,) or (instants, n) each, from the first instant on.

    Mean force of a step times its mean rate. A scheme of second order gives a step the momentum of the mean force, so
    that the kinetic energy changes by just this; the mean power differs from it by a quarter of h dF dv, which is first
    order in h where the force jumps, and is nothing that the motion has.
    """
    mean = 0.25 * (force[1:] + force[:-1]) * (rate[1:] + rate[:-1])
    power = mean if mean.ndim == 1 else mean.sum(axis=1)
    return np.concatenate([[0.0], np.cumsum(power * np.diff(time))])
