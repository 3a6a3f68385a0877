"""Falling, curling and thrown ropes, strips and wires, and vibrating rods: error by elements and its estimate.

The reference has three times as many elements as the finest run. The error is the greatest distance of the middle of
any element, or of the tip, from the reference. It is divided by the scale of the estimate: the path length or the
deflection.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from granular_contact import load
from granular_contact.mechanics.space.kinematics import SpatialKinematics
from granular_contact.run import run
from granular_contact.scene import build
from validation.tables import markdown

Vector = NDArray[np.float64]
Config = dict[str, Any]
ROPE = {"length_m": 0.4, "diameter_m": 0.006}
STRIP = {"length_m": 0.3, "width_m": 0.004, "thickness_m": 0.0004}
WIRE = {"length_m": 3.0, "diameter_m": 0.002}
HUB = {"type": "rigid", "mass_kg": 0.2, "inertia_kg_m2": dict.fromkeys(("xx", "yy", "zz"), 1e-4)}


@dataclass(frozen=True)
class Run:
    """Results of a run.

    time (n,) s; places (k, n, 3) m: middles of the elements and the tip, which is last; scale: length that errors are
    relative to, m; estimate: of the relative error; told: whether the run warned.
    """

    time: Vector
    places: Vector
    scale: float
    estimate: float
    told: bool


def _link(sides: Config, modulus: float, elements: int) -> Config:
    flexible = {"youngs_modulus_Pa": modulus, "elements": elements}
    return {"type": "link", **sides, "density_kg_m3": 1200, "flexible": flexible}


def _config(bodies: Config, joints: Config, end: float, **keys: Any) -> Config:
    model = {"in_space": True, "name": "curls", "bodies": bodies, "joints": joints}
    return {"model": model, "solver": {"end_time_s": end, "accuracy": 1e-3, "rest_time_s": None}, **keys}


def falling(link: Config, end: float, height: float | None = None) -> Config:
    """Config of a link that is clamped to a wall and released in the horizontal position; height: above sand, m."""
    wall = {"type": "weld", "parent": "ground", "child": "link", "rpy_deg": [20, 0, 0]}
    sand = {} if height is None else {"medium": "play_sand", "surface_height_m": -height}
    return _config({"link": link}, {"wall": wall}, end, **sand)


def thrown(link: Config, end: float) -> Config:
    """Config of a link that flies over sand, spins about two axes, and falls on the sand."""
    start = {"z_m": 0.1, "vx_m_s": 1.0, "spin_rad_s": [0, 8, 3]}
    scene = {"medium": "play_sand", "surface_height_m": 0.0, "initial": {"joints": {"flight": start}}}
    return _config({"link": link}, {"flight": {"type": "free", "parent": "ground", "child": "link"}}, end, **scene)


def swept(link: Config, end: float) -> Config:
    """Config of a link on a hub that rotates by 200 deg in 0.25 s about an inclined axis, and stops.

    A rope curls behind the hub and overtakes it.
    """
    joints = {
        "turn": {"type": "hinge", "parent": "ground", "child": "hub", "axis": [0, 1, 0.4]},
        "clamp": {"type": "weld", "parent": "hub", "child": "link"},
    }
    turn = {"type": "table", "time_s": [0.0, 0.25, 2.0], "values": [0.0, 200.0, 200.0]}
    return _config({"hub": HUB, "link": link}, joints, end, drives={"turn": {"type": "motion", "angle_deg": turn}})


CASES: dict[str, Callable[[int], Config]] = {
    "rope that falls": lambda n: falling(_link(ROPE, 2e6, n), 0.35),
    "soft rope that falls and curls": lambda n: falling(_link(ROPE, 2e5, n), 0.35),
    "rope that falls on sand": lambda n: falling(_link(ROPE, 2e6, n), 0.3, 0.15),
    "rope that lies on sand": lambda n: falling(_link(ROPE, 2e7, n), 0.05, 0.003),
    "rope that is thrown on sand": lambda n: thrown(_link(ROPE, 2e6, n), 0.25),
    "rope that is swept and curls": lambda n: swept(_link(ROPE, 2e7, n), 0.4),
    "rope that is swept and swings on": lambda n: swept(_link(ROPE, 2e7, n), 1.0),
    "rope that swings": lambda n: falling(_link(ROPE, 2e7, n), 1.5),
    "rod that vibrates twice": lambda n: falling(_link(ROPE, 2e9, n), 0.3),
    "rod that vibrates ten times": lambda n: falling(_link(ROPE, 2e9, n), 1.5),
    "rod that is swept and vibrates": lambda n: swept(_link(ROPE, 2e9, n), 1.0),
    "strip of 0.4 mm that falls": lambda n: falling(_link(STRIP, 2e8, n), 0.3),
    "wire, 1500 times as long as thick, that falls": lambda n: falling(_link(WIRE, 2e9, n), 0.8),
}


def found(config: Config) -> Run:
    """Run a config."""
    inspected: list[Run] = []

    def inspect(system: Any, trajectory: Any) -> None:
        motion = SpatialKinematics(system, trajectory)
        bent = motion.beams["link"]
        beam, bend = bent.beam, max(float(np.abs(angles).max()) for angles in motion.bends()["link"])
        body, origin, axes = beam.tip
        middles = [motion.position(name, at)[0] for name, at, _ in beam.pieces[1:-1]]
        places = np.array([*middles, motion.position(body, origin + axes[:, 0] * beam.length)[0]])
        scale = max(motion.path_length, motion.scene.least_path, bend)
        inspected[:] = [Run(trajectory.time, places, scale, bent.element_error() / scale, False)]

    scenario = load(config).scenario
    results = run(build(scenario), scenario, inspect=inspect)
    base = inspected[0]
    return Run(
        base.time, base.places, base.scale, base.estimate, any("too few elements" in w for w in results.warnings)
    )


def error(coarse: Run, fine: Run) -> float:
    """Relative error of a run: greatest distance of a place along the link from that in a finer run.

    The finer run has an odd multiple of the elements.
    """
    every = len(fine.places) // len(coarse.places)
    t = np.linspace(0.0, min(coarse.time[-1], fine.time[-1]), 600)
    computed, reference = (
        np.array([[np.interp(t, r.time, axis) for axis in place.T] for place in places])
        for r, places in ((coarse, coarse.places), (fine, fine.places[every - 1 :: every]))
    )
    return float(np.linalg.norm(computed - reference, axis=1).max()) / coarse.scale


def curled(counts: list[int], names: list[str]) -> tuple[str, float, tuple[float, float]]:
    """Run links that curl or vibrate with these numbers of elements.

    Returns the table, the greatest error of a run without a warning, and the least and greatest ratio of estimate to
    error.
    """
    rows, silent, ratios = [], 0.0, []
    for name in names:
        fine = found(CASES[name](3 * counts[-1]))
        for count in counts:
            coarse = found(CASES[name](count))
            error_of_run = error(coarse, fine)
            ratios.append(coarse.estimate / error_of_run)
            warning = "too few elements" if coarse.told else "nothing"
            rows.append([name, count, f"{error_of_run:.1e}", f"{coarse.estimate:.1e}", f"{ratios[-1]:.2f}", warning])
            silent = max(silent, 0.0 if coarse.told else error_of_run)
    caption = (
        "Links that curl or vibrate: error of the axis due to the elements, over the path length, and its estimate."
    )
    header = ["link", "elements", "error", "estimated", "estimate over error", "warning"]
    return f"{caption}\n\n{markdown(header, rows)}", silent, (min(ratios), max(ratios))
