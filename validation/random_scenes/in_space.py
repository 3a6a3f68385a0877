"""Random scene in space by its seed: all shapes, meshes, hinges, balls, sliders, legs, drives; slopes, maps, layers."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from random import Random
from typing import Any

import numpy as np

from granular_contact.config import load_scenario
from granular_contact.scene import build
from granular_contact.scene.types import Minimal
from validation.fuzzing.media import law
from validation.random_scenes.bodies import media
from validation.random_scenes.images import STEP
from validation.random_scenes.scenes import Drawn, fitting, touching, write
from validation.random_scenes.signals import hinge_drive, signal, slider_drive

Tree = dict[str, Any]
Made = tuple[Tree, Tree]  # model (bodies, joints) and initial.joints; drives and files are added to the scene
GROUND = "ground"
SOLIDS = ("box", "sphere", "cylinder", "capsule", "cone", "plate", "arc", "polygon", "wheel")


def draw(seed: int, folder: Path) -> Drawn:
    """Draw the scene of a seed in space, as `scenes.draw` does in the plane."""
    return fitting(seed, folder, _drawn)


def _drawn(seed: int, rng: Random, folder: Path) -> Drawn:
    kind = rng.choices(list(KINDS), [weight for weight, _, _ in KINDS.values()])[0]
    _, make, family = KINDS[kind]
    scene: Tree = {}
    model, starts = make(rng, scene)
    tree: Tree = {"model": {"name": "drawn", "in_space": True} | model, "initial": {"joints": starts}}
    tree |= scene | {"medium": media(rng, family), "load": {}, "output": {"bodies": "all", "figures": False}}
    if isinstance(tree["medium"], dict) and "from" in tree["medium"]:
        tree["medium"]["stiffness_N_m"] = 60.0
    if rng.random() < 0.15:
        tree["load"]["friction"] = {"type": "smooth", "reference_speed_m_s": 10.0 ** rng.uniform(-3, -1.5)}
    tree["solver"] = {"end_time_s": round(rng.uniform(0.06, 0.18), 3), "rest_time_s": None}
    solver = _solver(rng, tree)
    _lay(rng, tree, family, folder)
    minimal = isinstance(build(load_scenario(write(tree, folder))).method, Minimal)
    return Drawn(seed, kind, f"{solver}, {'minimal' if minimal else 'engine'}", tree)


def _solver(rng: Random, tree: Tree) -> str:
    """Draw the solver: steps of 0.2 ms, default steps or an accuracy; minimal coordinates or the engine."""
    if rng.random() < 0.3:
        tree["method"] = "engine"
    form = rng.random()
    if form < 0.4:
        tree["solver"]["step_s"] = STEP
        return "fixed steps"
    if form < 0.7:
        return "chosen steps"
    tree["solver"]["accuracy"] = rng.choice((1e-2, 1e-3))
    return "chosen steps"


def _lay(rng: Random, tree: Tree, family: str, folder: Path) -> None:
    """Add a bed to the scene that touches it or is somewhat lower; level, sloped or with a height map."""
    bed: Tree = {}
    form = rng.random()
    if form < 0.3:
        bed |= {"slope_deg": rng.uniform(3.0, 20.0), "slope_direction_deg": rng.uniform(-180.0, 180.0)}
    elif form < 0.5:
        bed["height_map"] = _map(rng, tree)
    bed["height_m"] = touching(tree | {"bed": bed}, folder) - rng.choice((0.0, 0.0, rng.uniform(0.0, 0.02)))
    if rng.random() < 0.15:
        bed["depth_m"] = rng.uniform(0.03, 0.08)
        bed["floor"] = {"stiffness_N_m3": 10.0 ** rng.uniform(6, 7.5), "damping_s_m": rng.choice((0.0, 0.3))}
    if rng.random() < 0.15 and family != "ball":
        bed["layers"] = [{"top_m": rng.uniform(0.005, 0.03), "medium": law(rng, family)}]
    tree["bed"] = bed


def _map(rng: Random, tree: Tree) -> Tree:
    """Draw a map of 8 x 10 heights (m) with cells of 50 mm and slopes of up to some 15 degrees."""
    values = [[f"{rng.uniform(0.0, 0.012):.5f}" for _ in range(10)] for _ in range(8)]
    tree.setdefault("files", {})["map.csv"] = "\n".join(",".join(row) for row in values)
    return {"file": "map.csv", "cell_m": 0.05, "corner_m": [-0.22, -0.17]}


# ---- bodies ----


def turn(rng: Random) -> list[float]:
    """Draw an orientation as a quaternion w, x, y, z."""
    return [rng.gauss(0.0, 1.0) for _ in range(4)]


def vector(rng: Random, size: float) -> list[float]:
    """Draw three numbers of at most a size."""
    return [rng.uniform(-size, size) for _ in range(3)]


def shape(rng: Random, kind: str) -> Tree:
    """Draw a shape of a kind about the origin of its body, with a size of some 30 to 120 mm."""
    size, thick = rng.uniform(0.03, 0.12), rng.uniform(0.002, 0.006)
    sides = [size, rng.uniform(0.3, 1.0) * size, rng.uniform(0.15, 1.0) * size]
    corners = [[0.5 * size * math.cos(a), 0.5 * size * math.sin(a)] for a in (0.3, 1.9, 3.0, rng.uniform(3.8, 5.5))]
    keys: Tree = {
        "box": {"size_m": sides},
        "sphere": {"diameter_m": 0.6 * size},
        "cylinder": {"diameter_m": sides[1], "length_m": size},
        "capsule": {"diameter_m": 0.5 * sides[1], "length_m": 0.7 * size},
        "cone": {"diameter_m": sides[1], "height_m": 0.8 * size},
        "plate": {"size_m": sides[:2], "thickness_m": thick},
        "arc": {"radius_m": 0.5 * size, "from_deg": 0.0, "to_deg": rng.uniform(60.0, 300.0)}
        | {"width_m": 0.5 * sides[1], "thickness_m": thick},
        "polygon": {"points_m": corners, "width_m": 0.7 * sides[1]},
        "wheel": {"radius_m": 0.5 * size, "width_m": 0.5 * sides[1]},
    }[kind]
    if kind == "wheel" and rng.random() < 0.4:
        keys["grousers"] = {"count": rng.randint(6, 12), "height_m": 0.1 * size}
    return {"type": kind, **keys}


def rigid(rng: Random, kinds: tuple[str, ...] = SOLIDS, count: int = 1) -> Tree:
    """Draw a rigid body of `count` shapes, rotated and away from its origin."""
    shapes = [shape(rng, rng.choice(kinds)) for _ in range(count)]
    for placed in shapes:
        if rng.random() < 0.5 or count > 1:
            placed |= {"center_m": vector(rng, 0.03), "quaternion": turn(rng)}
    body: Tree = {"type": "rigid", "shapes": shapes}
    if rng.random() < 0.8:
        return body | {"density_kg_m3": rng.uniform(600.0, 4000.0)}
    mass = rng.uniform(0.05, 0.5)
    moments = {axis: mass * rng.uniform(0.02, 0.025) ** 2 for axis in ("xx", "yy", "zz")}
    return body | {"mass_kg": mass, "inertia_kg_m2": moments, "center_of_mass_m": vector(rng, 0.005)}


def link(rng: Random, flat: bool) -> Tree:
    """Draw a rigid link along x, round or flat."""
    body: Tree = {"type": "link", "length_m": rng.uniform(0.05, 0.18), "density_kg_m3": rng.uniform(1000.0, 8000.0)}
    if flat:
        return body | {"width_m": rng.uniform(0.015, 0.05), "thickness_m": rng.uniform(0.003, 0.008)}
    return body | {"diameter_m": rng.uniform(0.006, 0.02)}


def bar(rng: Random) -> Tree:
    """Draw a thin round bar, straight or bent."""
    corners = [[-0.05, 0.0, 0.0], vector(rng, 0.03), [0.06, 0.0, 0.01]]
    shape_of_bar = {"type": "bar", "points_m": corners[:: rng.choice((1, 2))], "diameter_m": rng.uniform(0.004, 0.012)}
    return {"type": "rigid", "density_kg_m3": rng.choice((7700.0, 2700.0)), "shapes": [shape_of_bar]}


# ---- mechanisms ----


def free(rng: Random) -> Tree:
    """Draw the initial state of a free body that falls and rotates."""
    start: Tree = {"quaternion": turn(rng)}
    start |= {key: rng.uniform(-0.8, 0.8) for key in ("vx_m_s", "vy_m_s")} | {"vz_m_s": -rng.uniform(0.0, 1.5)}
    return start | {"spin_rad_s": rng.choice(([0.0, 0.0, 0.0], vector(rng, 8.0)))}


def thrown(rng: Random, body: Tree) -> Made:
    """One free body."""
    joints = {"root": {"type": "free", "parent": GROUND, "child": "body"}}
    return {"bodies": {"body": body}, "joints": joints}, {"root": free(rng)}


def thrown_mesh(rng: Random, scene: Tree) -> Made:
    """A free lump of 80 triangles, from a file."""
    points, faces = _sphere()
    axes = np.array([rng.uniform(0.015, 0.05) for _ in range(3)])
    place = np.array(points) * axes * np.array([[1.0 + rng.uniform(-0.08, 0.08)] for _ in points])
    lines = [f"v {x:.8f} {y:.8f} {z:.8f}" for x, y, z in place]
    lines += [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in faces]
    scene["files"] = {"lump.obj": "\n".join(lines) + "\n"}
    shapes = [{"type": "mesh", "file": "lump.obj", "scale": [1.0, 1.0, 1.0]}]
    return thrown(rng, {"type": "rigid", "density_kg_m3": rng.uniform(800.0, 3000.0), "shapes": shapes})


def _sphere() -> tuple[list[Any], list[tuple[int, int, int]]]:
    """Points and triangles of a unit sphere: an octahedron whose triangles are divided into four, twice."""
    points = [np.array(p, float) for p in ((1, 0, 0), (0, 1, 0), (-1, 0, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1))]
    faces = [(k, (k + 1) % 4, 4) for k in range(4)] + [((k + 1) % 4, k, 5) for k in range(4)]
    for _ in range(2):
        middles: dict[tuple[int, int], int] = {}
        cut = []
        for face in faces:
            m = []
            for a, b in zip(face, (*face[1:], face[0]), strict=True):
                key = (min(a, b), max(a, b))
                if key not in middles:
                    middles[key] = len(points)
                    points.append((points[a] + points[b]) / np.linalg.norm(points[a] + points[b]))
                m.append(middles[key])
            cut += [(face[0], m[0], m[2]), (face[1], m[1], m[0]), (face[2], m[2], m[1]), (m[0], m[1], m[2])]
        faces = cut
    return points, faces


def hung(rng: Random, scene: Tree) -> Made:
    """A body on a hinge or a ball joint beside it, sometimes with a drive."""
    joint: Tree = {"type": rng.choice(("hinge", "hinge", "ball")), "parent": GROUND, "child": "body"}
    joint |= {"child_point_m": vector(rng, 0.08), "quaternion": turn(rng), "damping_Nm_s_per_rad": 1e-4}
    model = {"bodies": {"body": rigid(rng)}, "joints": {"pivot": joint}}
    if joint["type"] == "ball":
        return model, {"pivot": {"quaternion": turn(rng), "spin_rad_s": vector(rng, 6.0)}}
    joint["axis"] = vector(rng, 1.0)
    if rng.random() < 0.5:
        scene["drives"] = {"pivot": hinge_drive(rng, scene, 0.0, 0.1)}
        return model, {}
    return model, {"pivot": {"angle_deg": 0.0, "rate_rad_s": rng.uniform(-6.0, 6.0)}}


def pressed(rng: Random, scene: Tree) -> Made:
    """A body on a slider at an angle to the vertical, driven or pushed down."""
    joint = {"type": "slider", "parent": GROUND, "child": "body", "quaternion": turn(rng), "axis": vector(rng, 1.0)}
    model = {"bodies": {"body": rigid(rng)}, "joints": {"rail": joint}}
    if rng.random() < 0.5:
        scene["drives"] = {"rail": slider_drive(rng, scene, 2.0)}
        return model, {}
    return model, {"rail": {"position_m": 0.0, "speed_m_s": rng.uniform(-1.0, 1.0)}}


def chain(rng: Random, scene: Tree, flat: bool = True) -> Made:
    """Two to four links on hinges, sometimes with a drive, or on ball joints; floating or hanging."""
    count = rng.randint(2, 4)
    bodies = {f"link_{i}": link(rng, flat and rng.random() < 0.5) for i in range(count)}
    joints: Tree = {"root": {"type": "free", "parent": GROUND, "child": "link_0"}}
    starts: Tree = {"root": free(rng)}
    if rng.random() < 0.3:
        joints["root"] = {"type": "hinge", "parent": GROUND, "child": "link_0", "axis": [0.2, 1.0, 0.1]}
        starts["root"] = {"angle_deg": rng.uniform(-40.0, 80.0), "rate_rad_s": rng.uniform(-4.0, 4.0)}
    for i in range(1, count):
        before, kind = bodies[f"link_{i - 1}"], rng.choice(("hinge", "hinge", "ball"))
        joint: Tree = {"type": kind, "parent": f"link_{i - 1}", "child": f"link_{i}"}
        joint |= {"parent_point_m": [before["length_m"], 0.0, 0.0], "damping_Nm_s_per_rad": 2e-4}
        if kind == "hinge":
            joint["axis"] = rng.choice(([0.0, 0.0, 1.0], [0.0, 1.0, 0.0], vector(rng, 1.0)))
            if rng.random() < 0.5:
                scene.setdefault("drives", {})[f"joint_{i}"] = hinge_drive(rng, scene, 0.0, 0.05)
        else:
            joint["spring"] = {"stiffness_Nm_per_rad": rng.uniform(0.02, 0.3)}
        joints[f"joint_{i}"] = joint
    return {"bodies": bodies, "joints": joints}, starts


def legged(rng: Random, scene: Tree) -> Made:
    """A trunk on four legs with feet, each on a hinge with a servo."""
    length, width, leg = rng.uniform(0.1, 0.16), rng.uniform(0.06, 0.1), rng.uniform(0.03, 0.06)
    trunk: Tree = {"type": "box", "size_m": [length, width, 0.025]}
    bodies: Tree = {"trunk": {"type": "rigid", "density_kg_m3": rng.uniform(500.0, 1200.0), "shapes": [trunk]}}
    joints: Tree = {"root": {"type": "free", "parent": GROUND, "child": "trunk"}}
    foot = rng.choice(("sphere", "cylinder", "box"))
    of_foot: Tree = {"sphere": {"diameter_m": 0.025}, "cylinder": {"diameter_m": 0.02, "length_m": 0.02}}.get(
        foot, {"size_m": [0.03, 0.02, 0.01]}
    )
    bone = {"type": "cylinder", "diameter_m": 0.008, "start_m": [0.0, 0.0, 0.0], "end_m": [leg, 0.0, 0.0]}
    shapes = [bone, {"type": foot, "center_m": [leg, 0.0, 0.0]} | of_foot]
    drives = scene.setdefault("drives", {})
    for i, (x, y) in enumerate(((1, 1), (1, -1), (-1, -1), (-1, 1))):
        bodies[f"leg_{i}"] = {"type": "rigid", "density_kg_m3": 1200.0, "shapes": shapes}
        at = [0.5 * x * length, 0.5 * y * (width + 0.03), 0.0]
        joint = {"type": "hinge", "parent": "trunk", "child": f"leg_{i}", "axis": [0.0, 1.0, 0.0], "home_deg": 90.0}
        joints[f"hip_{i}"] = joint | {"parent_point_m": at, "damping_Nm_s_per_rad": 1e-3}
        gains = {"gain_Nm_per_rad": 3.0, "rate_gain_Nm_s_per_rad": 0.03, "limit_Nm": 1.0}
        drives[f"hip_{i}"] = {"type": "pd", "angle_deg": signal(rng, scene, 90.0, 25.0, "sine")} | gains
    start = {"vz_m_s": -rng.uniform(0.0, 0.5), "rpy_deg": [rng.uniform(-5.0, 5.0), rng.uniform(-5.0, 5.0), 20.0]}
    return {"bodies": bodies, "joints": joints}, {"root": start}


def rolling(rng: Random, scene: Tree) -> Made:
    """A wheel on a free hub, rotated by a drive."""
    bodies = {"hub": {"type": "rigid", "mass_kg": 0.5, "inertia_kg_m2": {"xx": 1e-3, "yy": 1e-3, "zz": 1e-3}}}
    bodies["wheel"] = {"type": "rigid", "density_kg_m3": 1000.0, "shapes": [shape(rng, "wheel")]}
    joints: Tree = {"root": {"type": "free", "parent": GROUND, "child": "hub"}}
    joints["axle"] = {"type": "hinge", "parent": "hub", "child": "wheel", "axis": [0.0, 1.0, 0.0]}
    scene["drives"] = {"axle": {"type": "torque", "torque_Nm": rng.uniform(-0.2, 0.2)}}
    start = {"rpy_deg": [rng.uniform(-10.0, 10.0), 0.0, rng.uniform(-180.0, 180.0)], "vx_m_s": rng.uniform(-0.4, 0.4)}
    return {"bodies": bodies, "joints": joints}, {"root": start | {"vz_m_s": -rng.uniform(0.0, 0.5)}}


KINDS: dict[str, tuple[float, Callable[[Random, Tree], Made], str]] = {
    "thrown solid": (6, lambda rng, _: thrown(rng, rigid(rng)), "plate"),
    "thrown compound": (2, lambda rng, _: thrown(rng, rigid(rng, count=rng.randint(2, 3))), "plate"),
    "thrown mesh": (2, thrown_mesh, "plate"),
    "thrown link": (1, lambda rng, _: thrown(rng, link(rng, flat=True)), "plate"),
    "hung": (3, hung, "plate"),
    "pressed": (2, pressed, "plate"),
    "chain": (3, chain, "plate"),
    "legged": (2, legged, "plate"),
    "rolling": (2, rolling, "plate"),
    "thrown bar": (1, lambda rng, _: thrown(rng, bar(rng)), "bar"),
    "chain of bars": (1, lambda rng, scene: chain(rng, scene, flat=False), "bar"),
    "thrown ball": (1, lambda rng, _: thrown(rng, rigid(rng, ("sphere",))), "ball"),
}
