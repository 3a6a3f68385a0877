"""A medium of any law with numbers made from the keys of its coefficients, and bodies that it takes."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from granular_contact.laws.coefficients import Coefficients
from granular_contact.laws.law import METADATA, Law
from granular_contact.laws.probe import Probe, ball, force, plate
from granular_contact.laws.rft import GENERIC
from granular_contact.laws.table import StressTable

Array = NDArray[np.float64]

# By the unit at the end of a key: the exponents of mass, length and time, and a number of the size met in sand.
UNITS: dict[str, tuple[tuple[int, int, int], float]] = {
    "_kg_m3": ((1, -3, 0), 1600.0),
    "_N_cm3": ((1, -2, -2), 0.1),
    "_N_m3": ((1, -2, -2), 1e5),
    "_N_m2": ((1, -1, -2), 4000.0),
    "_Pa": ((1, -1, -2), 4000.0),
    "_N_s_m": ((1, 0, -1), 2.0),
    "_N_m": ((1, 0, -2), 90.0),
    "_kg_m": ((1, -1, 0), 0.7),
    "_N": ((1, 1, -2), 3.0),
    "_s_m": ((0, -1, 1), 0.5),
    "_m_s": ((0, 1, -1), 0.3),
    "_s": ((0, 0, 1), 0.01),
    "_m": ((0, 1, 0), 0.02),
}
NONE = (0, 0, 0)
# Of two lengths one has to be given; what has a default is to count, too.
SHEAR = {"cohesion": 300.0, "shear_deformation_modulus": 0.02, "plate_width": 0.03}
MORE: dict[str, dict[str, float]] = {
    "katsuragi_durian": {"drag_length": 0.09},
    "pressure_sinkage": {"k_c": 90.0, "reference_depth": 0.02, **SHEAR},
    "reece": {"k_c_prime": 3.0, **SHEAR},
}
WITHOUT_UNIT = 1.3


def unit(key: str) -> tuple[tuple[int, int, int], float]:
    return next((held for end, held in UNITS.items() if key.endswith(end)), (NONE, WITHOUT_UNIT))


def sample(law: type[Coefficients], scale: tuple[float, float, float] = (1.0, 1.0, 1.0)) -> Any:
    """A medium of a law; scale: by how much the units of mass, length and time are smaller."""
    given = {}
    if law is StressTable:
        return table(law, scale)
    for name, field in law.model_fields.items():
        kind, more = field.annotation, MORE.get(law.tag(), {}) if issubclass(law, Law) else {}
        powers, size = unit(field.alias or name)
        factor = math.prod(s**p for s, p in zip(scale, powers, strict=True))
        if name in (*METADATA, "law"):
            continue
        if isinstance(field.default, Coefficients):  # a set of numbers of one unit
            given[name] = kind(**{key: factor * value for key, value in dict(field.default).items()})
        elif isinstance(kind, type) and issubclass(kind, Coefficients) and field.is_required():
            given[name] = sample(kind, scale)
        elif field.is_required() or name in more:
            given[name] = factor * more.get(name, size)
    return law(**given)


def table(law: type[Coefficients], scale: tuple[float, float, float]) -> Any:
    """The generic set of resistive force theory as a table, times (1 + z / 0.1 m)."""
    mass, length, time = scale
    depth, beta, gamma = (0.01, 0.03, 0.08), range(-90, 91, 30), range(-90, 91, 18)
    of_x, of_z = [], []
    for z in depth:
        for b in beta:
            for g in gamma:
                x, up = rft(b, g)
                factor = 1e5 * z * (1.0 + z / 0.1) * mass / length / time**2
                of_x.append(factor * x)
                of_z.append(factor * up)
    angles = [tuple(map(float, pair)) for pair in (beta, gamma)]
    return law(tuple(length * z for z in depth), *angles, tuple(of_x), tuple(of_z))


def rft(beta: float, gamma: float) -> tuple[float, float]:
    """alpha_x, alpha_z (N/cm3) of the generic set at angles in degrees."""
    b, g, c = math.radians(beta), math.radians(gamma), GENERIC
    x = c.C11 * math.cos(2 * b + g) + c.C01 * math.cos(g) + c.C_11 * math.cos(-2 * b + g) + c.D10 * math.sin(2 * b)
    z = c.A00 + c.A10 * math.cos(2 * b) + c.B11 * math.sin(2 * b + g) + c.B01 * math.sin(g)
    return x, z + c.B_11 * math.sin(-2 * b + g)


def bodies(medium: Law, depth: float, scale: float = 1.0, mass: float = 1.0) -> list[Probe]:
    """Bodies whose lowest point is at a depth (m), sizes times scale; balls of a density of steel times mass / scale^3.

    Slanting, so that each gets in little by little.
    """
    if "ball" in medium.takes:
        return [ball(depth, 0.025 * scale, 7700.0 * mass / scale**3)]
    size, probes = 0.03 * scale, []
    for beta in (35.0, -60.0):
        flat = plate(0.0, beta, size)
        probes.append(Probe(flat.points - np.array([0.0, depth + flat.points[:, 1].min()]), size))
    return probes


def motions(count: int = 12) -> Array:
    """Velocities (n, 2) m/s all around, at speeds from slow to fast."""
    angles = np.linspace(0.1, 0.1 + 2 * np.pi, count, endpoint=False)
    return np.geomspace(0.01, 2.0, count)[:, None] * np.column_stack([np.cos(angles), np.sin(angles)])


def total(medium: Law, body: Probe, velocity: Array) -> Array:
    return force(medium, body, velocity).sum(axis=0)
