"""How faults of inputs are gathered: each step refuses its own, and whoever has several steps reports those of all."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager

from granular_contact.errors import ConfigError, Fault


def refuse(faults: Iterable[Fault]) -> None:
    """Raise ConfigError with these faults, if there are any."""
    if found := list(faults):
        raise ConfigError(found)


@contextmanager
def gathered(faults: list[Fault]) -> Iterator[None]:
    """Add to `faults` those with which the block is left; what follows the block goes on."""
    try:
        yield
    except ConfigError as error:
        faults += error.faults
