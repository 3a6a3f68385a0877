"""Links that bend in space, and what theory says of them."""

from __future__ import annotations

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
    found = solve_bvp(slope, ends, s, guess, tol=1e-8)
    assert found.success
    return np.asarray(rotations.of_quaternion(root).T @ found.y[4:7, -1] - [LENGTH, 0.0, 0.0])


def order(numbers: list[int], errors: list[float]) -> float:
    """Order of convergence of errors in a number of elements."""
    return -float(np.polyfit(np.log(numbers), np.log(errors), 1)[0])
