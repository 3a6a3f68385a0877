"""Sobol indices of the pendulum's stopping time and angle at stop, for six inputs and for the four coefficients alone.

    python validation/sensitivity.py [--quick]

The system is the source's pendulum with a rigid link, in the reduced model. eta_d, eta_h and eta_v range over their
values for play sand plus or minus half, lambda from 0.8 to 1.4; these ranges are our choice, not measurements. Impact
speeds and angles range over those of the twelve impacts. The indices depend on these ranges.
"""

from __future__ import annotations

import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

from granular_contact.config import Sweep, load_sweep
from granular_contact.report.figures.studies import draw_sensitivity
from granular_contact.scene import build
from granular_contact.studies.sweep import Journal, WorkerPool, run, sensitivity
from granular_contact.studies.sweep.sensitivity import Indices
from validation.study import Claim, Outcome, script
from validation.tables import markdown

ROOT = Path(__file__).parents[1]
FIGURES = Path(__file__).parent / "figures"
OUTPUTS = ("stopping_time_s", "angle_at_stop_deg")
COEFFICIENTS = {
    "medium.eta_d": (3.25, 9.75),
    "medium.eta_h": (4.0, 12.0),
    "medium.plunging.eta_v": (11.0, 33.0),
    "medium.plunging.lambda": (0.8, 1.4),
}
IMPACT = {"initial.impact_speed_rad_s": (1.75, 9.17), "initial.impact_angle_deg": (22.0, 61.5)}
SYMBOLS = {
    "medium.eta_d": "eta_d",
    "medium.eta_h": "eta_h",
    "medium.plunging.eta_v": "eta_v",
    "medium.plunging.lambda": "lambda",
    "initial.impact_speed_rad_s": "speed",
    "initial.impact_angle_deg": "angle",
}
COUNT, QUICK_COUNT = 1024, 32


@dataclass(frozen=True)
class Design:
    """A design of runs: its name in the tables, and the range of each input."""

    name: str
    ranges: dict[str, tuple[float, float]]


DESIGNS = (
    Design("all six inputs", {**COEFFICIENTS, **IMPACT}),
    Design("the coefficients, at 31 deg and 6.24 rad/s", COEFFICIENTS),
)


def sweep_of(design: Design, count: int, folder: Path) -> Sweep:
    lines = "".join(f"    {key}: [{low}, {high}]\n" for key, (low, high) in design.ranges.items())
    path = folder / "design.yaml"
    path.write_text(
        f"config: {ROOT / 'configs' / 'pendulum.yaml'}\n"
        "set: {method: {reduced: {modes: 0}}, output.figures: false}\n"
        f"sample:\n  method: saltelli\n  count: {count}\n  outputs: [{', '.join(OUTPUTS)}]\n  ranges:\n{lines}",
        encoding="utf-8",
    )
    return load_sweep(path, probe=build)


def indices(design: Design, count: int) -> list[Indices]:
    """Indices of each output of a design, computed by the same functions as the command `sweep` uses."""
    with tempfile.TemporaryDirectory() as name, WorkerPool() as pool:
        folder = Path(name)
        sweep, journal = sweep_of(design, count, folder), Journal(folder)
        for _ in run(sweep, pool, journal=journal):
            pass
        return sensitivity.of_sweep(sweep, journal)


def table(outputs: list[Indices]) -> str:
    rows = []
    for i, key in enumerate(outputs[0].inputs):
        cells = [SYMBOLS[key]]
        for output in outputs:
            for value, ends in ((output.first, output.first_interval), (output.total, output.total_interval)):
                cells.append(f"{value[i]:.3f} ({ends[0, i]:.3f} to {ends[1, i]:.3f})")
        rows.append(cells)
    sums = ["sum"] + [f"{values.sum():.3f}" for output in outputs for values in (output.first, output.total)]
    head = ["input", *(f"{name}, {kind}" for name in ("stopping time", "angle at stop") for kind in ("first", "total"))]
    return markdown(head, [*rows, sums])


def claims(results: dict[str, list[Indices]]) -> list[Claim]:
    time, _ = results[DESIGNS[0].name]
    one_impact, stop_angle = results[DESIGNS[1].name]
    at = {SYMBOLS[key]: i for i, key in enumerate(time.inputs)}  # coefficients first, in both designs
    of_motion = float(time.first[[at["speed"], at["angle"]]].sum())
    sand = float(time.total[[at[name] for name in ("eta_d", "eta_h", "eta_v", "lambda")]].sum())
    drag, vertical = at["eta_d"], at["eta_v"]
    return [
        Claim(
            "sensitivity.speed and angle decide the stopping time more than the sand does",
            of_motion > 0.5 > sand,
            f"{100 * of_motion:.0f} % of the variance is due to them alone (required: over 50), at most "
            f"{100 * sand:.0f} % has to do with the four coefficients (required: under 50)",
        ),
        Claim(
            "sensitivity.eta_v is the coefficient that decides the stopping time of one impact",
            bool(one_impact.first[vertical] > 0.5),
            f"first order {one_impact.first[vertical]:.3f} (required: 0.5)",
        ),
        Claim(
            "sensitivity.eta_d hardly changes the stopping time",
            bool(max(time.total_interval[1, drag], one_impact.total_interval[1, drag]) < 0.05),
            f"total at most {time.total_interval[1, drag]:.4f} of all six, "
            f"{one_impact.total_interval[1, drag]:.4f} of the coefficients at one impact (required: 0.05)",
        ),
        Claim(
            "sensitivity.eta_d decides where one impact stops",
            bool(stop_angle.first[drag] > 0.5),
            f"first order {stop_angle.first[drag]:.3f} of the angle at stop (required: 0.5)",
        ),
    ]


def draw(results: dict[str, list[Indices]]) -> str:
    links = []
    for design, name in zip(DESIGNS, ("six", "coefficients"), strict=True):
        stopping_time = results[design.name][0]
        file = FIGURES / f"sensitivity_{name}.png"
        bars = (stopping_time.first, stopping_time.first_interval), (stopping_time.total, stopping_time.total_interval)
        draw_sensitivity("the stopping time", [SYMBOLS[key] for key in stopping_time.inputs], *bars, file)
        links.append(f"![Sobol indices of the stopping time: {design.name}](figures/{file.name})")
    return "\n".join(links)


def study(quick: bool) -> Outcome:
    """Run both designs; draw the figures unless quick."""
    count = QUICK_COUNT if quick else COUNT
    results = {design.name: indices(design, count) for design in DESIGNS}
    refused = [output.refused for outputs in results.values() for output in outputs if output.refused]
    if refused:
        return Outcome("\n".join(refused), (Claim("sensitivity.every case has its numbers", False, refused[0]),))
    text = [f"Designs of {count} points (count x (inputs + 2) runs); in brackets 95 % intervals by bootstrap."]
    for design in DESIGNS:
        text += [f"{design.name[0].upper()}{design.name[1:]}:", table(results[design.name])]
    if not quick:
        text.append(draw(results))
    return Outcome("\n\n".join(text), tuple(claims(results)))


if __name__ == "__main__":
    sys.exit(script(study))
