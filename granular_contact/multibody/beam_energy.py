"""Energies of planar ANCF cable elements, for all instants at once.

The engine's own strain measures: axial strain |r'| - 1 and material curvature (r' x r'') / |r'|^2.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from granular_contact.scene.types import Vector

# Order 9 in the axial strain and 5 in the curvature are the engine's rules; five points serve both to round-off.
GAUSS_POINTS, GAUSS_WEIGHTS = np.polynomial.legendre.leggauss(5)


@dataclass(frozen=True)
class Strain:
    """Axial strain and curvature (1/m) at the Gauss points of every element, and their rates: (instants, points) each.

    weights: (points,) m, so that a sum over the last axis is an integral along the beam.
    """

    axial: Vector
    curvature: Vector
    axial_rate: Vector
    curvature_rate: Vector
    weights: Vector


def strain(q: Vector, v: Vector, length: float) -> Strain:
    """Strains of a beam of equal elements.

    q, v: (instants, nodes, 4) coordinates r_x, r_y, r'_x, r'_y and their rates; length of one element (m).
    """
    elements = q.shape[1] - 1
    xi = 0.5 * (1.0 + GAUSS_POINTS)
    first = np.stack([-6 * xi + 6 * xi**2, (1 - 4 * xi + 3 * xi**2) * length], 1)
    first = np.hstack([first, np.stack([6 * xi - 6 * xi**2, (3 * xi**2 - 2 * xi) * length], 1)]) / length
    second = np.stack([12 * xi - 6, (6 * xi - 4) * length, 6 - 12 * xi, (6 * xi - 2) * length], 1) / length**2

    def along(field: Vector, shapes: Vector) -> tuple[Vector, Vector]:
        nodes = field.reshape(len(field), -1, 2, 2)
        ends = np.concatenate([nodes[:, :-1], nodes[:, 1:]], axis=2)
        value = np.einsum("gk,tekd->tegd", shapes, ends)
        return value[..., 0].reshape(len(field), -1), value[..., 1].reshape(len(field), -1)

    x1, y1 = along(q, first)
    x2, y2 = along(q, second)
    u1, w1 = along(v, first)
    u2, w2 = along(v, second)
    stretch = np.hypot(x1, y1)
    turn = x1 * y2 - y1 * x2
    stretch_rate = (x1 * u1 + y1 * w1) / stretch
    turn_rate = u1 * y2 + x1 * w2 - w1 * x2 - y1 * u2
    return Strain(
        axial=stretch - 1.0,
        curvature=turn / stretch**2,
        axial_rate=stretch_rate,
        curvature_rate=turn_rate / stretch**2 - 2.0 * turn * stretch_rate / stretch**3,
        weights=np.tile(0.5 * length * GAUSS_WEIGHTS, elements),
    )


def elastic_energy(s: Strain, axial_stiffness: float, bending_stiffness: float) -> Vector:
    """Strain energy (instants,) J of a beam with stiffnesses in N and N m2."""
    energy: Vector = 0.5 * (axial_stiffness * s.axial**2 + bending_stiffness * s.curvature**2) @ s.weights
    return energy


def damping_power(s: Strain, axial_damping: float, bending_damping: float) -> Vector:
    """Power (instants,) W lost in a beam with damping constants in N s and N m2 s."""
    power: Vector = (axial_damping * s.axial_rate**2 + bending_damping * s.curvature_rate**2) @ s.weights
    return power
