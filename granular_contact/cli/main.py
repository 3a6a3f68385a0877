"""Entry of the command line.

Exit codes: 0 fine, 2 faulty input, 3 the solver failed, 4 time limit reached, 130
interrupted. Heavy imports are in the commands that need them, so that `check` never loads the engine and a run without
figures never loads the plots.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence

from granular_contact.cli import (
    check,
    compare,
    compare_media,
    examples,
    fit,
    media,
    report,
    run,
    schema,
    sweep,
    validate,
)
from granular_contact.cli.common import FAILED, FAULTY_INPUT, FINE, INTERRUPTED, OUT_OF_TIME, Refusal, complain
from granular_contact.errors import ConfigError, OutOfTimeError, SceneError, SolveError

COMMANDS = (run, sweep, compare, compare_media, fit, report, media, check, examples, validate, schema)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; `arguments` default to those of the process. Returns the exit code."""
    chosen = _parser().parse_args(arguments)
    try:
        code: int = chosen.command(chosen)
    except (ConfigError, SceneError, Refusal) as error:
        complain(str(error))
        return FAULTY_INPUT
    except OutOfTimeError as error:
        complain(str(error))
        return OUT_OF_TIME
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
    for module in COMMANDS:
        name = module.__name__.rpartition(".")[2].replace("_", "-")
        command = commands.add_parser(name, help=module.HELP)
        module.add_arguments(command)
        command.set_defaults(command=module.act)
    return parser
