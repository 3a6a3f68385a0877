"""Complete random scenarios: mechanisms, media, beds, drives and settings that mostly fit together.

Everything is drawn from a `random.Random`, so that a seed determines a case.
"""

from __future__ import annotations

import math
from itertools import pairwise
from random import Random
from typing import Any

from validation.fuzzing.media import law, media_for

Tree = dict[str, Any]


def scenario(rng: Random) -> Tree:
    """Draw a whole config as plain YAML types; most configs run, the others have a fault."""
    family = rng.choice(("bar", "bar", "plate", "plate", "ball", "vacuum"))
    template = rng.choices((_tree, _pendulum, _chain, _loop), (10, 4, 2, 1))[0]
    drawn = template(rng, family)
    step = 10.0 ** rng.uniform(-4.5, -3.0)
    drawn |= {
        "gravity_m_s2": rng.choice((9.81, 9.81, 0.0, -9.81, 100.0, rng.uniform(0.0, 30.0))),
        "load": _load(rng),
        "solver": {
            "step_s": step,
            "end_time_s": step * rng.randint(1, 40),
            "spectral_radius": rng.choice((0.9, 0.0, 1.0, rng.random())),
            "tolerance": 10.0 ** rng.uniform(-8.0, -3.0),
            "rest_time_s": rng.choice((None, 0.02, step)),
            "rest_speed_m_s": 10.0 ** rng.uniform(-4.0, 0.0),
        },
        "output": {"bodies": rng.choice(("auto", "all", "none")), "interval_s": rng.choice((None, 3.0 * step))},
    }
    if family != "vacuum":
        drawn["medium"] = media_for(rng, family)
        if rng.random() < 0.4:
            drawn["bed"] = _bed(rng, family)
        elif rng.random() < 0.2:
            drawn["surface_height_m"] = -rng.uniform(0.0, 0.6)
    return drawn


def size(rng: Random, low: float = 0.02, high: float = 0.4) -> float:
    """Draw a length (m), uniformly on a logarithmic scale."""
    return math.exp(rng.uniform(math.log(low), math.log(high)))


def _point(rng: Random) -> list[float]:
    return [rng.uniform(-0.1, 0.1), rng.uniform(-0.1, 0.1)]


def _load(rng: Random) -> Tree:
    plastic = {"type": "elastoplastic", "yield_displacement_m": 10.0 ** rng.uniform(-7, -2)}
    plastic["damping_time_s"] = rng.choice((0.0, 1e-3, 1.0))
    smooth = {"type": "smooth", "reference_speed_m_s": 10.0 ** rng.uniform(-6, 0)}
    return {
        "form": rng.choice(("distributed", "distributed", "distributed", "resultant")),
        "end_cap": rng.random() < 0.3,
        "strips_per_element": rng.randint(1, 8),
        "strips_per_rigid_part": rng.randint(1, 24),
        "friction": rng.choice((plastic, plastic, smooth)),
    }


def _bed(rng: Random, family: str) -> Tree:
    bed: Tree = {}
    if rng.random() < 0.4:
        bed["slope_deg"] = rng.uniform(-50.0, 50.0)
    elif rng.random() < 0.4:
        x = sorted(rng.uniform(-0.5, 0.5) for _ in range(rng.randint(2, 6)))
        y = [-rng.uniform(0.0, 1.0)]
        for before, at in pairwise(x):  # slopes of up to 60 degrees are allowed
            y.append(y[-1] + (at - before) * rng.uniform(-1.7, 1.7))
        bed["profile_m"] = [list(corner) for corner in zip(x, y, strict=True)]
    if rng.random() < 0.5:
        bed["depth_m"] = rng.uniform(0.001, 0.5)
        if rng.random() < 0.7:
            bed["floor"] = {"stiffness_N_m2": 10.0 ** rng.uniform(2, 8), "damping_s_m": rng.choice((0.0, 0.1, 10.0))}
    if rng.random() < 0.3:
        bed["container_x_m"] = [-rng.uniform(0.0, 0.5), rng.uniform(0.0, 0.5)]
    if rng.random() < 0.3 and family != "ball":
        tops = sorted(rng.uniform(0.001, min(0.2, bed.get("depth_m", 1.0))) for _ in range(rng.randint(1, 3)))
        bed["layers"] = [{"top_m": top, "medium": law(rng, family)} for top in tops]
    return bed


def _section(rng: Random, family: str) -> Tree:
    if family == "plate" and rng.random() < 0.6:
        return {"width_m": size(rng), "thickness_m": size(rng, 5e-4, 0.01)}
    return {"diameter_m": size(rng, 1e-3, 0.05)}


def _shape(rng: Random, family: str) -> Tree:
    kinds = {"bar": ("cylinder", "arc", "polyline"), "ball": ("sphere",)}
    both = ("cylinder", "arc", "polyline", "plate", "disc", "polygon", "foot", "sphere")
    fitting = kinds.get(family, both[:-1] if family == "plate" else both)
    kind = rng.choice(fitting) if rng.random() < 0.95 else rng.choice(both)
    shape: Tree = {"type": kind}
    if kind in ("cylinder", "plate"):
        shape |= {"start_m": _point(rng), "end_m": _point(rng)}
        shape |= {"diameter_m": size(rng, 1e-3, 0.05)} if kind == "cylinder" else {}
        shape |= {"width_m": size(rng), "thickness_m": size(rng, 5e-4, 0.01)} if kind == "plate" else {}
    elif kind in ("disc", "sphere"):
        shape |= {"diameter_m": size(rng), "center_m": _point(rng)}
        shape |= {"thickness_m": size(rng)} if kind == "disc" else {}
    elif kind == "arc":
        start = rng.uniform(-360.0, 360.0)
        shape |= {"radius_m": size(rng), "from_deg": start, "to_deg": start + rng.uniform(-360.0, 360.0)}
        shape |= _section(rng, family)
    elif kind == "polyline":
        shape |= {"points_m": [_point(rng) for _ in range(rng.randint(2, 6))]} | _section(rng, family)
    elif kind == "polygon":
        corners = [_point(rng) for _ in range(rng.randint(3, 6))]
        if rng.random() < 0.9:  # by angle around the middle, so that no sides cross
            corners.sort(key=lambda corner: math.atan2(corner[1], corner[0]))
        shape |= {"points_m": corners, "width_m": size(rng)}
    else:
        height = size(rng, 0.005, 0.05)
        shape |= {"length_m": height * rng.uniform(1.0, 6.0), "height_m": height, "width_m": size(rng)}
    if rng.random() < 0.15:
        shape["in_sand"] = False
    return shape


def _flexible(rng: Random) -> Tree:
    flexible: Tree = {"elements": rng.randint(1, 6)}
    if rng.random() < 0.5:
        flexible["youngs_modulus_Pa"] = 10.0 ** rng.uniform(6, 12)
    else:
        flexible["bending_stiffness_N_m2"] = 10.0 ** rng.uniform(-4, 3)
    if rng.random() < 0.3:
        flexible["axial_stiffness_N"] = 10.0 ** rng.uniform(2, 8)
    if rng.random() < 0.3:
        flexible |= {"bending_damping_N_m2_s": 10.0 ** rng.uniform(-6, 0), "axial_damping_N_s": rng.uniform(0, 10)}
    return flexible


def _link(rng: Random, family: str, bends: float = 0.4) -> Tree:
    link = {"type": "link", "length_m": size(rng), "density_kg_m3": 10.0 ** rng.uniform(2, 4.3)} | _section(rng, family)
    return link | ({"flexible": _flexible(rng)} if rng.random() < bends else {})


def _body(rng: Random, family: str) -> Tree:
    if rng.random() < 0.5 and family != "ball":
        return _link(rng, family)
    shapes = [_shape(rng, family) for _ in range(rng.randint(1, 3))]
    if rng.random() < 0.7:
        return {"type": "rigid", "density_kg_m3": 10.0 ** rng.uniform(2, 4.3), "shapes": shapes}
    mass = 10.0 ** rng.uniform(-3, 1)
    inertia = mass * size(rng) ** 2
    return {
        "type": "rigid",
        "mass_kg": mass,
        "inertia_kg_m2": inertia,
        "center_of_mass_m": _point(rng),
        "shapes": shapes,
    }


def _in_hinge(rng: Random) -> Tree:
    """Draw springs, dampers, stops and friction of a hinge."""
    forces: Tree = {}
    if rng.random() < 0.3:
        forces["spring"] = {"stiffness_Nm_per_rad": 10.0 ** rng.uniform(-3, 3), "rest_deg": rng.uniform(-90, 90)}
    if rng.random() < 0.3:
        forces["damping_Nm_s_per_rad"] = 10.0 ** rng.uniform(-5, 1)
    if rng.random() < 0.2:
        lower = rng.uniform(-180, 90)
        forces["stops"] = {"lower_deg": lower, "upper_deg": lower + rng.uniform(0.1, 180)}
        forces["stops"] |= {
            "stiffness_Nm_per_rad": 10.0 ** rng.uniform(0, 4),
            "dissipation_s_per_rad": rng.uniform(0, 1),
        }
    if rng.random() < 0.2:
        forces["friction"] = {"torque_Nm": 10.0 ** rng.uniform(-4, 1), "slip_deg": 10.0 ** rng.uniform(-4, 1)}
    return forces


def _in_slider(rng: Random) -> Tree:
    forces: Tree = {}
    if rng.random() < 0.3:
        forces["spring"] = {"stiffness_N_per_m": 10.0 ** rng.uniform(0, 6), "rest_m": rng.uniform(-0.2, 0.2)}
    if rng.random() < 0.3:
        forces["damping_N_s_per_m"] = 10.0 ** rng.uniform(-3, 3)
    if rng.random() < 0.2:
        forces["stops"] = {"lower_m": -rng.uniform(0, 0.2), "upper_m": rng.uniform(0.001, 0.2)}
        forces["stops"] |= {"stiffness_N_per_m": 10.0 ** rng.uniform(2, 6)}
    if rng.random() < 0.2:
        forces["friction"] = {"force_N": 10.0 ** rng.uniform(-3, 2), "slip_m": 10.0 ** rng.uniform(-6, -2)}
    return forces


def _seat(rng: Random, body: Tree | None) -> list[float]:
    """Draw the point of a joint on its parent: an end of a flexible body, otherwise any point."""
    if body is not None and body["type"] == "link":
        return [body["length_m"] if rng.random() < 0.8 else 0.0, 0.0]
    return _point(rng) if rng.random() < 0.5 else [0.0, 0.0]


def _tree(rng: Random, family: str) -> Tree:
    """Draw bodies on joints of all kinds."""
    bodies: Tree = {}
    joints: Tree = {}
    starts: Tree = {}
    for i in range(rng.randint(1, 4)):
        name, parent = f"body_{i}", rng.choice(("ground", *bodies))
        on_ground = parent == "ground"
        kind = rng.choices(("hinge", "weld", "slider", "free"), (6, 2 * (i > 0), 2, 3 * on_ground))[0]
        joint = {"type": kind, "parent": parent, "child": name, "parent_point_m": _seat(rng, bodies.get(parent))}
        start: Tree = {}
        if kind == "hinge":
            joint |= {"home_deg": rng.uniform(-180, 180)} | _in_hinge(rng)
            start = {"angle_deg": rng.uniform(-180, 180), "rate_rad_s": rng.gauss(0, 5)}
        elif kind == "slider":
            joint |= {"axis": [rng.gauss(0, 1), rng.gauss(0, 1)], "home_deg": rng.uniform(-180, 180)} | _in_slider(rng)
            start = {"position_m": rng.uniform(-0.1, 0.1), "speed_m_s": rng.gauss(0, 1)}
        elif kind == "weld":
            joint["home_deg"] = rng.uniform(-180, 180)
        else:
            start = {"x_m": rng.gauss(0, 0.2), "y_m": rng.gauss(0, 0.2), "angle_deg": rng.uniform(-180, 180)}
            start |= {"vx_m_s": rng.gauss(0, 1), "vy_m_s": -abs(rng.gauss(0, 2)), "rate_rad_s": rng.gauss(0, 5)}
        bodies[name], joints[f"joint_{i}"] = _body(rng, family), joint
        if start and rng.random() < 0.8:
            starts[f"joint_{i}"] = start
    drives = {name: _drive(rng, joint["type"]) for name, joint in joints.items() if rng.random() < 0.2}
    drives = {name: drive for name, drive in drives.items() if drive is not None}
    for name, drive in drives.items():
        if drive["type"] == "motion":
            starts.pop(name, None)
    model = {"name": "drawn", "bodies": bodies, "joints": joints}
    initial: Tree = {"joints": starts}
    if rng.random() < 0.1:
        initial = {"settle": True}
    return {"model": model, "initial": initial} | ({"drives": drives} if drives else {})


def _drive(rng: Random, kind: str) -> Tree | None:
    if kind not in ("hinge", "slider"):
        return None
    turns = kind == "hinge"
    form = rng.choice(("load", "motion", "control", "speed"))
    if form == "load":
        return (
            {"type": "torque", "torque_Nm": _signal(rng, 1.0)}
            if turns
            else {"type": "force", "force_N": _signal(rng, 10)}
        )
    target = _signal(rng, 60.0, clock=True) if turns else _signal(rng, 0.05)
    if form == "motion":
        jumps = isinstance(target, dict) and target.get("interpolation") == "linear"
        smooth = {"smooth_s": 0.02} if jumps else {}  # without it jumps of rates are refused
        return {"type": "motion", "angle_deg" if turns else "position_m": target} | smooth
    drive: Tree = {"type": "pd" if turns else "pd_slider"}
    gains = ("gain_Nm_per_rad", "rate_gain_Nm_s_per_rad") if turns else ("gain_N_per_m", "speed_gain_N_s_per_m")
    if form == "control":
        drive |= {"angle_deg" if turns else "position_m": target, gains[0]: 10.0 ** rng.uniform(-2, 4)}
    else:
        drive |= {"rate_rad_s" if turns else "speed_m_s": _signal(rng, 3.0)}
    drive[gains[1]] = 10.0 ** rng.uniform(-4, 2)
    if rng.random() < 0.5:
        drive["limit_Nm" if turns else "limit_N"] = 10.0 ** rng.uniform(-3, 2)
    return drive


def _signal(rng: Random, scale: float, clock: bool = False) -> Any:
    kind = rng.choice(("number", "sine", "ramp", "table", *(["buehler"] * clock)))
    if kind == "number":
        return rng.gauss(0, scale)
    if kind == "sine":
        return {
            "type": "sine",
            "amplitude": rng.gauss(0, scale),
            "frequency_Hz": size(rng, 0.1, 100),
            "phase_deg": 90.0,
        }
    if kind == "ramp":
        return {
            "type": "ramp",
            "from": rng.gauss(0, scale),
            "to": rng.gauss(0, scale),
            "duration_s": size(rng, 1e-3, 1),
        }
    if kind == "table":
        times = sorted({rng.uniform(0, 0.05) for _ in range(rng.randint(2, 6))})
        values = [rng.gauss(0, scale) for _ in times]
        return {"type": "table", "time_s": times, "values": values, "interpolation": rng.choice(("linear", "cubic"))}
    return {"type": "buehler", "frequency_Hz": size(rng, 0.1, 20), "stance_sweep_deg": 60.0, "duty_factor": 0.5}


def _strike(rng: Random) -> Tree:
    speed = rng.choice((0.0, rng.gauss(0, 5), 10.0 ** rng.uniform(-6, 2)))
    angle = rng.choice((rng.uniform(-90, 90), 0.0, 90.0, -90.0, 0.01, 89.99))
    if rng.random() < 0.2:
        return {"impact_angle_deg": angle, "impact_tip_speed_m_s": speed}
    return {"impact_angle_deg": angle, "impact_speed_rad_s": speed}


def _pendulum(rng: Random, family: str) -> Tree:
    """Draw a hub on a ground hinge with a welded link, the system of the reduced model."""
    hub = {"type": "rigid", "density_kg_m3": 7700.0, "shapes": [_shape(rng, family)]}
    link = _link(rng, family, bends=0.7)
    joints = {
        "pivot": {"type": "hinge", "parent": "ground", "child": "hub"},
        "clamp": {"type": "weld", "parent": "hub", "child": "link", "parent_point_m": [size(rng), 0.0]},
    }
    drawn: Tree = {"model": {"name": "pendulum", "bodies": {"hub": hub, "link": link}, "joints": joints}}
    drawn["initial"] = _strike(rng)
    if rng.random() < 0.6:
        modes = rng.randint(0, 4) if "flexible" in link else 0
        drawn["method"] = {"reduced": {"modes": modes, "rtol": 10.0 ** rng.uniform(-9, -2)}}
    return drawn


def _chain(rng: Random, _: str) -> Tree:
    link = {"length_m": size(rng, 0.01, 0.2), "diameter_m": size(rng, 1e-3, 0.02), "density_kg_m3": 7700.0}
    if rng.random() < 0.3:
        link["flexible"] = _flexible(rng)
    chain = {"count": rng.randint(1, 8), "link": link, "hinge": {"home_deg": rng.uniform(-30, 30)} | _in_hinge(rng)}
    return {"model": {"name": "chain", "chain": chain}, "initial": _strike(rng)}


def _loop(rng: Random, _: str) -> Tree:
    """Draw two parallel cranks with a coupler between their tips."""
    section = {"type": "link", "diameter_m": 0.01, "density_kg_m3": 7700.0}
    crank, coupler, angle = section | {"length_m": size(rng)}, section | {"length_m": size(rng)}, rng.uniform(5, 175)
    base, tip = [coupler["length_m"], 0.0], [crank["length_m"], 0.0]
    joints = {
        "left": {"type": "hinge", "parent": "ground", "child": "crank", "home_deg": angle},
        "right": {"type": "hinge", "parent": "ground", "child": "rocker", "home_deg": angle, "parent_point_m": base},
        "knee": {"type": "hinge", "parent": "crank", "child": "coupler", "parent_point_m": tip, "home_deg": -angle},
    }
    elbow = {"type": "hinge", "parent": "coupler", "child": "rocker", "parent_point_m": base, "child_point_m": tip}
    bodies = {"crank": crank, "rocker": crank, "coupler": coupler}
    start = {"left": {"angle_deg": angle + rng.gauss(0, 10), "rate_rad_s": rng.gauss(0, 3)}}
    model = {"name": "loop", "bodies": bodies, "joints": joints, "closures": {"elbow": elbow | _in_hinge(rng)}}
    return {"model": model, "initial": {"joints": start}}
