"""The command `run`: one config simulated, saved and summarised."""

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
    words = "auto: the fastest that the mechanism allows; engine: Exudyn; minimal: trees of rigid bodies in minimal "
    words += "coordinates; reduced: a pendulum, or links in space, by a few modes"
    parser.add_argument("--method", choices=("auto", "engine", "minimal", "reduced"), help=words)
    words = "modes of the reduced model: 0 rigid, 1 as in the source paper, to 20"
    parser.add_argument("--modes", metavar="N", help=words)
    parser.add_argument("--no-plots", action="store_true", help="draw no figures")
    words = "save figures as PDF or SVG too: pdf, svg or pdf,svg"
    parser.add_argument("--format", metavar="FORMAT", dest="formats", type=_formats, default=(), help=words)
    films = parser.add_mutually_exclusive_group()
    films.add_argument("--animate", dest="film", action="store_const", const="gif", help="save an animation.gif")
    words = "save an animation.mp4; needs ffmpeg"
    films.add_argument("--animate-mp4", dest="film", action="store_const", const="mp4", help=words)
    words = "say which steps are taken and what is left out, and why"
    parser.add_argument("--explain", action="store_true", help=words)
    viewers = parser.add_mutually_exclusive_group()
    words = "write the report of the run, and open it in the browser: its player shows the motion"
    viewers.add_argument("--view", action="store_true", help=words)
    words = "play the run in Exudyn's own viewer afterwards; it needs a display"
    viewers.add_argument("--exudyn-viewer", dest="viewer", action="store_true", help=words)
    add_output(parser, "results/NAME_OF_CONFIG")


def _formats(text: str) -> tuple[str, ...]:
    """Formats of figures that were asked for."""
    from granular_contact.report import FORMATS

    names = tuple(part.strip().lower() for part in text.split(","))
    if unknown := [name for name in names if name not in FORMATS]:
        raise argparse.ArgumentTypeError(f"got {unknown[0]!r}; allowed are {', '.join(FORMATS)}, with commas between")
    return names


def _method(chosen: argparse.Namespace) -> Iterator[str]:
    """--method and --modes in the form of --set; --modes alone keeps the other options of the config's method.

    A solver.accuracy of the config is not for the reduced model of the plane, which has an rtol of its own.
    """
    if chosen.method not in (None, "reduced") and chosen.modes is not None:
        what = "rigid bodies have none" if chosen.method == "minimal" else "the engine has none"
        raise ConfigError([Fault(f"--modes {chosen.modes}", None, "", f"{what}: needs --method reduced")])
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
    kept: list[tuple[System, Trajectory]] = []
    results, took = _simulate(chosen, scenario, scene, kept)
    # Before what is drawn below is imported.
    explained = [*_explanation(scene, kept)] if chosen.explain else []
    _save(chosen, results, folder, figures=scenario.output.figures and not chosen.no_plots)
    if not chosen.quiet:
        say("\n".join(_summary(results, _surface_follows(scenario), took, folder)))
        told = set(map(str, scene.notes))  # when the config was read
        say("\n".join(f"warning: {warning}" for warning in results.warnings if warning not in told))
    elif results.status.code in ENDS:
        complain(f"{results.status.message}; saved in {folder}")
    elif not results.summary.get("usable", True):
        complain(f"the result is not usable, see its warnings; saved in {folder}")
    if explained:
        say("\n".join(explained))
    if chosen.view:
        view(folder)
    for solved in kept if chosen.viewer else ():
        from granular_contact.engines.exudyn import viewer

        viewer.show(*solved)
    return exit_code(results)


def _save(chosen: argparse.Namespace, results: Results, folder: Path, *, figures: bool) -> None:
    """Write the results, with the film that was asked for; say what that lacks."""
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
    chosen: argparse.Namespace, scenario: Scenario, scene: Scene, kept: list[tuple[System, Trajectory]]
) -> tuple[Results, str]:
    """The results of the run, and how long it took; kept: gets the engine's system, if it is looked at afterwards."""
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
            inspect=(lambda *solved: kept.append(solved)) if chosen.viewer or chosen.explain else None,
            compiling=None if chosen.quiet else announce,
        )
    compiled = seconds() - compiled
    also = f", and {compiled:.1f} s of compiling, once in an installation" if compiled else ""
    return results, f"{time.perf_counter() - begin - compiled:.2f} s{also}"


def _explanation(scene: Scene, solved: list[tuple[System, Trajectory]]) -> Iterator[str]:
    """Lines on how a run was computed, and on what it did without; reduced models have no system."""
    from granular_contact.scene.methods import reason

    if scene.scenario is not None and scene.scenario.method.name == "auto":
        yield f"computed {reason(scene)}"
    yield f"steps {scene.solver.why}"
    for both in solved if scene.in_space else ():
        from granular_contact.mechanics.space.facet_sizes import explained

        yield from explained(*both)
    yield "left out:"
    if scene.method is not None:
        also = "" if "exudyn" in sys.modules else ", and it is not imported"
        yield f"  the engine: the method does without its solver{also}"
    for system, trajectory in solved:
        from granular_contact.mechanics.omissions import left_out

        yield from (f"  {line}" for line in left_out(system, trajectory))


def _surface_follows(scenario: Scenario) -> bool:
    """Whether the height of a body was given, and none of the surface, which then goes with it."""
    if not scenario.media or scenario.surface_height is not None or getattr(scenario.bed, "profile_m", None):
        return False
    return any(start.height is not None for start in (scenario.initial.joints or {}).values())


def _refuse_viewer(scene: Scene) -> None:
    """Raise if the engine's viewer can't show the run."""
    if scene.method is not None:
        raise Refusal("--exudyn-viewer: it is the engine's, which this method does not run in; --view shows both")
    from granular_contact.engines.exudyn import viewer

    if (problem := viewer.problem()) is not None:
        raise Refusal(f"--exudyn-viewer: {problem}; --view shows the run in the browser, --animate saves a film")


@contextmanager
def _progress(shown: bool, end_time: float) -> Iterator[tuple[Progress | None, Compiling]]:
    """Give a callable that shows the simulated time, of `end_time` (s), on stderr, and one that says what is compiled.

    The first is None if nothing is to be shown. The second speaks above the bar and in it, or on stderr alone.
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
    words = f"{{task.completed:.{digits}f}} of {{task.total:g}} {unit}, {{task.fields[rate]}}"
    columns = (BarColumn(8 if narrow else 40), TextColumn(words), *(() if narrow else (TimeElapsedColumn(),)))
    with Bar(*columns, console=console, transient=True) as bar:
        task = bar.add_task("", total=end_time, rate="starting")
        begin, compiled = time.perf_counter(), seconds()

        def update(simulated: float, end: float) -> None:
            spent = time.perf_counter() - begin - (seconds() - compiled)
            rate = simulated / max(spent, 1e-9)
            bar.update(task, completed=simulated, total=end, rate=f"{rate:.3g} s per s")

        def announce(what: str) -> None:
            bar.console.print(what, highlight=False)
            bar.update(task, rate="compiling")

        yield update, announce


_LINES = (  # key, unit that gets a prefix if it is a length or a time, digits, and words
    ("penetration_time_s", "s", "#.4g", "  sinking         {}, from touch until the lower end sinks no deeper"),
    ("angle_at_stop_deg", "deg", "#.5g", "  angle at stop   {}"),
    ("max_depth_m", "m", "#.4g", "  largest depth   {}"),
    ("max_deflection_m", "m", "#.4g", "  deflection      {} at most"),
    ("forward_speed_second_half_m_s", "m/s", "#.4g", "  forward speed   {} in the second half"),
)


def _strain(links: dict[str, dict[str, Any]]) -> str:
    """A line on the link that is strained most."""
    name, most = max(links.items(), key=lambda item: item[1]["strain"])
    stress = most["stress_Pa"]
    mega = f"; stress {1e-6 * stress:.3g} MPa (von Mises)" if stress is not None and math.isfinite(stress) else ""
    return f"  strain          {100.0 * most['strain']:.3g} % at most, at the skin of {name}{mega}"


def _summary(results: Results, surface_follows: bool, elapsed: str, folder: Path) -> Iterator[str]:
    """Lines that summarise a run; quantities that it does not have are left out."""
    from granular_contact.report.units import sized

    found: dict[str, Any] = results.summary
    doubt = "" if found.get("usable", True) else "; the result is not usable, see its warnings"
    yield f"{results.name}: {results.status.message}{doubt}"
    if surface_follows:
        yield "  surface         where it touches the mechanism at the start, as surface_height_m is not given"
    if (stop := found.get("stopping_time_s")) is not None:
        yield f"  stopping time   {sized(stop, 's', '#.4g')}, {found['stopping_time_measure']}"
    for key, unit, form, line in _LINES:
        value = found.get(key)
        if value is not None and not (key == "max_depth_m" and value < 0.0):
            yield line.format(sized(value, unit, form) if unit in ("s", "m") else f"{value:{form}} {unit}")
    if links := found.get("links"):
        yield _strain(links)
    if wheel := found.get("wheel"):
        sinkage = f"sinkage {sized(wheel['sinkage_m'], 'm', '#.4g')}"
        yield f"  wheel           slip {wheel['slip']:.3f}, {sinkage}, means of the last half"
        yield f"                  pull {wheel['drawbar_pull_N']:.3g} N, torque {wheel['torque_Nm']:.3g} N m"
    if (cost := found.get("cost_of_transport")) is not None:
        yield f"  transport cost  {cost:.3g} of weight times distance"
    if (imbalance := found.get("energy", {}).get("imbalance_relative")) is not None:
        yield f"  imbalance       {imbalance:.1e} of the energy"
    yield f"  wall time       {elapsed}"
    yield f"  saved in        {folder}"
