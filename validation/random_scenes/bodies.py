"""Random bodies and media, of the sizes of a table-top experiment."""

from __future__ import annotations

import math
from random import Random
from typing import Any

from validation.fuzzing.media import PRESETS, law

Tree = dict[str, Any]
DENSITIES = (7700.0, 2700.0, 1200.0)
# Shapes for each family of laws; `links` are round or flat bars.
SHAPES = {
    "bar": ("link", "cylinder", "arc", "polyline"),
    "plate": ("link", "cylinder", "arc", "polyline", "plate", "disc", "polygon", "foot"),
    "ball": ("sphere",),
}
STIFFNESS = (2e11, 7e10, 3e9, 3e8)  # Pa


def media(rng: Random, family: str) -> Any:
    """Draw media: mostly a preset, otherwise laws with random coefficients."""
    if rng.random() < 0.55:
        name = rng.choice(PRESETS[family])
        return name if name != "glass_beads_katsuragi_durian" else {"from": name}
    return law(rng, family) if rng.random() < 0.85 else [law(rng, family), law(rng, family)]


def section(rng: Random, family: str) -> Tree:
    """Draw the section of a bar: round, or flat if the law takes plates."""
    if family == "plate" and rng.random() < 0.5:
        return {"width_m": rng.uniform(0.015, 0.06), "thickness_m": rng.uniform(0.002, 0.006)}
    return {"diameter_m": rng.uniform(0.004, 0.014)}


def link(rng: Random, family: str, bends: float = 0.0, length: float | None = None) -> Tree:
    """Draw a straight link; bends: probability that it is flexible."""
    body: Tree = {"type": "link", "length_m": length or rng.uniform(0.08, 0.35), "density_kg_m3": rng.choice(DENSITIES)}
    body |= section(rng, family)
    if rng.random() < bends:
        flexible: Tree = {"youngs_modulus_Pa": rng.choice(STIFFNESS)}
        if rng.random() < 0.3:
            flexible["elements"] = rng.choice((2, 3, 8))
        if rng.random() < 0.3:
            flexible["bending_damping_N_m2_s"] = 10.0 ** rng.uniform(-5, -3)
        body["flexible"] = flexible
    return body


def rigid(rng: Random, family: str, kind: str | None = None) -> Tree:
    """Draw a rigid body of one shape or two, with a density or a given mass."""
    kind = kind or rng.choice([name for name in SHAPES[family] if name != "link"])
    shapes = [shape(rng, family, kind)]
    if rng.random() < 0.2:
        shapes.append(shape(rng, family, rng.choice([name for name in SHAPES[family] if name != "link"])))
    if rng.random() < 0.8:
        return {"type": "rigid", "density_kg_m3": rng.choice(DENSITIES), "shapes": shapes}
    mass = rng.uniform(0.05, 1.0)
    center = [rng.uniform(-0.01, 0.01), rng.uniform(-0.01, 0.01)]
    return {"type": "rigid", "mass_kg": mass, "inertia_kg_m2": mass * 0.05**2, "center_of_mass_m": center} | {
        "shapes": shapes
    }


def shape(rng: Random, family: str, kind: str) -> Tree:
    """Draw one shape about the origin of its body."""
    size = rng.uniform(0.03, 0.12)
    if kind in ("cylinder", "plate"):
        heading = rng.uniform(0.0, math.pi)
        end = [size * math.cos(heading), size * math.sin(heading)]
        config: Tree = {"type": kind, "start_m": [-end[0], -end[1]], "end_m": end}
        flat = {"width_m": rng.uniform(0.02, 0.08), "thickness_m": rng.uniform(0.002, 0.006)}
        return config | (flat if kind == "plate" else {"diameter_m": rng.uniform(0.005, 0.014)})
    if kind == "arc":
        start = rng.uniform(-180.0, 180.0)
        return {
            "type": kind,
            "radius_m": 0.6 * size,
            "from_deg": -start,
            "to_deg": -start - rng.uniform(60.0, 300.0),
        } | (section(rng, family))
    if kind == "polyline":
        corners = [[-size, 0.0], [0.0, rng.uniform(-0.5, 0.5) * size], [size, rng.uniform(-0.5, 0.5) * size]]
        return {"type": kind, "points_m": corners} | section(rng, family)
    if kind == "disc":
        return {"type": kind, "diameter_m": size, "thickness_m": rng.uniform(0.01, 0.06)}
    if kind == "sphere":
        center = [rng.uniform(-0.02, 0.02), rng.uniform(-0.02, 0.02)] if rng.random() < 0.3 else [0.0, 0.0]
        return {"type": kind, "diameter_m": 0.6 * size, "center_m": center}
    if kind == "polygon":
        turns = sorted(rng.uniform(0.0, 2.0 * math.pi) for _ in range(rng.randint(3, 6)))
        if max(b - a for a, b in zip(turns, [*turns[1:], turns[0] + 2.0 * math.pi], strict=True)) > 3.0:
            turns = [0.3, 1.9, 3.6, 5.2]
        corners = [[0.5 * size * math.cos(a), 0.5 * size * math.sin(a)] for a in turns]
        return {"type": kind, "points_m": corners, "width_m": rng.uniform(0.02, 0.08)}
    height = rng.uniform(0.008, 0.025)
    return {"type": kind, "length_m": height * rng.uniform(1.5, 5.0), "height_m": height} | {
        "width_m": rng.uniform(0.02, 0.06),
        "tilt_deg": rng.choice((0.0, -rng.uniform(-30.0, 30.0))),
    }
