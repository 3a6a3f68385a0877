"""The command `run`: simulate a config, save the results and print a summary."""

from __future__ import annotations

import argparse
import math
import shutil
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from granular_contact.cli.common import (
    ENDS,
    NARROW,
    Refusal,
    add_output,
    add_set,
    complain,
    exit_code,
    output_folder,
    read,
    say,
    view,
)
from granular_contact.errors import ConfigError, Fault

if TYPE_CHECKING:
    from granular_contact.config import Scenario
    from granular_contact.mechanics.system import System, Trajectory
    from granular_contact.results import Compiling, Progress, Results
    from granular_contact.scene import Scene

HELP = "simulate a config and save the results"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("config", metavar="CONFIG", help="YAML file of the run")
    add_set(parser)
    text = (
        "method of solution. auto: minimal if the mechanism allows it, else engine; engine: Exudyn; minimal: minimal "
    )
    text += "coordinates, for trees of bodies; reduced: a few modes of a pendulum, or of flexible links in space"
    parser.add_argument("--method", choices=("auto", "engine", "minimal", "reduced"), help=text)
    text = "number of modes of the reduced model, 0 to 20: 0 is rigid, 1 is the reduction of the source paper"
    parser.add_argument("--modes", metavar="N", help=text)
    parser.add_argument("--no-plots", action="store_true", help="draw no figures")
    text = "save figures as PDF or SVG in addition to PNG: pdf, svg or pdf,svg"
    parser.add_argument("--format", metavar="FORMAT", dest="formats", type=_formats, default=(), help=text)
    films = parser.add_mutually_exclusive_group()
    films.add_argument("--animate", dest="film", action="store_const", const="gif", help="save an animation.gif")
    text = "save an animation.mp4; needs ffmpeg"
    films.add_argument("--animate-mp4", dest="film", action="store_const", const="mp4", help=text)
    text = "print which method and time steps are used, what is left out, and why"
    parser.add_argument("--explain", action="store_true", help=text)
    viewers = parser.add_mutually_exclusive_group()
    text = "write the report of the run and open it in the browser; its player shows the motion"
    viewers.add_argument("--view", action="store_true", help=text)
    text = "show the motion in Exudyn's own viewer after the run; needs a display"
    viewers.add_argument("--exudyn-viewer", dest="viewer", action="store_true", help=text)
    add_output(parser, "results/NAME_OF_CONFIG")


def _formats(text: str) -> tuple[str, ...]:
    """Formats of figures from the text of the option --format."""
    from granular_contact.report import FORMATS

    names = tuple(part.strip().lower() for part in text.split(","))
    if unknown := [name for name in names if name not in FORMATS]:
        raise argparse.ArgumentTypeError(f"got {unknown[0]!r}; allowed are {', '.join(FORMATS)}, with commas between")
    return names


def _method(chosen: argparse.Namespace) -> Iterator[str]:
    """Texts of --set for the options --method and --modes.

    --modes alone keeps the other options of the method in the config.
    --method reduced removes a solver.accuracy of the config in the plane, since that model has its own rtol.
    """
    if chosen.method not in (None, "reduced") and chosen.modes is not None:
        reason = "rigid bodies have none" if chosen.method == "minimal" else "the engine has none"
        raise ConfigError([Fault(f"--modes {chosen.modes}", None, "", f"{reason}: needs --method reduced")])
    if chosen.method is not None:
        yield "method={reduced: {}}" if chosen.method == "reduced" else f"method={chosen.method}"
        if chosen.method == "reduced" and not _in_space(chosen):
            yield "solver.accuracy=null"
    if chosen.modes is not None:
        yield f"method.reduced.modes={chosen.modes}"


def _in_space(chosen: argparse.Namespace) -> bool:
    """Whether the mechanism is in space."""
    from granular_contact.config import load

    return load(chosen.config, chosen.set).scenario.model.in_space


def execute(chosen: argparse.Namespace) -> int:
    """Run the command; returns the exit code."""
    scenario, scene = read(chosen.config, [*_method(chosen), *chosen.set])
    if chosen.film == "mp4" and shutil.which("ffmpeg") is None:
        raise Refusal("--animate-mp4: there is no ffmpeg on the path; --animate saves a GIF, which needs none")
    if chosen.viewer:
        if scenario.method.name == "auto":
            from granular_contact.scene import build

            scenario = scenario.replace(method="engine")
            scene = build(scenario)
        _refuse_viewer(scene)
    folder = output_folder(chosen.out, Path(chosen.config).stem)
    solved: list[tuple[System, Trajectory]] = []
    results, duration = _simulate(chosen, scenario, scene, solved)
    # The explanation says which packages are not imported, so it is made before figures import more of them.
    explanation = [*_explanation(scene, solved)] if chosen.explain else []
    _save(chosen, results, folder, figures=scenario.output.figures and not chosen.no_plots)
    if not chosen.quiet:
        say("\n".join(_summary(results, _surface_follows(scenario), duration, folder)))
        printed = set(map(str, scene.notes))  # when the config was read
        say("\n".join(f"warning: {warning}" for warning in results.warnings if warning not in printed))
    elif results.status.code in ENDS:
        complain(f"{results.status.message}; saved in {folder}")
    elif not results.summary.get("usable", True):
        complain(f"the result is not usable, see its warnings; saved in {folder}")
    if explanation:
        say("\n".join(explanation))
    if chosen.view:
        view(folder)
    for system, trajectory in solved if chosen.viewer else ():
        from granular_contact.engines.exudyn import viewer

        viewer.show(system, trajectory)
    return exit_code(results)


def _save(chosen: argparse.Namespace, results: Results, folder: Path, *, figures: bool) -> None:
    """Write the results, with the animation if there is one; print a notice if it is no shaded picture in space."""
    from granular_contact import report

    try:
        report.write(results, folder, figures=figures, film=chosen.film, formats=chosen.formats)
    except OSError as error:
        raise Refusal(f"the results can't be saved in {folder}: {error}") from None
    if chosen.film:
        from granular_contact.report.figures.film import why_flat

        if why := why_flat(results):
            complain(f"notice: {why}")


def _simulate(
    chosen: argparse.Namespace, scenario: Scenario, scene: Scene, solved: list[tuple[System, Trajectory]]
) -> tuple[Results, str]:
    """The results of the run, and its wall time in words.

    solved: gets the system and the trajectory if --exudyn-viewer or --explain need them.
    """
    from granular_contact.jit.compiling import seconds
    from granular_contact.results.frames import MOST
    from granular_contact.run import run

    begin, compiled = time.perf_counter(), seconds()
    shown = sys.stderr.isatty() and not chosen.quiet
    with _progress(shown, scenario.solver.end_time_s) as (progress, announce):
        results = run(
            scene,
            scenario,
            progress=progress,
            most_frames=MOST,
            inspect=(lambda *pair: solved.append(pair)) if chosen.viewer or chosen.explain else None,
            compiling=None if chosen.quiet else announce,
        )
    compiled = seconds() - compiled
    compiling = f", and {compiled:.1f} s of compiling, once in an installation" if compiled else ""
    return results, f"{time.perf_counter() - begin - compiled:.2f} s{compiling}"


def _explanation(scene: Scene, solved: list[tuple[System, Trajectory]]) -> Iterator[str]:
    """Lines on the method and the time steps of a run, and on the parts of the program that it did not need.

    solved: system and trajectory; empty for reduced models.
    """
    from granular_contact.scene.methods import reason

    if scene.scenario is not None and scene.scenario.method.name == "auto":
        yield f"computed {reason(scene)}"
    yield f"steps {scene.solver.why}"
    for system, trajectory in solved if scene.in_space else ():
        from granular_contact.mechanics.space.facet_sizes import explained

        yield from explained(system, trajectory)
    yield "left out:"
    if scene.method is not None:
        not_imported = "" if "exudyn" in sys.modules else ", and it is not imported"
        yield f"  the engine: the method does without its solver{not_imported}"
    for system, trajectory in solved:
        from granular_contact.mechanics.omissions import left_out

        yield from (f"  {line}" for line in left_out(system, trajectory))


def _surface_follows(scenario: Scenario) -> bool:
    """Whether the height of the surface follows from the mechanism although the config gives the height of a body."""
    if not scenario.media or scenario.surface_height is not None or getattr(scenario.bed, "profile_m", None):
        return False
    return any(start.height is not None for start in (scenario.initial.joints or {}).values())


def _refuse_viewer(scene: Scene) -> None:
    """Raise Refusal if Exudyn's viewer can't show the run."""
    if scene.method is not None:
        raise Refusal("--exudyn-viewer: shows runs with method engine, this run has another; --view shows both")
    from granular_contact.engines.exudyn import viewer

    if (problem := viewer.problem()) is not None:
        raise Refusal(f"--exudyn-viewer: {problem}; --view shows the run in the browser, --animate saves a film")


@contextmanager
def _progress(shown: bool, end_time: float) -> Iterator[tuple[Progress | None, Compiling]]:
    """Give a callable that shows the simulated time on stderr, and one that reports what is compiled.

    shown: whether there is a progress bar; else the first callable is None, and the second prints on stderr. end_time:
    end of the run (s).
    """
    if not shown:
        yield None, complain
        return
    from rich.console import Console
    from rich.progress import BarColumn, TextColumn, TimeElapsedColumn
    from rich.progress import Progress as Bar

    from granular_contact.jit.compiling import seconds

    console = Console(stderr=True)
    narrow, digits = console.width < NARROW, 4 if end_time < 1.0 else 2
    unit = "s" if narrow else "s simulated"
    text = f"{{task.completed:.{digits}f}} of {{task.total:g}} {unit}, {{task.fields[rate]}}"
    columns = (BarColumn(8 if narrow else 40), TextColumn(text), *(() if narrow else (TimeElapsedColumn(),)))
    with Bar(*columns, console=console, transient=True) as bar:
        task = bar.add_task("", total=end_time, rate="starting")
        begin, compiled = time.perf_counter(), seconds()

        def update(simulated: float, end: float) -> None:
            spent = time.perf_counter() - begin - (seconds() - compiled)
            rate = simulated / max(spent, 1e-9)
            bar.update(task, completed=simulated, total=end, rate=f"{rate:.3g} s per s")

        def announce(text: str) -> None:
            bar.console.print(text, highlight=False)
            bar.update(task, rate="compiling")

        yield update, announce


_LINES = (  # key, unit (s and m get a prefix), number format, and line of the summary
    ("penetration_time_s", "s", "#.4g", "  sinking         {}, from touch until the lower end sinks no deeper"),
    ("angle_at_stop_deg", "deg", "#.5g", "  angle at stop   {}"),
    ("max_depth_m", "m", "#.4g", "  largest depth   {}"),
    ("max_deflection_m", "m", "#.4g", "  deflection      {} at most"),
    ("forward_speed_second_half_m_s", "m/s", "#.4g", "  forward speed   {} in the second half"),
)


def _strain(links: dict[str, dict[str, Any]]) -> str:
    """Line of the summary on the link with the largest strain."""
    name, largest = max(links.items(), key=lambda item: item[1]["strain"])
    stress = largest["stress_Pa"]
    has_stress = stress is not None and math.isfinite(stress)
    stress_words = f"; stress {1e-6 * stress:.3g} MPa (von Mises)" if has_stress else ""
    return f"  strain          {100.0 * largest['strain']:.3g} % at most, at the skin of {name}{stress_words}"


def _summary(results: Results, surface_follows: bool, duration: str, folder: Path) -> Iterator[str]:
    """Lines of the summary of a run, without quantities that the run does not have."""
    from granular_contact.report.units import sized

    summary: dict[str, Any] = results.summary
    doubt = "" if summary.get("usable", True) else "; the result is not usable, see its warnings"
    yield f"{results.name}: {results.status.message}{doubt}"
    if surface_follows:
        yield "  surface         where it touches the mechanism at the start, as surface_height_m is not given"
    if (stop := summary.get("stopping_time_s")) is not None:
        yield f"  stopping time   {sized(stop, 's', '#.4g')}, {summary['stopping_time_measure']}"
    for key, unit, form, line in _LINES:
        value = summary.get(key)
        if value is not None and not (key == "max_depth_m" and value < 0.0):
            yield line.format(sized(value, unit, form) if unit in ("s", "m") else f"{value:{form}} {unit}")
    if links := summary.get("links"):
        yield _strain(links)
    if wheel := summary.get("wheel"):
        sinkage = f"sinkage {sized(wheel['sinkage_m'], 'm', '#.4g')}"
        yield f"  wheel           slip {wheel['slip']:.3f}, {sinkage}, means of the last half"
        yield f"                  pull {wheel['drawbar_pull_N']:.3g} N, torque {wheel['torque_Nm']:.3g} N m"
    if (cost := summary.get("cost_of_transport")) is not None:
        yield f"  transport cost  {cost:.3g} of weight times distance"
    if (imbalance := summary.get("energy", {}).get("imbalance_relative")) is not None:
        yield f"  imbalance       {imbalance:.1e} of the energy"
    yield f"  wall time       {duration}"
    yield f"  saved in        {folder}"
