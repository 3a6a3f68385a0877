"""Random mechanisms with their initial states and drives: one function for each kind."""

from __future__ import annotations

import math
from collections.abc import Callable
from random import Random
from typing import Any

from validation.random_scenes.bodies import link, rigid
from validation.random_scenes.signals import hinge_drive, signal, slider_drive

Tree = dict[str, Any]
Made = tuple[Tree, Tree]  # model (bodies, joints, closures) and initial.joints; drives are added to the scene


def _free(rng: Random, spin: float = 5.0) -> Tree:
    return {
        "x_m": 0.0,
        "y_m": 0.0,
        "angle_deg": rng.choice((rng.uniform(-180.0, 180.0), rng.uniform(-180.0, 180.0), 0.0, 90.0)),
        "vx_m_s": rng.uniform(-1.0, 1.0),
        "vy_m_s": -rng.uniform(0.0, 2.5),
        "rate_rad_s": rng.choice((0.0, rng.uniform(-spin, spin))),
    }


def _direction(angle: float) -> list[float]:
    """Direction at an angle (deg) counter-clockwise from the x axis, exact along an axis."""
    turned = math.radians(angle)
    return [round(math.cos(turned), 15), round(math.sin(turned), 15)]


def _fallen(rng: Random, body: Tree) -> Made:
    model = {"bodies": {"body": body}, "joints": {"root": {"type": "free", "parent": "ground", "child": "body"}}}
    return model, {"root": _free(rng)}


def free_rod(rng: Random, family: str, _: Tree) -> Made:
    """A rigid rod that falls."""
    return _fallen(rng, link(rng, family))


def free_flexible_rod(rng: Random, family: str, _: Tree) -> Made:
    """A flexible rod that falls."""
    return _fallen(rng, link(rng, family, bends=1.0))


def free_solid(rng: Random, family: str, _: Tree) -> Made:
    """A disc, polygon or foot that falls."""
    return _fallen(rng, rigid(rng, family, rng.choice(("disc", "polygon", "foot"))))


def free_bent(rng: Random, family: str, _: Tree) -> Made:
    """A bent bar, a plate or a cylinder that falls."""
    kinds = ("arc", "polyline", "cylinder") + (("plate",) if family == "plate" else ())
    return _fallen(rng, rigid(rng, family, rng.choice(kinds)))


def ball(rng: Random, family: str, _: Tree) -> Made:
    """A ball that falls, hangs on a rod or slides."""
    body = rigid(rng, family, "sphere")
    form = rng.choice(("free", "free", "hinge", "slider"))
    if form == "free":
        return _fallen(rng, body)
    if form == "hinge":
        arm = [rng.uniform(0.05, 0.2), 0.0]
        joint = {"type": "hinge", "parent": "ground", "child": "body", "child_point_m": [-arm[0], 0.0]}
        start = {"angle_deg": rng.uniform(0.0, 80.0), "rate_rad_s": rng.uniform(0.0, 8.0)}
    else:
        joint = {"type": "slider", "parent": "ground", "child": "body", "axis": _direction(rng.uniform(-110.0, -70.0))}
        start = {"position_m": 0.0, "speed_m_s": rng.uniform(0.0, 2.0)}
    return {"bodies": {"body": body}, "joints": {"root": joint}}, {"root": start}


def _in_hinge(rng: Random, scale: float, home: float) -> Tree:
    """Draw springs, dampers, stops and friction for moments of about `scale` (N m)."""
    forces: Tree = {}
    if rng.random() < 0.3:
        forces["spring"] = {"stiffness_Nm_per_rad": scale * 10.0 ** rng.uniform(0, 1), "rest_deg": home}
    if rng.random() < 0.3:
        forces["damping_Nm_s_per_rad"] = scale * 10.0 ** rng.uniform(-2.5, -1)
    if rng.random() < 0.2:
        span = {"lower_deg": home - rng.uniform(2.0, 40.0), "upper_deg": home + rng.uniform(2.0, 40.0)}
        dissipation = rng.choice((0.0, rng.uniform(0.05, 0.5)))
        forces["stops"] = span | {
            "stiffness_Nm_per_rad": scale * 10.0 ** rng.uniform(1, 2),
            "dissipation_s_per_rad": dissipation,
        }
    if rng.random() < 0.2:
        forces["friction"] = {"torque_Nm": scale * rng.uniform(0.05, 0.5), "slip_deg": 10.0 ** rng.uniform(-2, 0)}
    return forces


def _moment(body: Tree) -> float:
    """Estimate of the moment (N m) of a link's weight about its root."""
    area = 0.25 * math.pi * body["diameter_m"] ** 2 if "diameter_m" in body else body["width_m"] * body["thickness_m"]
    return 9.81 * 0.5 * float(body["density_kg_m3"] * area * body["length_m"] ** 2)


def _hung(rng: Random, body: Tree, seat: list[float] | None = None) -> Made:
    joint = {"type": "hinge", "parent": "ground", "child": "body"} | ({"child_point_m": seat} if seat else {})
    start = {"angle_deg": rng.uniform(5.0, 85.0), "rate_rad_s": rng.uniform(0.5, 9.0)}
    return {"bodies": {"body": body}, "joints": {"pivot": joint}}, {"pivot": start}


def pendulum(rng: Random, family: str, _: Tree) -> Made:
    """A rigid or flexible link on a hinge without a drive, with springs and stops."""
    body = link(rng, family, bends=0.4)
    mechanism = _hung(rng, body)
    mechanism[0]["joints"]["pivot"] |= _in_hinge(rng, _moment(body), mechanism[1]["pivot"]["angle_deg"])
    return mechanism


def plain_pendulum(rng: Random, family: str, scene: Tree) -> Made:
    """A hub with a welded link, sometimes solved by a reduced model."""
    body = link(rng, family, bends=0.5)
    hub = {"type": "disc", "diameter_m": 0.03, "thickness_m": 0.03, "in_sand": False}
    bodies = {"hub": {"type": "rigid", "density_kg_m3": 7700.0, "shapes": [hub]}, "body": body}
    joints = {
        "pivot": {"type": "hinge", "parent": "ground", "child": "hub"},
        "clamp": {"type": "weld", "parent": "hub", "child": "body", "parent_point_m": [0.015, 0.0]},
    }
    modes = rng.choice((1, 2, 3)) if "flexible" in body else 0
    static = rng.choice(("auto", "elastoplastic", "true_sign") if family == "bar" else ("auto", "elastoplastic"))
    scene["method"] = {"reduced": {"modes": modes, "static": static}}
    return {"bodies": bodies, "joints": joints}, {
        "pivot": {"angle_deg": rng.uniform(10.0, 80.0), "rate_rad_s": rng.uniform(0.5, 9.0)}
    }


def hinged_solid(rng: Random, family: str, _: Tree) -> Made:
    """A solid or a bent bar on a hinge beside it."""
    kinds = ("disc", "polygon", "foot", "arc") if family == "plate" else ("arc", "polyline")
    return _hung(rng, rigid(rng, family, rng.choice(kinds)), [-rng.uniform(0.05, 0.15), 0.0])


def chain(rng: Random, family: str, scene: Tree) -> Made:
    """A hanging chain of links on hinges; without forces in the hinges sometimes solved by the engine."""
    count = rng.randint(2, 5)
    plain = rng.random() < 0.5
    bodies, joints, starts = {}, {}, {}
    for i in range(count):
        name, parent = f"link_{i}", f"link_{i - 1}" if i else "ground"
        bodies[name] = link(rng, family, bends=0.0 if plain else 0.15, length=rng.uniform(0.06, 0.16))
        home = rng.uniform(10.0, 80.0) if i == 0 else rng.uniform(-25.0, 25.0)
        joint: Tree = {"type": "hinge", "parent": parent, "child": name, "home_deg": home}
        joint |= {} if i == 0 else {"parent_point_m": [bodies[parent]["length_m"], 0.0]}
        joints[f"hinge_{i}"] = joint | ({} if plain else _in_hinge(rng, _moment(bodies[name]), home))
        starts[f"hinge_{i}"] = {"angle_deg": home, "rate_rad_s": rng.uniform(-1.0, 6.0) if i == 0 else 0.0}
    if plain and rng.random() < 0.7:
        scene["method"] = "engine"
    return {"bodies": bodies, "joints": joints}, starts


def swimmer(rng: Random, family: str, scene: Tree) -> Made:
    """A floating chain of links on driven hinges."""
    count, wave = rng.randint(2, 4), rng.uniform(0.5, 4.0)
    same = link(rng, family, length=rng.uniform(0.06, 0.14))
    bodies, joints, drives = {}, {}, {}
    for i in range(count):
        bodies[f"link_{i}"] = dict(same)
        if i == 0:
            joints["root"] = {"type": "free", "parent": "ground", "child": "link_0"}
            continue
        joint = {"type": "hinge", "parent": f"link_{i - 1}", "child": f"link_{i}"}
        joints[f"hinge_{i}"] = joint | {"parent_point_m": [same["length_m"], 0.0]}
        bend = {"type": "sine", "amplitude": rng.uniform(15.0, 45.0), "frequency_Hz": wave, "phase_deg": 90.0 * i}
        gain = 20.0 * count * _moment(same)
        form = (
            {"type": "motion"}
            if rng.random() < 0.5
            else {"type": "pd", "gain_Nm_per_rad": gain, "rate_gain_Nm_s_per_rad": 0.02 * gain}
        )
        drives[f"hinge_{i}"] = form | {"angle_deg": bend}
    scene["drives"] = drives
    scene["buried"] = rng.uniform(0.0, 0.03)
    start = _free(rng) | {"angle_deg": rng.uniform(-8.0, 8.0), "vx_m_s": 0.0, "vy_m_s": 0.0, "rate_rad_s": 0.0}
    return {"bodies": bodies, "joints": joints}, {"root": start}


def driven_pendulum(rng: Random, family: str, scene: Tree) -> Made:
    """A link or a leg that a drive rotates about a fixed axle."""
    if family == "plate" and rng.random() < 0.4:
        body = rigid(rng, family, rng.choice(("arc", "polygon", "disc")))
        seat, scale = [rng.uniform(-0.04, 0.04), 0.0], 0.1
    else:
        body, seat = link(rng, family, bends=0.3), None
        scale = _moment(body)
    home = rng.uniform(20.0, 80.0)
    mechanism = _hung(rng, body, seat)
    mechanism[0]["joints"]["pivot"] |= {"home_deg": home}
    scene["drives"] = {"pivot": hinge_drive(rng, scene, home, scale, clock=True)}
    return mechanism[0], {}


def rail(rng: Random, family: str, scene: Tree) -> Made:
    """A body on a slider to the ground, driven or falling."""
    body = rigid(rng, family) if rng.random() < 0.6 else link(rng, family, bends=0.2)
    axis = rng.choice((0.0, -90.0, 90.0, rng.uniform(-90.0, 90.0)))
    joint: Tree = {"type": "slider", "parent": "ground", "child": "body", "axis": _direction(axis)}
    joint["home_deg"] = rng.choice((0.0, 90.0, -rng.uniform(-180.0, 180.0)))
    model = {"bodies": {"body": body}, "joints": {"rail": joint}}
    weight = rng.uniform(0.5, 4.0)
    if rng.random() < 0.7:
        scene["drives"] = {"rail": slider_drive(rng, scene, weight)}
        scene["buried"] = rng.choice((0.0, rng.uniform(0.0, 0.05)))
        return model, {}
    if rng.random() < 0.4:
        joint["spring"] = {"stiffness_N_per_m": 10.0 ** rng.uniform(1, 3), "rest_m": rng.uniform(-0.05, 0.05)}
    if rng.random() < 0.4:
        joint["damping_N_s_per_m"] = 10.0 ** rng.uniform(-1, 1)
    if rng.random() < 0.3:
        joint["stops"] = {"lower_m": -rng.uniform(0.005, 0.05), "upper_m": rng.uniform(0.005, 0.05)}
        joint["stops"] |= {"stiffness_N_per_m": 10.0 ** rng.uniform(3, 4), "dissipation_s_per_m": rng.uniform(0.0, 1.0)}
    if rng.random() < 0.3:
        joint["friction"] = {"force_N": rng.uniform(0.05, 1.0)}
    return model, {"rail": {"position_m": 0.0, "speed_m_s": rng.uniform(-1.5, 1.5)}}


def leg(rng: Random, family: str, scene: Tree) -> Made:
    """A leg of two links with a foot, on a hip on an upright slider or on a free trunk."""
    length = rng.uniform(0.05, 0.1)
    hip = {"type": "rigid", "mass_kg": rng.uniform(0.1, 0.5), "inertia_kg_m2": 1e-4, "shapes": []}
    bodies = {"hip": hip, "thigh": link(rng, family, length=length), "shank": link(rng, family, length=length)}
    bodies["shank"] |= {"diameter_m": 0.01} if "diameter_m" in bodies["shank"] else {}
    held = rng.random() < 0.6
    root = {"type": "slider", "axis": [0.0, 1.0]} if held else {"type": "free"}
    swing, knee = rng.uniform(50.0, 75.0), rng.uniform(20.0, 60.0)
    joints: Tree = {
        "root": root | {"parent": "ground", "child": "hip"},
        "swing": {"type": "hinge", "parent": "hip", "child": "thigh", "home_deg": swing},
        "knee": {
            "type": "hinge",
            "parent": "thigh",
            "child": "shank",
            "parent_point_m": [length, 0.0],
            "home_deg": knee,
        },
    }
    if family == "plate":
        bodies["foot"] = rigid(rng, family, "foot")
        seat = {"parent_point_m": [length, 0.0], "home_deg": -swing - knee}
        joints["ankle"] = {"type": "weld", "parent": "shank", "child": "foot"} | seat
    scale = 9.81 * hip["mass_kg"] * length
    scene["drives"] = {
        name: {"type": "pd", "gain_Nm_per_rad": 10.0 * scale, "rate_gain_Nm_s_per_rad": 0.3 * scale}
        | {"angle_deg": signal(rng, scene, home, 25.0, rng.choice(("sine", "ramp", "table", "constant")))}
        for name, home in (("swing", swing), ("knee", knee))
    }
    if held:
        return {"bodies": bodies, "joints": joints}, {"root": {"speed_m_s": -rng.uniform(0.0, 1.0)}}
    start = _free(rng) | {"angle_deg": 0.0, "rate_rad_s": 0.0}
    return {"bodies": bodies, "joints": joints}, {"root": start}


def wheel(rng: Random, family: str, scene: Tree) -> Made:
    """A driven disc, polygon or C-leg on a free hub."""
    hub = {"type": "rigid", "mass_kg": rng.uniform(0.1, 0.6), "inertia_kg_m2": 2e-3, "shapes": []}
    tread = rigid(rng, family, rng.choice(("disc", "arc", "polygon")))
    joints = {
        "root": {"type": "free", "parent": "ground", "child": "hub"},
        "axle": {"type": "hinge", "parent": "hub", "child": "tread"},
    }
    scene["drives"] = {"axle": hinge_drive(rng, scene, 0.0, 0.1, clock=True)}
    start = _free(rng) | {"angle_deg": 0.0, "rate_rad_s": 0.0, "vy_m_s": -rng.uniform(0.0, 0.5)}
    return {"bodies": {"hub": hub, "tread": tread}, "joints": joints}, {"root": start}


def loop(rng: Random, family: str, scene: Tree) -> Made:
    """Two parallel cranks with a coupler between their tips, driven or swinging."""
    crank, coupler = link(rng, family, length=rng.uniform(0.08, 0.16)), link(rng, family, length=rng.uniform(0.08, 0.2))
    home = rng.uniform(20.0, 70.0)
    base, tip = [coupler["length_m"], 0.0], [crank["length_m"], 0.0]
    joints = {
        "left": {"type": "hinge", "parent": "ground", "child": "crank", "home_deg": home},
        "right": {"type": "hinge", "parent": "ground", "child": "rocker", "home_deg": home, "parent_point_m": base},
        "knee": {"type": "hinge", "parent": "crank", "child": "coupler", "parent_point_m": tip, "home_deg": -home},
    }
    elbow = {"type": "hinge", "parent": "coupler", "child": "rocker", "parent_point_m": base, "child_point_m": tip}
    model = {"bodies": {"crank": crank, "rocker": dict(crank), "coupler": coupler}, "joints": joints}
    model["closures"] = {"elbow": elbow}
    if rng.random() < 0.5:
        scene["drives"] = {"left": hinge_drive(rng, scene, home, 3.0 * _moment(crank))}
        return model, {}
    return model, {"left": {"angle_deg": home, "rate_rad_s": rng.uniform(0.5, 6.0)}}


Kind = Callable[[Random, str, Tree], Made]
# Weight of each kind, and the families of laws that it can have.
KINDS: dict[str, tuple[Kind, float, tuple[str, ...]]] = {
    "free rod": (free_rod, 3, ("bar", "plate")),
    "free flexible rod": (free_flexible_rod, 2, ("bar", "plate")),
    "free solid": (free_solid, 3, ("plate",)),
    "free bent bar": (free_bent, 2, ("bar", "plate")),
    "ball": (ball, 2, ("ball",)),
    "pendulum": (pendulum, 3, ("bar", "plate")),
    "reduced pendulum": (plain_pendulum, 2, ("bar", "plate")),
    "hinged solid": (hinged_solid, 2, ("bar", "plate")),
    "chain": (chain, 3, ("bar", "plate")),
    "swimmer": (swimmer, 2, ("bar", "plate")),
    "driven pendulum": (driven_pendulum, 3, ("bar", "plate")),
    "rail": (rail, 2, ("bar", "plate")),
    "leg": (leg, 2, ("plate", "bar")),
    "wheel": (wheel, 2, ("plate",)),
    "loop": (loop, 2, ("bar", "plate")),
}
