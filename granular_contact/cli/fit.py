"""The command `fit`: parameters from measured runs, with standard errors and diagnostics, shown and saved."""

from __future__ import annotations

import argparse
import sys
from math import floor, isfinite, log10
from pathlib import Path
from typing import TYPE_CHECKING

from granular_contact.cli.common import (
    FAILED,
    FINE,
    Refusal,
    add_output,
    add_set,
    complain,
    output_folder,
    print_table,
    reason,
    say,
    telling,
    worker_count,
)

if TYPE_CHECKING:
    from granular_contact.studies.fit import Fit

HELP = "fit coefficients to measured runs and force tests, with standard errors"
MOST_SHOWN = 12  # parameters in the matrix of correlations


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    words = "a fit file; or configs, each followed by the CSV files that were measured of it"
    parser.add_argument("files", metavar="FILE", nargs="+", help=words)
    parser.add_argument("--parameters", metavar="KEY,KEY", help="parameters to fit, as medium.eta_h,medium.eta_d")
    words = "bounds of a parameter, as medium.eta_h=1:40; repeatable"
    parser.add_argument("--bounds", metavar="KEY=LOW:HIGH", action="append", default=[], help=words)
    words = "headers in the CSV files by quantity, as time_s=t,tip_x_mm=X"
    parser.add_argument("--columns", metavar="COLUMN=NAME,...", help=words)
    words = (
        "by how much the clock of the data is ahead: the run starts at S by it. Without a number it is looked for in "
    )
    words += "each run, from -0.02 to 0.02 s (wider in a fit file: time_offset_s: {from: LOW, to: HIGH})"
    parser.add_argument("--time-offset", metavar="S", nargs="?", const="fit", help=words)
    words = "known noise, as tip_x_mm=0.1; estimated where not given; repeatable"
    parser.add_argument("--noise", metavar="COLUMN=X", action="append", default=[], help=words)
    words = "how the body of a force test was moved, as direction=down, speed_m_s=0.005, depth_offset_m=fit; repeatable"
    parser.add_argument("--force-test", metavar="KEY=VALUE", action="append", default=[], help=words)
    parser.add_argument(
        "--loss",
        metavar="soft_l1|linear",
        help="linear: ordinary least squares; soft_l1: outliers have limited weight (soft_l1)",
    )
    words = "separate the scatter of grains from noise, in force tests: best in repeated ones"
    parser.add_argument("--scatter", action="store_true", help=words)
    parser.add_argument("--starts", metavar="N", help="number of starting points (8)")
    parser.add_argument("--seed", metavar="N", help="seed of the choice of these points (0)")
    parser.add_argument("--workers", metavar="N", type=worker_count, help="worker processes (one per core)")
    add_set(parser)
    parser.add_argument("--no-plots", action="store_true", help="draw no figures")
    add_output(parser, "results/NAME_OF_FIRST_FILE_fit")


def execute(chosen: argparse.Namespace) -> int:
    """Run the command; returns the exit code."""
    from granular_contact.cli.fit_options import requested_fit

    request = requested_fit(chosen)
    folder = output_folder(chosen.out, f"{Path(chosen.files[0]).stem}_fit", "fit")

    from granular_contact.studies.fit import fit, prepare, write
    from granular_contact.studies.processes import cores

    problem = prepare(request)
    with telling(sys.stderr.isatty() and not chosen.quiet, "{} of {} starting points done") as progress:
        found = fit(problem, chosen.workers or cores(), progress)
    try:
        write(found, folder, figures=not chosen.no_plots)
    except OSError as error:
        raise Refusal(f"the fit can't be saved in {folder}: {reason(error)}") from None
    if not chosen.quiet:
        _show(found)
        say(f"saved in {folder}")
    for warning in found.warnings if chosen.quiet else ():
        complain(f"warning: {warning}")
    return FINE if found.solution.converged else FAILED


def _show(found: Fit) -> None:
    rows = []
    for one in found.uncertainty.estimates:
        label = one.parameter.label + (" (at its bound)" if one.at_bound else "")
        ends = (_known(x, f".{digits(x, one.error)}g") for x in (one.low, one.high))
        rows.append([label, f"{one.value:.6g}", _known(one.error, ".4g"), *ends])
    print_table("parameter", ("value", "standard error", "95 % from", "to"), rows)
    shared = [j for j, p in enumerate(found.problem.parameters) if p.shared]
    if 1 < len(shared) <= MOST_SHOWN:
        print()
        matrix, names = found.uncertainty.correlation, found.problem.parameters
        lines = [[names[i].label, *(_known(matrix[i, j], "+.3f") for j in shared)] for i in shared]
        print_table("correlation", [names[j].key[-1] for j in shared], lines)
    print()
    for column in found.goodness.columns:
        kind = "given" if column.noise_given else "estimated"
        print(f"noise of {column.column}: {column.noise:.3g} ({kind}, {column.rows} values)")
    if (grains := found.scatter) is not None:
        say(
            f"scatter of the force {100 * grains.force:.3g} +- {100 * grains.force_error:.1g} % over "
            f"{1e3 * grains.length:.3g} +- {1e3 * grains.length_error:.1g} mm; "
            f"of the medium {100 * grains.relative:.3g} %"
        )
    good = found.goodness
    words = "the residuals look like noise" if good.status == "fits" else "the residuals do not look like noise"
    rest = f" ({good.without_outliers:.3g} without the outliers)" if good.outliers else ""
    say(
        f"{good.status}: {words}; reduced chi-square {good.reduced_chi_square:.3g}{rest} of {good.degrees_of_freedom} "
        f"degrees of freedom, {found.agreeing} of {len(found.solution.starts)} starts agree"
    )
    for warning in found.warnings:
        say(f"warning: {warning}")


def digits(value: float, error: float) -> int:
    """How many significant digits of a value are shown: two of those that its standard error reaches, and four."""
    if not (isfinite(value) and isfinite(error) and value and error):
        return 4
    return min(max(4, 2 + floor(log10(abs(value))) - floor(log10(error))), 12)


def _known(value: float, form: str) -> str:
    return format(value, form) if isfinite(value) else "-"
