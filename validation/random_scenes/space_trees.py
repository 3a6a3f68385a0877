"""Random trees of rigid bodies in space, over sand or in vacuum, as configs."""

from __future__ import annotations

from typing import Any

import numpy as np

SHAPES = ("box", "sphere", "rod")
FIRST, KINDS = (
    ("free", "hinge", "ball"),
    ("hinge", "ball", "slider"),
)  # kinds of the joint on the ground, and of other joints


def shape(rng: np.random.Generator) -> dict[str, Any]:
    kind = rng.choice(SHAPES)
    if kind == "sphere":
        return {"type": "sphere", "diameter_m": rng.uniform(0.03, 0.06), "facet_size_m": 0.02}
    size = [0.1, 0.015, 0.015] if kind == "rod" else rng.uniform(0.02, 0.08, 3).tolist()
    return {"type": "box", "size_m": size, "center_m": rng.uniform(-0.02, 0.02, 3).tolist(), "facet_size_m": 0.03}


def law(rng: np.random.Generator, kind: str) -> dict[str, Any]:
    """Draw the forces in a joint; all joints have damping, so that no joint swings for ever."""
    if kind == "slider":
        spring = {"stiffness_N_per_m": rng.uniform(50.0, 300.0), "rest_m": 0.0}
        return {"spring": spring, "damping_N_s_per_m": rng.uniform(0.05, 0.5)}
    forces: dict[str, Any] = {"damping_Nm_s_per_rad": rng.uniform(1e-4, 2e-3)}
    choice = rng.integers(4)
    if choice == 0:
        forces["spring"] = {"stiffness_Nm_per_rad": rng.uniform(0.05, 0.5)}
    elif choice == 1:
        forces["stops"] = {"upper_deg": 40, "stiffness_Nm_per_rad": 10, "dissipation_s_per_rad": 0.1}
        forces["stops"] |= {"lower_deg": -30} if kind == "hinge" else {}
    elif choice == 2 and kind == "hinge":
        forces["friction"] = {"torque_Nm": rng.uniform(1e-3, 2e-2)}
    return forces


def start(rng: np.random.Generator, kind: str) -> dict[str, Any]:
    if kind == "hinge":
        return {"angle_deg": rng.uniform(-25, 25), "rate_rad_s": rng.uniform(-5, 5)}
    if kind == "slider":
        return {"position_m": 0.0, "speed_m_s": rng.uniform(-0.2, 0.2)}
    state: dict[str, Any] = {"spin_rad_s": rng.uniform(-6, 6, 3).tolist()}
    if kind == "free":
        place = dict(
            zip(("z_m", "vx_m_s", "vy_m_s", "vz_m_s"), rng.uniform([0.1, -1, -1, -2], [0.16, 1, 1, 0]), strict=True)
        )
        state |= {"rpy_deg": rng.uniform(-180, 180, 3).tolist()} | {key: float(value) for key, value in place.items()}
    return state


def random_tree(seed: int) -> dict[str, Any]:
    """Config of a random tree of up to five bodies on joints of all kinds; some hinges have a prescribed motion."""
    rng = np.random.default_rng(seed)
    bodies, joints, starts, drives = {}, {}, {}, {}
    for i in range(rng.integers(1, 6)):
        bodies[f"b{i}"] = {"type": "rigid", "density_kg_m3": rng.uniform(800, 4000), "shapes": [shape(rng)]}
        kinds, shares = (
            (("hinge", "ball", "slider"), (0.55, 0.25, 0.2)) if i else (("free", "hinge", "ball"), (0.7, 0.15, 0.15))
        )
        kind, parent = str(rng.choice(kinds, p=shares)), f"b{rng.integers(i)}" if i else "ground"
        joint: dict[str, Any] = {"type": kind, "parent": parent, "child": f"b{i}"}
        if kind != "free":
            joint |= {"rpy_deg": rng.uniform(-180, 180, 3).tolist()} | law(rng, kind)
            joint |= {f"{end}_point_m": rng.uniform(-0.05, 0.05, 3).tolist() for end in ("parent", "child")}
        if kind in ("hinge", "slider"):
            joint["axis"] = rng.normal(size=3).tolist()
        if kind == "hinge" and i and rng.random() < 0.25:
            wave = {"type": "sine", "amplitude": rng.uniform(5, 25), "frequency_Hz": rng.uniform(1, 4)}
            drives[f"j{i}"] = {"type": "motion", "angle_deg": wave}
        else:
            starts[f"j{i}"] = start(rng, kind)
        joints[f"j{i}"] = joint
    free = joints["j0"]["type"] == "free"
    sand = (
        {"medium": "rft3d_sand", "bed": {"height_m": 0.0 if free else -0.1}} if rng.random() < 0.8 else {"medium": None}
    )
    return {
        "model": {"name": f"tree {seed}", "in_space": True, "bodies": bodies, "joints": joints},
        "initial": {"joints": starts},
        "drives": drives,
        "solver": {"end_time_s": 0.3, "accuracy": 1e-3, "rest_time_s": None},
    } | sand
