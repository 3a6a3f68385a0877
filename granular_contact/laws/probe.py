"""A law by itself: the force on a body in steady motion, and the curves that show it."""

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
# On a bristle that is not stretched the sign of any speed above 1e-12 m/s, in closed form: the motion is steady,
# nothing is at rest.
STEADY = Elastoplastic(1e-12, 1.0)
BALL, BAR, PLATE = 0.0254, 0.00635, 0.03  # sizes where a medium states none (m)
STEEL = 7700.0  # kg/m3, of a ball for laws that ask for its mass
SLOW, DEPTH = 0.1, 0.05  # m/s, m


@dataclass(frozen=True)
class Probe:
    """Straight strip or ball that a law is asked about.

    points: (2, 2) m, its ends, with the surface at y = 0 (both the centre of a ball); width: m, as in the kernels;
    side: of an outline; ball: mass (kg) of a ball, None for a strip.
    """

    points: Vector
    width: float
    side: int = 0
    ball: float | None = None


def force(medium: Law, probe: Probe, velocity: Vector, gravity: float = 9.81) -> Vector:
    """Force x, y (N) of each term, (terms, 2), on a body that moves steadily with a velocity (2,) m/s, y up."""
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
    """Round bar that pierces the surface at right angles, its tip at a depth (m)."""
    return Probe(np.array([[0.0, 0.5 * depth], [0.0, -depth]]), diameter)


def plate(depth: float, beta: float, size: float) -> Probe:
    """Square plate, its middle at a depth (m), at the angle beta (deg) to the horizontal."""
    b = math.radians(beta)
    half = 0.5 * size * np.array([math.cos(b), math.sin(b)])
    return Probe(np.array([-half, half]) - np.array([0.0, depth]), size)


def ball(depth: float, diameter: float, density: float = STEEL) -> Probe:
    """Solid ball, its lowest point at a depth (m)."""
    centre = np.array([[0.0, 0.5 * diameter - depth]] * 2)
    return Probe(centre, diameter, ball=density * math.pi / 6.0 * diameter**3)


@dataclass(frozen=True)
class Curve:
    """Force y (N) over x, with what it is called."""

    label: str
    x: Vector
    y: Vector


@dataclass(frozen=True)
class Panel:
    """Curves over one axis."""

    x_label: str
    title: str
    curves: tuple[Curve, ...]


def panels(medium: Law) -> tuple[Panel, Panel, Panel]:
    """Force of a medium against depth, against speed, and against the direction of motion, on a body that it takes."""
    shape, what, directions = _body(medium)
    z, v, gamma = np.linspace(1e-4, 2 * DEPTH, 60), np.linspace(0.0, 3.0, 60), np.linspace(-90.0, 90.0, 91)
    deep = shape(DEPTH)
    by_depth = tuple(
        Curve(label, z, np.array([_against(medium, shape(x), SLOW, a) for x in z])) for label, a in directions.items()
    )
    by_speed = tuple(
        Curve(label, v, np.array([_against(medium, deep, x, a) for x in v])) for label, a in directions.items()
    )
    turned = np.array([_total(medium, deep, SLOW, x) for x in gamma])
    components = (Curve("horizontal, against the motion", gamma, -turned[:, 0]), Curve("upward", gamma, turned[:, 1]))
    return (
        Panel("depth (m)", f"{what}, {SLOW:g} m/s", by_depth),
        Panel("speed (m/s)", f"{what}, {DEPTH:g} m deep", by_speed),
        Panel("direction below the horizontal (deg)", f"{what}, {DEPTH:g} m deep, {SLOW:g} m/s", components),
    )


def _body(medium: Law) -> tuple[Callable[[float], Probe], str, dict[str, float]]:
    """The body by its depth, its name, and the directions (deg below the horizontal) that matter for it."""
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


def _total(medium: Law, probe: Probe, speed: float, angle: float) -> Vector:
    a = math.radians(angle)
    total: Vector = force(medium, probe, speed * np.array([math.cos(a), -math.sin(a)])).sum(axis=0)
    return total


def _against(medium: Law, probe: Probe, speed: float, angle: float) -> float:
    """Part of the force against the motion (N)."""
    a = math.radians(angle)
    return float(-_total(medium, probe, max(speed, 1e-6), angle) @ np.array([math.cos(a), -math.sin(a)]))
