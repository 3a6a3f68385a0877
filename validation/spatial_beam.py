"""Beam models for links that bend in space: the engine's elements and rigid elements with springs, error and run time.

    python validation/spatial_beam.py [--quick]

Statics: the strip of Dowell and Traybar's experiment in Princeton (1975) carries a weight at its end, with its section
turned about its axis by 0, 45 and 90 degrees. The reference is Kirchhoff's rod, solved as a boundary value problem.
Dynamics: a rod clamped to a wall is released and falls. The reference is 48 of the engine's cable elements with a
quarter of the step. This module assembles the engine's elements as the engine's own examples do; the rigid elements are
those of the package. Three more cases use rigid elements only: Kane's spin-up (`spin_up`), links from soft to stiff in
sand (`soft_and_stiff`), and links that curl (`curled`).
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterable
from functools import partial
from itertools import pairwise
from pathlib import Path
from typing import Any

import exudyn as exu
import numpy as np
from exudyn import itemInterface as items
from numpy.typing import NDArray

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE.parent), str(HERE.parent / "tests" / "space")]

from support_bending import LENGTH, MODULUS, POISSON, THICKNESS, WIDTH, kirchhoff, order, princeton

from granular_contact import load, simulate
from granular_contact.scene.space.section import Section
from validation import curled, soft_and_stiff, spin_up
from validation.study import Claim, Outcome, script
from validation.tables import markdown

Vector = NDArray[np.float64]
WEIGHT = 8.896  # N, the second load of the experiment
STRIP = Section(None, WIDTH, THICKNESS)
SHEAR = MODULUS / (2.0 * (1.0 + POISSON))
STIFFNESS = np.array([SHEAR * STRIP.torsion_constant, *(MODULUS * STRIP.second_moments)])
# The falling rod: round, of soft plastic.
FALLS, DIAMETER, YOUNG, DENSITY, DURATION = 0.4, 0.006, 2e9, 1200.0, 0.15
ROD = Section(DIAMETER, DIAMETER, DIAMETER)
CABLE, BEAM, EXACT, RIGID = "ObjectANCFCable", "ObjectANCFBeam", "ObjectBeamGeometricallyExact", "rigid elements"


def claim(statement: str, held: Any, detail: str) -> Claim:
    """Make a claim of this study."""
    return Claim(f"spatial_beam.{statement}", bool(held), detail)


# ---- beams of the engine ----


def hold(mbs: Any, node: Any, coordinates: Iterable[int]) -> None:
    """Fix coordinates of a node at their initial values."""
    ground = mbs.AddMarker(items.MarkerNodeCoordinate(nodeNumber=mbs.AddNode(items.NodePointGround()), coordinate=0))
    for i in coordinates:
        marker = mbs.AddMarker(items.MarkerNodeCoordinate(nodeNumber=node, coordinate=i))
        mbs.AddObject(items.ObjectConnectorCoordinate(markerNumbers=[ground, marker]))


def heavy_cables(mbs: Any, nodes: list[Any], **options: Any) -> list[Any]:
    """Add a cable element with weight between each pair of neighbouring nodes; options: of every element."""
    cables = [mbs.AddObject(items.ObjectANCFCable(nodeNumbers=list(pair), **options)) for pair in pairwise(nodes)]
    for cable in cables:
        marker = mbs.AddMarker(items.MarkerBodyMass(bodyNumber=cable))
        mbs.AddLoad(items.LoadMassProportional(markerNumber=marker, loadVector=[0, 0, -9.81]))
    return cables


# ---- the strip ----


def _material() -> Any:
    data, area = exu.BeamSection(), STRIP.area
    data.stiffnessMatrix = np.diag([MODULUS * area, SHEAR * area, SHEAR * area, *STIFFNESS])
    data.inertia, data.massPerLength = 1e-9 * np.eye(3), 1e-3 * area
    return data


def _by_engine(kind: str, count: int, angle: float) -> Vector:
    """Displacement (3,) m of the end of the strip by elements of the engine, in the axes of its section."""
    mbs = exu.SystemContainer().AddSystem()
    node_types: dict[str, tuple[list[float], Any]] = {
        CABLE: ([1.0, 0.0, 0.0], items.NodePointSlope1),
        BEAM: ([0.0, 1.0, 0.0, 0.0, 0.0, 1.0], items.NodePointSlope23),
        EXACT: ([1.0, 0.0, 0.0, 0.0], items.NodeRigidBodyEP),
    }
    slopes, node = node_types[kind]
    nodes = [mbs.AddNode(node(referenceCoordinates=[x, 0, 0, *slopes])) for x in np.linspace(0.0, LENGTH, count + 1)]
    for pair in pairwise(nodes):
        options: dict[str, Any] = {"nodeNumbers": list(pair), "length": LENGTH / count}
        if kind == CABLE:
            bending = float(STIFFNESS[1 if angle == 0.0 else 2])
            options |= {"massPerLength": 1e-3, "bendingStiffness": bending, "axialStiffness": MODULUS * STRIP.area}
            mbs.AddObject(items.ObjectANCFCable(**options))
            continue
        options["sectionData"] = _material()
        if kind == BEAM:
            options["crossSectionPenaltyFactor"] = [10.0] * 3  # as in the engine's own test of this strip
        mbs.AddObject(getattr(items, kind)(**options))
    # The first Euler parameter is left free: the norm condition of the Euler parameters determines it.
    hold(mbs, nodes[0], range(len(slopes) + 3) if kind != EXACT else (0, 1, 2, 4, 5, 6))
    a = np.radians(angle)
    force = [0.0, -WEIGHT * np.sin(a), -WEIGHT * np.cos(a)]
    tip = mbs.AddMarker(items.MarkerNodePosition(nodeNumber=nodes[-1]))
    mbs.AddLoad(items.LoadForceVector(markerNumber=tip, loadVector=force))
    mbs.Assemble()
    settings = exu.SimulationSettings()
    settings.staticSolver.numberOfLoadSteps = 5
    settings.staticSolver.adaptiveStep = True
    settings.staticSolver.newton.absoluteTolerance = 1e-6
    settings.staticSolver.newton.relativeTolerance = 1e-8
    settings.staticSolver.verboseMode = 0
    settings.solution.file.write = False
    exu.config.printToConsole = False
    mbs.SolveStatic(settings)
    return np.asarray(mbs.GetNodeOutput(nodes[-1], exu.OutputVariableType.Displacement))


def _by_rigid_elements(count: int, angle: float) -> Vector:
    results = simulate(load(princeton(WEIGHT, angle, count)))
    return np.array([0.0, results["strip_deflection_y_m"][0], results["strip_deflection_z_m"][0]])


def strip_errors(kind: str, counts: list[int], angle: float) -> list[float]:
    """Relative errors of the deflection for each number of elements."""
    exact, errors = kirchhoff(WEIGHT, angle, STIFFNESS)[1:], []
    for count in counts:
        displacement = _by_rigid_elements(count, angle) if kind == RIGID else _by_engine(kind, count, angle)
        errors.append(float(np.linalg.norm(displacement[1:] - exact) / np.linalg.norm(exact)))
    return errors


# ---- the falling rod ----


def implicit(end: float, step: float) -> Any:
    """Settings of Exudyn for the falling beam; sensors store every step (s)."""
    settings = exu.SimulationSettings()
    t = settings.timeIntegration
    t.endTime, t.numberOfSteps, t.verboseMode = end, round(end / step), 0
    t.newton.useModifiedNewton, t.newton.absoluteTolerance, t.newton.relativeTolerance = True, 1e-5, 1e-8
    t.generalizedAlpha.spectralRadius = 0.9
    settings.solution.file.write, settings.solution.sensors.writePeriod = False, step
    settings.linearSolver.solverType = exu.LinearSolverType.EigenSparse
    return settings


def fallen_by_cables(count: int, step: float) -> tuple[Vector, Vector, float]:
    """Times (n,) s, height of the end (n,) m and processor time (s), by the engine's cable elements without torsion."""
    mbs = exu.SystemContainer().AddSystem()
    line, bending = DENSITY * ROD.area, YOUNG * float(ROD.second_moments[0])
    nodes = [
        mbs.AddNode(items.NodePointSlope1(referenceCoordinates=[x, 0, 0, 1, 0, 0]))
        for x in np.linspace(0.0, FALLS, count + 1)
    ]
    stiff = {"bendingStiffness": bending, "axialStiffness": YOUNG * ROD.area}
    heavy_cables(mbs, nodes, length=FALLS / count, massPerLength=line, **stiff)
    hold(mbs, nodes[0], range(6))
    sensor = mbs.AddSensor(
        items.SensorNode(nodeNumber=nodes[-1], storeInternal=True, outputVariableType=exu.OutputVariableType.Position)
    )
    mbs.Assemble()
    exu.config.printToConsole = False
    settings = implicit(DURATION, step)
    began = time.process_time()
    mbs.SolveDynamic(settings)
    seconds = time.process_time() - began
    sensor_data = mbs.GetSensorStoredData(sensor)
    return sensor_data[:, 0], sensor_data[:, 3], seconds


def fallen_by_rigid_elements(count: int, step: float, method: str = "minimal") -> tuple[Vector, Vector, float]:
    """Times (n,) s, height of the end (n,) m and solve time (s), by the package's rigid elements with springs.

    method: minimal coordinates or the engine.
    """
    flexible = {"youngs_modulus_Pa": YOUNG, "elements": count}
    rod = {"type": "link", "length_m": FALLS, "diameter_m": DIAMETER, "density_kg_m3": DENSITY, "flexible": flexible}
    wall = {"type": "weld", "parent": "ground", "child": "rod"}
    model = {"in_space": True, "name": "falls", "bodies": {"rod": rod}, "joints": {"wall": wall}}
    solver = {"end_time_s": DURATION, "step_s": step, "spectral_radius": 0.9, "rest_time_s": None}
    results = simulate(load({"model": model, "solver": solver, "method": method}))
    return results["time_s"], results["tip_z_m"], float(results.summary["cost"]["solve_s"])


def fall_errors(
    fallen: Callable[[int, float], tuple[Vector, Vector, float]], counts: list[int], step: float, exact: Vector
) -> list[tuple[float, float]]:
    """Error of the height of the end, relative to its path length, and run time (s) for each number of elements.

    exact (2, n): times (s) and heights (m) of the reference.
    """
    rows = []
    for count in counts:
        seconds = []
        for _ in range(2):
            t, z, took = fallen(count, step)
            seconds.append(took)
        path_length = float(np.abs(np.diff(exact[1])).sum())
        rows.append((float(np.abs(np.interp(exact[0], t, z) - exact[1]).max()) / path_length, min(seconds)))
    return rows


# ---- the study ----


def study(quick: bool) -> Outcome:
    """Run all cases."""
    counts = [4, 8, 16] if quick else [4, 8, 16, 32]
    rows, rigid = [], {}
    for kind in (CABLE, BEAM, EXACT, RIGID):
        for angle in (0.0, 45.0, 90.0):
            if kind == CABLE and angle == 45.0:
                rows.append([kind, angle, *["bends alike about both axes"] * len(counts), ""])
                continue
            errors = strip_errors(kind, counts, angle)
            power = order(counts, errors)
            rows.append([kind, f"{angle:g}", *(f"{error:.1e}" for error in errors), f"{power:.2f}"])
            if kind == RIGID:
                rigid[angle] = errors, power
    strip = markdown(["beam", "section rotated by, deg", *(f"{n} elements" for n in counts), "order"], rows)
    t, z, _ = fallen_by_cables(24 if quick else 48, 1.25e-4)
    exact, falls = np.array([t, z]), []
    by_engine = partial(fallen_by_rigid_elements, method="engine")
    models = (
        (CABLE, fallen_by_cables),
        (f"{RIGID}, minimal coordinates", fallen_by_rigid_elements),
        (f"{RIGID}, by the engine", by_engine),
    )
    for kind, fallen in models:
        for count, (error, took) in zip(counts, fall_errors(fallen, counts, 5e-4, exact), strict=True):
            falls.append([kind, count, f"{error:.1e}", f"{took:.3f}"])
    fall = markdown(["beam", "elements", "error of the end over its path", "s"], falls)
    powers = [power for _, power in rigid.values()]
    at_eight = [errors[1] for errors, _ in rigid.values()]
    claims = (
        claim(
            "rigid elements in the strip",
            all(abs(power - 2.0) < 0.1 for power in powers) and max(at_eight) < 5e-3,
            f"orders {', '.join(f'{p:.2f}' for p in powers)} at 0, 45 and 90 deg (required: 2), with 8 elements "
            f"{100 * max(at_eight):.2f} % error at most (required: 0.5)",
        ),
        claim(
            "rigid elements in the fall",
            float(falls[len(counts) + 2][2]) < 5e-3,
            f"with 16 elements {falls[len(counts) + 2][2]} of the path length as error (required: 5e-3)",
        ),
    )
    text = f"Strip with a weight of {WEIGHT} N at its end: error of the deflection, relative.\n\n{strip}\n\n"
    text += f"Rod that falls for {DURATION} s, in steps of 0.5 ms.\n\n{fall}\n\n"
    parts = [_spin_up([4, 8, 16]), _soft_and_stiff(quick)]
    names = list(curled.CASES)
    curls, silent, (least, most) = curled.curled([4, 8] if quick else [4, 8, 16], names[:2] if quick else names)
    curl_claims = (
        claim(
            "links that curl have no large error without a warning",
            silent < 0.02,
            f"largest error without a warning {100 * silent:.1f} % (required: 2)",
        ),
        claim(
            "error estimates of links that curl are correct",
            least > 0.4 and most < 10.0,
            f"estimates are {least:.2f} to {most:.1f} times the error (required: 0.4 to 10)",
        ),
    )
    tables = [*(table for table, _ in parts), curls]
    return Outcome(text + "\n\n".join(tables), (*claims, *(part for _, part in parts), *curl_claims))


def _spin_up(counts: list[int]) -> tuple[str, Claim]:
    """Table and claim of Kane's spin-up manoeuvre."""
    rows = spin_up.rows(counts)
    cells = [[n, f"{1e3 * most:.1f}", f"{off:.1e}", f"{took:.2f}"] for n, most, off, took in rows]
    table = markdown(["elements", "largest deflection, mm", "largest difference from the theory, relative", "s"], cells)
    off = rows[-1][2]
    detail = (
        f"with {counts[-1]} elements {100 * off:.2f} % of the largest deflection from the linear theory (required: 1)"
    )
    caption = "Spin-up of Kane, Ryan and Banerjee, rigid elements in minimal coordinates."
    return f"{caption}\n\n{table}", claim("spin-up", off < 0.01, detail)


def _soft_and_stiff(quick: bool) -> tuple[str, Claim]:
    """Table and claim of links with a stiffness from that of a rope to that of a rod that hardly bends."""
    cases = soft_and_stiff.cases((1e-4, 1.0, 1e6) if quick else soft_and_stiff.FACTORS, 64 if quick else 256)
    header = ["stiffness factor", "elements", "error of the tip over its path", "warning", "energy imbalance", "s"]
    silent = max(case.error for case in cases if not case.told)
    worst = max(case.imbalance for case in cases)
    held = silent < 0.01 and worst < 1e-3
    detail = (
        f"largest error without a warning {100 * silent:.2f} % (required: 1), imbalance {worst:.1e} (required: 1e-3)"
    )
    caption = (
        "The source's link on a hub strikes play sand at 31 deg, with its stiffness multiplied by a factor; "
        "`solver.accuracy: 1e-3`."
    )
    return f"{caption}\n\n{markdown(header, [case.cells for case in cases])}", claim("soft and stiff", held, detail)


if __name__ == "__main__":
    sys.exit(script(study))
