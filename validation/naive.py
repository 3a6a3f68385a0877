"""The simplest implementation of sand in Exudyn: one Python load function per quadrature point. For comparison only.

Each point has a force load. Its user function gets the position, velocity and direction of the point from the engine
and evaluates the Lee-Marghitu law there. The engine calls all of these functions in every residual. `VectorPoint` is
the simplest form, with small NumPy vectors; `FloatPoint` is optimised: it uses plain floats and returns at once above
the surface.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from exudyn import OutputVariableType as Output
from exudyn import itemInterface as items

from granular_contact.engines.exudyn.build import System

GAUSS, WEIGHTS = np.polynomial.legendre.leggauss(3)


class FloatPoint:
    """One quadrature point of a cable element; weight is its share of the arc length (m)."""

    def __init__(self, system: System, element: int, place: list[float], weight: float, diameter: float) -> None:
        (medium,) = system.scene.media
        assert system.scene.surface is not None
        self.element, self.place, self.weight, self.d = element, place, weight, diameter
        self.medium, self.surface, self.g = medium, system.scene.surface, system.scene.gravity
        self.u_y, self.tau = system.scene.static.yield_displacement, system.scene.static.damping_time  # type: ignore[union-attr]
        self.anchor = [0.0, 0.0]

    def force(self, mbs: Any, t: float, load: Any) -> list[float]:  # noqa: ARG002
        """Force (N) on the point, the law times its share of the length."""
        p = mbs.GetObjectOutputBody(self.element, Output.Position, self.place)
        z = self.surface - p[1]
        if z <= 0.0:
            return [0.0, 0.0, 0.0]
        v = mbs.GetObjectOutputBody(self.element, Output.Velocity, self.place)
        tangent = mbs.GetObjectOutputBody(self.element, Output.Director1, self.place)
        m, d = self.medium, self.d
        ex = min(self.u_y, max(-self.u_y, p[0] - self.anchor[0]))
        ey = min(self.u_y, max(-self.u_y, p[1] - self.anchor[1]))
        sx = min(1.0, max(-1.0, (ex + self.tau * v[0]) / self.u_y))
        sy = min(1.0, max(-1.0, (ey + self.tau * v[1]) / self.u_y))
        vertical = m.plunging if sy < 0.0 else m.withdrawing
        drag = m.eta_d * m.density * d * abs(tangent[0] * v[1] - tangent[1] * v[0])
        bound_x = 2.0 * m.eta_h * self.g * m.density * d * z * abs(tangent[1])
        area = math.pi * d * d / 4.0
        bound_y = (vertical.lam + 1.0) * vertical.eta_v * self.g * m.density * area * (z / d) ** vertical.lam
        return [
            -self.weight * (drag * v[0] + bound_x * sx),
            -self.weight * (drag * v[1] + bound_y * sy),
            0.0,
        ]

    def accept(self, mbs: Any) -> None:
        """Move the anchor after an accepted step."""
        p = mbs.GetObjectOutputBody(self.element, Output.Position, self.place)
        for i in range(2):
            reach = min(self.u_y, max(-self.u_y, p[i] - self.anchor[i])) if p[1] < self.surface else 0.0
            self.anchor[i] = p[i] - reach


class VectorPoint(FloatPoint):
    """The same with NumPy vectors, not optimised."""

    def force(self, mbs: Any, t: float, load: Any) -> list[float]:  # noqa: ARG002
        """Force (N) on the point, the law times its share of the length."""
        p = np.array(mbs.GetObjectOutputBody(self.element, Output.Position, self.place))[:2]
        v = np.array(mbs.GetObjectOutputBody(self.element, Output.Velocity, self.place))[:2]
        tangent = np.array(mbs.GetObjectOutputBody(self.element, Output.Director1, self.place))[:2]
        m, d = self.medium, self.d
        z = np.maximum(self.surface - p[1], 0.0)
        stretch = np.clip(p - np.array(self.anchor), -self.u_y, self.u_y)
        sigma = np.clip((stretch + self.tau * v) / self.u_y, -1.0, 1.0)
        vertical = m.plunging if sigma[1] < 0.0 else m.withdrawing
        drag = -m.eta_d * m.density * d * np.abs(tangent[0] * v[1] - tangent[1] * v[0]) * v * (z > 0.0)
        bound = np.array(
            [
                2.0 * m.eta_h * self.g * m.density * d * z * np.abs(tangent[1]),
                (vertical.lam + 1.0)
                * vertical.eta_v
                * self.g
                * m.density
                * np.pi
                * d**2
                / 4.0
                * (z / d) ** vertical.lam,
            ]
        )
        force = self.weight * (drag - bound * sigma)
        return [float(force[0]), float(force[1]), 0.0]


def add_points(system: System, kind: type[FloatPoint]) -> list[FloatPoint]:
    """Add loads at three Gauss points of every cable element of an assembled system, and assemble it again."""
    points = []
    for handle in system.links.values():
        length = handle.link.length / handle.link.elements
        for element in handle.elements:
            for xi, weight in zip(GAUSS, WEIGHTS, strict=True):
                place = [0.5 * length * (1.0 + xi), 0.0, 0.0]
                point = kind(system, element, place, 0.5 * length * weight, handle.link.width)
                marker = system.mbs.AddMarker(items.MarkerBodyPosition(bodyNumber=element, localPosition=place))
                system.mbs.AddLoad(
                    items.LoadForceVector(markerNumber=marker, loadVectorUserFunction=point.force, loadVector=[0, 0, 0])
                )
                points.append(point)
    system.mbs.Assemble()
    return points
