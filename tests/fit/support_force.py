"""Force tests made by a law of known coefficients, as the files that a user has."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from support_runs import CONFIGS

from granular_contact.config import load_scenario
from granular_contact.config.schema.fit import ForceTest
from granular_contact.sand.steady import SteadyBody
from granular_contact.scene import build
from granular_contact.studies.fit import Fit, fit, load_specification, prepare
from granular_contact.studies.fit.law_alone import Motion, steady_forces
from granular_contact.studies.fit.problem import Problem

Vector = NDArray[np.float64]
PLATE, DRAGGED = CONFIGS / "penetrometer.yaml", CONFIGS / "dragged_plate.yaml"
WIDTH = "model.bodies.plate.shapes.0.width_m"


def forces(config: Path, sets: Sequence[str], depth: Vector, speed: float | Vector = 1e-3, direction: float = 90.0):
    """Columns of a test by the law itself."""
    body = SteadyBody(build(load_scenario(config, list(sets))))
    speeds = np.broadcast_to(np.asarray(speed, float), depth.shape)
    return steady_forces(body, Motion(depth, speeds, np.zeros(len(depth)), direction))


def table(file: Path, head: str, *columns: Vector, noise: float = 0.0, seed: int = 0) -> Path:
    """CSV file of these columns, the last with noise."""
    values = [*columns[:-1], columns[-1] + noise * np.random.default_rng(seed).standard_normal(len(columns[-1]))]
    rows = [",".join(f"{x:.7g}" for x in row) for row in zip(*values, strict=True)]
    file.write_text("\n".join([head, *rows]) + "\n", encoding="utf-8")
    return file


def problem(folder: Path, text: str) -> Problem:
    """Problem of a fit file of this text, from one start unless it says otherwise."""
    path = folder / "fit.yaml"
    path.write_text(text if "starts:" in text else f"starts: 1\n{text}", encoding="utf-8")
    return prepare(load_specification(path))


def fitted(folder: Path, text: str) -> Fit:
    return fit(problem(folder, text))


def estimates_of(fit: Fit) -> dict[str, tuple[float, float]]:
    """Values and standard errors by label."""
    return {e.parameter.label: (e.value, e.error) for e in fit.uncertainty.estimates}


__all__ = ["DRAGGED", "PLATE", "WIDTH", "ForceTest", "estimates_of", "fitted", "forces", "problem", "table"]
