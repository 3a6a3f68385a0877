"""The command line: the only place that prints and exits. A module a command: its arguments, and what it does."""

from granular_contact.cli.main import main

__all__ = ["main"]
