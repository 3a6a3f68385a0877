"""Candidates without motion along the surface: a plate and the wheel pressed straight down.

Ruts, heaps, wedges and slip sinkage need travel along the surface, so candidates with only these equal the level
surface here. Growth of the pressure and friction of the sides differ. The one number of the growth comes from the plate
of 60 mm.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from validation.braked.candidates import CANDIDATES, PLATE, Effects, grown, side_pressure, size_of
from validation.braked.wheel import POINTS, rim, stress
from validation.measurements.cmu import BOUNDS, table
from validation.tables import markdown

Vector = NDArray[np.float64]

FROM = 0.01  # m; at smaller depths the error of the zero of depth matters, which was set by hand
DOWN = np.array([[0.0, -1.0]])
ALONE = ("E1", "E2", "F1", "F2")  # candidates without travel; combinations equal the one of these that they contain
NAMES = {"level surface": Effects(), **{n: effects for n, effects in CANDIDATES.items() if n.split()[0] in ALONE}}


def plate(effects: Effects, diameter: float, depth: float) -> float:
    """Mean pressure (Pa) under a level round plate of a diameter (m) at a depth (m); its thin sides are neglected."""
    return float(stress(DOWN, DOWN)[0, 1] * grown(effects, np.array([depth]), diameter)[0])


def wheel(effects: Effects, bound: tuple[float, float], depth: float) -> float:
    """Force (N) on the wheel (radius, width) that is pressed in without rotation, at a depth (m); both halves bear."""
    radius, width = bound
    half_rim = rim(radius, width, 0.0)
    front = half_rim.angle < 0.5 * np.pi
    normal = np.column_stack([np.sin(half_rim.angle[front]), -np.cos(half_rim.angle[front])])
    _, z = half_rim.place(depth)
    g = grown(effects, -z[front], size_of(2.0 * width * half_rim.front(depth)))
    lift = stress(normal, np.broadcast_to(DOWN, normal.shape))[:, 1]
    force = 2.0 * width * radius * (np.pi / POINTS) * float(g @ lift)
    if not effects.sides:
        return force
    below = np.linspace(0.0, depth, 401)
    chord = 2.0 * np.sqrt(np.maximum(0.0, radius**2 - (radius - depth + below) ** 2))
    return force + 2.0 * side_pressure(effects) * float(np.trapezoid(below * chord, below))


def compared() -> tuple[str, dict[str, list[float]]]:
    """Table of forces, and rms of relative errors from the depth FROM on, by candidate.

    The errors are those of the plates of 60 and 80 mm, and of the wheel with both stated sizes.
    """
    plates, pressed = table("plates_large_box"), table("wheel_smooth_pressed_in")
    rows, errors = [], {}
    for name, effects in NAMES.items():
        apart = []
        for size in (PLATE, 0.08):
            measured = plates[(plates["diameter_mm"] == 1e3 * size) & (plates["depth_mm"] >= 1e3 * FROM)]
            computed = [1e-3 * plate(effects, size, 1e-3 * z) for z in measured["depth_mm"]]
            apart.append(_rms(computed, measured["pressure_kPa"]))
        measured = pressed[pressed["depth_mm"] >= 1e3 * FROM]
        forces = {b: [wheel(effects, bound, 1e-3 * z) for z in measured["depth_mm"]] for b, bound in BOUNDS.items()}
        apart += [_rms(computed, measured["force_N"]) for computed in forces.values()]
        errors[name] = apart
        first = next(iter(forces.values()))
        rows.append([name, *(f"{x:.0f}" for x in first), *(f"{100 * x:.0f} %" for x in apart)])
    measured = pressed[pressed["depth_mm"] >= 1e3 * FROM]
    rows.insert(0, ["measured", *(f"{x:.0f}" for x in measured["force_N"]), *([""] * 4)])
    head = ["force N on the wheel pressed in to", *(f"{z:.0f} mm" for z in measured["depth_mm"])]
    head += ["rms, plate 60 mm", "plate 80 mm", *(f"wheel {b}" for b in BOUNDS)]
    text = (
        "Pressed straight down, from 10 mm on. Here candidates A to D are the same as the level surface, and G "
        "is the same as its part E or F."
    )
    return f"{text} Forces are for the wheel of {next(iter(BOUNDS))}.\n\n{markdown(head, rows)}", errors


def _rms(computed: list[float], data: Vector) -> float:
    """Root mean square of the errors relative to the measured values."""
    return float(np.sqrt(np.mean((np.array(computed) / data - 1.0) ** 2)))
