"""Chains of hinged links that strike sand, as the studies on speed need them."""

from __future__ import annotations

import tempfile
from dataclasses import replace
from pathlib import Path
from typing import Any

import yaml

from granular_contact.config import load_scenario
from granular_contact.scene import Scene
from granular_contact.scene import build as build_scene

LENGTH = 0.2635  # m, the reach of the paper's pendulum
DIAMETER = 0.00635  # m
DENSITY = 7700.0  # kg/m3
STRIPS = 16  # along a chain of that length, at least one on each link
SOFT = 1e9  # Pa, Young's modulus of the links that bend


def strips(links: int) -> int:
    """Strips on each link."""
    return max(1, STRIPS // links)


def chain(
    links: int,
    angle_deg: float = 31.0,
    rate_rad_s: float = 6.24,
    *,
    length: float = LENGTH,
    strips_per_link: int | None = None,
    flexible: bool = False,
    immersed: float = 0.0,
    medium: str | None = "play_sand",
    method: Any = "engine",
    **solver: Any,
) -> Scene:
    """Straight chain on a ground hinge that turns into the sand, as in `granular-contact run`; length (m) of all of it.

    immersed: share of the chain that is in the sand already at the start; 0: its tip touches. solver: keys of the
    config's `solver`.
    """
    link: dict[str, Any] = {"length_m": length / links, "diameter_m": DIAMETER, "density_kg_m3": DENSITY}
    if flexible:
        link["flexible"] = {"youngs_modulus_Pa": SOFT, "elements": 1}
    count = strips_per_link or strips(links)
    config = {
        "model": {"name": f"chain_{links}", "chain": {"count": links, "link": link}},
        "medium": medium,
        "initial": {"impact_angle_deg": angle_deg, "impact_speed_rad_s": rate_rad_s},
        "load": {"strips_per_rigid_part": count, "strips_per_element": count},
        "solver": {"rest_time_s": None} | solver,
        "method": method,
    }
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "chain.yaml"
        path.write_text(yaml.safe_dump(config), encoding="utf-8")
        scene = build_scene(load_scenario(path))
    return scene if immersed == 0.0 else _sunk(scene, immersed)


def _sunk(scene: Scene, immersed: float) -> Scene:
    """The scene with its surface higher up, which a config refuses: there a run starts above the sand."""
    assert scene.bed is not None
    profile = scene.bed.profile.copy()
    profile[:, 1] *= 1.0 - immersed
    return replace(scene, bed=replace(scene.bed, profile=profile))
