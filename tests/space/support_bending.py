"""Links that bend in space, and what theory says of them."""

from __future__ import annotations

import copy
from typing import Any

import numpy as np
from numpy.typing import NDArray

from granular_contact.geometry import rotations

Array = NDArray[np.float64]
# The beam of Dowell and Traybar's experiment in Princeton (1975), an aluminium strip.
LENGTH, WIDTH, THICKNESS, MODULUS, POISSON = 0.508, 12.3777e-3, 3.2024e-3, 71.7e9, 0.31


def princeton(weight: float, angle: float, elements: int) -> dict[str, Any]:
    """Config of the strip, without mass, that stands out of a wall and carries a weight (N) at its end.

    angle (deg): by which its section is turned about its axis; 0: it bends about the weaker axis.
    """
    flexible = {"youngs_modulus_Pa": MODULUS, "poissons_ratio": POISSON, "elements": elements}
    sides = {"length_m": LENGTH, "width_m": WIDTH, "thickness_m": THICKNESS}
    inertia = dict.fromkeys(("xx", "yy", "zz"), 1e-4)
    bodies = {
        "strip": {"type": "link", **sides, "density_kg_m3": 1e-3, "flexible": flexible},
        "weight": {"type": "rigid", "mass_kg": weight / 9.81, "inertia_kg_m2": inertia},
    }
    wall = {"type": "weld", "parent": "ground", "child": "strip", "rpy_deg": [angle, 0, 0]}
    end = {"type": "weld", "parent": "strip", "child": "weight", "parent_point_m": [LENGTH, 0, 0]}
    return {
        "model": {"in_space": True, "name": "princeton", "bodies": bodies, "joints": {"wall": wall, "end": end}},
        "initial": {"settle": True},
        "solver": {"end_time_s": 2e-4, "step_s": 1e-4},
    }


def kirchhoff(weight: float, angle: float, stiffness: Array) -> Array:
    """Displacement (3,) m of the end of the same strip in its own frame, by Kirchhoff's equations of a rod.

    With e its orientation as Euler parameters, d its tangent, m the moment and K the stiffness (3,) N m2 about its
    axes: e' = e (0, k) / 2, k = K^-1 R^T m, x' = d, m' = -d x F, and m = 0 at the end.
    """
    from scipy.integrate import solve_bvp

    force, half = np.array([0.0, 0.0, -weight]), 0.5 * np.radians(angle)
    root = np.array([np.cos(half), np.sin(half), 0.0, 0.0])

    def slope(s: Array, y: Array) -> Array:
        del s
        e, R = y[:4], rotations.of_quaternion(y[:4].T)
        k = np.einsum("nji,nj->in", R, y[7:].T) / stiffness[:, None]
        vector = 0.5 * (e[0] * k + np.cross(e[1:].T, k.T).T)
        d = R[:, :, 0].T
        return np.vstack([-0.5 * np.sum(e[1:] * k, axis=0), vector, d, -np.cross(d.T, force).T])

    def ends(first: Array, last: Array) -> Array:
        return np.concatenate([first[:4] - root, first[4:7], last[7:]])

    s = np.linspace(0.0, LENGTH, 40)
    guess = np.zeros((10, len(s)))
    guess[:4], guess[4], guess[8] = root[:, None], s, weight * (LENGTH - s)
    solution = solve_bvp(slope, ends, s, guess, tol=1e-8)
    assert solution.success
    return np.asarray(rotations.of_quaternion(root).T @ solution.y[4:7, -1] - [LENGTH, 0.0, 0.0])


def pendulum(bending: float, elements: int, slender: float = 1.0) -> dict[str, Any]:
    """The source's link on a heavy hub, that strikes sand, in the plane; slender: by which it is thinner, as heavy."""
    section = {"diameter_m": 0.00635 / slender, "density_kg_m3": 7700 * slender**2}
    link = {"type": "link", "length_m": 0.23876, **section}
    flexible = {"bending_stiffness_N_m2": bending, "elements": elements}
    hub = {"type": "rigid", "mass_kg": 0.06, "inertia_kg_m2": 5e-6}
    joints = {
        "pivot": {"type": "hinge", "parent": "ground", "child": "hub", "home_deg": 31},
        "clamp": {"type": "weld", "parent": "hub", "child": "link", "parent_point_m": [0.02, 0.0]},
    }
    model = {"name": "pendulum", "bodies": {"hub": hub, "link": link | {"flexible": flexible}}, "joints": joints}
    solver = {"end_time_s": 0.025, "accuracy": 1e-4}
    start = {"joints": {"pivot": {"rate_rad_s": 6.24}}}
    return {"model": model, "medium": "play_sand", "initial": start, "solver": solver}


def into_space(flat: dict[str, Any], azimuth: float) -> dict[str, Any]:
    """The same in space, turned about the vertical (deg)."""
    deep = copy.deepcopy(flat)
    model = deep["model"]
    model["in_space"] = True
    model["bodies"]["hub"]["inertia_kg_m2"] = dict.fromkeys(("xx", "yy", "zz"), 5e-6)
    model["joints"]["pivot"] |= {"axis": [0, 1, 0], "rpy_deg": [0, 0, azimuth]}
    model["joints"]["clamp"]["parent_point_m"] = [0.02, 0.0, 0.0]
    return deep


def order(numbers: list[int], errors: list[float]) -> float:
    """Order of convergence of errors in a number of elements."""
    return -float(np.polyfit(np.log(numbers), np.log(errors), 1)[0])
