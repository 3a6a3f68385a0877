"""Strain energy and dissipation of planar ANCF cable elements, for all instants at once.

The strain measures are those of the engine: axial strain |r'| - 1 and material curvature (r' x r'') / |r'|^2.
"""

from __future__ import annotations

import numpy as np

from granular_contact.scene.parts import FlexibleLink
from granular_contact.scene.types import Vector

# The engine's quadrature has order 9 for the axial strain and 5 for the curvature. With five Gauss points both agree to
# round-off.
GAUSS_POINTS, GAUSS_WEIGHTS = np.polynomial.legendre.leggauss(5)


def elastic_energy_and_loss(q: Vector, v: Vector, link: FlexibleLink) -> tuple[Vector, Vector]:
    """Strain energy (instants,) J of a link, and the power (instants,) W that its damping dissipates.

    q, v: (instants, nodes, 4) coordinates r_x, r_y, r'_x, r'_y and their rates.
    """
    length = link.length / link.elements
    xi = 0.5 * (1.0 + GAUSS_POINTS)
    first = np.stack([-6 * xi + 6 * xi**2, (1 - 4 * xi + 3 * xi**2) * length], 1)
    first = np.hstack([first, np.stack([6 * xi - 6 * xi**2, (3 * xi**2 - 2 * xi) * length], 1)]) / length
    second = np.stack([12 * xi - 6, (6 * xi - 4) * length, 6 - 12 * xi, (6 * xi - 2) * length], 1) / length**2

    def along(field: Vector, shapes: Vector) -> tuple[Vector, Vector]:
        """Components x and y of an interpolated field (instants, points)."""
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
    axial, curvature = stretch - 1.0, turn / stretch**2
    curvature_rate = turn_rate / stretch**2 - 2.0 * turn * stretch_rate / stretch**3
    weights = np.tile(0.5 * length * GAUSS_WEIGHTS, link.elements)  # a sum over points is an integral along the beam
    energy: Vector = 0.5 * (link.axial_stiffness * axial**2 + link.bending_stiffness * curvature**2) @ weights
    power: Vector = (link.axial_damping * stretch_rate**2 + link.bending_damping * curvature_rate**2) @ weights
    return energy, power


def curvatures(q: Vector, length: float) -> tuple[Vector, Vector]:
    """Curvature (1/m) at the first and second end of every element, (instants, elements); length (m): of an element.

    q (instants, nodes, 4): as in `elastic_energy_and_loss`.
    """
    position, slope = q[..., :2], q[..., 2:]
    chord = 6.0 * np.diff(position, axis=1)
    a, b = slope[:, :-1], slope[:, 1:]
    ends = []
    for first, second in ((a, chord - length * (4.0 * a + 2.0 * b)), (b, length * (2.0 * a + 4.0 * b) - chord)):
        cross = first[..., 0] * second[..., 1] - first[..., 1] * second[..., 0]
        ends.append(cross / length**2 / np.sum(first**2, axis=2) ** 1.5)
    return ends[0], ends[1]
