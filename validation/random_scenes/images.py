"""Other forms of the same scene: mirrored in x, moved away, with its parts in another order, computed more finely."""

from __future__ import annotations

import copy
import math
from collections.abc import Callable
from typing import Any

from granular_contact.config.schema.scenario import Load

Tree = dict[str, Any]
GROUND = "ground"
AWAY = (800.0, 600.0)  # m
STEP = 2e-4  # s, step of runs that name none


class NoImage(Exception):
    """The scene has no such form: it has a clock that runs in one direction only, or no parts to reorder."""


# ---- mirror image in x ----
# The mirror image of a frame at the angle a has the angle pi - a and a reversed y axis. So points (x, y) of a body
# become (x, -y), angles between bodies change their sign, and an angle a to the ground becomes 180 degrees - a.


def mirrored(tree: Tree) -> Tree:
    """Mirror image of a scene; raises NoImage."""
    tree = copy.deepcopy(tree)
    model = tree["model"]
    for body in model["bodies"].values():
        _mirror_body(body)
    turns = {}
    for name, joint in (model["joints"] | model.get("closures", {})).items():
        _mirror_joint(joint)
        turns[name] = 180.0 if joint["parent"] == GROUND else 0.0
    for name, start in tree["initial"].get("joints", {}).items():
        _mirror_start(start, turns[name], model["joints"][name]["type"])
    shared = tree.pop("signals", {})
    for name, drive in tree.get("drives", {}).items():
        _mirror_drive(drive, turns[name], shared, tree.get("files", {}))
    _mirror_bed(tree.get("bed", {}))
    return tree


def _flip(point: list[float]) -> list[float]:
    return [point[0], -point[1]]


def _mirror_body(body: Tree) -> None:
    if "center_of_mass_m" in body:
        body["center_of_mass_m"] = _flip(body["center_of_mass_m"])
    for shape in body.get("shapes", []):
        for key in ("start_m", "end_m", "center_m"):
            if key in shape:
                shape[key] = _flip(shape[key])
        if "points_m" in shape:
            shape["points_m"] = [_flip(point) for point in shape["points_m"]]
        for key in ("from_deg", "to_deg", "tilt_deg"):
            if key in shape:
                shape[key] = -shape[key]


def _mirror_joint(joint: Tree) -> None:
    on_ground = joint["parent"] == GROUND
    turn = 180.0 if on_ground else 0.0
    if "parent_point_m" in joint:
        x, y = joint["parent_point_m"]
        joint["parent_point_m"] = [-x, y] if on_ground else [x, -y]
    if "child_point_m" in joint:
        joint["child_point_m"] = _flip(joint["child_point_m"])
    if joint["type"] == "hinge":
        if "home_deg" in joint or on_ground:
            joint["home_deg"] = turn - joint.get("home_deg", 0.0)
        if "spring" in joint:
            joint["spring"]["rest_deg"] = turn - joint["spring"].get("rest_deg", 0.0)
        if "stops" in joint:
            stops = joint["stops"]
            stops["lower_deg"], stops["upper_deg"] = turn - stops["upper_deg"], turn - stops["lower_deg"]
    elif joint["type"] != "free":
        joint["home_deg"] = turn - joint.get("home_deg", 0.0)
        if joint["type"] == "slider":
            x, y = joint.get("axis", (1.0, 0.0))
            joint["axis"] = [-x, y] if on_ground else [x, -y]


def _mirror_start(start: Tree, turn: float, kind: str) -> None:
    if "angle_deg" in start or kind == "free":
        start["angle_deg"] = turn - start.get("angle_deg", 0.0)
    for key in ("rate_rad_s", "x_m", "vx_m_s"):
        if key in start:
            start[key] = -start[key]


def _mirror_drive(drive: Tree, turn: float, shared: Tree, files: Tree) -> None:
    for key, offset in (("angle_deg", turn), ("rate_rad_s", 0.0), ("torque_Nm", 0.0)):
        if key in drive:
            drive[key] = _opposite(_own(drive[key], shared), offset, files)
    for key in ("position_m", "speed_m_s", "force_N"):
        if key in drive:
            drive[key] = _own(drive[key], shared)


def _own(signal: Any, shared: Tree) -> Any:
    """Signal of a drive, with a shared signal (sines only) written out."""
    if not isinstance(signal, dict) or signal["type"] != "shared":
        return signal
    return shared[signal["name"]] | {"phase_deg": signal.get("phase_deg", 0.0)}


def _opposite(signal: Any, offset: float, files: Tree) -> Any:
    """Signal with the value `offset` minus a signal."""
    if not isinstance(signal, dict):
        return offset - signal
    kind, signal = signal["type"], dict(signal)
    if kind == "sine":
        signal |= {"amplitude": -signal["amplitude"], "offset": offset - signal.get("offset", 0.0)}
    elif kind == "ramp":
        signal |= {"from": offset - signal["from"], "to": offset - signal["to"]}
    elif kind == "table":
        signal["values"] = [offset - value for value in signal["values"]]
    elif kind == "csv":
        column = files[signal["file"]]
        column[signal["column"]] = [offset - value for value in column[signal["column"]]]
    else:
        raise NoImage(f"a {kind} clock turns one way")
    return signal


def _mirror_bed(bed: Tree) -> None:
    if "slope_deg" in bed:
        bed["slope_deg"] = -bed["slope_deg"]
    if "profile_m" in bed:
        bed["profile_m"] = [[-x, y] for x, y in reversed(bed["profile_m"])]


# ---- elsewhere ----


def shifted(tree: Tree) -> Tree:
    """Scene moved by 1 km."""
    tree = copy.deepcopy(tree)
    x, y = AWAY
    joints = tree["model"]["joints"] | tree["model"].get("closures", {})
    for joint in joints.values():
        if joint["parent"] == GROUND:
            at = joint.get("parent_point_m", [0.0, 0.0])
            joint["parent_point_m"] = [at[0] + x, at[1] + y]
    bed = tree["bed"]
    if "height_m" in bed:
        bed["height_m"] += y - x * math.tan(math.radians(bed.get("slope_deg", 0.0)))
    if "profile_m" in bed:
        bed["profile_m"] = [[a + x, b + y] for a, b in bed["profile_m"]]
    if "depth_m" in bed:  # the depth is that at x = 0
        bed["depth_m"] -= x * math.tan(math.radians(bed.get("slope_deg", 0.0)))
        if bed["depth_m"] <= 0.0 or "profile_m" in bed:
            raise NoImage("the floor hangs on the surface at x = 0")
    return tree


def reordered(tree: Tree) -> Tree:
    """Scene with bodies, joints, drives and the shapes of each body in reverse order; raises NoImage."""
    tree = copy.deepcopy(tree)
    model = tree["model"]
    if len(model["bodies"]) == 1 and all(len(body.get("shapes", [])) < 2 for body in model["bodies"].values()):
        raise NoImage("one part alone")
    for holder, key in ((model, "bodies"), (model, "joints"), (tree, "drives")):
        if key in holder:
            holder[key] = dict(reversed(holder[key].items()))
    for body in model["bodies"].values():
        if "shapes" in body:
            body["shapes"] = body["shapes"][::-1]
    return tree


# ---- more finely ----


def is_reduced(tree: Tree) -> bool:
    """Whether a scene is solved by a reduced model."""
    return isinstance(tree.get("method"), dict)


def finer(tree: Tree, factor: float) -> Tree:
    """Scene with fixed steps: its step, or STEP if it names none, divided by a factor.

    A reduced model gets a relative tolerance of 1e-6 over the square of the factor instead.
    """
    tree = copy.deepcopy(tree)
    solver = tree["solver"]
    if is_reduced(tree):
        tree["method"]["reduced"]["rtol"] = 1e-6 / factor**2
    else:
        solver["step_s"] = solver.get("step_s", STEP) / factor
        solver.pop("accuracy", None)
    return tree


def chosen(tree: Tree) -> Tree:
    """Scene with adaptive steps if they were fixed, and the other way round; raises NoImage."""
    tree = copy.deepcopy(tree)
    if is_reduced(tree):
        raise NoImage("a reduced model chooses its steps by itself")
    if tree["solver"].pop("accuracy", None) is None:
        tree["solver"]["accuracy"] = 1e-3
    else:
        tree["solver"].setdefault("step_s", STEP)
    return tree


def divided(tree: Tree, strips: int, elements: int) -> Tree:
    """Scene with the numbers of strips and elements multiplied by factors."""
    tree = copy.deepcopy(tree)
    load, usual = tree["load"], Load()
    for key, share, most in (("strips_per_rigid_part", strips, 1024), ("strips_per_element", strips // elements, 64)):
        load[key] = min(most, max(1, share) * load.get(key, getattr(usual, key)))
    for body in tree["model"]["bodies"].values():
        if "flexible" in body:
            body["flexible"]["elements"] = elements * body["flexible"].get("elements", 4)
    return tree


Image = Callable[[Tree], Tree]
