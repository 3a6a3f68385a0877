"""Error and run time of every model, step and integrator on one impact; where the defaults lie among them.

    python validation/error_vs_run_time.py

The case is configs/pendulum.yaml to 40 ms. Errors are total errors, which include the modelling error of a rigid or
modal link: tip path (largest distance), stopping time, angle at stop, and deflection (root mean square). Run times are
medians of the solve alone: after a warm-up all settings run in turn for several rounds.

The error of a stopping time or an angle can be small by chance if it changes sign between two steps. Therefore, in a
ranking, an error counts as no smaller than those of finer steps or tolerances of the same model and integrator.
"""

from __future__ import annotations

import functools
import statistics
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import exudyn as exu
import numpy as np
from numpy.typing import NDArray

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parent))

from granular_contact.config import load_scenario
from granular_contact.engines.exudyn.build import build as build_system
from granular_contact.engines.exudyn.solve import settings, solve
from granular_contact.mechanics.observe import observe
from granular_contact.results.stopping import find_touch
from granular_contact.run import run
from granular_contact.scene import build
from validation.study import Claim, Outcome, script
from validation.tables import markdown

Vector = NDArray[np.float64]
CONFIG = HERE.parent / "configs" / "pendulum.yaml"
FIGURES = HERE / "figures"
TO_40_MS = ("solver.end_time_s=0.04", "solver.rest_time_s=null")
# Key, name, unit, factor from SI (angles: from degrees) to the unit.
MEASURES = (
    ("tip", "tip path", "um", 1e6),
    ("stop", "stopping time", "us", 1e6),
    ("angle", "angle at stop", "mdeg", 1e3),
    ("bend", "deflection", "um", 1e6),
)
KEYS = tuple(key for key, *_ in MEASURES)
LETTERS = dict(zip(KEYS, "TSAD", strict=True))
NEAR = 1.5  # run time allowed, relative to the front: runs of one setting differ by as much on a shared machine
EXPLICIT = ("ExplicitEuler", "VelocityVerlet", "RK44", "ODE23", "DOPRI5", "DVERK6")
ONE_CHANGE = "one change"  # model name of settings that differ from the FE default in one value
FE_DEFAULT, RIGID, ONE_MODE = "4 elements, step 0.0002", "rigid", "1 mode"


@dataclass(frozen=True)
class Path40:
    """Measured results of a run to 40 ms.

    time (n,) s; tip (n, 2) m; bend: deflection (n,) m; stop: stopping time, s; angle: at the stop, deg; seconds: solve
    time, s.
    """

    time: Vector
    tip: Vector
    bend: Vector
    stop: float
    angle: float
    seconds: float


@dataclass(frozen=True)
class Setting:
    """A row of the table.

    model: settings with the same model form one curve of the figure; change: function that changes Exudyn's settings.
    """

    model: str
    name: str
    overrides: tuple[str, ...]
    change: Callable[[Any], None] | None = None
    default: bool = False

    @property
    def ladder(self) -> bool:
        """Whether the setting belongs to a series of steps or tolerances, which are listed from coarse to fine."""
        return self.model != ONE_CHANGE and not self.name.endswith("defaults")

    @property
    def engine(self) -> bool:
        """Whether Exudyn solves the setting."""
        return self.overrides[0] == "method=engine"


@dataclass
class Point:
    """Errors of a setting in the units of MEASURES, and its run times (s).

    failure: reason why there are none; empty if the run succeeded. ranked: errors for the ranking, each at least as
    large as those of finer settings of the same series.
    """

    setting: Setting
    errors: dict[str, float] = field(default_factory=dict)
    seconds: list[float] = field(default_factory=list)
    failure: str = ""
    ranked: dict[str, float] = field(default_factory=dict)

    @property
    def ms(self) -> float:
        """Median run time (ms)."""
        return 1e3 * statistics.median(self.seconds)


class Failed(Exception):
    """A run failed or did not stop within 40 ms."""


# ---- one run ----


def simulate(setting: Setting, *overrides: str) -> Path40:
    """Run a setting to 40 ms."""
    scenario = load_scenario(CONFIG, [*TO_40_MS, *setting.overrides, *overrides])
    scene = build(scenario)
    if not setting.engine:
        results = run(scene, scenario)
        if results.status.code == "failed":
            raise Failed(results.status.message)
        series = {column.name: results[column.name] for column in results.columns}
        stop, angle = (results.summary[key] for key in ("stopping_time_s", "angle_at_stop_deg"))
        return _path(series, stop, angle, results.summary["cost"]["solve_s"])
    system = build_system(scene)
    simulation = settings(scene)
    if setting.change is not None:
        setting.change(simulation)
    trajectory = solve(system, simulation=simulation)
    if trajectory.status.code == "failed":
        raise Failed(trajectory.status.message)
    observation = observe(system, trajectory)
    columns, table = observation.columns()
    series = {column.name: table[:, i] for i, column in enumerate(columns)}
    touch = find_touch(trajectory.time, observation.depths)
    stop_event = None if touch is None else observation.stop(touch)
    if touch is None or stop_event is None:
        raise Failed("it does not stop within 40 ms")
    return _path(series, stop_event.time - touch.time, float(np.degrees(stop_event.angle)), trajectory.cost.solve_s)


def _path(series: dict[str, Vector], stop: float | None, angle: float | None, seconds: float) -> Path40:
    if stop is None or angle is None:
        raise Failed("it does not stop within 40 ms")
    tip = np.column_stack([series["tip_x_m"], series["tip_y_m"]])
    bend = series.get("deflection_m", np.zeros(len(tip)))
    return Path40(series["time_s"], tip, bend, stop, angle, seconds)


def errors(path: Path40, truth: Path40) -> dict[str, float]:
    """Errors of a run in the units of MEASURES, evaluated at the run's own instants."""
    tip = np.column_stack([np.interp(path.time, truth.time, truth.tip[:, i]) for i in range(2)])
    bend = np.interp(path.time, truth.time, truth.bend)
    si_errors = {
        "tip": float(np.max(np.linalg.norm(path.tip - tip, axis=1))),
        "stop": abs(path.stop - truth.stop),
        "angle": abs(path.angle - truth.angle),
        "bend": float(np.sqrt(np.mean((path.bend - bend) ** 2))),
    }
    return {key: factor * si_errors[key] for key, _, _, factor in MEASURES}


# ---- the reference ----


@dataclass(frozen=True)
class Reference:
    """The extrapolated run, its uncertainty in each measure, and the table rows that derive the uncertainty."""

    path: Path40
    uncertainty: dict[str, float]
    rows: list[list[str]]


def reference(quick: bool) -> Reference:
    """Compute the reference: finest beam, Richardson extrapolation in the step with order one.

    The order is one, as bristles yield at ends of steps. The uncertainty is the whole correction of the extrapolation
    plus the difference from a beam with half as many elements.
    """
    elements, step = (8, 4e-5) if quick else (64, 1e-5)
    coarse, fine = (simulate(beam(elements, h)) for h in (step, 0.5 * step))
    half = simulate(beam(elements // 2, step))
    modes = simulate(modal(10 if quick else 15, "elastoplastic", 1e-8))
    on = functools.partial(np.interp, coarse.time, fine.time)
    path = Path40(
        coarse.time,
        2.0 * np.column_stack([on(fine.tip[:, 0]), on(fine.tip[:, 1])]) - coarse.tip,
        2.0 * on(fine.bend) - coarse.bend,
        2.0 * fine.stop - coarse.stop,
        2.0 * fine.angle - coarse.angle,
        fine.seconds,
    )
    correction, space = errors(fine, path), errors(half, coarse)
    uncertainty = {key: correction[key] + space[key] for key in KEYS}
    parts = (
        (f"step: correction of the run at {0.5 * step:g} s", correction),
        (f"elements: {elements // 2} against {elements}", space),
        ("sum, taken as the uncertainty", uncertainty),
        (f"for comparison, {10 if quick else 15} modes against the reference", errors(modes, path)),
    )
    rows = [[name, *(f"{values[key]:.2g}" for key in KEYS)] for name, values in parts]
    return Reference(path, uncertainty, rows)


# ---- the settings ----


def beam(elements: int, step: float, more: Sequence[str] = (), note: str = "", **others: Any) -> Setting:
    """Setting with finite elements; more: further overrides; note: added to the name; others: fields to replace."""
    name = f"{elements} elements, step {step:g}{note}"
    key = "model.bodies.link.flexible.elements"
    overrides = ("method=engine", f"{key}={elements}", f"solver.step_s={step}", *more)
    setting = Setting(f"{elements} elements", name, overrides)
    return replace(setting, default=name == FE_DEFAULT, **others)


def chosen(accuracy: float) -> Setting:
    """Setting with four elements and adaptive steps."""
    return Setting(
        "4 elements, chosen steps",
        f"4 elements, accuracy {accuracy:g}",
        ("method=engine", f"solver.accuracy={accuracy}"),
    )


def modal(modes: int, static: str, rtol: float) -> Setting:
    """Setting with a reduced model."""
    model = "rigid" if modes == 0 else f"{modes} mode{'s' if modes > 1 else ''}"
    law = static.replace("_", " ")
    chosen = f"method={{reduced: {{modes: {modes}, static: {static}, rtol: {rtol}}}}}"
    return Setting(f"{model}, {law}", f"{model}, {law}, rtol {rtol:g}", (chosen,))


def default_reduced(modes: int) -> Setting:
    """Setting with a reduced model for which a user names the number of modes only."""
    model, law = ("rigid", "true sign") if modes == 0 else (f"{modes} mode", "elastoplastic")
    return Setting(f"{model}, {law}", f"{model}, defaults", (f"method={{reduced: {{modes: {modes}}}}}",), default=True)


def trapezoidal(simulation: Any) -> None:
    """Select Newmark's method without numerical damping, with constraints at velocity level."""
    alpha = simulation.timeIntegration.generalizedAlpha
    alpha.useNewmark, alpha.useIndex2Constraints = True, True


def beams(quick: bool) -> list[Setting]:
    """Settings with finite elements: elements and steps, integrators at four elements, and changes of the default."""
    fine = (1e-3, 5e-4, 2e-4, 1e-4, 5e-5, 2e-5, 1e-5, 1e-6)
    coarse = (1e-3, 5e-4, 2e-4, 5e-5, 1e-5)
    if quick:
        fine, coarse = (1e-3, 2e-4, 5e-5), (1e-3, 2e-4)
    counts = (4, 8) if quick else (4, 8, 16, 32, 64)
    listed = [beam(n, h) for n in counts for h in (fine if n == 4 else coarse)]
    for radius in (1.0, 0.4) if quick else (1.0, 0.7, 0.4, 0.0):
        option = (f"solver.spectral_radius={radius}",)
        listed += [beam(4, h, option, f", radius {radius:g}", model=f"radius {radius:g}") for h in coarse]
    listed += [beam(4, h, (), ", trapezoidal", model="trapezoidal", change=trapezoidal) for h in coarse]
    listed += [chosen(accuracy) for accuracy in ((1e-3,) if quick else (1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 1e-5))]
    changes = [("load.strips_per_element", n, f"{n} strips") for n in (2, 8)]
    changes += [("solver.tolerance", x, f"tolerance {x:g}") for x in (1e-3, 1e-4, 1e-6, 1e-7)]
    listed += [beam(4, 2e-4, (f"{key}={x}",), f", {note}", model=ONE_CHANGE) for key, x, note in changes]
    return [*listed, beam(2, 2e-4, model=ONE_CHANGE)]


def reductions(quick: bool) -> list[Setting]:
    """Settings with reduced models."""
    listed = [default_reduced(0), default_reduced(1)]
    for modes in (0, 1, 2, 5):
        for static in ("true_sign", "elastoplastic"):
            listed += [modal(modes, static, rtol) for rtol in ((1e-6,) if quick else (1e-4, 1e-6, 1e-8))]
    return listed


def explicit() -> list[Point]:
    """Try Exudyn's explicit and adaptive solvers on the beam and the rigid pendulum; points with their messages."""
    tried = []
    for model, config in (("4 elements", CONFIG), ("rigid in Exudyn", CONFIG.with_name("pendulum_rigid.yaml"))):
        for kind in EXPLICIT:
            scene = build(load_scenario(config, TO_40_MS))
            system, simulation = build_system(scene), settings(scene)
            simulation.timeIntegration.numberOfSteps = 4000
            simulation.timeIntegration.solverType = getattr(exu.DynamicSolverType, kind)
            point = Point(Setting(model, f"{model}, {kind}", ("method=engine",)), failure="does not apply: it ran")
            printing, exu.config.printToConsole = exu.config.printToConsole, False
            try:
                exu.MainSolverExplicit().SolveSystem(system.mbs, simulation)
            except (exu.ExudynError, RuntimeError) as error:
                point.failure = f"does not apply: {_reason(str(error))}"
            finally:
                exu.config.printToConsole = printing
            tried.append(point)
    return tried


def _reason(message: str) -> str:
    if "contains constraints" in message:
        return "explicit solvers of Exudyn refuse joints, which are algebraic constraints"
    if "must be an explicit solver" in message:
        return "Exudyn lists the name, and its explicit solver refuses it"
    return message.splitlines()[0]


def explicit_limit(elements: int) -> tuple[float, float]:
    """Highest angular frequency (1/s) of the beam at rest without its joints, and longest stable step (s) of RK44."""
    scene = build(load_scenario(CONFIG, ["medium=null", f"model.bodies.link.flexible.elements={elements}"]))
    mass, stiffness = build_system(scene).mbs.ComputeLinearizedSystem(settings(scene))[:2]
    omega = float(np.sqrt(np.max(np.abs(np.linalg.eigvals(np.linalg.solve(mass, stiffness))))))
    return omega, 2.0 * np.sqrt(2.0) / omega


# ---- measuring ----


def measure(chosen: Sequence[Setting], truth: Path40, rounds: int, budget: float) -> list[Point]:
    """Measure errors in a warm-up, then run times of all settings in turn, in `rounds` rounds.

    Without rounds the warm-up is timed. A setting that has used up the `budget` (s) runs in three rounds only.
    """
    points = []
    for setting in chosen:
        point = Point(setting)
        try:
            path = simulate(setting)
            point.errors = errors(path, truth)
            point.seconds = [] if rounds else [path.seconds]
        except Failed as failure:
            point.failure = f"failed: {failure}"
        points.append(point)
    rank(points)
    for turn in range(rounds):
        for point in points:
            if not point.failure and (turn < 3 or sum(point.seconds) < budget):
                point.seconds.append(simulate(point.setting).seconds)
    return points


def rank(points: Sequence[Point]) -> None:
    """Set `ranked` of each point of a series to the largest of its own error and those of the finer points."""
    finer: dict[str, dict[str, float]] = {}
    for point in reversed([p for p in points if p.setting.ladder and not p.failure]):
        worst = finer.get(point.setting.model, {})
        finer[point.setting.model] = point.ranked = {key: max(point.errors[key], worst.get(key, 0.0)) for key in KEYS}


def whole_run(overrides: Sequence[str], repeats: int) -> float:
    """Median solve time (s) of the config with overrides, to rest."""
    scenario = load_scenario(CONFIG, overrides)
    scene = build(scenario)
    times = [run(scene, scenario).summary["cost"]["solve_s"] for _ in range(repeats + 1)]
    return statistics.median(times[1:])


# ---- the front ----


def floored(point: Point, key: str, uncertainty: dict[str, float]) -> float:
    """Error for the ranking of a setting, at least the uncertainty of the reference."""
    return max(point.ranked.get(key, point.errors[key]), uncertainty[key])


def front(points: Sequence[Point], key: str, uncertainty: dict[str, float]) -> list[Point]:
    """Pareto front: points that no other point beats in both time and error, fastest first."""
    best: list[Point] = []
    for point in sorted((p for p in points if not p.failure), key=lambda p: (p.ms, p.errors[key])):
        if not best or floored(point, key, uncertainty) < floored(best[-1], key, uncertainty):
            best.append(point)
    return best


def distance(point: Point, points: Sequence[Point], key: str, uncertainty: dict[str, float]) -> tuple[float, Point]:
    """Run time relative to the fastest setting with no greater error, and that setting."""
    limit = floored(point, key, uncertainty)
    good = [p for p in points if not p.failure and floored(p, key, uncertainty) <= limit]
    best = min(good, key=lambda p: p.ms)
    return point.ms / best.ms, best


def table(points: Sequence[Point], fronts: dict[str, list[Point]], kind_fronts: dict[str, list[Point]]) -> str:
    """Table of all settings, with letters for the fronts on which a setting lies."""
    rows = []
    for p in points:
        name = f"**{p.setting.name}**" if p.setting.default else p.setting.name
        if p.failure:
            rows.append([name, p.failure, *[""] * 6])
            continue
        marks = ["".join(LETTERS[key] for key in KEYS if p in chosen[key]) for chosen in (fronts, kind_fronts)]
        low, high = (1e3 * f(p.seconds) for f in (min, max))
        values = (f"{p.errors[key]:.3g}" for key in KEYS)
        rows.append([name, *values, f"{p.ms:.2f} ({low:.2f}-{high:.2f})", *marks])
    head = [
        "setting",
        *(f"{name} {unit}" for _, name, unit, _ in MEASURES),
        "median ms (range)",
        "front of all",
        "front of its kind",
    ]
    return markdown(head, rows)


# ---- figures ----

FE_MODELS = ("4 elements", "8 elements", "16 elements", "32 elements", "64 elements")
OWN = tuple(
    f"{model}, {law}" for law in ("true sign", "elastoplastic") for model in ("rigid", "1 mode", "2 modes", "5 modes")
)
INTEGRATORS = ("4 elements", "radius 1", "radius 0.7", "radius 0.4", "radius 0", "trapezoidal")


def draw(points: Sequence[Point], truth: Reference) -> None:
    """Draw two figures: all models, and Exudyn's integrators at four elements."""
    names = {"4 elements": "radius 0.9 (default)"}
    _diagram(points, truth, (*OWN, *FE_MODELS), FIGURES / "error_vs_run_time.png", {}, True)
    _diagram(points, truth, INTEGRATORS, FIGURES / "error_vs_run_time_integrators.png", names, False)


def _looks(model: str, index: int) -> dict[str, Any]:
    from granular_contact.report.figures.style import BLUE, FAINT, GREEN, INK, ORANGE, PURPLE, SKY, VERMILION

    colours = (BLUE, VERMILION, GREEN, PURPLE, ORANGE, SKY, INK)
    if model in OWN and index == OWN.index(model):
        colour, law = (INK, VERMILION, ORANGE, PURPLE)[OWN.index(model) % 4], OWN.index(model) // 4
        marker = "^vDP"[OWN.index(model) % 4]
        return {"color": colour, "ls": (":", "-")[law], "marker": marker, "mfc": ("white", colour)[law]}
    if model in FE_MODELS and index > 6:
        colour = (BLUE, SKY, GREEN, FAINT, INK)[FE_MODELS.index(model)]
        return {"color": colour, "ls": "-", "marker": "os<>h"[FE_MODELS.index(model)], "mfc": colour}
    return {"color": colours[index % 7], "ls": "-", "marker": "os^vDPX"[index % 7], "mfc": colours[index % 7]}


def _diagram(
    points: Sequence[Point],
    truth: Reference,
    models: Sequence[str],
    file: Path,
    names: dict[str, str],
    fronts: bool,
) -> None:
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    from granular_contact.report.figures.style import DOUBLE, DPI, style

    drawn = [p for p in points if not p.failure and (fronts or p.setting.model in models)]
    rows = -(-(len(models) + 3) // 4)
    with style():
        figure = Figure(figsize=(DOUBLE / 25.4, (112 + 4 * rows) / 25.4), layout="constrained")
        grid = figure.subplots(2, 2, sharex=True)
        for axes, (key, name, unit, _) in zip(grid.flat, MEASURES, strict=True):
            _lines(axes, drawn, models, key, truth, names)
            if fronts:
                _draw_front(axes, drawn, key, truth)
            _draw_defaults(axes, [p for p in drawn if p.setting.default], key, truth)
            text = "rms deflection" if key == "bend" else name
            axes.set_ylabel(f"{text}: error ({unit.replace('um', 'µm').replace('us', 'µs')})")
        for axes in grid[1]:
            axes.set_xlabel("median solve time (ms)")
        handles, labels = grid[0, 0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=4, frameon=False)
        FIGURES.mkdir(exist_ok=True)
        FigureCanvasAgg(figure).print_figure(file, dpi=DPI)


def _lines(
    axes: Any, drawn: Sequence[Point], models: Sequence[str], key: str, truth: Reference, names: dict[str, str]
) -> None:
    floor = truth.uncertainty[key]
    for index, model in enumerate(models):
        of_model = [p for p in drawn if p.setting.model == model and p.setting.ladder]
        values = [max(p.errors[key], floor) for p in of_model]
        label = names.get(model, model)
        axes.loglog([p.ms for p in of_model], values, lw=0.8, ms=3.6, mew=0.7, label=label, **_looks(model, index))
    axes.axhspan(0.0, floor, color="0.9", lw=0, zorder=0, label="uncertainty of the reference")
    axes.set_ylim(0.45 * floor, 2.5 * max(max(p.errors[key], floor) for p in drawn))


def _draw_front(axes: Any, drawn: Sequence[Point], key: str, truth: Reference) -> None:
    best = front(drawn, key, truth.uncertainty)
    x, y = [p.ms for p in best], [floored(p, key, truth.uncertainty) for p in best]
    axes.step([*x, 1e5], [*y, y[-1]], where="post", color="#F3C623", lw=3.0, alpha=0.7, zorder=1, label="Pareto front")
    axes.set_xlim(0.6 * min(p.ms for p in drawn), 1.6 * max(p.ms for p in drawn))


def _draw_defaults(axes: Any, defaults: Sequence[Point], key: str, truth: Reference) -> None:
    if not defaults:
        return
    x, y = [p.ms for p in defaults], [floored(p, key, truth.uncertainty) for p in defaults]
    axes.plot(x, y, "o", ms=8, mfc="none", mec="black", mew=1.0, ls="none", zorder=9, label="defaults")


# ---- the study ----


def defaults_table(points: Sequence[Point], uncertainty: dict[str, float]) -> tuple[str, dict[str, float]]:
    """Table of each default's distance from the front of its kind and of all settings; worst distance of the kind."""
    rows, worst = [], dict[str, float]()
    for point in (p for p in points if p.setting.default):
        kind = [p for p in points if p.setting.engine == point.setting.engine]
        for key, name, *_ in MEASURES:
            factor, best = distance(point, kind, key, uncertainty)
            every, overall = distance(point, points, key, uncertainty)
            worst[point.setting.name] = max(worst.get(point.setting.name, 1.0), factor)
            cells = [f"{factor:.1f}", best.setting.name, f"{every:.1f}", overall.setting.name]
            rows.append([point.setting.name, name, *cells])
    head = [
        "default",
        "error compared",
        "ratio to the best of its kind",
        "that setting",
        "ratio to the best of all",
        "that setting",
    ]
    return markdown(head, rows), worst


def fastest_table(points: Sequence[Point]) -> str:
    """Table of the fastest setting of each kind for several limits on the error of the tip path."""
    rows = []
    for level in (50.0, 30.0, 10.0, 3.0, 1.0, 0.3):
        row = [f"{level:g}"]
        for engine in (False, True):
            good = [p for p in points if not p.failure and p.setting.engine == engine and p.errors["tip"] <= level]
            best = min(good, key=lambda p: p.ms, default=None)
            row.append("not reached" if best is None else f"{best.setting.name}: {best.ms:.2f} ms")
        rows.append(row)
    return markdown(["tip path at most, um", "fastest reduced", "fastest FE"], rows)


def claims(points: Sequence[Point], truth: Reference, worst: dict[str, float], repeats: int) -> tuple[Claim, ...]:
    """Claims on the project's targets, and on the distance of its defaults from the front."""
    fe = next(p for p in points if p.setting.name == FE_DEFAULT)
    stop, angle = 1e-4 * fe.errors["stop"] / truth.path.stop, 1e-3 * fe.errors["angle"]
    times = {n: whole_run((f"method={{reduced: {{modes: {n}}}}}",), repeats) for n in (0, 1)}
    beam_time = whole_run((), repeats)
    share = max(truth.uncertainty[key] / fe.errors[key] for key in KEYS)
    failed = [p.setting.name for p in points if p.failure.startswith("failed")]

    def claim(name: str, held: bool, detail: str) -> Claim:
        return Claim(f"error_vs_run_time.{name}", bool(held), detail)

    def near(key: str, name: str) -> Claim:
        detail = f"at most {worst[name]:.2f} times the best time of its kind at equal error, required: at most {NEAR}"
        return claim(f"{key}_default_near_front", worst[name] <= NEAR, detail)

    return (
        claim(
            "reference_uncertainty",
            share <= 0.25,
            f"at most {share:.2f} of the FE default's errors, required: at most 0.25",
        ),
        claim("fe_default_stopping_time", stop <= 0.5, f"{stop:.4f} % off, required: at most 0.5 %"),
        claim("fe_default_angle_at_stop", angle <= 0.01, f"{angle:.5f} deg off, required: at most 0.01 deg"),
        claim("fe_default_run_time", beam_time <= 0.1, f"{1e3 * beam_time:.1f} ms to rest, required: at most 100 ms"),
        claim("rigid_run_time", times[0] < 5e-3, f"{1e3 * times[0]:.2f} ms to rest, required: at most 5 ms"),
        claim("single_mode_run_time", times[1] < 20e-3, f"{1e3 * times[1]:.2f} ms to rest, required: at most 20 ms"),
        near("fe", FE_DEFAULT),
        near("rigid", f"{RIGID}, defaults"),
        near("single_mode", f"{ONE_MODE}, defaults"),
        claim("nothing_failed", not failed, f"{len(failed)} runs failed{': ' if failed else ''}{'; '.join(failed)}"),
    )


def study(quick: bool) -> Outcome:
    """Measure all settings; draw the figures unless quick."""
    truth = reference(quick)
    rounds = 0 if quick else 9
    points = measure([*reductions(quick), *beams(quick)], truth.path, rounds, 0.5)
    kinds = {kind: [p for p in points if p.setting.engine == kind] for kind in (True, False)}
    fronts = {key: front(points, key, truth.uncertainty) for key in KEYS}
    kind_fronts = {key: [p for k in kinds.values() for p in front(k, key, truth.uncertainty)] for key in KEYS}
    distances, worst = defaults_table(points, truth.uncertainty)
    omega, limit = explicit_limit(4)
    if not quick:
        draw(points, truth)
    head = ["uncertainty of the reference", *(f"{name} {unit}" for _, name, unit, _ in MEASURES)]
    text = "\n\n".join(
        [
            f"Reference: stopping time {1e3 * truth.path.stop:.5f} ms, angle at stop {truth.path.angle:.5f} deg.",
            markdown(head, truth.rows),
            "The fastest setting within a given error:",
            fastest_table(points),
            "Run times of the defaults at equal error (an error below the uncertainty of the reference counts as "
            "equal to it):",
            distances,
            f"All settings, median of {rounds} alternating rounds after a warm-up (three rounds for the slow ones). On "
            "the front of all, or of its kind (FE or reduced), in T tip path, S stopping time, A angle at stop, D "
            "deflection; defaults in bold.",
            table([*points, *explicit()], fronts, kind_fronts),
            "If the joints were eliminated, axial waves would limit explicit steps: the highest frequency of 4 free "
            f"elements is {omega:.3g} rad/s, the longest stable step of RK44 {1e6 * limit:.1f} us, "
            f"{0.04 / limit:.0f} steps of 4 evaluations each.",
        ]
    )
    return Outcome(text, claims(points, truth, worst, 1 if quick else 15))


if __name__ == "__main__":
    sys.exit(script(study))
