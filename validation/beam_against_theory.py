"""The flexible link against theory: static deflection, frequencies, the elastica, and the period of the pendulum.

    python validation/beam_against_theory.py

The finite elements and the modes are those of the package: a scene is built from the default config, and its link is
clamped to the ground or stays on its pivot, and is loaded. This module computes the theory from the dimensions in the
source paper. Orders of convergence are least-squares slopes in the logarithms, without points at round-off.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import exudyn as exu
import numpy as np
from exudyn import itemInterface as items
from exudyn.solver import ComputeODE2Eigenvalues
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from scipy.special import ellipe, ellipeinc, ellipk, ellipkinc

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parent))

from granular_contact.config import load_scenario
from granular_contact.engines.exudyn.build import build as assemble
from granular_contact.engines.modal.arrays import arrays_of
from granular_contact.engines.modal.model import model
from granular_contact.report.figures.panels import blank
from granular_contact.report.figures.style import BLUE, DOUBLE, DPI, FAINT, GREEN, INK, ORANGE, PURPLE, VERMILION, style
from granular_contact.run import run
from granular_contact.scene import build
from granular_contact.scene.parts import InitialMotion
from granular_contact.scene.types import Joint, Reduced, Scene
from validation.study import Claim, Outcome, script
from validation.tables import markdown

CONFIGS = HERE.parent / "configs"
FIGURES = HERE / "figures"
Vector = NDArray[np.float64]
ZERO = np.zeros(2)

# Dimensions of the source paper's link and root, SI units.
RHO, G = 7700.0, 9.81
D1, L1, D2, L2, D, L, EI = 0.01905, 0.019812, 0.01524, 0.01524, 0.00635, 0.23876, 15.1642
OFFSET = D1 / 2 + L2  # distance of the clamp from the pivot
MU = RHO * math.pi * D**2 / 4  # kg/m
EA = EI / (D / 4) ** 2  # for a solid round section
M1, M2, M3 = RHO * math.pi * D1**2 / 4 * L1, RHO * math.pi * D2**2 / 4 * L2, MU * L
ROOT_INERTIA = M1 * D1**2 / 8 + M2 * (L2**2 / 12 + D2**2 / 16 + (D1 / 2 + L2 / 2) ** 2)
BEAM_INERTIA = M3 * (
    L**2 / 12 + (OFFSET + L / 2) ** 2
)  # of a line of mass, as the beam elements have no rotary inertia of their section
MOMENT = M2 * (D1 / 2 + L2 / 2) + M3 * (OFFSET + L / 2)

ELEMENTS, QUICK_ELEMENTS = (1, 2, 4, 8, 16, 32), (2, 4, 8, 16)
MODES = (1, 2, 3, 5, 8, 12, 20)
LOAD = 5.0  # tip force as F L^2 / EI
AMPLITUDES = (5.0, 90.0, 170.0)  # deg
STEPS = (8e-3, 4e-3, 2e-3, 1e-3)  # s
COLOURS, MARKS = (BLUE, VERMILION, GREEN, PURPLE, ORANGE), "osD^v"


def order(values: Sequence[float], errors: Sequence[float], floor: float = 0.0, first: int = 0) -> float:
    """Fitted order of convergence, from the point `first` on and with errors above the floor only."""
    pairs = [(v, abs(e)) for v, e in list(zip(values, errors, strict=True))[first:] if abs(e) > floor]
    return float(-np.polyfit(*np.log(np.array(pairs)).T, 1)[0]) if len(pairs) > 1 else math.nan


def claim(statement: str, held: Any, detail: str) -> Claim:
    """Make a claim of this study."""
    return Claim(f"beam_against_theory.{statement}", bool(held), detail)


def words(numbers: Sequence[float], form: str = ".2f") -> str:
    """Format numbers as a list separated by commas."""
    return ", ".join(format(x, form) for x in numbers)


# ---- computed values: finite elements and modes of the package ----


def pendulum(elements: int = 4, gravity: float = 0.0) -> Scene:
    """Build the pendulum at rest in the horizontal position, in vacuum."""
    overrides = ["medium=null", f"gravity_m_s2={gravity}", f"model.bodies.link.flexible.elements={elements}"]
    overrides += ["initial.impact_angle_deg=0", "initial.impact_speed_rad_s=0"]
    return build(load_scenario(CONFIGS / "pendulum.yaml", overrides))


def cantilever(elements: int, gravity: float = 0.0) -> Scene:
    """Build the link alone, clamped to the ground."""
    scene = pendulum(elements, gravity)
    link = replace(scene.links[0], motion=InitialMotion(ZERO, 0.0, ZERO, 0.0))
    return replace(scene, rigid=(), links=(link,), joints=(Joint("clamp", "weld", None, ZERO, link.name, ZERO),))


def statics(elements: int, *, force: float = 0.0, moment: float = 0.0, gravity: float = 0.0, steps: int = 1) -> Vector:
    """Positions (elements + 1, 2) m of the nodes of the clamped link in static equilibrium.

    force: dead force at the tip, downward, N; moment: at the tip, clockwise, N m; steps: load steps.
    """
    system = assemble(cantilever(elements, gravity))
    mbs, handle = system.mbs, system.links["link"]
    tip = {"bodyNumber": handle.elements[-1], "localPosition": [L / elements, 0.0, 0.0]}
    if force:
        marker = mbs.AddMarker(items.MarkerBodyPosition(**tip))
        mbs.AddLoad(items.LoadForceVector(markerNumber=marker, loadVector=[0.0, -force, 0.0]))
    if moment:
        marker = mbs.AddMarker(items.MarkerBodyRigid(**tip))
        mbs.AddLoad(items.LoadTorqueVector(markerNumber=marker, loadVector=[0.0, 0.0, -moment]))
    mbs.Assemble()
    settings = exu.SimulationSettings()
    settings.staticSolver.numberOfLoadSteps = steps
    settings.staticSolver.newton.relativeTolerance = 1e-10
    settings.staticSolver.newton.absoluteTolerance = 200 * np.finfo(float).eps * EA  # the round-off of the residual
    settings.staticSolver.verboseMode = 0
    settings.solution.file.write = False
    exu.config.printToConsole = False
    mbs.SolveStatic(settings)
    return np.array([mbs.GetNodeOutput(n, exu.OutputVariableType.Position)[:2] for n in handle.nodes])


def fe_frequencies(scene: Scene) -> Vector:
    """Bending frequencies (Hz) of the engine's linearised constrained system, without the rigid-body rotation."""
    system = assemble(scene)
    values, vectors = ComputeODE2Eigenvalues(system.mbs, exu.SimulationSettings())[:2]
    data = system.mbs.systemData
    nodes = np.array([data.GetNodeLTGODE2(n) for n in system.links["link"].nodes])
    along = np.sum(vectors[nodes[:, 0]] ** 2, axis=0)
    across = np.sum(vectors[nodes[:, 1]] ** 2, axis=0)
    frequencies = np.sqrt(np.abs(values)) / (2 * math.pi)
    return np.sort(frequencies[(across > along) & (frequencies > 1.0)])


def reduced_record(modes: int) -> np.void:
    """Record of the modal pendulum: inertia, couplings c, static moments p and stiffness k."""
    return arrays_of(model(pendulum(), Reduced(modes=modes, static="true_sign", rtol=1e-10))).pendulum[0]


def reduced_frequencies(modes: int) -> Vector:
    """Frequencies (modes,) Hz of the modal pendulum on its pivot, without gravity."""
    record = reduced_record(modes)
    mass = np.diag([record["J"], *[record["m"]] * modes]).astype(float)
    mass[0, 1:] = mass[1:, 0] = record["c"][:modes]
    stiffness = np.diag([0.0, *record["k"][:modes]])
    values = np.linalg.eigvals(np.linalg.solve(mass, stiffness)).real
    return np.sqrt(np.sort(values)[1:]) / (2 * math.pi)


# ---- theory ----


def clamped_free(count: int) -> Vector:
    """Frequencies (count,) Hz of an Euler-Bernoulli cantilever: cos(b) cosh(b) = -1."""
    b = [
        brentq(lambda b: math.cos(b) + 1 / math.cosh(b), k * math.pi, (k + 1) * math.pi, xtol=1e-14)
        for k in range(count)
    ]
    return np.array(b) ** 2 * math.sqrt(EI / MU) / (2 * math.pi * L**2)


def hinged(count: int) -> Vector:
    """Frequencies (count,) Hz of the beam on its rigid root, which rotates about the pivot, without gravity.

    y = A cos(b z/L) + B sin(b z/L) + C exp(-b z/L) + E exp(-b (1 - z/L)), free at z = L. At z = 0, with the offset a
    and the inertia J of the root, y = a y' and EI y'' - a EI y''' + w^2 J y' = 0. The frequencies are the zeros of the
    determinant of these four conditions.
    """
    a, j = OFFSET / L, ROOT_INERTIA / (MU * L**3)

    def determinant(b: float) -> float:
        c, s, e = math.cos(b), math.sin(b), math.exp(-b)
        y, y1 = np.array([1, 0, 1, e]), b * np.array([0, 1, -1, e])
        y2, y3 = b**2 * np.array([-1, 0, 1, e]), b**3 * np.array([0, -1, -1, e])
        free = np.array([[-c, -s, e, 1], [s, -c, -e, 1]])
        return float(np.linalg.det(np.vstack([y - a * y1, (y2 - a * y3 + b**4 * j * y1) / b**2, free])))

    grid = np.linspace(0.5, (count + 2) * math.pi, 200 * (count + 2))
    signs = np.sign([determinant(b) for b in grid])
    b = [brentq(determinant, grid[k], grid[k + 1], xtol=1e-13) for k in np.flatnonzero(signs[1:] != signs[:-1])[:count]]
    return np.array(b) ** 2 * math.sqrt(EI / MU) / (2 * math.pi * L**2)


def elastica(force: float = 0.0, weight: float = 0.0, axial: float = EA) -> Vector:
    """Tip position (2,) m of a clamped elastica under a downward dead force (N) at its tip and its weight (N/m).

    Shooting method for EI theta'' = -(1 + e) P cos(theta), with the angle theta below the horizontal as a function of
    the material coordinate S, the axial strain e = P sin(theta) / EA, and P = force + weight (L - S).
    """

    def slope(s: float, state: Vector) -> list[float]:
        theta, bend = state[:2]
        p = force + weight * (L - s)
        stretch = 1.0 + p * math.sin(theta) / axial
        return [bend, -stretch * p * math.cos(theta) / EI, stretch * math.cos(theta), -stretch * math.sin(theta)]

    def shoot(tip_angle: float) -> Vector:
        start = [tip_angle, 0.0, 0.0, 0.0]
        return solve_ivp(slope, (L, 0.0), start, method="DOP853", rtol=1e-13, atol=1e-15).y[:, -1]

    angle = brentq(lambda tip_angle: shoot(tip_angle)[0], 0.0, 0.5 * math.pi, xtol=1e-15, rtol=1e-14)
    return -shoot(angle)[2:]


def elliptic_elastica(load: float) -> Vector:
    """Tip position (2,) m of an inextensible elastica under a dead tip force F = load EI / L^2.

    Bisshopp and Drucker, 1945.
    """

    def modulus(angle: float) -> tuple[float, float]:
        k2 = (1 + math.sin(angle)) / 2
        return k2, math.asin(1 / math.sqrt(2 * k2))

    def excess(angle: float) -> float:
        k2, phi = modulus(angle)
        return float(ellipk(k2) - ellipkinc(phi, k2)) - math.sqrt(load)

    angle = brentq(excess, 1e-9, math.pi / 2 - 1e-9, xtol=1e-15)
    k2, phi = modulus(angle)
    drop = 1 - 2 / math.sqrt(load) * float(ellipe(k2) - ellipeinc(phi, k2))
    return L * np.array([math.sqrt(2 * math.sin(angle) / load), -drop])


def quarter_period(amplitude: float, inertia: float) -> float:
    """Time (s) of a pendulum from rest at an amplitude (deg) to the lowest position."""
    return math.sqrt(inertia / (G * MOMENT)) * float(ellipk(math.sin(math.radians(amplitude) / 2) ** 2))


Part = tuple[str, list[Claim], dict[str, Any]]

# ---- statics ----


def static_part(elements: Sequence[int]) -> Part:
    """Compare tip deflections under the link's own weight, and under the same weight at its tip."""
    weight = M3 * G
    linear = {"own weight": weight * L**3 / (8 * EI), "tip weight": weight * L**3 / (3 * EI)}
    bent = {"own weight": -elastica(weight=weight / L)[1], "tip weight": -elastica(force=weight)[1]}
    loads: dict[str, dict[str, float]] = {"own weight": {"gravity": G}, "tip weight": {"force": weight}}
    record = reduced_record(max(MODES))
    series = {"own weight": G * record["p"] / record["k"], "tip weight": weight / record["k"]}
    rows, data, fe_orders, modal_orders = [], {}, [], []
    for name, load in loads.items():
        fe = [-statics(n, **load)[-1, 1] / bent[name] - 1 for n in elements]
        modal = [float(series[name][:n].sum()) / linear[name] - 1 for n in MODES]
        fe_orders.append(order(elements, fe, 2e-9))
        modal_orders.append(order(MODES, modal, 1e-12, first=2))
        data[name] = {"fe": fe, "modal": modal}
        ends = f"{fe[0]:+.1e} ({elements[0]}), {fe[-1]:+.1e} ({elements[-1]})"
        geometry = f"{bent[name] / linear[name] - 1:+.1e}"
        rows.append([name, f"{1e6 * linear[name]:.3f}", geometry, ends, f"{fe_orders[-1]:.2f}", f"{modal[0]:+.1e}",
                     f"{modal[-1]:+.1e}", f"{modal_orders[-1]:.2f}"])  # fmt: skip
    head = ["load", "linear theory um", "elastica from linear", "FE from elastica (elements)", "order"]
    head += ["1 mode from linear", f"{MODES[-1]} modes", "order"]
    worst = max(abs(data[name]["fe"][-1]) for name in data)
    claims = [
        claim(
            "static deflection by FE",
            worst < 1e-8 and min(fe_orders) > 3.8,
            f"{worst:.1e} off with {elements[-1]} elements (required: 1e-8), orders {words(fe_orders)} under its own "
            "weight and a tip weight (required: at least 4)",
        ),
        claim(
            "static deflection by modes",
            abs(modal_orders[0] - 5) < 0.2 and abs(modal_orders[1] - 3) < 0.2,
            f"orders {words(modal_orders)} under its own weight and a tip weight (required: 5 and 3, the orders of the "
            f"series); one mode {100 * data['own weight']['modal'][0]:+.1f} and "
            f"{100 * data['tip weight']['modal'][0]:+.1f} %",
        ),
    ]
    return f"Tip deflection of the clamped link, relative differences.\n\n{markdown(head, rows)}", claims, data


# ---- frequencies ----


def frequency_part(elements: Sequence[int], count: int = 5) -> Part:
    """Compare the first `count` frequencies of the link, clamped to the ground and on the pivot."""
    theory = {"clamped": clamped_free(count), "hinged": hinged(count)}
    scenes: dict[str, Callable[[int], Scene]] = {"clamped": cantilever, "hinged": pendulum}
    elements = [n for n in elements if n > 2]
    rows, data, fe_orders, modal_orders = [], {}, {}, []
    link = cantilever(1).links[0]
    exact = model(pendulum(), Reduced(modes=count, static="true_sign", rtol=1e-10)).modes.frequencies(
        link.bending_stiffness, link.mass_per_length
    )
    modes = [n for n in MODES if n >= 5]
    for name, scene in scenes.items():
        fe = np.array([fe_frequencies(scene(n))[:count] for n in elements]) / theory[name] - 1
        modal = np.array([reduced_frequencies(n)[:count] for n in modes]) / theory[name] - 1
        modal = modal if name == "hinged" else np.array([exact / theory[name] - 1])
        data[name] = {"elements": elements, "fe": fe, "modes": modes, "modal": modal}
        # The higher modes need more than 4 elements to reach the asymptotic range of convergence.
        fe_orders[name] = [order(elements, fe[:, i], 1e-9, first=int(i > 0)) for i in range(count)]
        for i in range(count):
            finer = ["exact", ""]
            if name == "hinged":
                finer = [f"{modal[-1, i]:+.1e}", f"{order(modes, modal[:, i], 1e-12, first=1):.2f}"]
            rows.append([name, i + 1, f"{theory[name][i]:.3f}", f"{fe[0, i]:+.1e}", f"{fe[-1, i]:+.1e}",
                         f"{fe_orders[name][i]:.2f}", f"{modal[0, i]:+.1e}", *finer])  # fmt: skip
    modal_orders = [order(modes, data["hinged"]["modal"][:, i], 1e-12, first=1) for i in range(count)]
    head = ["root", "mode", "theory Hz", f"FE, {elements[0]}", f"FE, {elements[-1]} elements", "order", "5 modes",
            f"{modes[-1]} modes", "order"]  # fmt: skip
    finest = max(np.abs(data[name]["fe"][-1]).max() for name in data)
    every = [*fe_orders["clamped"], *fe_orders["hinged"]]
    worst = float(np.abs(data["clamped"]["modal"]).max())
    first, last = theory["clamped"][0], float(np.abs(data["hinged"]["modal"][-1]).max())
    claims = [
        claim("first frequency", abs(first - 77.4) < 0.05, f"{first:.3f} Hz clamped and free (required: 77.4)"),
        claim(
            "frequencies by FE",
            finest < 1e-3 and all(abs(x - 4) < 0.2 for x in every),
            f"ten frequencies at most {finest:.1e} off with {elements[-1]} elements (required: 1e-3), orders "
            f"{min(every):.2f} to {max(every):.2f} (required: 4)",
        ),
        claim("clamped frequencies by modes", worst < 1e-10, f"at most {worst:.1e} off (required: 1e-10)"),
        claim(
            "hinged frequencies by modes",
            last < 1e-5 and min(modal_orders) > 4.8,
            f"with {modes[-1]} modes at most {last:.1e} off in the first five (required: 1e-5); "
            f"orders {words(modal_orders)} (required: at least 5)",
        ),
    ]
    return (
        f"Frequencies of bending without gravity, relative differences from theory.\n\n{markdown(head, rows)}",
        claims,
        data,
    )


# ---- the elastica ----


def elastica_part(elements: Sequence[int]) -> Part:
    """Compare large deflections under a tip force, and under the moment that bends the link to a half circle."""
    force = LOAD * EI / L**2
    exact = {"tip force": elastica(force=force), "tip moment": np.array([0.0, -2 * L / math.pi])}
    shapes = {
        "tip force": [statics(n, force=force, steps=20) for n in elements],
        "tip moment": [statics(n, moment=math.pi * EI / L, steps=40) for n in elements],
    }
    errors = {name: [float(np.linalg.norm(s[-1] - exact[name])) / L for s in shapes[name]] for name in shapes}
    asymptotic = list(elements).index(4)
    orders = {name: order(elements, errors[name], 1e-9, first=asymptotic) for name in shapes}
    rows = [[name, *(f"{e:.1e}" for e in errors[name]), f"{orders[name]:.2f}"] for name in shapes]
    head = ["error of the tip over L", *(f"{n} element{'s' * (n > 1)}" for n in elements), "order from 4"]
    rigid = elastica(force=force, axial=1e12 * EA)
    closed = float(np.linalg.norm(rigid - elliptic_elastica(LOAD))) / L
    loads = np.array([0.05, 0.1, 0.2, 0.4])
    linear = [x / 3 * L / -elliptic_elastica(x)[1] - 1 for x in loads]
    limit = brentq(lambda x: x / 3 * L / -elliptic_elastica(x)[1] - 1.01, 0.05, 2.0)
    slope = -order(loads, linear)
    claims = [
        claim("elastica by shooting", closed < 1e-10, f"{closed:.1e} L from the elliptic integrals (required: 1e-10)"),
        claim(
            "elastica by FE",
            min(orders.values()) > 3.8 and max(e[-1] for e in errors.values()) < 2e-5,
            f"orders {words(list(orders.values()))} under tip force and moment (required: at least 4), at most "
            f"{max(e[-1] for e in errors.values()):.1e} L off with {elements[-1]} elements (required: 2e-5)",
        ),
        claim(
            "modes are linear",
            abs(slope - 2) < 0.1,
            "any number of modes bends too far, by an error that grows with the square of the load (fitted "
            f"{slope:.2f}), by 1 % at F L^2/EI = {limit:.2f}, a deflection of {limit / 3 / 1.01:.2f} L",
        ),
    ]
    caption = f"Elastica: dead tip force F L^2/EI = {LOAD:g} (stretch included), tip moment to a half circle."
    data = {"shapes": {k: v[-1] for k, v in shapes.items()}, "errors": errors, "exact": exact, "elements": elements}
    return f"{caption}\n\n{markdown(head, rows)}", claims, data


# ---- the period ----


def swing(config: str, amplitude: float, step: float, *overrides: str) -> float:
    """Time (s) from rest at an amplitude (deg) to the lowest position, by a cubic through the step around it."""
    scenario = load_scenario(
        CONFIGS / config,
        [
            "medium=null",
            f"initial.impact_angle_deg={90 - amplitude}",
            "initial.impact_speed_rad_s=0",
            "solver.rest_time_s=null",
            f"solver.end_time_s={1.1 * quarter_period(amplitude, ROOT_INERTIA + BEAM_INERTIA)}",
            f"solver.step_s={step}",
            "solver.tolerance=1e-8",
            *overrides,
        ],
    )
    results = run(build(scenario), scenario)
    time, rate = results["time_s"], results["pivot_rate_rad_s"]
    angle = np.radians(results["pivot_angle_deg"]) - 0.5 * math.pi
    k = int(np.flatnonzero((angle[:-1] < 0) & (angle[1:] >= 0))[0])
    h = time[k + 1] - time[k]

    def cubic(x: float) -> float:
        ends = (1 + 2 * x) * (1 - x) ** 2 * angle[k] + x**2 * (3 - 2 * x) * angle[k + 1]
        return float(ends + h * (x * (1 - x) ** 2 * rate[k] + x**2 * (x - 1) * rate[k + 1]))

    return float(time[k] + h * brentq(cubic, 0.0, 1.0))


def period_part() -> Part:
    """Compare periods of small and large swings in vacuum with the complete elliptic integral."""
    line = ROOT_INERTIA + BEAM_INERTIA
    solid = line + M3 * D**2 / 16  # a rigid bar has the rotary inertia of its section
    models = {
        "rigid, reduced": ("pendulum.yaml", 1e-3, solid, "method={reduced: {modes: 0, rtol: 1e-10}}"),
        "rigid, engine": ("pendulum_rigid.yaml", 1e-4, solid),
        "one mode": ("pendulum.yaml", 1e-3, line, "method={reduced: {modes: 1, rtol: 1e-9}}"),
        "FE": ("pendulum.yaml", 2e-4, line),
    }
    errors = {
        name: [swing(config, a, step, *more) / quarter_period(a, inertia) - 1 for a in AMPLITUDES]
        for name, (config, step, inertia, *more) in models.items()
    }
    exact = [4 * quarter_period(a, solid) for a in AMPLITUDES]
    rows = [["period of the rigid pendulum s", *(f"{t:.6f}" for t in exact)]]
    rows += [[f"{name} from theory", *(f"{e:+.1e}" for e in errors[name])] for name in models]
    steps = [swing("pendulum_rigid.yaml", 90.0, h) / quarter_period(90.0, solid) - 1 for h in STEPS]
    fitted = -order(STEPS, steps)
    reduced, engine = (max(map(abs, errors[name])) for name in list(models)[:2])
    bending = max(max(map(abs, errors[name])) for name in list(models)[2:])
    claims = [
        claim(
            "period of the rigid pendulum",
            reduced < 1e-8 and engine < 1e-5 and abs(fitted - 2) < 0.1,
            f"at 5, 90 and 170 deg at most {reduced:.1e} off reduced (required: 1e-8), {engine:.1e} by the engine with "
            f"a step of 0.1 ms (required: 1e-5), whose order in the step is {fitted:.2f} (required: 2)",
        ),
        claim(
            "period of the flexible pendulum",
            bending < 1e-4,
            f"one mode and FE at most {bending:.1e} from the rigid one (required: 1e-4)",
        ),
    ]
    head = ["amplitude", *(f"{a:g} deg" for a in AMPLITUDES)]
    return (
        f"Period in vacuum, relative differences from theory; FE of 4 elements.\n\n{markdown(head, rows)}",
        claims,
        {"steps": steps},
    )


# ---- the figure ----


def draw(static: Any, frequency: Any, bent: Any, period: Any) -> str:
    """Draw the figure; return its link in Markdown."""
    with style():
        figure = blank(DOUBLE, 112.0, layout="constrained")
        figure.get_layout_engine().set(wspace=0.05, hspace=0.06)
        panels = figure.subplots(2, 3).flat
        draw_static(next(panels), static)
        for name, title in (
            ("clamped", "(b) frequencies, clamped and free"),
            ("hinged", "(c) frequencies, on the pivot"),
        ):
            draw_frequencies(next(panels), frequency[name], title, name == "hinged")
        draw_shapes(next(panels), bent)
        draw_elastica(next(panels), bent)
        axes = next(panels)
        axes.loglog(np.array(STEPS) * 1e3, np.abs(period["steps"]), "o-", color=BLUE)
        guide(axes, np.array(STEPS) * 1e3, abs(period["steps"][-1]) * 0.4, 2, -1)
        label(axes, "(f) period from 90°, rigid, engine", "step (ms)")
        figure.savefig(FIGURES / "beam_against_theory.png", dpi=DPI)
    return "![Errors of elements, modes and steps against closed forms](figures/beam_against_theory.png)"


def label(axes: Axes, title: str, across: str, up: str = "relative error") -> None:
    """Set title and labels of axes; ticks at counts are plain numbers."""
    axes.set_title(title, loc="left")
    axes.set_xlabel(across)
    axes.set_ylabel(up)
    if axes.get_xscale() == "log":
        ticks = [t for t in (1, 2, 4, 8, 16, 32) if axes.get_xlim()[0] <= t <= axes.get_xlim()[1]]
        axes.set_xticks(ticks, [str(t) for t in ticks])
        axes.minorticks_off()


def guide(axes: Axes, places: Sequence[float] | Vector, at: float, power: float, where: int) -> None:
    """Draw a faint line of slope `power` through the point (places[where], at), labelled with its slope."""
    x = np.array(places, float)
    y = at * (x / x[where]) ** power
    axes.loglog(x, y, ":", color=FAINT, linewidth=0.9)
    low, side = int(np.argmin(y)), math.copysign(3.0, power)
    text = f"slope {power:g}".replace("-", "\u2212")
    look = {"ha": "right" if side < 0 else "left", "va": "center", "color": FAINT, "fontsize": 7}
    axes.annotate(text, (x[low], y[low]), xytext=(4 * side, 0), textcoords="offset points", **look)


def draw_static(axes: Axes, data: Any) -> None:
    """Draw the error of the modal series in the static tip deflection."""
    for (name, errors), colour, mark in zip(data.items(), COLOURS, MARKS, strict=False):
        axes.loglog(MODES, np.abs(errors["modal"]), f"{mark}-", color=colour, label=name)
    guide(axes, (3, 20), 0.3 * abs(data["own weight"]["modal"][-1]), -5, -1)
    guide(axes, (5, 20), 0.5 * abs(data["tip weight"]["modal"][-1]), -3, -1)
    axes.legend(loc="upper right")
    label(axes, "(a) static deflection by modes", "modes")


def draw_frequencies(axes: Axes, data: Any, title: str, modal: bool) -> None:
    """Draw the errors of five frequencies over the number of elements and, if `modal`, of modes."""
    for i, (colour, mark) in enumerate(zip(COLOURS, MARKS, strict=True)):
        axes.loglog(data["elements"], np.abs(data["fe"][:, i]), f"{mark}-", color=colour, label=f"{i + 1}")
        if modal:
            look = {"color": colour, "markerfacecolor": "white", "linewidth": 0.7}
            axes.loglog(data["modes"], np.abs(data["modal"][:, i]), f"{mark}--", **look)
    guide(axes, data["elements"], 0.25 * abs(data["fe"][-1, 0]), -4, -1)
    handles, _ = axes.get_legend_handles_labels()
    if modal:
        handles = [Line2D([], [], color=INK, label="FE"), Line2D([], [], color=INK, linestyle="--", label="modes")]
    if modal:
        axes.legend(handles=handles, loc="lower left")
    else:
        axes.set_ylim(None, 8.0)
        axes.legend(title="mode", title_fontsize=7, ncols=5, loc="upper right", handlelength=1.0)
    label(axes, title, "elements or modes" if modal else "elements")


def draw_shapes(axes: Axes, data: Any) -> None:
    """Draw bent shapes by finite elements, with the exact positions of the tip."""
    names = {"tip force": f"force {LOAD:g} EI/L²", "tip moment": "moment π EI/L"}
    for (name, nodes), colour in zip(data["shapes"].items(), COLOURS, strict=False):
        axes.plot(*nodes.T / L, "-", color=colour, label=f"FE, {names[name]}")
        axes.plot(*data["exact"][name] / L, "o", color=INK, markerfacecolor="none", markersize=5)
    axes.plot([], [], "o", color=INK, markerfacecolor="none", markersize=5, label="exact tip")
    axes.set_xlim(-0.3, 1.2)
    axes.set_ylim(-0.85, 0.5)
    axes.set_aspect("equal", adjustable="box")
    axes.legend(loc="upper left")
    label(axes, "(d) elastica", "x / L", "y / L")


def draw_elastica(axes: Axes, data: Any) -> None:
    """Draw the error of the tip position over the number of elements."""
    for (name, errors), colour, mark in zip(data["errors"].items(), COLOURS, MARKS, strict=False):
        axes.loglog(data["elements"], errors, f"{mark}-", color=colour, label=name)
    guide(axes, data["elements"], 0.3 * min(e[-1] for e in data["errors"].values()), -4, -1)
    axes.legend(loc="upper right")
    label(axes, "(e) tip of the elastica", "elements", "error (L)")


# ---- the study ----


def study(quick: bool) -> Outcome:
    """Run all parts; draw the figure unless quick."""
    elements = QUICK_ELEMENTS if quick else ELEMENTS
    parts = [static_part(elements), frequency_part(elements), elastica_part(elements), period_part()]
    texts = [text for text, _, _ in parts]
    if not quick:
        texts.append(draw(*(data for _, _, data in parts)))
    return Outcome("\n\n".join(texts), tuple(claim for _, claims, _ in parts for claim in claims))


if __name__ == "__main__":
    sys.exit(script(study))
