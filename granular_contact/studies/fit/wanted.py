"""What a fit is asked for: runs, parameters and options, as they were written."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from granular_contact.config.overrides import Override
from granular_contact.config.tree import Position
from granular_contact.studies.fit.problem import Loss


@dataclass(frozen=True)
class Wanted:
    """A parameter as asked for; None where nothing was said."""

    key: tuple[str, ...]
    position: Position
    low: float | None = None
    high: float | None = None
    start: float | None = None
    scale: str | None = None

    @property
    def name(self) -> str:
        """The dotted key."""
        return ".".join(self.key)

    @property
    def bounds(self) -> tuple[float, float, float]:
        """Lower and upper bound and start, of one that has all three."""
        if self.low is None or self.high is None or self.start is None:
            raise ValueError(f"{self.name} has no bounds")
        return self.low, self.high, self.start


@dataclass(frozen=True)
class RunWanted:
    """One run as asked for. columns: measured name -> header and place; offset: a number (s), or bounds for one."""

    name: str
    config: Path
    data: Path
    at_config: Position
    at_data: Position
    overrides: tuple[Override, ...] = ()
    columns: Mapping[str, tuple[str, Position]] = field(default_factory=dict)
    offset: float | Wanted = 0.0
    parameters: tuple[Wanted, ...] = ()


@dataclass(frozen=True)
class Specification:
    """A fit as asked for. noise: measured name -> value and place."""

    name: str
    runs: tuple[RunWanted, ...]
    parameters: tuple[Wanted, ...]
    common: tuple[Override, ...]
    noise: Mapping[str, tuple[float, Position]]
    loss: Loss
    starts: int
    seed: int
