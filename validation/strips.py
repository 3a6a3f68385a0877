"""Errors of motions by the number of strips, and whether adaptive strips keep their promise.

    python validation/strips.py [--quick]

The bodies are rods, solids, a bent bar, paddles and a double pendulum that rotate in the sand. An error is the largest
distance of the centre of any body from a run with 256 strips a part at the same fixed steps (20 us), relative to the
distance that the fastest centre travels. The table also has total errors of runs with adaptive steps and strips.
"""

from __future__ import annotations

import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

import numpy as np
import yaml

from granular_contact.config import load_scenario
from granular_contact.results import Results
from granular_contact.run import run
from granular_contact.scene import build
from validation.study import Claim, Outcome, script
from validation.tables import markdown

STRIPS, REFERENCE, STEP = (8, 16, 32, 64), 256, 2e-5
ACCURACIES = (1e-2, 1e-3)
DEFAULT = 16
ROD = {"type": "link", "length_m": 0.25, "diameter_m": 0.008, "density_kg_m3": 2700}
BOX = [[-0.03, -0.02], [0.03, -0.02], [0.03, 0.02], [-0.03, 0.02]]
BLADE = [[0, -0.02], [0.12, -0.02], [0.12, 0.02], [0, 0.02]]


@dataclass(frozen=True)
class Case:
    """A body, free or on a hinge, with its medium, the height of the surface (m) and its initial state."""

    body: dict[str, object]
    joint: str
    medium: str
    surface: float
    start: dict[str, float]
    end: float = 0.35

    def config(self, **solver: float) -> dict[str, object]:
        """Config of the case as a dict; solver: further keys of the section `solver`, besides the end time."""
        model = {
            "name": "case",
            "bodies": {"body": self.body},
            "joints": {"joint": {"type": self.joint, "parent": "ground", "child": "body"}},
        }
        return {
            "model": model,
            "medium": self.medium,
            "surface_height_m": self.surface,
            "initial": {"joints": {"joint": self.start}},
            "solver": {"end_time_s": self.end, **solver},
        }


def solid(points: list[list[float]]) -> dict[str, object]:
    """Config of a solid of 1500 kg/m3, 30 mm wide, with a polygon (m) as its section."""
    shape = {"type": "polygon", "points_m": points, "width_m": 0.03}
    return {"type": "rigid", "density_kg_m3": 1500, "shapes": [shape]}


def flight(y: float, angle: float, vx: float, vy: float, rate: float) -> dict[str, float]:
    """Initial state of a free body in m, deg, m/s and rad/s, by the keys of a config."""
    return {"x_m": 0.0, "y_m": y, "angle_deg": angle, "vx_m_s": vx, "vy_m_s": vy, "rate_rad_s": rate}


CASES = {
    "rod, play sand": Case(ROD, "free", "play_sand", 0.0, flight(0.25, 55, 0.0, -2.0, 3)),
    "rod, 3D-RFT, steep": Case(ROD, "free", "rft3d_sand", 0.0, flight(0.25, 55, 0.3, -2.0, 3)),
    "rod, 3D-RFT, flat": Case(ROD, "free", "rft3d_sand", 0.0, flight(0.25, 20, 0.5, -1.5, -6)),
    "rod, 3D-RFT, tumbling": Case(ROD, "free", "rft3d_sand", 0.0, flight(0.25, 80, 0.5, -2.5, 8)),
    "rod, poppy seeds": Case(ROD, "free", "poppy_seeds_close", 0.0, flight(0.25, 40, 0.5, -1.5, 6)),
    "solid, 3D-RFT": Case(solid(BOX), "free", "rft3d_sand", 0.0, flight(0.05, 30, 0.5, -1.5, 6), 0.25),
    "solid, poppy seeds": Case(solid(BOX), "free", "poppy_seeds_close", 0.0, flight(0.05, 10, 0.8, -1.0, 15), 0.25),
    "paddle, 3D-RFT": Case(solid(BLADE), "hinge", "rft3d_sand", -0.05, {"angle_deg": 0, "rate_rad_s": 6}, 0.25),
    "paddle, poppy seeds": Case(
        solid(BLADE), "hinge", "poppy_seeds_close", -0.05, {"angle_deg": 10, "rate_rad_s": 10}, 0.25
    ),
}
QUICK = ("rod, play sand", "rod, 3D-RFT, flat", "solid, poppy seeds", "paddle, poppy seeds")


def simulate(case: Case, strips: int | None, **solver: float) -> Results:
    """Run a case with a number of strips a part; None: the default."""
    config = case.config(**solver)
    if strips is not None:
        config["load"] = {"strips_per_rigid_part": strips}
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "case.yaml"
        path.write_text(yaml.safe_dump(config), encoding="utf-8")
        scenario = load_scenario(path)
    return run(build(scenario), scenario)


def centre(results: Results, at: np.ndarray) -> np.ndarray:
    """Centre of mass (n, 2) m at times (n,) s; after the end of the run, its last position."""
    names = [column.name for column in results.columns]
    columns = ("body_x_m", "body_y_m") if "body_x_m" in names else ("tip_x_m", "tip_y_m")
    return np.column_stack([np.interp(at, results["time_s"], results[name]) for name in columns])


def error(results: Results, reference: Results) -> float:
    """Largest distance of the centre from that of a reference, relative to the path length of the reference."""
    at = np.linspace(0.0, min(results["time_s"][-1], reference["time_s"][-1]), 500)
    exact = centre(reference, at)
    travelled = np.linalg.norm(np.diff(exact, axis=0), axis=1).sum()
    return float(np.linalg.norm(centre(results, at) - exact, axis=1).max() / travelled)


@dataclass(frozen=True)
class Found:
    """Results of a case: errors by `STRIPS`, and (error, steps, strips) for each accuracy.

    told: whether the run with the default settings warned.
    """

    errors: list[float]
    chosen: list[tuple[float, int, int]]
    told: bool


def judge(case: Case) -> Found:
    """Make all runs of a case."""
    reference = simulate(case, REFERENCE, step_s=STEP)
    fixed = [simulate(case, strips, step_s=STEP) for strips in STRIPS]
    chosen = []
    for accuracy in ACCURACIES:
        results = simulate(case, None, accuracy=accuracy)
        strips = results.summary["strips"]["per_rigid_part"]
        chosen.append((error(results, reference), results.summary["cost"]["steps"], strips))
    default = fixed[STRIPS.index(DEFAULT)]
    warned = any("strips" in sentence for sentence in default.warnings)
    return Found([error(results, reference) for results in fixed], chosen, warned)


def percent(value: float) -> str:
    """Format a fraction of one as a percentage."""
    return f"{100 * value:.3f}"


def study(quick: bool) -> Outcome:
    """Run all cases, or those of QUICK."""
    results = {name: judge(CASES[name]) for name in (QUICK if quick else CASES)}
    head = ["case", *(f"{n} strips %" for n in STRIPS)]
    head += [f"accuracy {a:g}: error %, steps, strips" for a in ACCURACIES]
    rows = [
        [
            name,
            *map(percent, result.errors),
            *(f"{percent(off)}, {steps}, {strips}" for off, steps, strips in result.chosen),
        ]
        for name, result in results.items()
    ]
    at_default = {name: result.errors[STRIPS.index(DEFAULT)] for name, result in results.items()}
    silent = max((off for name, off in at_default.items() if not results[name].told), default=0.0)
    promise = [max(result.chosen[i][0] for result in results.values()) / a for i, a in enumerate(ACCURACIES)]
    claims = (
        Claim(
            "strips.no error above 1 % is without a warning",
            silent <= 0.01,
            f"{100 * silent:.2f} % with {DEFAULT} strips",
        ),
        Claim(
            "strips.chosen steps and strips keep the accuracy",
            promise[0] <= 1.0 and promise[1] <= 4.0,
            ", ".join(f"{p:.2f} times {a:g}" for p, a in zip(promise, ACCURACIES, strict=True))
            + " at most (required: 1 and 4)",
        ),
    )
    return Outcome(markdown(head, rows), claims)


if __name__ == "__main__":
    sys.exit(script(study))
