"""Force of a law on a body in steady motion, outside any simulation, and curves of it."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from granular_contact.laws.law import Law
from granular_contact.laws.static_friction import Elastoplastic

Vector = NDArray[np.float64]

LEVEL = np.array([[0.0, 0.0]])
# Elastoplastic friction in which an unstretched bristle yields at any speed above 1e-12 m/s: the static resistance of a
# steady motion is then fully mobilised.
STEADY = Elastoplastic(1e-12, 1.0)
BALL, BAR, PLATE = 0.0254, 0.00635, 0.03  # sizes where a medium states none (m)
STEEL = 7700.0  # density (kg/m3) of the ball, for laws that need its mass
SLOW, DEPTH = 0.1, 0.05  # speed (m/s) and depth (m) of the curves over other quantities


@dataclass(frozen=True)
class Probe:
    """Straight strip or ball on which a law acts.

    Parameters
    ----------
    points : (2, 2) array
        Ends of the strip (m), with the surface at y = 0; both rows are the centre of a ball.
    width : float
        Diameter of a round bar or ball, or width of a plate normal to the plane (m).
    side : int
        0 if both faces can lead, else the side of the outward normal of an outline: +1 left of the strip, -1 right.
    ball : float, optional
        Mass of a ball (kg); None for a strip.
    """

    points: Vector
    width: float
    side: int = 0
    ball: float | None = None


def force(medium: Law, probe: Probe, velocity: Vector, gravity: float = 9.81) -> Vector:
    """Force of each term on a body in steady motion.

    Parameters
    ----------
    medium : Law
        The medium.
    probe : Probe
        The body.
    velocity : (2,) array
        Velocity of the body (m/s), y up.
    gravity : float
        Gravity (m/s2).

    Returns
    -------
    (terms, 2) array
        Force of each term (N), x and y (up).
    """
    from granular_contact.sand.kernels import probe as kernel
    from granular_contact.sand.kernels.law import LINE, TERMS

    line = np.zeros(1, LINE)
    line["width"], line["side"] = probe.width, probe.side
    if probe.ball is not None:
        line["drop"], line["mass"] = 0.5 * probe.width, probe.ball
    F, totals = np.zeros((2, 2)), np.zeros((TERMS, 3))
    V = np.tile(np.asarray(velocity, float), (2, 1))
    kernel.probe(probe.points, V, probe.points.copy(), line, LEVEL, medium.record(STEADY, gravity), F, totals)
    terms: Vector = totals[: len(medium.terms), :2]
    return terms


def upright_bar(depth: float, diameter: float) -> Probe:
    """Vertical round bar that pierces the surface.

    Parameters
    ----------
    depth : float
        Depth of its tip (m).
    diameter : float
        Diameter (m).
    """
    return Probe(np.array([[0.0, 0.5 * depth], [0.0, -depth]]), diameter)


def plate(depth: float, beta: float, size: float) -> Probe:
    """Square plate.

    Parameters
    ----------
    depth : float
        Depth of its middle (m).
    beta : float
        Angle to the horizontal (deg), counter-clockwise.
    size : float
        Side (m).
    """
    b = math.radians(beta)
    half = 0.5 * size * np.array([math.cos(b), math.sin(b)])
    return Probe(np.array([-half, half]) - np.array([0.0, depth]), size)


def ball(depth: float, diameter: float, density: float = STEEL) -> Probe:
    """Solid ball.

    Parameters
    ----------
    depth : float
        Depth of its lowest point (m).
    diameter : float
        Diameter (m).
    density : float
        Density (kg/m3), from which its mass follows.
    """
    centre = np.array([[0.0, 0.5 * diameter - depth]] * 2)
    return Probe(centre, diameter, ball=density * math.pi / 6.0 * diameter**3)


@dataclass(frozen=True)
class Curve:
    """Force over a quantity.

    Parameters
    ----------
    label : str
        Text of the legend.
    x : (n,) array
        The quantity, see `Panel.x_label`.
    y : (n,) array
        Force (N).
    """

    label: str
    x: Vector
    y: Vector


@dataclass(frozen=True)
class Panel:
    """Curves over a common axis.

    Parameters
    ----------
    x_label : str
        Label of the axis, with the unit.
    title : str
        Title.
    curves : tuple of Curve
        The curves.
    """

    x_label: str
    title: str
    curves: tuple[Curve, ...]


def panels(medium: Law) -> tuple[Panel, Panel, Panel]:
    """Curves of the force on a body that the medium acts on.

    Parameters
    ----------
    medium : Law
        The medium.

    Returns
    -------
    tuple of Panel
        Force against depth, against speed, and against the direction of motion.
    """
    body_at, name, directions = _body(medium)
    z, v, gamma = np.linspace(1e-4, 2 * DEPTH, 60), np.linspace(0.0, 3.0, 60), np.linspace(-90.0, 90.0, 91)
    body = body_at(DEPTH)
    by_depth = tuple(
        Curve(label, z, np.array([_resistance(medium, body_at(x), SLOW, angle) for x in z]))
        for label, angle in directions.items()
    )
    by_speed = tuple(
        Curve(label, v, np.array([_resistance(medium, body, x, angle) for x in v]))
        for label, angle in directions.items()
    )
    forces = np.array([_total_force(medium, body, SLOW, angle) for angle in gamma])
    components = (Curve("horizontal, against the motion", gamma, -forces[:, 0]), Curve("upward", gamma, forces[:, 1]))
    return (
        Panel("depth (m)", f"{name}, {SLOW:g} m/s", by_depth),
        Panel("speed (m/s)", f"{name}, {DEPTH:g} m deep", by_speed),
        Panel("direction below the horizontal (deg)", f"{name}, {DEPTH:g} m deep, {SLOW:g} m/s", components),
    )


def _body(medium: Law) -> tuple[Callable[[float], Probe], str, dict[str, float]]:
    """Body by its depth (m), its name, and the directions (deg below the horizontal) that matter for it."""
    size = None if medium.validity.size is None else medium.validity.size[1]
    if "ball" in medium.takes:
        diameter = size or BALL
        return lambda depth: ball(depth, diameter), f"steel ball of {1e3 * diameter:.3g} mm", {"downward": 90.0}
    directions = {"plunging": 90.0, "withdrawing": -90.0, "horizontally": 0.0}
    if "flat" in medium.takes:
        width = size or PLATE
        return lambda depth: plate(depth, 0.0, width), f"level plate of {1e3 * width:.3g} mm", directions
    diameter = size or BAR
    return lambda depth: upright_bar(depth, diameter), f"upright bar of {1e3 * diameter:.3g} mm", directions


def _total_force(medium: Law, probe: Probe, speed: float, angle: float) -> Vector:
    """Force (2,) N of all terms at a speed (m/s) and a direction (deg below the horizontal)."""
    a = math.radians(angle)
    total: Vector = force(medium, probe, speed * np.array([math.cos(a), -math.sin(a)])).sum(axis=0)
    return total


def _resistance(medium: Law, probe: Probe, speed: float, angle: float) -> float:
    """Component of the force (N) against the motion; arguments as in `_total_force`."""
    a = math.radians(angle)
    return float(-_total_force(medium, probe, max(speed, 1e-6), angle) @ np.array([math.cos(a), -math.sin(a)]))
