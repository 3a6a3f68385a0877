"""The command line, the only place that prints and exits. Each command is a module with its arguments and action."""

from granular_contact.cli.main import main

__all__ = ["main"]
