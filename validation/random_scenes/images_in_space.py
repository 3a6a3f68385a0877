"""Other forms of a scene in space, as in `images`: mirrored in the x-z plane, rotated about a vertical, moved away."""

from __future__ import annotations

import copy
import math
from typing import Any

import numpy as np

from granular_contact.geometry import rotations
from validation.random_scenes.images import GROUND, NoImage, Tree

AWAY = (800.0, 600.0, 300.0)  # m
TURN = 40.0  # deg, rotation about the vertical; 90 for scenes with a height map
POLAR, AXIAL = (
    np.array([1.0, -1.0, 1.0]),
    np.array([-1.0, 1.0, -1.0]),
)  # signs in a mirror image of polar and axial vectors
PLACES = ("center_m", "start_m", "end_m", "center_of_mass_m", "parent_point_m", "child_point_m")


def mirrored(tree: Tree) -> Tree:
    """Mirror image of a scene: every frame is mirrored, so that symmetric shapes keep their place in the frame."""
    tree = copy.deepcopy(tree)
    model = tree["model"]
    for body in model["bodies"].values():
        _mirror(body)
        for shape in body.get("shapes", []):
            _mirror(shape)
            if shape["type"] == "bar":
                shape["points_m"] = [_times(point, POLAR) for point in shape["points_m"]]
            if shape["type"] == "mesh":
                shape["scale"] = _times(shape["scale"], POLAR)
    for joint in model["joints"].values():
        _mirror(joint)
        if "axis" in joint:
            joint["axis"] = _times(joint["axis"], POLAR if joint["type"] == "slider" else AXIAL)
    for start in tree["initial"]["joints"].values():
        _mirror(start)
        if "spin_rad_s" in start:
            start["spin_rad_s"] = _times(start["spin_rad_s"], AXIAL)
        for key in ("y_m", "vy_m_s"):
            if key in start:
                start[key] *= -1.0
    bed = tree["bed"]
    if "slope_direction_deg" in bed:
        bed["slope_direction_deg"] *= -1.0
    if "height_map" in bed:
        height_map, values = bed["height_map"], _heights(tree)
        height_map["corner_m"] = [
            height_map["corner_m"][0],
            -height_map["corner_m"][1] - height_map["cell_m"] * (len(values) - 1),
        ]
        _lay(tree, values[::-1])
    return tree


def _times(point: list[float], factors: Any) -> list[float]:
    return [a * float(b) for a, b in zip(point, factors, strict=True)]


def _mirror(part: Tree) -> None:
    """Mirror the positions and orientations of a body, a shape, a joint or a start."""
    for key in PLACES:
        if key in part:
            part[key] = _times(part[key], POLAR)
    if "quaternion" in part:
        w, *axis = part["quaternion"]
        part["quaternion"] = [w, *_times(axis, AXIAL)]
    if "rpy_deg" in part:
        part["rpy_deg"] = _times(part["rpy_deg"], AXIAL)


def _heights(tree: Tree) -> list[list[str]]:
    return [line.split(",") for line in tree["files"][tree["bed"]["height_map"]["file"]].splitlines()]


def _lay(tree: Tree, values: list[list[str]]) -> None:
    tree["files"][tree["bed"]["height_map"]["file"]] = "\n".join(",".join(row) for row in values)


def turned(tree: Tree) -> Tree:
    """Scene rotated about the vertical through the origin, counter-clockwise seen from above."""
    tree = copy.deepcopy(tree)
    angle = 90.0 if "height_map" in tree["bed"] else TURN
    tree["aside"] = tree.get("aside", {}) | {"turned_deg": angle}
    R = rotations.of_rpy([0.0, 0.0, math.radians(angle)])
    starts = tree["initial"]["joints"]
    for name, joint in tree["model"]["joints"].items():
        if joint["parent"] != GROUND:
            continue
        if "parent_point_m" in joint:
            joint["parent_point_m"] = (R @ joint["parent_point_m"]).tolist()
        _turn(joint, R)
        start = starts.setdefault(name, {}) if joint["type"] == "free" else starts.get(name, {})
        if joint["type"] in ("free", "ball") and start:
            _turn(start, R)
        for keys in (("x_m", "y_m", "z_m"), ("vx_m_s", "vy_m_s", "vz_m_s")):
            if any(key in start for key in keys):
                place = R @ [start.get(key, 0.0) for key in keys]
                start |= dict(zip(keys, place.tolist(), strict=True))
        if "spin_rad_s" in start:
            start["spin_rad_s"] = (R @ start["spin_rad_s"]).tolist()
    bed = tree["bed"]
    if "slope_direction_deg" in bed:
        bed["slope_direction_deg"] += angle
    if "height_map" in bed:
        height_map, values = bed["height_map"], _heights(tree)
        x, y = height_map["corner_m"]
        height_map["corner_m"] = [-y - height_map["cell_m"] * (len(values) - 1), x]
        _lay(tree, [[row[i] for row in values[::-1]] for i in range(len(values[0]))])
    return tree


def _turn(part: Tree, R: Any) -> None:
    orientation = np.eye(3)
    if "rpy_deg" in part:
        orientation = rotations.of_rpy(np.radians(part.pop("rpy_deg")))
    if "quaternion" in part:
        orientation = rotations.of_quaternion(part["quaternion"])
    part["quaternion"] = rotations.quaternion_of(R @ orientation).tolist()


def shifted(tree: Tree) -> Tree:
    """Scene moved by 1 km; raises NoImage."""
    tree = copy.deepcopy(tree)
    bed = tree["bed"]
    if "depth_m" in bed and ("slope_deg" in bed or "height_map" in bed):
        raise NoImage("the floor hangs on the surface at the origin")
    for joint in tree["model"]["joints"].values():
        if joint["parent"] == GROUND:
            at = joint.get("parent_point_m", [0.0, 0.0, 0.0])
            joint["parent_point_m"] = [a + b for a, b in zip(at, AWAY, strict=True)]
    bed["height_m"] += AWAY[2]
    if "slope_deg" in bed:
        toward = math.radians(bed["slope_direction_deg"])
        along = AWAY[0] * math.cos(toward) + AWAY[1] * math.sin(toward)
        bed["height_m"] -= along * math.tan(math.radians(bed["slope_deg"]))
    if "height_map" in bed:
        height_map = bed["height_map"]
        height_map["corner_m"] = [a + b for a, b in zip(height_map["corner_m"], AWAY, strict=False)]
    return tree


def finer(tree: Tree, share: float) -> Tree:
    """Scene with facets of a fraction of the size that `scenes.solve_and_keep` has recorded."""
    aside = tree["aside"]
    return tree | {"aside": aside | {"facets": {body: share * size for body, size in aside["facets"].items()}}}
