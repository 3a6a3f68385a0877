"""The command `fit`: estimate parameters from measured runs, with standard errors and diagnostics."""

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
    status_line,
    worker_count,
)

if TYPE_CHECKING:
    from granular_contact.studies.fit import Fit

HELP = "fit coefficients to measured runs and force tests, with standard errors"
MOST_SHOWN = 12  # largest number of parameters for which the correlation matrix is printed


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    text = "a fit file; or configs, each followed by its CSV files with measured values"
    parser.add_argument("files", metavar="FILE", nargs="+", help=text)
    parser.add_argument("--parameters", metavar="KEY,KEY", help="parameters to fit, as medium.eta_h,medium.eta_d")
    text = "bounds of a parameter, as medium.eta_h=1:40; repeatable"
    parser.add_argument("--bounds", metavar="KEY=LOW:HIGH", action="append", default=[], help=text)
    text = "header in the CSV files of each quantity, as time_s=t,tip_x_mm=X"
    parser.add_argument("--columns", metavar="COLUMN=NAME,...", help=text)
    text = "time S (s) at which the runs start, by the clock of the data. Without S it is estimated for each run, "
    text += "from -0.02 to 0.02 s (other bounds in a fit file: time_offset_s: {from: LOW, to: HIGH})"
    parser.add_argument("--time-offset", metavar="S", nargs="?", const="fit", help=text)
    text = "standard deviation of the noise of a column, as tip_x_mm=0.1; of other columns it is estimated; repeatable"
    parser.add_argument("--noise", metavar="COLUMN=X", action="append", default=[], help=text)
    text = "motion of the body in a force test, as direction=down, speed_m_s=0.005, depth_offset_m=fit; repeatable"
    parser.add_argument("--force-test", metavar="KEY=VALUE", action="append", default=[], help=text)
    text = "loss function. linear: ordinary least squares; soft_l1: limits the weight of outliers (soft_l1)"
    parser.add_argument("--loss", metavar="soft_l1|linear", help=text)
    text = "in force tests, separate the scatter of the grains' resistance from noise; best with repeated tests"
    parser.add_argument("--scatter", action="store_true", help=text)
    parser.add_argument("--starts", metavar="N", help="number of starting points (8)")
    parser.add_argument("--seed", metavar="N", help="seed of the random starting points (0)")
    parser.add_argument("--workers", metavar="N", type=worker_count, help="number of worker processes (one per core)")
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
    with status_line(sys.stderr.isatty() and not chosen.quiet, "{} of {} starting points done") as progress:
        result = fit(problem, chosen.workers or cores(), progress)
    try:
        write(result, folder, figures=not chosen.no_plots)
    except OSError as error:
        raise Refusal(f"the fit can't be saved in {folder}: {reason(error)}") from None
    if not chosen.quiet:
        _show(result)
        say(f"saved in {folder}")
    for warning in result.warnings if chosen.quiet else ():
        complain(f"warning: {warning}")
    return FINE if result.solution.converged else FAILED


def _show(result: Fit) -> None:
    """Print the estimates, correlations, noise, goodness of fit and warnings."""
    rows = []
    for estimate in result.uncertainty.estimates:
        label = estimate.parameter.label + (" (at its bound)" if estimate.at_bound else "")
        ends = (_finite_or_dash(x, f".{digits(x, estimate.error)}g") for x in (estimate.low, estimate.high))
        rows.append([label, f"{estimate.value:.6g}", _finite_or_dash(estimate.error, ".4g"), *ends])
    print_table("parameter", ("value", "standard error", "95 % from", "to"), rows)
    shared = [j for j, p in enumerate(result.problem.parameters) if p.shared]
    if 1 < len(shared) <= MOST_SHOWN:
        print()
        matrix, parameters = result.uncertainty.correlation, result.problem.parameters
        lines = [[parameters[i].label, *(_finite_or_dash(matrix[i, j], "+.3f") for j in shared)] for i in shared]
        print_table("correlation", [parameters[j].key[-1] for j in shared], lines)
    print()
    for column in result.goodness.columns:
        origin = "given" if column.noise_given else "estimated"
        print(f"noise of {column.column}: {column.noise:.3g} ({origin}, {column.rows} values)")
    if (grains := result.scatter) is not None:
        say(
            f"scatter of the force {100 * grains.force:.3g} +- {100 * grains.force_error:.1g} % over "
            f"{1e3 * grains.length:.3g} +- {1e3 * grains.length_error:.1g} mm; "
            f"of the medium {100 * grains.relative:.3g} %"
        )
    goodness = result.goodness
    verdict = "the residuals look like noise" if goodness.status == "fits" else "the residuals do not look like noise"
    without_outliers = f" ({goodness.without_outliers:.3g} without the outliers)" if goodness.outliers else ""
    say(
        f"{goodness.status}: {verdict}; reduced chi-square {goodness.reduced_chi_square:.3g}{without_outliers} of "
        f"{goodness.degrees_of_freedom} degrees of freedom, {result.agreeing} of {len(result.solution.starts)} starts "
        "agree"
    )
    for warning in result.warnings:
        say(f"warning: {warning}")


def digits(value: float, error: float) -> int:
    """Number of significant digits of a value in tables: to the second digit of its standard error, from 4 to 12."""
    if not (isfinite(value) and isfinite(error) and value and error):
        return 4
    return min(max(4, 2 + floor(log10(abs(value))) - floor(log10(error))), 12)


def _finite_or_dash(value: float, form: str) -> str:
    """A formatted number, or a dash for one that is not finite."""
    return format(value, form) if isfinite(value) else "-"
