"""Energy balance of a run by any engine: columns of stored energies, works and the imbalance, and key numbers."""

from __future__ import annotations

import numpy as np

from granular_contact.results.series import Series
from granular_contact.values.arrays import Vector

SPRING = "spring_J"
IN_JOINTS = {  # columns that exist only if the joints or the bed have such parts
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
    """Columns of energies and of the work of the medium and of internal damping since the start, (n,) J each.

    joints: energy stored in joints (`spring_J`) and work done in joints since the start, by column name.
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
    works = "all work done on the mechanism" if joints else "the work of medium and damping"
    series[IMBALANCE] = (f"change of energy since the start, minus {works}", total - done - total[0])
    return series


def key_numbers(series: dict[str, Vector], least: float) -> dict[str, float]:
    """Energy at the start and at the end, works, and the relative imbalance, from columns (n,) J by name.

    imbalance_relative: largest imbalance divided by the largest of all energies and works, or by `least` (J) if that
    is larger.
    """
    present = {name: series[name] for name in (*STORED, *WORKS) if name in series}
    stored = np.sum([values for name, values in present.items() if name in STORED], axis=0)
    scale = max(least, *(float(np.max(np.abs(values))) for values in present.values()))
    imbalance = float(np.max(np.abs(series[IMBALANCE]))) / scale if scale > 0.0 else 0.0
    numbers = {"initial_J": float(stored[0]), "final_J": float(stored[-1])}
    numbers |= {name: float(values[-1]) for name, values in present.items() if name in WORKS}
    return numbers | {"imbalance_relative": imbalance}


# ---- integrals over time ----


def accumulate(time: Vector, rate: Vector) -> Vector:
    """Cumulative trapezoidal integral (instants,) of a rate, zero at the first instant; empty without instants."""
    return np.concatenate([np.zeros(min(len(time), 1)), np.cumsum(0.5 * (rate[1:] + rate[:-1]) * np.diff(time))])


def work(time: Vector, force: Vector, rate: Vector) -> Vector:
    """Work (instants,) J since the first instant, of forces and their rates, (instants,) or (instants, n) each.

    The work of a step is its mean force times its mean rate. In a step of a second-order scheme the mean force changes
    the momentum, so the kinetic energy changes by exactly this work. The mean power times h differs by h dF dv / 4; the
    difference is of first order in h where the force jumps, and is no energy of the motion.
    """
    mean = 0.25 * (force[1:] + force[:-1]) * (rate[1:] + rate[:-1])
    power = mean if mean.ndim == 1 else mean.sum(axis=1)
    return np.concatenate([[0.0], np.cumsum(power * np.diff(time))])
