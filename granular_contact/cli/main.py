"""Entry point of the command line.

Exit codes: 0 fine, 2 faulty input, 3 the solver failed, 4 time limit reached, 5 a result is not usable, 130
interrupted. A figure that can't be drawn gives a warning and does not change the exit code. Each command imports
what it needs: `check` never loads the engine, and a run without figures never loads matplotlib.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence
from importlib import import_module

from granular_contact import __version__
from granular_contact.cli.common import FAILED, FAULTY_INPUT, FINE, INTERRUPTED, OUT_OF_TIME, Refusal, complain
from granular_contact.errors import GranularContactError, OutOfTimeError, SolveError, missing_figures

COMMANDS = (
    *("new", "run", "check", "report", "sweep", "ensemble", "optimise", "compare", "compare-media", "fit"),
    *("media", "examples", "schema", "warm", "validate"),
)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; `arguments` default to those of the process. Returns the exit code."""
    parser = _parser()
    chosen, unknown = parser.parse_known_args(arguments)
    if unknown:
        chosen.parser.error(f"unrecognized arguments: {' '.join(unknown)}")
    if chosen.version:
        print(_versions())
        return FINE
    if chosen.command is None:
        parser.print_help()
        return FINE
    try:
        with missing_figures(lambda message: complain(f"warning: {message}")):
            code: int = chosen.command(chosen)
    except (GranularContactError, Refusal) as error:
        complain(str(error))
        codes = {OutOfTimeError: OUT_OF_TIME, SolveError: FAILED}
        return next((code for kind, code in codes.items() if isinstance(error, kind)), FAULTY_INPUT)
    except KeyboardInterrupt as stopped:
        complain(f"interrupted; {str(stopped) or 'nothing was saved'}")
        return INTERRUPTED
    except BrokenPipeError:
        # The reader of the output has closed the pipe. Python would report that once more when it closes stdout.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return FINE
    return code


def _versions() -> str:
    """Versions of the program and of the packages that compute."""
    import platform
    from importlib import metadata

    known = ", ".join(f"{name} {metadata.version(name)}" for name in ("exudyn", "numba", "numpy"))
    return f"granular-contact {__version__}, {known}, Python {platform.python_version()}"


def _parser() -> argparse.ArgumentParser:
    """Parser of all commands, without loading what they need to run."""
    parser = argparse.ArgumentParser(
        "granular-contact",
        description="Robots and other mechanisms that move in sand, simulated in Exudyn.",
        epilog="`granular-contact COMMAND --help` lists the options of a command; begin with `new` or `examples`. "
        "Exit codes: 0 fine, 2 faulty input, 3 failed, 4 time limit, 5 a result is not usable, 130 interrupted.",
    )
    parser.add_argument("--version", action="store_true", help="print the versions of the program and of the engine")
    parser.set_defaults(command=None, parser=parser)
    commands = parser.add_subparsers(title="commands", metavar="COMMAND")
    for name in COMMANDS:
        module = import_module(f"granular_contact.cli.{name.replace('-', '_')}")
        command = commands.add_parser(name, help=module.HELP)
        module.add_arguments(command)
        command.set_defaults(command=module.execute, parser=command)
    return parser
