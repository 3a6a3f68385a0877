"""The command line: the only place that prints and exits.

Exit codes: 0 fine, 2 faulty input, 3 the solver failed, 130 interrupted. The heavy imports stand in the commands that
need them, so that `check` never loads the engine and a run without figures never loads the plots.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from granular_contact import config
from granular_contact.errors import ConfigError, Fault, SceneError, SolveError

if TYPE_CHECKING:
    from granular_contact.results import Results
    from granular_contact.scene import Scene

FINE, FAULTY_INPUT, FAILED, INTERRUPTED = 0, 2, 3, 130
MOST_WORKERS = 256
_STATUS_CODES = {"failed": FAILED, "interrupted": INTERRUPTED}
Progress = Callable[[float, float], None]


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; `arguments` default to those of the process. Returns the exit code."""
    chosen = _parser().parse_args(arguments)
    try:
        code: int = chosen.command(chosen)
    except (ConfigError, SceneError) as error:
        complain(str(error))
        return FAULTY_INPUT
    except SolveError as error:
        complain(str(error))
        return FAILED
    except KeyboardInterrupt:
        complain("interrupted; nothing was saved")
        return INTERRUPTED
    except BrokenPipeError:
        # Whoever read our output wants no more of it; Python would complain once more while it closes the pipe.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return FINE
    return code


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser("granular-contact", description="Links that strike and move in sand.")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")

    run = commands.add_parser("run", help="simulate a config and save what came of it")
    run.add_argument("config", metavar="CONFIG", help="YAML file of the run")
    run.add_argument(
        "--set", metavar="KEY=VALUE", action="append", default=[], help="replace a value, as medium.eta_h=9; repeatable"
    )
    run.add_argument(
        "--method",
        choices=("engine", "reduced"),
        help="the engine, or the reduced model of a pendulum with its defaults",
    )
    run.add_argument(
        "--modes", metavar="N", help="modes of the reduced model: 0 rigid, 1 as in the source paper, to 20"
    )
    run.add_argument("--out", metavar="DIR", help="folder of the results (results/NAME_OF_CONFIG)")
    run.add_argument("--no-plots", action="store_true", help="draw no figures")
    run.add_argument("--quiet", action="store_true", help="print faults only")
    run.set_defaults(command=_run)

    sweep = commands.add_parser("sweep", help="simulate many cases of a config on all cores, a row of a table each")
    sweep.add_argument("file", metavar="FILE", help="YAML file with a config, and cases or vary")
    sweep.add_argument("--out", metavar="DIR", help="folder of the results (results/NAME_OF_FILE)")
    sweep.add_argument("--workers", metavar="N", type=_worker_count, help="processes to run in (one a core)")
    sweep.add_argument("--plots", action="store_true", help="save a folder with series and figures for each case")
    sweep.add_argument("--quiet", action="store_true", help="print faults only")
    sweep.set_defaults(command=_sweep)

    compare = commands.add_parser("compare", help="run a config by several models and say which is enough")
    compare.add_argument("config", metavar="CONFIG", help="YAML file of the run")
    compare.add_argument("--modes", metavar="N,N", type=_counts, default=(0, 1, 2, 5), help="modal models (0,1,2,5)")
    compare.add_argument("--elements", metavar="N,N", type=_counts, default=(4, 8, 16, 32), help="beams (4,8,16,32)")
    compare.add_argument("--tolerance", metavar="X", type=_tolerance, default=0.01, help="what is enough (0.01)")
    compare.add_argument("--set", metavar="KEY=VALUE", action="append", default=[], help="as for run")
    compare.add_argument("--out", metavar="DIR", help="folder of the results (results/NAME_OF_CONFIG_compare)")
    compare.add_argument("--no-plots", action="store_true", help="draw no figure")
    compare.add_argument("--quiet", action="store_true", help="print faults only")
    compare.set_defaults(command=_compare)

    check = commands.add_parser("check", help="read configs and sweeps, and their geometry, without a run")
    check.add_argument("configs", metavar="FILE", nargs="+")
    check.set_defaults(command=_check)

    validate = commands.add_parser("validate", help="run the studies of a checkout and say what holds")
    validate.add_argument("--quick", action="store_true", help="fewer cases, same claims")
    validate.add_argument("--record", action="store_true", help="keep what was found as the record")
    validate.set_defaults(command=_validate)

    schema = commands.add_parser("schema", help="print the JSON Schema of a config")
    schema.set_defaults(command=_schema)
    return parser


def _worker_count(text: str) -> int:
    if not text.isdecimal() or not 1 <= int(text) <= MOST_WORKERS:
        raise argparse.ArgumentTypeError(f"got {text!r}; allowed is a whole number from 1 to {MOST_WORKERS}")
    return int(text)


def _counts(text: str) -> tuple[int, ...]:
    parts = [part.strip() for part in text.split(",") if part.strip()]
    if not all(part.lstrip("-").isdecimal() for part in parts):
        raise argparse.ArgumentTypeError(f"got {text!r}; allowed are whole numbers with commas, as 0,1,5")
    return tuple(int(part) for part in parts)


def _tolerance(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    if not 0.0 < value < 1.0:
        raise argparse.ArgumentTypeError(f"got {text!r}; allowed is a number between 0 and 1")
    return value


def complain(text: str) -> None:
    """Say what is wrong."""
    print(text, file=sys.stderr)


def _read(path: str, overrides: Sequence[str] = ()) -> tuple[config.Scenario, Scene]:
    """Scenario and scene of a config; a fault of the geometry gets the line that its key was written in."""
    from granular_contact import scene

    scenario, sources = config.load(path, overrides)
    try:
        return scenario, scene.build(scenario)
    except SceneError as error:
        raise SceneError(sources.place(error.faults)) from None


def _check(chosen: argparse.Namespace) -> int:
    fine = [_is_fine(path) for path in chosen.configs]
    return FINE if all(fine) else FAULTY_INPUT


def _is_fine(path: str) -> bool:
    from granular_contact import scene

    try:
        if config.is_sweep(path):
            config.load_sweep(path, probe=scene.build)
        else:
            _read(path)
    except (ConfigError, SceneError) as error:
        complain(str(error))
        return False
    print(f"{path}: ok")
    return True


def _schema(_: argparse.Namespace) -> int:
    print(json.dumps(config.json_schema(), indent=2))
    return FINE


def _sweep(chosen: argparse.Namespace) -> int:
    from granular_contact import cli_sweep

    return cli_sweep.sweep(chosen)


def _validate(chosen: argparse.Namespace) -> int:
    from granular_contact import cli_validate

    return cli_validate.run(chosen)


def _compare(chosen: argparse.Namespace) -> int:
    from granular_contact import cli_compare

    return cli_compare.run(chosen)


def _method(chosen: argparse.Namespace) -> Iterator[str]:
    """--method and --modes as what --set takes; modes alone keep the other options of the config's method."""
    if chosen.method == "engine" and chosen.modes is not None:
        raise ConfigError([Fault(f"--modes {chosen.modes}", None, "", "the engine has none: needs --method reduced")])
    if chosen.method is not None:
        yield "method=engine" if chosen.method == "engine" else "method={reduced: {}}"
    if chosen.modes is not None:
        yield f"method.reduced.modes={chosen.modes}"


def _run(chosen: argparse.Namespace) -> int:
    scenario, scene = _read(chosen.config, [*_method(chosen), *chosen.set])
    folder = Path(chosen.out) if chosen.out else Path("results", Path(chosen.config).stem)
    problem = folder_problem(folder)
    if problem:
        complain(problem)
        return FAULTY_INPUT

    from granular_contact import report
    from granular_contact.run import run

    begin = time.perf_counter()
    shown = sys.stderr.isatty() and not chosen.quiet
    with _progress(shown, scenario.solver.end_time_s) as progress:
        results = run(scene, scenario, progress=progress)
    elapsed = time.perf_counter() - begin
    try:
        report.write(results, folder, figures=scenario.output.figures and not chosen.no_plots)
    except OSError as error:
        complain(f"the results can't be saved in {folder}: {error}")
        return FAULTY_INPUT
    if not chosen.quiet:
        print("\n".join(_summary(results, elapsed, folder)))
    elif results.status.code in _STATUS_CODES:
        complain(f"{results.status.message}; saved in {folder}")
    return _STATUS_CODES.get(results.status.code, FINE)


def folder_problem(folder: Path, kind: str = "run") -> str | None:
    """Why `folder` can't take results of a kind (of `report.ENTRIES`), or None.

    It is found by trying, before the run, and nothing is left behind.
    """
    from granular_contact import report

    try:
        report.check_target(folder, kind)
        # The new folder is made beside the old one; where even the parent is missing, the nearest one there is decides.
        nearest = folder.resolve().parent
        while not nearest.exists():
            nearest = nearest.parent
        if not nearest.is_dir():
            return f"--out {folder}: {nearest} is a file, so no folder can be made in it"
        with tempfile.TemporaryDirectory(dir=nearest, prefix=f".{folder.resolve().name}."):
            return None
    except OSError as error:
        # `check_target` raises sentences; the system raises numbers with a short reason.
        reason = f"can't be written: {error.strerror}" if error.strerror else str(error)
        return f"--out {folder}: {reason}"


@contextmanager
def _progress(shown: bool, end_time: float) -> Iterator[Progress | None]:
    """Give a callable that draws simulated time, of `end_time` (s), on stderr, or None if nothing is to be shown."""
    if not shown:
        yield None
        return
    from rich.console import Console
    from rich.progress import BarColumn, TextColumn, TimeElapsedColumn
    from rich.progress import Progress as Bar

    text = TextColumn("{task.completed:.4f} of {task.total:g} s simulated, {task.fields[rate]}")
    with Bar(BarColumn(), text, TimeElapsedColumn(), console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("", total=end_time, rate="starting")
        begin = time.perf_counter()

        def update(simulated: float, end: float) -> None:
            rate = simulated / max(time.perf_counter() - begin, 1e-9)
            bar.update(task, completed=simulated, total=end, rate=f"{rate:.3g} s per s")

        yield update


def _summary(results: Results, elapsed: float, folder: Path) -> Iterator[str]:
    """Lines that tell a person what came of a run; a quantity that the run has not is left out."""
    found: dict[str, Any] = results.summary
    yield f"{results.name}: {results.status.message}"
    if (stop := found.get("stopping_time_s")) is not None:
        yield f"  stopping time   {1e3 * stop:.2f} ms, {found['stopping_time_measure']}"
    if (angle := found.get("angle_at_stop_deg")) is not None:
        yield f"  angle at stop   {angle:.3f} deg"
    if (depth := found.get("max_depth_m")) is not None:
        yield f"  largest depth   {1e3 * depth:.2f} mm"
    if (deflection := found.get("max_deflection_m")) is not None:
        yield f"  deflection      {1e3 * deflection:.4f} mm at most"
    if (imbalance := found.get("energy", {}).get("imbalance_relative")) is not None:
        yield f"  energy          {imbalance:.1e} of it unaccounted for"
    yield f"  wall time       {elapsed:.2f} s"
    yield f"  saved in        {folder}"
    yield from (f"warning: {warning}" for warning in results.warnings)
