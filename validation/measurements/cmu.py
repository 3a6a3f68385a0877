"""Plates and a wheel in dry sand (configs/cmu, MIT licence): measured tables, models, and their predictions."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from granular_contact import preset
from granular_contact.config import load_scenario
from granular_contact.laws.law import Law
from granular_contact.laws.layer import Layer
from granular_contact.laws.probe import STEADY
from granular_contact.laws.rft import GENERIC, Rft
from granular_contact.sand.contact_lines import Body, outline
from granular_contact.sand.load import GranularLoad
from granular_contact.sand.steady import SteadyBody
from granular_contact.scene import build
from granular_contact.studies.fit import fit, load_specification, prepare

Vector = NDArray[np.float64]

CONFIGS = Path(__file__).parents[2] / "configs"
TABLES = CONFIGS / "cmu"
# Radius and width of the wheel (m) as stated in the authors' code, and in their meshes.
BOUNDS = {"58 mm x 50 mm": (0.058, 0.050), "62.5 mm x 60 mm": (0.0625, 0.060)}
DEEPEST = 0.11  # m, upper bound of the wheel's sinkage
CHORDS = 96
SHEAR_MODULUS = 0.021  # m, set by hand by the authors


def table(name: str) -> Any:
    """Read a table of measurements; columns by name."""
    return np.genfromtxt(TABLES / f"{name}.csv", delimiter=",", names=True)


@cache
def fitted(parameters: str = "", medium: str = "") -> dict[str, tuple[float, float]]:
    """Fit coefficients to the plate of 60 mm; values and standard errors by key.

    parameters, medium: replace those of the shipped fit file; empty: the shipped file is used.
    """
    text = (CONFIGS / "fit_cmu_plates.yaml").read_text(encoding="utf-8")
    if medium:
        text = f"parameters: {parameters}\nset: {{medium: {medium}}}\n{text[text.index('force_test:') :]}"
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "fit.yaml"
        for key in ("config: ", "data: "):  # paths in the file are relative to it
            text = text.replace(key, f"{key}{CONFIGS}/")
        path.write_text(text, encoding="utf-8")
        result = fit(prepare(load_specification(path)))
    return {e.parameter.label: (e.value, e.error) for e in result.uncertainty.estimates}


@cache
def models() -> dict[str, Law]:
    """Media by a name that says where their coefficients come from."""
    zeta, _ = fitted("[medium.zeta]", "rft_generic")["medium.zeta"]
    return {
        "3D-RFT, nothing fitted": preset("cmu_dry_sand"),
        "RFT, zeta of the 60 mm plate": Rft(GENERIC, zeta),
        "k z^n of the 60 mm plate": preset("cmu_dry_sand_plate"),
    }


# ---- plates, and the wheel pressed in ----


@cache
def plate(diameter: float) -> SteadyBody:
    """Square plate with the area of a round plate of this diameter (m)."""
    side = diameter * np.sqrt(np.pi) / 2
    shape = "model.bodies.plate.shapes.0"
    sets = [f"{shape}.start_m=[{-side / 2}, 0]", f"{shape}.end_m=[{side / 2}, 0]", f"{shape}.width_m={side}"]
    return SteadyBody(build(load_scenario(CONFIGS / "penetrometer.yaml", sets)))


def plate_pressure(medium: Law, depth: Vector, size: float) -> Vector:
    """Pressure (Pa) under a level plate of a diameter (mm) at depths (n,) m."""
    down = np.tile([0.0, -0.005], (len(depth), 1))
    area = np.pi * (0.5e-3 * size) ** 2
    return plate(1e-3 * size).force(depth, down, np.zeros(len(depth)), [Layer(medium)])[:, 1] / area


@cache
def wheel(bound: str) -> SteadyBody:
    """The wheel with one of its stated sizes (a name of BOUNDS)."""
    radius, width = BOUNDS[bound]
    shape = f"{{type: disc, diameter_m: {2 * radius}, thickness_m: {width}}}"
    body = f"wheel: {{type: rigid, density_kg_m3: 1000, shapes: [{shape}]}}"
    rail = "rail: {type: slider, parent: ground, child: wheel, axis: [0, -1]}"
    model = f"model={{name: wheel, bodies: {{{body}}}, joints: {{{rail}}}}}"
    return SteadyBody(
        build(load_scenario(CONFIGS / "penetrometer.yaml", [model, f"load.strips_per_rigid_part={CHORDS}"]))
    )


def pressed_wheel(medium: Law, bound: str, depth: Vector) -> Vector:
    """Force (n,) N on the wheel that is pressed in without rotation, at depths (n,) m."""
    down = np.tile([0.0, -0.005], (len(depth), 1))
    return wheel(bound).force(depth, down, np.zeros(len(depth)), [Layer(medium)])[:, 1]


# ---- the rolling wheel ----


@dataclass(frozen=True)
class Rolling:
    """Measurement of the wheel at a slip: forward force (N) and sinkage (m), means and standard deviations over trials.

    load: mean vertical force, N; forward, rim: speeds of axle and rim, m/s; within: scatter of the force in a run, N.
    """

    slip: float
    forward: float
    rim: float
    load: float
    force: float
    sinkage: float
    force_sd: float
    sinkage_sd: float
    within: float


@cache
def rolling() -> tuple[Rolling, ...]:
    """Measurements in the order of slip."""
    rows = table("wheel_smooth_straight")
    measurements = []
    for group in np.split(rows, np.flatnonzero(np.abs(np.diff(rows["slip"])) > 0.05) + 1):
        measurements.append(
            Rolling(
                slip=float(group["slip"].mean()),
                forward=1e-3 * float(group["forward_speed_mm_s"].mean()),
                rim=1e-3 * float(group["rim_speed_mm_s"].mean()),
                load=float(group["Fz_N"].mean()),
                force=float(group["Fx_N"].mean()),
                sinkage=1e-3 * float(group["sinkage_mm"].mean()),
                force_sd=float(group["Fx_N"].std(ddof=1)),
                sinkage_sd=1e-3 * float(group["sinkage_mm"].std(ddof=1)),
                within=float(group["sd_Fx_N"].mean()),
            )
        )
    return tuple(measurements)


@cache
def rolled(medium: Law, bound: str) -> tuple[tuple[float, float], ...]:
    """Sinkage (m) at which the wheel bears its measured load, and forward force (N) there, for each slip."""
    return tuple(_balance(medium, bound, measured) for measured in rolling())


def _balance(medium: Law, bound: str, measured: Rolling) -> tuple[float, float]:
    def force(depth: float) -> Vector:
        if medium.needs_path_length:
            return _with_history(medium, bound, measured, depth)
        speed, rate = np.array([[measured.forward, 0.0]]), np.array([-measured.rim / BOUNDS[bound][0]])
        return wheel(bound).force(np.array([depth]), speed, rate, [Layer(medium)])[0]

    if force(DEEPEST)[1] < measured.load:
        return np.nan, np.nan
    depth = float(brentq(lambda z: force(z)[1] - measured.load, 1e-4, DEEPEST, xtol=1e-6))
    return depth, float(force(depth)[0])


def _with_history(medium: Law, bound: str, measured: Rolling, depth: float) -> Vector:
    """Forces x, y (N) on the wheel at a depth (m), after it has rolled for 0.12 m or turned once."""
    radius, width = BOUNDS[bound]
    angles = np.linspace(0.0, 2.0 * np.pi, CHORDS + 1)[:-1]
    circle = radius * np.column_stack([np.cos(angles), np.sin(angles)])
    load = GranularLoad(medium, 0.0, static=STEADY)
    load.add(outline(Body("wheel", [0, 1, 2]), circle, width, turns=np.full(CHORDS, 2 * np.pi / CHORDS), strips=CHORDS))
    rate = -measured.rim / radius
    end = max(0.12 / max(measured.forward, measured.rim), 2.0 * np.pi / abs(rate) if rate else 0.0)
    end = min(end, 0.12 / measured.forward)
    steps = 400
    v, q = np.array([measured.forward, 0.0, rate]), np.array([0.0, radius - depth, 0.0])
    load.start(q)
    for i in range(steps + 1):
        load.accept(i * end / steps, q + v * (i * end / steps), v)
    return load.force(q + v * end, v, np.zeros(3))[:2]


def relative(model: Sequence[float] | Vector, data: Sequence[float] | Vector) -> Vector:
    """Relative errors (n,) of a model."""
    return np.asarray(model) / np.asarray(data) - 1.0
