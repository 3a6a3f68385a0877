"""Candidates where nothing is dragged along: a plate and the wheel pressed straight down.

Ruts, heaps, wedges and slip sinkage need a way along the surface, so they are the level surface here; growth of the
pressure and friction of the sides are not. The one number of the growth is that of the plate of 60 mm.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from validation.braked.candidates import CANDIDATES, PLATE, Effects, grown, side_pressure, size_of
from validation.braked.wheel import POINTS, rim, stress
from validation.measurements.cmu import BOUNDS, table
from validation.tables import markdown

Vector = NDArray[np.float64]

FROM = 0.01  # m; above it the zero of depth, set by hand, matters
DOWN = np.array([[0.0, -1.0]])
ALONE = ("E1", "E2", "F1", "F2")  # what does not need a way along the surface; combinations are as their part of these
NAMES = {"level surface": Effects(), **{n: one for n, one in CANDIDATES.items() if n.split()[0] in ALONE}}


def plate(effects: Effects, diameter: float, depth: float) -> float:
    """Mean pressure (Pa) under a level round plate of a diameter at a depth (m); it has no sides to speak of."""
    return float(stress(DOWN, DOWN)[0, 1] * grown(effects, np.array([depth]), diameter)[0])


def wheel(effects: Effects, bound: tuple[float, float], depth: float) -> float:
    """Force (N) on the wheel (radius, width) that is pressed in without turning, at a depth (m): both halves bear."""
    radius, width = bound
    one = rim(radius, width, 0.0)
    front = one.angle < 0.5 * np.pi
    normal = np.column_stack([np.sin(one.angle[front]), -np.cos(one.angle[front])])
    _, z = one.place(depth)
    g = grown(effects, -z[front], size_of(2.0 * width * one.front(depth)))
    lift = stress(normal, np.broadcast_to(DOWN, normal.shape))[:, 1]
    found = 2.0 * width * radius * (np.pi / POINTS) * float(g @ lift)
    if not effects.sides:
        return found
    below = np.linspace(0.0, depth, 401)
    chord = 2.0 * np.sqrt(np.maximum(0.0, radius**2 - (radius - depth + below) ** 2))
    return found + 2.0 * side_pressure(effects) * float(np.trapezoid(below * chord, below))


def compared() -> tuple[str, dict[str, list[float]]]:
    """The table, and the rms of the errors over the measured values from FROM on.

    By candidate: the plates of 60 and 80 mm, and the wheel with each of its stated sizes.
    """
    plates, pressed = table("plates_large_box"), table("wheel_smooth_pressed_in")
    rows, errors = [], {}
    for name, effects in NAMES.items():
        apart = []
        for size in (PLATE, 0.08):
            own = plates[(plates["diameter_mm"] == 1e3 * size) & (plates["depth_mm"] >= 1e3 * FROM)]
            found = [1e-3 * plate(effects, size, 1e-3 * z) for z in own["depth_mm"]]
            apart.append(_rms(found, own["pressure_kPa"]))
        own = pressed[pressed["depth_mm"] >= 1e3 * FROM]
        forces = {b: [wheel(effects, bound, 1e-3 * z) for z in own["depth_mm"]] for b, bound in BOUNDS.items()}
        apart += [_rms(found, own["force_N"]) for found in forces.values()]
        errors[name] = apart
        first = next(iter(forces.values()))
        rows.append([name, *(f"{x:.0f}" for x in first), *(f"{100 * x:.0f} %" for x in apart)])
    own = pressed[pressed["depth_mm"] >= 1e3 * FROM]
    rows.insert(0, ["measured", *(f"{x:.0f}" for x in own["force_N"]), *([""] * 4)])
    head = ["N on the wheel pressed in to", *(f"{z:.0f} mm" for z in own["depth_mm"])]
    head += ["rms, plate 60 mm", "plate 80 mm", *(f"wheel {b}" for b in BOUNDS)]
    text = "Pressed straight down, from 10 mm on. A to D are the level surface here, G as their part of E or F."
    return f"{text} Forces are those of {next(iter(BOUNDS))}.\n\n{markdown(head, rows)}", errors


def _rms(found: list[float], data: Vector) -> float:
    """Of the errors over the measured values."""
    return float(np.sqrt(np.mean((np.array(found) / data - 1.0) ** 2)))
