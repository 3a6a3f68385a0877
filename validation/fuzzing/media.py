"""Random media: every law of the schema with admissible coefficients, and the presets."""

from __future__ import annotations

import math
from collections.abc import Callable
from random import Random
from typing import Any

from granular_contact.laws import catalogue

Tree = dict[str, Any]


def _family(takes: frozenset[str]) -> str:
    """Family of shapes for which a law is drawn."""
    return "ball" if "ball" in takes else "plate" if "flat" in takes else "bar"


FAMILIES = {
    family: tuple(tag for tag, law in catalogue.LAWS.items() if _family(law.takes) == family)
    for family in ("bar", "plate", "ball")
}
PRESETS = {
    "bar": ("play_sand", "hill_cylinders"),
    "plate": ("rft_generic", "rft3d_sand", "poppy_seeds_loose", "poppy_seeds_close", "glass_beads_3mm"),
    "ball": ("glass_beads_katsuragi_durian",),
}


def media_for(rng: Random, family: str) -> Any:
    """Draw a preset, a law, or a list of several."""
    if rng.random() < 0.15:
        return rng.choice(PRESETS[family])
    if rng.random() < 0.1:
        return [law(rng, family) for _ in range(rng.randint(1, 3))]
    return law(rng, family)


def law(rng: Random, family: str) -> Tree:
    """Draw one law for a family of shapes."""
    name = rng.choice(FAMILIES[family])
    return {"law": name} | numbers(rng, name)


def numbers(rng: Random, tag: str) -> Tree:
    """Draw coefficients of a law; for laws without a line below: the required ones, within their bounds."""
    if tag in LAWS:
        return LAWS[tag](rng)
    schema = catalogue.LAWS[tag].model_json_schema()
    return {key: _within(rng, schema["properties"][key]) for key in schema["required"] if key != "law"}


def _within(rng: Random, bounds: Tree) -> float:
    """Draw a number within the bounds of a schema; over five decades if the bounds are open."""
    low = float(bounds.get("minimum", bounds.get("exclusiveMinimum", 0.0)))
    high = bounds.get("maximum", bounds.get("exclusiveMaximum"))
    return low + 10.0 ** rng.uniform(-2, 3) if high is None else low + (high - low) * rng.uniform(0.05, 0.95)


def _some(rng: Random, high: float) -> float:
    """Draw a coefficient over five decades up to `high`, and sometimes 0."""
    return 0.0 if rng.random() < 0.1 else high * 10.0 ** rng.uniform(-5, 0)


def _vertical(rng: Random) -> Tree:
    return {"eta_v": _some(rng, 100.0), "lambda": rng.choice((0.0, 1.0, 5.0, rng.uniform(0.0, 3.0)))}


def _density(rng: Random) -> Tree:
    return {"density_kg_m3": rng.uniform(500.0, 4000.0)}


def _lee_marghitu(rng: Random) -> Tree:
    optional = {"withdrawing": _vertical(rng)} if rng.random() < 0.5 else {}
    return _density(rng) | {"eta_d": _some(rng, 30), "eta_h": _some(rng, 30), "plunging": _vertical(rng)} | optional


def _rft(rng: Random) -> Tree:
    """Draw a scaled generic set, as not every set of coefficients resists in every direction."""
    return {"zeta": rng.uniform(0.05, 3.0)}


def _shear(rng: Random) -> Tree:
    optional = {
        "cohesion_Pa": _some(rng, 1e4),
        "shear_deformation_modulus_m": _some(rng, 0.1),
        "plate_width_m": rng.uniform(0.01, 0.2),
    }
    selected = {key: value for key, value in optional.items() if rng.random() < 0.5}
    return {
        "exponent": rng.uniform(0.5, 2.5),
        "friction_angle_deg": rng.choice((0.0, rng.uniform(0.0, 60.0))),
    } | selected


def _table(rng: Random) -> Tree:
    """Draw a table over depth and angle: resistance against the motion, and a smaller force across it."""
    depth = sorted({round(rng.uniform(0.001, 0.2), 4) for _ in range(rng.randint(1, 3))})
    beta = [-90.0, *sorted({float(rng.randint(-80, 80)) for _ in range(rng.randint(0, 3))}), 90.0]
    gamma = [-90.0, *sorted({float(rng.randint(-80, 80)) for _ in range(rng.randint(1, 4))}), 90.0]
    of_x, of_z = [], []
    for z in depth:
        for _ in beta:
            for g in map(math.radians, gamma):
                along, beside = rng.uniform(0.0, 1e6) * z, rng.uniform(-1e5, 1e5) * z
                of_x.append(along * math.cos(g) + beside * math.sin(g))
                of_z.append(along * math.sin(g) - beside * math.cos(g))
    return {"depth_m": depth, "beta_deg": beta, "gamma_deg": gamma, "stress_x_Pa": of_x, "stress_z_Pa": of_z}


# Laws with their own functions for drawing coefficients.
LAWS: dict[str, Callable[[Random], Tree]] = {
    "lee_marghitu": _lee_marghitu,
    "albert": lambda rng: _density(rng) | {"eta_h": _some(rng, 30)},
    "hill": lambda rng: _density(rng)
    | {"plunging": _vertical(rng), "withdrawing": _vertical(rng)}
    | ({"length_scale_m": rng.uniform(0.001, 0.1)} if rng.random() < 0.5 else {}),
    "rft": _rft,
    "drft": lambda rng: _rft(rng)
    | _density(rng)
    | {"lambda": _some(rng, 5), "surface_drop_m": rng.choice((0.0, rng.uniform(0, 0.05)))},
    "rft3d": lambda rng: _density(rng) | {"mu_int": rng.uniform(0.1, 1.5), "mu_surf": _some(rng, 1.5)},
    "pressure_sinkage": lambda rng: _shear(rng)
    | {"k_phi_Pa": _some(rng, 1e6), "k_c_N_m": _some(rng, 1e4), "reference_depth_m": 10.0 ** rng.uniform(-2, 0)},
    "reece": lambda rng: _shear(rng) | _density(rng) | {"k_phi_prime": _some(rng, 100), "k_c_prime": _some(rng, 100)},
    "table": _table,
    "bingham": lambda rng: {"yield_force_N": _some(rng, 50), "viscosity_N_s_m": _some(rng, 50)},
    "poncelet": lambda rng: {"constant_force_N": _some(rng, 50), "drag_kg_m": _some(rng, 50)},
    "allen": lambda rng: {
        "drag_kg_m": _some(rng, 50), "viscosity_N_s_m": _some(rng, 50), "constant_force_N": _some(rng, 50)
    },
    "linear_depth": lambda rng: {"stiffness_N_m": _some(rng, 1e4)},
    "tsimring_volfson": lambda rng: {
        "drag_kg_m": _some(rng, 50), "friction_N": _some(rng, 1e3),
        "exponent": rng.choice((1.0, 5.0, rng.uniform(0.1, 3))),
    },
    "katsuragi_durian": lambda rng: {"stiffness_N_m": _some(rng, 1e4)}
    | rng.choice(({"drag_length_m": rng.uniform(0.01, 1)}, {"drag_length_diameters": rng.uniform(0.5, 10)})),
}  # fmt: skip
