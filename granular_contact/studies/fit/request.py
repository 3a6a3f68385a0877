"""The request for a fit: runs, parameters and options, as they were written."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from granular_contact.config.overrides import Override
from granular_contact.config.schema.fit import Bounds, ClockBounds, FitFile, ForceTest
from granular_contact.config.tree import Position


def looked_for(zero: str | float | ClockBounds | None, reach: float) -> tuple[float, float, float] | None:
    """Least, greatest and start of a zero, of a clock, a depth or a force, that is to be found; None if it is known.

    reach: how far it is looked for where only `fit` is said.
    """
    if isinstance(zero, str):
        return -reach, reach, 0.0
    if isinstance(zero, ClockBounds):
        return zero.low, zero.high, min(max(0.0, zero.low), zero.high) if zero.start is None else zero.start
    return None


@dataclass(frozen=True)
class ParameterRequest:
    """A requested parameter."""

    key: tuple[str, ...]
    position: Position
    bounds: Bounds = field(default_factory=Bounds)

    @property
    def name(self) -> str:
        """The dotted key."""
        return ".".join(self.key)


@dataclass(frozen=True)
class RunRequest:
    """A requested run. columns: measured name -> header and place; rows: header -> number and place.

    offset: by how much its clock is ahead (s), or least, greatest and start of what is to be found. force_test: how the
    body was moved; None: as the columns say.
    """

    name: str
    config: Path
    data: Path
    at_config: Position
    at_data: Position
    overrides: tuple[Override, ...] = ()
    columns: Mapping[str, tuple[str, Position]] = field(default_factory=dict)
    offset: float | tuple[float, float, float] = 0.0
    parameters: tuple[ParameterRequest, ...] = ()
    rows: Mapping[str, tuple[float, Position]] = field(default_factory=dict)
    force_test: ForceTest | None = None


@dataclass(frozen=True)
class Specification:
    """A requested fit. noise: measured name -> value and place; file: with the options of the solver."""

    name: str
    file: FitFile
    runs: tuple[RunRequest, ...]
    parameters: tuple[ParameterRequest, ...]
    common: tuple[Override, ...]
    noise: Mapping[str, tuple[float, Position]]
