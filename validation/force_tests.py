"""Tests of the errors that fits to force tests state: coefficients recovered from synthetic plates pressed or dragged.

    python validation/force_tests.py [--quick]

The data have normal noise. In the last case the grains scatter, too, with another seed in each test, and the fit
separates scatter from noise. The second table has run times of a fit of three tests of 200 rows.
"""

from __future__ import annotations

import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

import numpy as np
from numpy.typing import NDArray
from scipy.stats import binom

from granular_contact.config import load_scenario
from granular_contact.laws.probe import STEADY
from granular_contact.laws.rft import GENERIC, Rft
from granular_contact.laws.scatter import Scatter
from granular_contact.sand.contact_lines import Body, polyline
from granular_contact.sand.load import GranularLoad
from granular_contact.sand.steady import SteadyBody
from granular_contact.scene import build
from granular_contact.studies.fit import fit, load_specification, prepare
from granular_contact.studies.fit.law_alone import Motion, steady_forces
from granular_contact.studies.fit.problem import Problem
from granular_contact.studies.processes import cores, local_processes
from validation.study import Claim, Outcome, script
from validation.tables import markdown

Vector = NDArray[np.float64]

CONFIGS = Path(__file__).parents[1] / "configs"
SIDE = 0.0532  # m, of the square plate
PLATE = "model.bodies.plate.shapes.0.width_m"
DRAWS, QUICK_DRAWS, ROWS = 100, 10, 40


@dataclass(frozen=True)
class Case:
    """A fit: true values and start values by key, the other keys of the medium, and the overrides of each test.

    direction: of the motion, deg below the horizontal; noise: standard deviation, N; more: further keys of `force_test`
    in the fit file; scatter: of the grains, for plates that are pressed in.
    """

    true: dict[str, float]
    start: dict[str, float]
    medium: str
    config: str
    tests: tuple[str, ...]
    direction: float
    noise: float
    more: str = ""
    scatter: Scatter | None = None


PLATES = tuple(f"{PLATE}: {width}" for width in (0.03, 0.0532, 0.08))
REPEATED = (f"{PLATE}: {SIDE}",) * 4
DRAGGED = tuple(f"{PLATE}: {width}" for width in (0.04, 0.06))
CASES = {
    "zeta": Case({"zeta": 0.9}, {"zeta": 0.3}, "law: rft", "penetrometer", PLATES, 90.0, 0.5),
    "zeta and the depth offset": Case(
        {"zeta": 0.9}, {"zeta": 0.3}, "law: rft", "penetrometer", PLATES, 90.0, 0.5, "depth_offset_m: fit"
    ),
    "k and n": Case(
        {"k_phi_Pa": 2e4, "exponent": 1.3},
        {"k_phi_Pa": 1e4, "exponent": 1.0},
        "law: pressure_sinkage, reference_depth_m: 0.02, friction_angle_deg: 29",
        "penetrometer",
        PLATES,
        90.0,
        1.0,
    ),
    "mu": Case(
        {"mu_int": 0.6},
        {"mu_int": 1.0},
        "law: rft3d, density_kg_m3: 1500, mu_surf: 0.3",
        "penetrometer",
        PLATES,
        90.0,
        1.0,
    ),
    "K and lambda of drag": Case(
        {"zeta": 0.8, "lambda": 1.1},
        {"zeta": 0.4, "lambda": 2.0},
        "law: drft, density_kg_m3: 900",
        "dragged_plate",
        DRAGGED,
        0.0,
        0.1,
    ),
    "zeta where grains scatter": Case(
        {"zeta": 0.9},
        {"zeta": 0.3},
        "law: rft",
        "penetrometer",
        REPEATED,
        90.0,
        0.15,
        scatter=Scatter(0.3, 0.003),
    ),
}


def _columns(case: Case, rows: int) -> tuple[Vector, Vector]:
    """Depth (rows,) m and speed (rows,) m/s of a test."""
    if case.direction == 90.0:
        return np.linspace(1e-3, 0.04, rows), np.full(rows, 0.01)
    return np.full(rows, 0.06), np.linspace(0.05, 0.6, rows)


def _medium(case: Case, values: dict[str, float]) -> str:
    return f"{{{', '.join([case.medium, *(f'{key}: {value}' for key, value in values.items())])}}}"


def problem(case: Case, rows: int = ROWS, starts: int = 1) -> Problem:
    """Write files of the tests without noise, and prepare the fit to them."""
    depth, speed = _columns(case, rows)
    text = "scatter: true\nloss: linear\n" if case.scatter is not None else ""
    text += f"starts: {starts}\nparameters: [{', '.join(f'medium.{key}' for key in case.true)}]\n"
    text += f"set: {{medium: {_medium(case, case.start)}}}\n"
    more = f", {case.more}" if case.more else ""
    text += f"force_test: {{direction: {case.direction:.1f}{more}}}\nruns:\n"
    with tempfile.TemporaryDirectory() as folder:
        for i, override in enumerate(case.tests):
            key, value = override.split(": ")
            sets = [f"medium={_medium(case, case.true)}", f"{key}={value}"]
            body = SteadyBody(build(load_scenario(CONFIGS / f"{case.config}.yaml", sets)))
            force = steady_forces(body, Motion(depth, speed, np.zeros(rows), case.direction))["force_N"]
            if case.scatter is not None:  # else all tests have the same data, which the fit refuses
                force = pressed(case.scatter.model_copy(update={"seed": i}), case.true["zeta"], depth)
            lines = [f"{z:.9g},{v:.9g},{f:.12g}" for z, v, f in zip(depth, speed, force, strict=True)]
            (Path(folder) / f"{i}.csv").write_text("\n".join(["depth_m,speed_m_s,force_N", *lines]), encoding="utf-8")
            text += (
                f"  - {{config: {CONFIGS / case.config}.yaml, data: {i}.csv, name: test_{i}, set: {{{override}}}}}\n"
            )
        path = Path(folder) / "fit.yaml"
        path.write_text(text, encoding="utf-8")
        return prepare(load_specification(path))


def pressed(scatter: Scatter, zeta: float, depth: Vector) -> Vector:
    """Force (n,) N on a plate at increasing depths (n,) m in scattering grains.

    The plate is pressed in step by step, since the scatter depends on the path.
    """
    load = GranularLoad(Rft(GENERIC, zeta, scatter=scatter), 0.0, static=STEADY)
    load.add(polyline(Body("plate", [0, 1, 2]), [[-0.5 * SIDE, 0.0], [0.5 * SIDE, 0.0]], width=SIDE, strips=32))
    load.start(np.zeros(3))
    v, force = np.array([0.0, -0.01, 0.0]), []
    for i, z in enumerate(depth):
        q = np.array([0.0, -z, 0.0])
        load.accept(float(i), q, v)
        force.append(load.force(q, v, np.zeros(3))[1])
    return np.array(force)


def noisy(exact: Problem, case: Case, seed: int) -> Problem:
    """Return the problem with noise (N) in its forces, and with scatter of the grains if the case has it."""
    random = np.random.default_rng(seed)
    runs = []
    for i, run in enumerate(exact.runs):
        values = run.measured.values
        if case.scatter is not None:
            grains = case.scatter.model_copy(update={"seed": len(exact.runs) * seed + i + 1})
            depth, _ = _columns(case, len(values))
            values = pressed(grains, case.true["zeta"], depth).reshape(values.shape)
        values = values + case.noise * random.standard_normal(values.shape)
        runs.append(replace(run, measured=replace(run.measured, values=values)))
    return replace(exact, runs=tuple(runs))


Draw = tuple[list[tuple[float, float, float, float]], bool]


def draws(name: str, seeds: Sequence[int]) -> list[Draw]:
    """Fit one draw for each seed; value, error and interval of each coefficient, and whether the fit is a misfit."""
    case, fits = CASES[name], []
    exact = problem(case)
    for seed in seeds:
        result = fit(noisy(exact, case, seed))
        shared = [e for e in result.uncertainty.estimates if e.parameter.shared]
        fits.append(([(e.value, e.error, e.low, e.high) for e in shared], result.goodness.status == "misfit"))
    return fits


def coverage(name: str, count: int) -> tuple[list[list[str]], list[Claim]]:
    """Table rows and claim on how many intervals contain the true value; few draws run in this process."""
    seeds = np.arange(count)
    if count <= QUICK_DRAWS:
        fits = draws(name, seeds.tolist())
    else:
        with local_processes(cores()) as pool:
            parts = [part.tolist() for part in np.array_split(seeds, cores())]
            fits = [draw for part in pool.map(partial(draws, name), parts) for draw in part]
    values = np.array([estimates for estimates, _ in fits])  # (draws, coefficients, 4)
    true = np.array(list(CASES[name].true.values()))
    hits = np.sum((values[:, :, 2] <= true) & (true <= values[:, :, 3]), axis=0)
    alarms = sum(misfit for _, misfit in fits)
    least = 90 if count == 100 else int(binom.ppf(1e-3, count, 0.95))
    low, high = (int(x) for x in binom.interval(0.95, count, 0.95))
    rows = [
        [
            name,
            key,
            f"{true[j]:g}",
            f"{values[:, j, 0].mean():.5g}",
            f"{values[:, j, 0].std(ddof=1):.2g}",
            f"{values[:, j, 1].mean():.2g}",
            f"{hits[j]} of {count}",
            f"{low} to {high}",
        ]
        for j, key in enumerate(CASES[name].true)
    ]
    counts = f"{', '.join(f'{key} {hit}' for key, hit in zip(CASES[name].true, hits, strict=True))} of {count}"
    held = bool(np.all(hits >= least)) and alarms <= max(1, count // 50)
    detail = f"{counts} (required: {least}); {alarms} called a misfit"
    return rows, [Claim(f"force_tests.{name}: 95 % intervals contain the true value", held, detail)]


def timed(name: str, repeats: int) -> list[str]:
    """Processor time (s) of reading, checking and fitting three tests of 200 rows from eight starts, warm."""
    case = CASES[name]
    exact = problem(case, 200, 8)
    fit(noisy(exact, case, 0))
    reading, fitting = [], []
    for seed in range(repeats):
        began = time.process_time()
        tests = problem(case, 200, 8)
        middle = time.process_time()
        fit(noisy(tests, case, seed))
        reading.append(middle - began)
        fitting.append(time.process_time() - middle)
    both = np.array(reading) + np.array(fitting)
    return [
        name,
        *(f"{np.median(seconds):.2f}" for seconds in (reading, fitting)),
        f"{both.min():.2f} to {both.max():.2f}",
    ]


def study(quick: bool) -> Outcome:
    """Run the draws of every case; unless quick also time fits."""
    names = ("zeta", "k and n") if quick else tuple(CASES)
    parts = [coverage(name, QUICK_DRAWS if quick else DRAWS) for name in names]
    head = ["fitted", "", "true", "mean", "scatter", "stated error", "95 % intervals with the true value", "expected"]
    text = [
        f"Two or three tests of {ROWS} rows each (four where grains scatter), noise unknown, soft_l1 (linear where "
        "grains scatter).",
        markdown(head, [row for rows, _ in parts for row in rows]),
    ]
    if not quick:
        times = [timed(name, 5) for name in ("zeta", "k and n")]
        head = ["three tests of 200 rows, 8 starts", "set-up, reading and checks s", "fit s", "sum, range"]
        text += ["Processor time of one core, warm, medians of five.", markdown(head, times)]
    return Outcome("\n\n".join(text), tuple(claim for _, claims in parts for claim in claims))


if __name__ == "__main__":
    sys.exit(script(study))
