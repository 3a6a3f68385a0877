"""Errors of input and runs, each with its place and with what is allowed instead."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from difflib import get_close_matches
from numbers import Integral
from typing import Any

MOST_NAMES = 12  # of what there is, in a message


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


class ControlError(GranularContactError):
    """Controls, a step or a state that a simulation can't take; it stays as it was."""


class ControllerError(ControlError):
    """The controller of a run raised, or gave what can't be set; its own exception is the cause.

    results: what was reached by then, with the status failed.
    """

    def __init__(self, message: str, results: Any = None) -> None:
        self.results = results
        super().__init__(message)


class OutOfTimeError(SolveError):
    """The time limit was reached before the first step: there is nothing to save."""


class ResultsError(GranularContactError):
    """Results that can't be opened or shown as asked; the message is one line."""


class WorkerPoolError(GranularContactError):
    """The workers can't be reached, or can't do this work; the message is one line."""


class MissingPackageError(GranularContactError, ImportError):
    """A package that only this call needs is not installed; the message is one line, with how to install it."""


def short(text: str, most: int = 60) -> str:
    """A value for a message, cut to so many characters."""
    return text if len(text) <= most else f"{text[: most - 3]}..."


def unknown_name(what: str, name: Any, known: Iterable[str], welded: Mapping[str, str] | None = None) -> str:
    """That there is no column, control, ... of a name, with the names nearest to it, or the first of all.

    welded: by whose name those of a body go that is welded to another.
    """
    names = [*known]
    for body, root in (welded or {}).items():
        if str(name).startswith(f"{body}_") and not any(one.startswith(f"{body}_") for one in names):
            return f"no {what} {name!r}; {body} is welded to {root}: they are one body, whose names begin with {root}_"
    if near := get_close_matches(str(name), names, 3):
        return f"no {what} {name!r}; did you mean {' or '.join(near)}?"
    more = f", and {len(names) - MOST_NAMES} more" if len(names) > MOST_NAMES else ""
    return f"no {what} {name!r}; there are: {', '.join(names[:MOST_NAMES]) or 'none'}{more}"


def of_type(name: str, given: Any, kinds: type | tuple[type, ...], allowed: str) -> None:
    """Refuse an argument of a public function that is of none of these types.

    Raises
    ------
    TypeError
        With its name, what was given and what is allowed, in one line.
    """
    if not isinstance(given, kinds):
        text = short(" ".join(repr(given).split()))
        raise TypeError(f"{name}: got {text} of type {type(given).__name__}; allowed is {allowed}")


def listed(name: str, given: Any, kind: type, allowed: str) -> None:
    """Refuse what is no list of things of a type, as `of_type`; a text is none."""
    of_type(name, given, () if isinstance(given, str) else Sequence, allowed)
    for one in given:
        of_type(name, one, kind, allowed)


def callables(**given: Any) -> None:
    """Refuse what can't be called among optional functions, as `of_type`."""
    for name, one in given.items():
        if one is not None and not callable(one):
            of_type(name, one, (), "a function, or None")


def whole(name: str, given: Any, least: int, none: bool = False) -> None:
    """Refuse what is no whole number from a least one on: TypeError as of `of_type`, or ValueError."""
    if given is None and none:
        return
    words = f"a whole number from {least} on" + ", or None" * none
    of_type(name, given, Integral, words)
    if isinstance(given, bool) or given < least:
        raise ValueError(f"{name}: got {given!r}; allowed is {words}")


class FigureWarning(UserWarning):
    """A figure, film or overview could not be drawn: its file is missing, all data is saved."""


@contextmanager
def missing_figures(tell: Callable[[str], object]) -> Iterator[None]:
    """Have each `FigureWarning` of the block told by a function; other warnings stay Python's."""
    with warnings.catch_warnings():
        warnings.simplefilter("always", FigureWarning)
        others = warnings.showwarning

        def show(message: Warning | str, category: type[Warning], *place: Any, **more: Any) -> None:
            if issubclass(category, FigureWarning):
                tell(str(message))
            else:
                others(message, category, *place, **more)

        warnings.showwarning = show
        yield


def scene_fault(key: str, message: str) -> Fault:
    """A fault of a scene, which knows keys, but no files."""
    return Fault("", None, key, message)


def scene_error(key: str, message: str) -> SceneError:
    """A scene error of one fault."""
    return SceneError([scene_fault(key, message)])
