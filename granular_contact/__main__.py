"""Entry point of `granular-contact` and of `python -m granular_contact`."""

import os
import sys

WITH_WORKERS = ("sweep", "ensemble", "optimise")  # commands that use worker processes


def main() -> int:
    """Run the command line of this process; return the exit code."""
    # A settings file of the user in ~/.exudyn would make `import exudyn` print into the output of the command.
    os.environ.setdefault("EXUDYN_NO_USER_SETTINGS", "1")
    arguments = sys.argv[1:]
    with_workers = bool(arguments) and arguments[0] in WITH_WORKERS
    if with_workers and not any(argument.startswith(("-h", "--h", "--sc")) for argument in arguments):
        from granular_contact.studies.processes import prepare

        prepare()  # the server of workers loads the package on another core while this process reads the file
    from granular_contact.cli import main as command

    return command()


if __name__ == "__main__":
    raise SystemExit(main())
