"""`granular-contact`, and `python -m granular_contact`."""

import os
import sys

OF_MANY = ("sweep", "ensemble", "optimise")  # commands that work in processes


def main() -> int:
    """Run the command of this process; returns the exit code."""
    # Else a file of the user's in ~/.exudyn makes `import exudyn` print where programs read what a command prints.
    os.environ.setdefault("EXUDYN_NO_USER_SETTINGS", "1")
    arguments = sys.argv[1:]
    if arguments and arguments[0] in OF_MANY and not any(word.startswith(("-h", "--h", "--sc")) for word in arguments):
        from granular_contact.studies.processes import prepare

        prepare()  # before all that reading a file takes: the server loads as much, on another core
    from granular_contact.cli import main as command

    return command()


if __name__ == "__main__":
    raise SystemExit(main())
