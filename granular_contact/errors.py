"""Errors of input and runs, each with its place and with what is allowed instead."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass


class GranularContactError(Exception):
    """Base class of all exceptions of this package."""


@dataclass(frozen=True)
class Fault:
    """One thing that is wrong with the input.

    file: as the user named it, or `--set KEY=VALUE`; empty while the place is unknown (a scene knows keys, not files).
    line: from 1; None where a line means nothing. key: dotted, as `medium.eta_h`; empty for a fault of the whole file.
    message: what was got and what is allowed.
    """

    file: str
    line: int | None
    key: str
    message: str

    def __str__(self) -> str:
        """`file:line: dotted.key: message` in one printable line, without the parts that are not known."""
        place = f"{self.file}:{self.line}" if self.line is not None else self.file
        text = ": ".join(part for part in (place, self.key, self.message) if part)
        # A key may hold a line break or a control sequence of the terminal.
        return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)


class _FaultyInput(GranularContactError):
    """Input refused for one or more faults; `str` gives one line for each."""

    def __init__(self, faults: Sequence[Fault]) -> None:
        self.faults = list(faults)
        super().__init__("\n".join(map(str, self.faults)))


class ConfigError(_FaultyInput):
    """A faulty YAML file or override; `faults` are sorted by file and line."""


class SceneError(_FaultyInput):
    """A scenario whose geometry contradicts itself; its faults carry dotted keys, and no file until they are placed."""


class SolveError(GranularContactError):
    """The engine could not be set up or started for this scene."""


class OutOfTimeError(SolveError):
    """The time limit was reached before the first step: there is nothing to save."""


def scene_fault(key: str, message: str) -> Fault:
    """A fault of a scene, which knows keys, but no files."""
    return Fault("", None, key, message)


def scene_error(key: str, message: str) -> SceneError:
    """A scene error of one fault."""
    return SceneError([scene_fault(key, message)])
