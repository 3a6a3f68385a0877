"""Constants and formulas of the sources for a dropped ball and a dragged plate.

We do not have the measured points of either source. Instead, models are compared with a scaling and a ratio that other
papers of the same laboratory state in their abstracts, and with the source's own formula at another depth.
"""

from __future__ import annotations

import tempfile
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from granular_contact import preset
from granular_contact.config import load_scenario
from granular_contact.laws.katsuragi_durian import KatsuragiDurian
from granular_contact.laws.law import Law
from granular_contact.laws.layer import Layer
from granular_contact.sand.steady import SteadyBody
from granular_contact.scene import build
from granular_contact.studies.fit import fit, load_specification, prepare
from validation.laws import DIAMETER, G, drop
from validation.measurements.cmu import CONFIGS

Vector = NDArray[np.float64]

# ---- Katsuragi and Durian 2007: a steel ball dropped into glass beads ----

MASS = 0.0692  # kg
K_OVER_M, K_ERROR = 1040.0, 10.0  # 1/s2
D1, D1_ERROR = 0.087, 0.007  # m
# Ambroso, Santore, Abate and Durian 2005 (cond-mat/0411231): depth as total drop distance to this power; spheres of
# other sizes and densities. Ambroso, Kamien and Durian 2005 (cond-mat/0503454): stopping time over depth and speed,
# wooden spheres in glass beads.
EXPONENT, TIME_RATIO = 1.0 / 3.0, 3.0
HEIGHTS = np.array([0.01, 0.03, 0.1, 0.3, 1.0])  # m, drop heights


@dataclass(frozen=True)
class Ball:
    """Drops from HEIGHTS (n,): depths (m) and stopping times (s) by the engine, and bounds of their bands (2, n)."""

    depth: Vector
    time: Vector
    depth_band: Vector
    time_band: Vector


@cache
def balls(step: float) -> Ball:
    """Simulate the ball with the preset in the engine, and compute the band of the constants' stated errors."""
    medium = preset("glass_beads_katsuragi_durian")
    assert isinstance(medium, KatsuragiDurian)
    runs = np.array([drop(medium, np.sqrt(2.0 * G * height), step, 0.15, MASS).stop for height in HEIGHTS])
    corners = [
        [stop(np.sqrt(2.0 * G * h), K_OVER_M + i * K_ERROR, D1 + j * D1_ERROR) for h in HEIGHTS]
        for i in (-1, 1)
        for j in (-1, 1)
    ]
    times, depths = np.moveaxis(np.array(corners), 2, 0)
    ends = [np.array([values.min(axis=0), values.max(axis=0)]) for values in (depths, times)]
    return Ball(runs[:, 1], runs[:, 0], ends[0], ends[1])


def stop(speed: float, k_over_m: float, d1: float) -> tuple[float, float]:
    """Time (s) and depth (m) of the first stop by the source's equation of motion."""

    def at_rest(_: float, y: Vector) -> float:
        return float(y[1])

    at_rest.terminal, at_rest.direction = True, -1  # type: ignore[attr-defined]
    solution = solve_ivp(
        lambda _, y: (y[1], G - k_over_m * y[0] - y[1] * abs(y[1]) / d1),
        (0.0, 1.0),
        (0.0, speed),
        events=at_rest,
        rtol=1e-9,
        atol=1e-12,
    )
    return float(solution.t[-1]), float(solution.y[0, -1])


# ---- Agarwal, Karsai, Goldman and Kamrin 2021: a plate dragged at a depth ----

K, LAMBDA, DENSITY = 580.0, 1.1, 900.0  # N/m, -, kg/m3
HIGH, WIDE = 0.016, 1.0  # m; the width is ours, see the preset agarwal_plate
SPEEDS = np.array([0.04, 0.08, 0.16, 0.32, 0.48, 0.64])  # m/s
DEPTHS = np.array([0.02, 0.03, 0.04])  # m
PLATE = [
    f"model.bodies.plate.shapes.0.end_m=[0, {-0.055 - HIGH}]",
    f"model.bodies.plate.shapes.0.width_m={WIDE}",
]


def source(depth: float, speed: Vector) -> Vector:
    """Drag (n,) N by the formula of the source, with the plate's middle at a depth (m), at speeds (n,) m/s."""
    return K * depth + LAMBDA * DENSITY * HIGH * WIDE * speed**2


@cache
def plate_coefficients() -> dict[str, tuple[float, float]]:
    """Fit zeta and lambda to the least depth alone; values and standard errors by key."""
    with tempfile.TemporaryDirectory() as folder:
        rows = [f"{v},{f}" for v, f in zip(SPEEDS, source(DEPTHS[0], SPEEDS), strict=True)]
        (Path(folder) / "drag.csv").write_text("\n".join(["speed_m_s,force_N", *rows]) + "\n", encoding="utf-8")
        text = "parameters: [medium.zeta, medium.lambda]\n"
        text += f"set: {{medium: {{law: drft, density_kg_m3: {DENSITY}, lambda: 2, zeta: 0.3}}, "
        text += "model.bodies.plate.shapes.0.end_m.1: -0.071, model.bodies.plate.shapes.0.width_m: 1}\n"
        text += f"force_test: {{direction: right, depth_m: {DEPTHS[0] + HIGH / 2}}}\n"
        text += f"runs: [{{config: {CONFIGS / 'dragged_plate.yaml'}, data: drag.csv}}]\n"
        path = Path(folder) / "fit.yaml"
        path.write_text(text, encoding="utf-8")
        result = fit(prepare(load_specification(path)))
    return {e.parameter.label: (e.value, e.error) for e in result.uncertainty.estimates}


def dragged(medium: Law, depth: float, speed: Vector) -> Vector:
    """Drag (n,) N on the plate with its middle at a depth (m), at speeds (n,) m/s."""
    body = SteadyBody(build(load_scenario(CONFIGS / "dragged_plate.yaml", PLATE)))
    velocity = np.column_stack([speed, np.zeros(len(speed))])
    lowest = np.full(len(speed), depth + HIGH / 2)
    return -body.force(lowest, velocity, np.zeros(len(speed)), [Layer(medium)])[:, 0]


__all__ = ["DIAMETER", "balls", "dragged", "plate_coefficients", "source"]
