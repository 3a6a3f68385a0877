"""The twelve impacts of the source paper with a rigid link, one mode and finite elements; claims of the paper.

    python validation/paper_cases.py

Every claim in the paper's text is marked as held or not held. The paper's Table 1 and the curves of its figures did not
survive, so no number is compared with them. The figures have the form of the paper's Figs 2, 5-8 and 9.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from numpy.typing import NDArray

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parent))

from granular_contact.config import load_scenario
from granular_contact.report.figures.panels import blank
from granular_contact.report.figures.style import BLUE, DOUBLE, DPI, GREEN, INK, PURPLE, SINGLE, VERMILION, style
from granular_contact.results import Results
from granular_contact.run import run
from granular_contact.scene import build
from validation.study import Claim, Outcome, script
from validation.tables import markdown

CONFIG = HERE.parent / "configs" / "pendulum.yaml"
FIGURES = HERE / "figures"
# Impact speeds (rad/s) of the paper by impact angle (deg).
SPEEDS = {22.0: (1.75, 3.38, 4.66), 31.0: (3.31, 6.24, 8.41), 45.0: (2.66, 6.47, 9.06), 61.5: (2.70, 6.54, 9.17)}
CASES = [(angle, speed) for angle, speeds in SPEEDS.items() for speed in speeds]
RIGID, ONE, FE = "rigid", "one mode", "FE"
MODELS = {
    RIGID: ("method={reduced: {modes: 0, static: true_sign}}",),
    ONE: ("method={reduced: {modes: 1, static: true_sign}}",),
    FE: ("method=engine", "model.bodies.link.flexible.elements=16"),
    "rigid, elastoplastic": ("method={reduced: {modes: 0, static: elastoplastic}}",),
    "one mode, elastoplastic": ("method={reduced: {modes: 1, static: elastoplastic}}",),
}
# Stopping time (s) and angle at stop (deg) of the cases in order, rounded to 0.1 ms and 0.001 deg. They are from our
# own computation of a rigid pendulum, which is older than this project.
CHECK = (
    (0.0352, 24.668), (0.0275, 25.049), (0.0243, 25.301), (0.0325, 34.623), (0.0255, 35.235), (0.0228, 35.566),
    (0.0459, 49.479), (0.0327, 50.512), (0.0290, 50.989), (0.0703, 68.017), (0.0513, 69.492), (0.0459, 70.171),
)  # fmt: skip
COEFFICIENTS = {"density_kg_m3": 2500.0, "eta_d": 6.5, "eta_h": 8.0}  # of the paper; PLUNGING, too
PLUNGING = {"eta_v": 22.0, "lambda": 1.1}
LENGTH = 0.23876  # length of the link, m
EQUAL_SPEED = 6.5  # rad/s
STEP, QUICK_STEP, SCAN_STEP = 5e-5, 2e-4, 1e-4  # s; QUICK_STEP is the default step of configs
SCAN_SPEEDS, SCAN_ANGLES = (
    np.linspace(1.0, 10.0, 28),
    np.linspace(12.0, 72.0, 19),
)  # rad/s, deg; for the curves of the figures
COLOURS, MARKS, LINES = (BLUE, VERMILION, GREEN, PURPLE), "osD^", ("-", "--", "-.")

Vector = NDArray[np.float64]
Runs = dict[tuple[str, float, float], Results]


def simulate(model: str, angle: float, speed: float, step: float) -> Results:
    """Run one impact to rest: angle in deg, speed in rad/s, step in s."""
    start = (f"initial.impact_angle_deg={angle}", f"initial.impact_speed_rad_s={speed}", f"solver.step_s={step}")
    scenario = load_scenario(CONFIG, [*start, *MODELS[model]])
    results = run(build(scenario), scenario)
    if results.status.code != "rest":
        raise RuntimeError(f"{model}, {angle:g} deg, {speed:g} rad/s: {results.status.message}")
    return results


def numbers(runs: Runs, model: str, key: str) -> Vector:
    """A number of the summaries of the twelve impacts, (4 angles, 3 speeds)."""
    return np.array([[runs[model, a, s].summary[key] for s in speeds] for a, speeds in SPEEDS.items()])


def reach(results: Results) -> float:
    """Distance (m) of the tip from the pivot at the start."""
    return math.hypot(results["tip_x_m"][0], results["tip_y_m"][0])


# ---- tables ----


def table(runs: Runs) -> str:
    """Table of the twelve impacts with three models."""
    three = RIGID, ONE, FE
    time, angle, bend = ("stopping_time_s", "angle_at_stop_deg", "max_deflection_m")
    head = [
        "angle deg", "speed rad/s", "tip speed m/s",
        *(f"stopping time ms, {model}" for model in three),
        *(f"angle at stop deg, {model}" for model in three),
        *(f"peak deflection mm, {model}" for model in three[1:]),
    ]  # fmt: skip
    rows = []
    for a, s in CASES:
        summaries = {model: runs[model, a, s].summary for model in three}
        cells = [f"{1e3 * summaries[model][time]:.2f}" for model in three] + [
            f"{summaries[model][angle]:.3f}" for model in three
        ]
        cells += [f"{1e3 * summaries[model][bend]:.3f}" for model in three[1:]]
        rows.append([f"{a:g}", f"{s:.2f}", f"{s * reach(runs[FE, a, s]):.2f}", *cells])
    return markdown(head, rows)


def equal_speed_table(peaks: Vector) -> str:
    """Table of the peak deflections (4,) m of impacts at one speed."""
    head = [f"at {EQUAL_SPEED:g} rad/s", *(f"{angle:g} deg" for angle in SPEEDS)]
    growth = [f"{1 / math.tan(math.radians(angle)):.2f}" for angle in SPEEDS]
    rows = [
        ["peak deflection mm, FE", *millimetres(peaks)],
        ["immersed length gained per path length of the tip", *growth],
    ]
    return markdown(head, rows)


def millimetres(lengths: Sequence[float] | Vector) -> list[str]:
    """Format lengths (m) in mm with two decimals."""
    return [f"{1e3 * length:.2f}" for length in lengths]


# ---- claims ----


def claim(statement: str, held: Any, detail: str) -> Claim:
    """Make a claim of this study."""
    return Claim(f"paper_cases.{statement}", bool(held), detail)


def motion_claims(runs: Runs) -> list[Claim]:
    """Claims of the paper on stopping time and penetration, for all three models."""
    speeds = np.array(list(SPEEDS.values()))
    times = np.array([numbers(runs, model, "stopping_time_s") for model in (RIGID, ONE, FE)])
    angles = np.array([numbers(runs, model, "angle_at_stop_deg") for model in (RIGID, ONE, FE)])
    steps, gains = np.diff(times, axis=2), np.diff(angles, axis=2)
    slopes = steps / np.diff(speeds, axis=1)
    flattening = slopes[..., 1] / slopes[..., 0]
    return [
        claim(
            "stopping time falls with speed",
            np.all(steps < 0),
            f"at every angle, by every model; smallest fall between two speeds {-1e3 * steps.max():.2f} ms",
        ),
        claim(
            "penetration grows with speed",
            np.all(gains > 0),
            f"at every angle, by every model; smallest growth between two speeds {gains.min():.3f} deg",
        ),
        claim(
            "fall of stopping time flattens",
            np.all((flattening < 1) & (flattening > 0)),
            "fall per rad/s between the two higher speeds divided by that between the two lower: "
            + ", ".join(f"{x:.2f}" for x in flattening[2])
            + f" at {', '.join(f'{a:g}' for a in SPEEDS)} deg (FE); at most {flattening.max():.2f} by any model",
        ),
    ]


def deflection_claims(runs: Runs, equal_speed: Vector) -> list[Claim]:
    """Claims of the paper on the peak deflection, for the paper's single mode and for finite elements."""
    mode, fe = (numbers(runs, model, "max_deflection_m") for model in (ONE, FE))
    both = np.array([mode, fe])
    growth = both[..., 1:] / both[..., :-1]
    return [
        claim(
            "deflection is very small",
            both.max() < 0.01 * LENGTH,
            f"at most {1e3 * both.max():.2f} mm, {100 * both.max() / LENGTH:.2f} % of the link's length (required: "
            "1 %)",
        ),
        claim(
            "deflection grows with speed",
            np.all(growth > 1),
            "at every angle, by one mode and by FE; smallest growth between two speeds "
            f"{100 * (growth.min() - 1):.0f} %",
        ),
        claim(
            "deflection grows with angle",
            np.all(np.diff(both, axis=1) > 0),
            f"at {', '.join(f'{a:g}' for a in SPEEDS)} deg and the highest speeds {', '.join(millimetres(fe[:, 2]))} "
            f"mm by FE, {', '.join(millimetres(mode[:, 2]))} mm by one mode; at the same speed, "
            f"{EQUAL_SPEED:g} rad/s, {', '.join(millimetres(equal_speed))} mm by FE",
        ),
    ]


def model_claims(runs: Runs) -> list[Claim]:
    """Claims that the link's flexibility hardly matters, and that both static laws agree."""
    impact = np.array(list(SPEEDS))[:, None]
    rigid, fe = ([numbers(runs, m, k) for k in ("stopping_time_s", "angle_at_stop_deg")] for m in (RIGID, FE))
    time = np.abs(rigid[0] / fe[0] - 1).max()
    travel = np.abs((rigid[1] - fe[1]) / (fe[1] - impact)).max()
    laws, turned = 0.0, 0.0
    for model in (RIGID, ONE):
        event_located, elastoplastic = ([numbers(runs, m, k) for k in ("stopping_time_s", "angle_at_stop_deg")]
                       for m in (model, f"{model}, elastoplastic"))  # fmt: skip
        laws = max(laws, np.abs(event_located[0] / elastoplastic[0] - 1).max())
        turned = max(turned, np.abs(event_located[1] - elastoplastic[1]).max())
    return [
        claim(
            "rigid and flexible links hardly differ",
            max(time, travel) < 0.01,
            f"rigid and FE at most {100 * time:.2f} % apart in stopping time, {100 * travel:.2f} % in travel from "
            "touch to stop (required: 1 %)",
        ),
        claim(
            "event-located and elastoplastic friction agree",
            laws < 0.005,
            f"at most {100 * laws:.2f} % apart in stopping time (required: 0.5 %), {turned:.1e} deg in angle at stop, "
            "by a rigid link and by one mode",
        ),
    ]


def check_claims(runs: Runs) -> list[Claim]:
    """Claims that rigid runs agree with the earlier computation, and that all runs have the same coefficients."""
    known = np.array(CHECK).reshape(4, 3, 2)
    times, angles = (numbers(runs, RIGID, key) for key in ("stopping_time_s", "angle_at_stop_deg"))
    # The rounding of the known number, half a unit of its last digit, does not count as an error of the run.
    time = np.maximum(np.abs(times - known[..., 0]) - 0.5e-4, 0.0) / known[..., 0]
    angle = np.abs(angles - known[..., 1]).max()
    rounded = int(np.sum(np.abs(np.round(times, 4) - known[..., 0]) < 1e-9))
    media = [results.scenario["medium"] for results in runs.values()]
    same = all(medium == media[0] for medium in media)
    paper = all(media[0][k] == v for k, v in COEFFICIENTS.items())
    paper = paper and all(media[0]["plunging"][k] == v for k, v in PLUNGING.items())
    return [
        claim(
            "the rigid link agrees with the earlier computation",
            time.max() < 1e-3 and angle < 0.02,
            f"{rounded} of 12 stopping times agree in all given digits (0.1 ms); none differs by more than "
            f"{100 * time.max():.3f} % beyond this rounding (required: 0.1 %); angle at stop at most {angle:.4f} deg "
            "off (required: 0.02)",
        ),
        claim("one set of coefficients is used", same and paper, f"the paper's play sand in all {len(runs)} runs"),
    ]


# ---- figures ----


def draw(runs: Runs) -> str:
    """Draw the figures; return their links in Markdown."""
    scan = {
        (model, angle): [simulate(model, angle, speed, SCAN_STEP).summary for speed in SCAN_SPEEDS]
        for model in (ONE, FE)
        for angle in SPEEDS
    }
    with style():
        draw_deflection(runs, scan)
        draw_histories(runs)
        draw_stopping(runs, scan)
    links = {
        "deflection": "Peak deflection against impact speed, and against impact angle at one speed",
        "histories": "Angle and rate until the stop",
        "stopping": "Stopping time against impact speed",
    }
    return "\n\n".join(f"![{caption}](figures/paper_cases_{name}.png)" for name, caption in links.items())


def key(model: str, **look: Any) -> Line2D:
    """Entry of a legend that shows the line style of a model, in a neutral colour."""
    return Line2D([], [], color=INK, label=model, **look)


def draw_deflection(runs: Runs, scan: dict[tuple[str, float], list[dict[str, Any]]]) -> None:
    """Draw peak deflections as in the paper's Fig 2, and beside them those at equal speeds, which the paper lacks."""
    figure = blank(DOUBLE, 72.0, layout="constrained")
    figure.get_layout_engine().set(wspace=0.06)
    left, right = figure.subplots(1, 2)
    bend = "max_deflection_m"
    for angle, colour, mark in zip(SPEEDS, COLOURS, MARKS, strict=True):
        for model, line, face in ((FE, "-", colour), (ONE, "--", "white")):
            left.plot(
                SCAN_SPEEDS, [1e3 * summary[bend] for summary in scan[model, angle]], line, color=colour, linewidth=0.8
            )
            points = [1e3 * runs[model, angle, speed].summary[bend] for speed in SPEEDS[angle]]
            left.plot(SPEEDS[angle], points, mark, color=colour, markerfacecolor=face, markersize=3.5)
    entries = [
        Line2D([], [], color=c, marker=m, label=f"{a:g}°") for a, c, m in zip(SPEEDS, COLOURS, MARKS, strict=True)
    ]
    entries += [key("FE", linestyle="-"), key("one mode", linestyle="--", marker="o", markerfacecolor="white")]
    left.legend(handles=entries, loc="upper left")
    frame(left, "(a) marks: the twelve impacts", "impact speed (rad/s)", "peak tip deflection (mm)")
    left.set_xlim(0.0, 10.2)
    for speed, line in zip((3.0, 6.0, 9.0), LINES, strict=True):
        peaks = [1e3 * simulate(FE, angle, speed, SCAN_STEP).summary[bend] for angle in SCAN_ANGLES]
        right.plot(SCAN_ANGLES, peaks, line, color=INK, label=f"{speed:g} rad/s")
    for angle, colour in zip(SPEEDS, COLOURS, strict=True):
        right.axvline(angle, color=colour, linewidth=0.6, zorder=0)
    right.legend(loc="upper right")
    frame(right, "(b) FE at equal impact speeds", "impact angle (deg)", "peak tip deflection (mm)")
    figure.savefig(FIGURES / "paper_cases_deflection.png", dpi=DPI)


def draw_histories(runs: Runs) -> None:
    """Draw angle and rate until the stop as in the paper's Figs 5-8, one column for each impact angle."""
    figure = blank(DOUBLE, 88.0, layout="constrained")
    grid = figure.subplots(2, 4, sharex="col", sharey="row")
    for column, (angle, speeds) in enumerate(SPEEDS.items()):
        top, bottom = grid[:, column]
        for speed, colour in zip(speeds, COLOURS, strict=False):
            for model, look in ((FE, {"linewidth": 1.1}), (RIGID, {"linewidth": 0.7, "linestyle": (0, (4, 2))})):
                results = runs[model, angle, speed]
                until = results["time_s"] <= results.summary["stopping_time_s"]
                time, ink = 1e3 * results["time_s"][until], colour if model == FE else INK
                top.plot(time, results["pivot_angle_deg"][until] - angle, color=ink, **look)
                bottom.plot(time, results["pivot_rate_rad_s"][until], color=ink, **look)
            end = runs[FE, angle, speed].summary
            stop = 1e3 * end["stopping_time_s"], end["angle_at_stop_deg"] - angle
            top.plot(*stop, "o", color=colour, markersize=2.5)
        handles = [Line2D([], [], color=c, label=f"{s:.2f} rad/s") for s, c in zip(speeds, COLOURS, strict=False)]
        bottom.legend(handles=handles, loc="upper right")
        top.set_title(f"({'abcd'[column]}) {angle:g}°", loc="left")
        bottom.set_xlabel("time since touch (ms)")
        bottom.set_xlim(0.0, None)
    grid[0, 0].set_ylabel("angle since touch (deg)")
    grid[1, 0].set_ylabel("rate (rad/s)")
    grid[0, 0].legend(handles=[key("FE"), key("rigid", linestyle=(0, (4, 2)), linewidth=0.7)], loc="upper left")
    figure.align_ylabels(grid[:, 0])
    figure.savefig(FIGURES / "paper_cases_histories.png", dpi=DPI)


def draw_stopping(runs: Runs, scan: dict[tuple[str, float], list[dict[str, Any]]]) -> None:
    """Draw stopping times as in the paper's Fig 9, for all four angles."""
    figure = blank(SINGLE, 70.0, layout="constrained")
    axes = figure.subplots()
    time = "stopping_time_s"
    for angle, colour, mark in zip(SPEEDS, COLOURS, MARKS, strict=True):
        axes.plot(SCAN_SPEEDS, [1e3 * summary[time] for summary in scan[FE, angle]], color=colour, linewidth=0.8)
        for model, look in ((FE, {"markersize": 3.0}), (RIGID, {"markersize": 6.0, "markerfacecolor": "none"})):
            points = [1e3 * runs[model, angle, speed].summary[time] for speed in SPEEDS[angle]]
            axes.plot(SPEEDS[angle], points, mark, color=colour, markeredgewidth=0.6, **look)
    entries = [
        Line2D([], [], color=c, marker=m, label=f"{a:g}°") for a, c, m in zip(SPEEDS, COLOURS, MARKS, strict=True)
    ]
    entries += [key("FE", linestyle="-", marker="o", linewidth=0.8)]
    entries += [key("rigid", linestyle="", marker="o", markersize=6.0, markerfacecolor="none", markeredgewidth=0.6)]
    axes.legend(handles=entries, loc="upper right", ncols=2)
    frame(axes, "", "impact speed (rad/s)", "stopping time (ms)")
    axes.set_xlim(0.0, 10.2)
    figure.savefig(FIGURES / "paper_cases_stopping.png", dpi=DPI)


def frame(axes: Axes, title: str, across: str, up: str) -> None:
    """Set title and labels of axes, and start the vertical axis at zero."""
    axes.set_title(title, loc="left")
    axes.set_xlabel(across)
    axes.set_ylabel(up)
    axes.set_ylim(0.0, None)


# ---- the study ----


def impacts(step: float) -> Runs:
    """Run the twelve impacts with all models."""
    return {(model, *case): simulate(model, *case, step) for model in MODELS for case in CASES}


def study(quick: bool) -> Outcome:
    """Run the impacts; draw the figures unless quick."""
    step = QUICK_STEP if quick else STEP
    return outcome(impacts(step), step, figures=not quick)


def outcome(runs: Runs, step: float, figures: bool) -> Outcome:
    """Tables and claims of impacts that are computed with a step (s)."""
    peaks = np.array([simulate(FE, angle, EQUAL_SPEED, step).summary["max_deflection_m"] for angle in SPEEDS])
    claims = [*motion_claims(runs), *deflection_claims(runs, peaks), *model_claims(runs), *check_claims(runs)]
    single, fe = (numbers(runs, model, "max_deflection_m") for model in (ONE, FE))
    short = 100 * (1 - single / fe)
    text = [
        f"The twelve impacts; FE of 16 elements, step {step:g} s; rigid link and one mode with the true sign function.",
        table(runs),
        f"One mode leaves out {short.min():.0f} to {short.max():.0f} % of the peak deflection.",
        "Impacts at the same speed: deflection against angle (in the paper the speed differs between the angles).",
        equal_speed_table(peaks),
    ]
    if figures:
        text.append(draw(runs))
    return Outcome("\n\n".join(text), tuple(claims))


if __name__ == "__main__":
    sys.exit(script(study))
