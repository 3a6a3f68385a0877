"""Chains of hinged links that strike sand, for the studies of run time."""

from __future__ import annotations

import tempfile
from dataclasses import replace
from pathlib import Path
from typing import Any

import yaml

from granular_contact.config import load_scenario
from granular_contact.scene import Scene
from granular_contact.scene import build as build_scene

LENGTH = 0.2635  # m, from pivot to tip of the paper's pendulum
DIAMETER = 0.00635  # m
DENSITY = 7700.0  # kg/m3
STRIPS = 16  # along a chain of length LENGTH; each link has at least one
SOFT = 1e9  # Pa, Young's modulus of flexible links


def strips(links: int) -> int:
    """Number of strips on each link."""
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
    """Build a straight chain on a ground hinge that rotates into the sand, as `granular-contact run` does.

    length: of the whole chain, m; immersed: share of the chain that is in the sand at the start, 0: the tip touches;
    solver: keys of the config's section `solver`.
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
    """Scene with a higher surface; a config can't have it, as its runs must start above the sand."""
    assert scene.bed is not None
    profile = scene.bed.profile.copy()
    profile[:, 1] *= 1.0 - immersed
    return replace(scene, bed=replace(scene.bed, profile=profile))
