"""Spin-up manoeuvre of Kane, Ryan and Banerjee (1987): a beam whose root is rotated at a growing rate.

The data are those of Simo and Vu-Quoc (1986), "On the dynamics of flexible beams under large overall motions", part II:
length 10 m, E I = 1.4e4 N m2, 1.2 kg/m, rho I = 6e-4 kg m. The beam is rotated about one end by psi(t) = 0.4 (t^2 / 2 +
(tau / 2 pi)^2 (cos(2 pi t / tau) - 1)) rad until tau = 15 s, and at 6 rad/s from then on. In a theory without
centrifugal stiffening the deflection grows without bound, which is why the manoeuvre is a known test.

The reference is the linear theory with centrifugal stiffening for the deflection w(x, t) from the rotating axis,

    mu (w'' + psi'' x - psi'^2 w) + E I w_xxxx - (T w_x)_x = 0,    T = mu psi'^2 (L^2 - x^2) / 2,

solved by Galerkin's method with six modes of a cantilever. Its relative error is of the order of the slope squared, at
most 0.09^2.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from granular_contact import load, simulate

Vector = NDArray[np.float64]
LENGTH, BENDING, LINE, RADIUS_OF_GYRATION, TAU, END = 10.0, 1.4e4, 1.2, np.sqrt(5e-4), 15.0, 18.0
ROOTS = (1.87510407, 4.69409113, 7.85475744, 10.99554073, 14.13716839, 17.27875953)


def angle(t: Vector) -> Vector:
    """Angle psi (rad) of the root at times (n,) s."""
    early = np.minimum(t, TAU)
    turned = 0.4 * (0.5 * early**2 + (TAU / (2.0 * np.pi)) ** 2 * (np.cos(2.0 * np.pi * early / TAU) - 1.0))
    return np.asarray(turned + 6.0 * (t - early))


def theory(t: Vector) -> Vector:
    """Deflection (n,) m of the tip from the rotating axis of the root, by the linear theory."""
    from scipy.integrate import solve_ivp

    x = np.linspace(0.0, LENGTH, 4001)
    shapes, slopes = zip(*(_mode(root, x) for root in ROOTS), strict=True)
    W, S = np.array(shapes), np.array(slopes)
    weigh = np.full(len(x), x[1])
    weigh[[0, -1]] *= 0.5
    mass = LINE * (W * weigh) @ W.T
    stiff = np.diag([BENDING * (root / LENGTH) ** 4 for root in ROOTS]) @ mass / LINE
    centrifugal = LINE * (S * weigh * 0.5 * (LENGTH**2 - x**2)) @ S.T - mass
    lever, n = LINE * (W * weigh) @ x, len(ROOTS)

    def rates(time: float, y: Vector) -> Vector:
        spinning = time < TAU
        rate = 0.4 * (time - TAU / (2.0 * np.pi) * np.sin(2.0 * np.pi * time / TAU)) if spinning else 6.0
        gain = 0.4 * (1.0 - np.cos(2.0 * np.pi * time / TAU)) if spinning else 0.0
        pull = -(stiff + rate**2 * centrifugal) @ y[:n] - gain * lever
        return np.concatenate([y[n:], np.linalg.solve(mass, pull)])

    solution = solve_ivp(rates, (0.0, END), np.zeros(2 * n), t_eval=t, method="LSODA", rtol=1e-9, atol=1e-11)
    return np.asarray(solution.y[:n].T @ W[:, -1])


def _mode(root: float, x: Vector) -> tuple[Vector, Vector]:
    """Mode of a cantilever and its slope (1/m) at positions x (n,) m."""
    k, s = root / LENGTH, root * x / LENGTH
    ratio = (np.cosh(root) + np.cos(root)) / (np.sinh(root) + np.sin(root))
    shape = np.cosh(s) - np.cos(s) - ratio * (np.sinh(s) - np.sin(s))
    return shape, k * (np.sinh(s) + np.sin(s) - ratio * (np.cosh(s) - np.cos(s)))


def config(elements: int) -> dict[str, Any]:
    """Config of the manoeuvre in space, without gravity."""
    diameter = 4.0 * RADIUS_OF_GYRATION
    flexible = {"bending_stiffness_N_m2": BENDING, "elements": elements}
    section = {"diameter_m": diameter, "density_kg_m3": LINE / (0.25 * np.pi * diameter**2)}
    beam = {"type": "link", "length_m": LENGTH, **section, "flexible": flexible}
    t = np.linspace(0.0, END + 1.0, 381)  # a table is constant after its last row
    turn = {"type": "table", "time_s": t.tolist(), "values": np.degrees(angle(t)).tolist()}
    root = {"type": "hinge", "parent": "ground", "child": "beam", "axis": [0, 0, 1]}
    return {
        "model": {"in_space": True, "name": "spin_up", "bodies": {"beam": beam}, "joints": {"root": root}},
        "drives": {"root": {"type": "motion", "angle_deg": turn}},
        "gravity_m_s2": 0.0,
        "solver": {"end_time_s": END, "accuracy": 1e-4, "rest_time_s": None},
    }


def spun_up(elements: int) -> tuple[Vector, Vector, float]:
    """Times (n,) s, deflection (n,) m of the tip and solve time (s), by rigid elements with springs."""
    results = simulate(load(config(elements)))
    return results["time_s"], results["beam_deflection_y_m"], float(results.summary["cost"]["solve_s"])


def rows(counts: list[int]) -> list[tuple[int, float, float, float]]:
    """Number of elements, greatest deflection (m), greatest relative difference from the theory, and solve time (s)."""
    t = np.linspace(0.0, END, 1801)
    exact, table = theory(t), []
    for count in counts:
        time, bent, seconds = spun_up(count)
        off = float(np.abs(np.interp(t, time, bent) - exact).max() / np.abs(exact).max())
        table.append((count, float(np.abs(bent).max()), off, seconds))
    return table
