"""Energies of modal pendulums at the rows of one or several runs; symbols as in `kernels.pendulum`."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from granular_contact.results import energy
from granular_contact.scene.types import Vector


class Mass(NamedTuple):
    """Mass properties, stiffness and gravity, with the symbols of `kernels.pendulum`.

    For one run numbers and arrays (1, modes), for several arrays (rows,) and (rows, modes).
    """

    J: Any
    S_e: Any
    S_n: Any
    b: Any
    m: Any
    g: Any
    p: Vector
    c: Vector
    k: Vector


def mass(pendulum: NDArray[np.void], modes: int, rows: NDArray[np.int64] | None = None) -> Mass:
    """Mass properties of records (runs,) of PENDULUM, repeated for the rows of each run, or of one record."""
    several = pendulum if rows is None else {name: np.repeat(pendulum[name], rows, axis=0) for name in Mass._fields}
    read = (several[name][:, :modes] if name in "pck" else several[name] for name in Mass._fields)
    return Mass(*read) if rows is not None else Mass(*(value if value.ndim == 2 else value[0] for value in read))


def inertia(bends: Vector, mass: Mass) -> Vector:
    """Moment of inertia (rows,) kg m2 about the pivot, for deflections (rows, modes) m."""
    moment: Vector = mass.J + 2.0 * mass.b * np.sum(bends * mass.p, axis=1) + mass.m * np.sum(bends**2, axis=1)
    return moment


def stored(q: Vector, v: Vector, mass: Mass) -> tuple[Vector, Vector, Vector | None]:
    """Kinetic, gravitational and strain energy (rows,) J; the last is None without modes."""
    angle, rate, bends, bend_rates = q[:, 0], v[:, 0], q[:, 1:], v[:, 1:]
    if not bends.shape[1]:
        return 0.5 * mass.J * rate**2, -mass.g * (mass.S_e * np.sin(angle) + mass.S_n * np.cos(angle)), None
    kinetic = 0.5 * inertia(bends, mass) * rate**2 + rate * np.sum(bend_rates * mass.c, axis=1)
    kinetic += 0.5 * mass.m * np.sum(bend_rates**2, axis=1)
    across = mass.S_n + np.sum(bends * mass.p, axis=1)
    gravity = -mass.g * (mass.S_e * np.sin(angle) + across * np.cos(angle))
    return kinetic, gravity, 0.5 * np.sum(bends**2 * mass.k, axis=1)


def key_numbers(
    first: NDArray[np.int64], parts: tuple[Vector, Vector, Vector | None], works: Vector, least: Vector
) -> list[dict[str, float]]:
    """`results.energy.key_numbers` of several runs.

    first (runs + 1,): first row of each run; parts: see `stored`; works (rows, 2) J: work of the medium and of the
    internal damping so far; least (runs,) J: least scale of the imbalance.
    """
    begin, counts = first[:-1], np.diff(first)
    kinetic, gravity, elastic = parts
    gravity = gravity - np.repeat(gravity[begin], counts)
    energies = [kinetic, gravity, *([] if elastic is None else [elastic])]
    total = sum(energies[1:], kinetic)
    # In this order, so that round-off is that of a single run.
    change = total - (works[:, 0] + works[:, 1]) - np.repeat(total[begin], counts)
    scale = np.maximum.reduceat(np.abs([*energies, works[:, 0], works[:, 1]]).max(axis=0), begin)
    scale = np.maximum(scale, least)
    greatest = np.maximum.reduceat(np.abs(change), begin)
    share = np.divide(greatest, scale, out=np.zeros(len(scale)), where=scale > 0.0)
    last = first[1:] - 1
    columns = total[begin], total[last], works[last, 0], works[last, 1], share
    names = ("initial_J", "final_J", *energy.WORKS[:2], "imbalance_relative")
    return [dict(zip(names, row, strict=True)) for row in zip(*(column.tolist() for column in columns), strict=True)]
