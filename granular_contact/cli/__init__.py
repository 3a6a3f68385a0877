"""The command line: the only place that prints and exits. One module per command: its arguments and its action."""

from granular_contact.cli.main import main

__all__ = ["main"]
