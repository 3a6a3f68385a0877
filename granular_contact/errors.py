"""Errors of input and of runs. Each message names the place of the fault and what is allowed."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from difflib import get_close_matches
from numbers import Integral
from typing import Any

MOST_NAMES = 12  # number of known names that a message lists


class GranularContactError(Exception):
    """Base class of all exceptions of this package."""


@dataclass(frozen=True)
class Fault:
    """One fault of the input.

    file: file as the user named it, or `--set KEY=VALUE`; empty while it is unknown (a scene knows keys, not files).
    line: from 1; None for a place without lines. key: dotted, as `medium.eta_h`; empty for a fault of the whole file.
    message: what was got, and what is allowed.
    """

    file: str
    line: int | None
    key: str
    message: str

    def __str__(self) -> str:
        """`file:line: dotted.key: message` in one printable line, without unknown parts."""
        place = f"{self.file}:{self.line}" if self.line is not None else self.file
        text = ": ".join(part for part in (place, self.key, self.message) if part)
        # A key may contain a line break or a control sequence of the terminal.
        return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)


class _FaultyInput(GranularContactError):
    """Input with one or more faults; `str` gives a line for each."""

    def __init__(self, faults: Sequence[Fault]) -> None:
        self.faults = list(faults)
        super().__init__("\n".join(map(str, self.faults)))


class ConfigError(_FaultyInput):
    """A faulty YAML file or override; `faults` are sorted by file and line."""


class SceneError(_FaultyInput):
    """A scenario whose geometry is contradictory. Its faults have dotted keys, and files once they are placed."""


class SolveError(GranularContactError):
    """The solver could not be set up or started for this scene."""


class ControlError(GranularContactError):
    """A simulation can't take these controls, this step or this state; its state does not change."""


class ControllerError(ControlError):
    """The controller of a run raised an exception, which is the cause of this one, or gave invalid controls.

    results: results up to this instant, with the status failed.
    """

    def __init__(self, message: str, results: Any = None) -> None:
        self.results = results
        super().__init__(message)


class OutOfTimeError(SolveError):
    """The limit of wall time was reached before the first step, so there are no results."""


class ResultsError(GranularContactError):
    """Results that can't be opened, or not be shown as requested; the message is one line."""


class WorkerPoolError(GranularContactError):
    """The worker processes can't be reached, or can't do this work; the message is one line."""


class MissingPackageError(GranularContactError, ImportError):
    """An optional package is not installed; the message is one line that says how to install it."""


def short(text: str, most: int = 60) -> str:
    """A text for a message, cut to `most` characters."""
    return text if len(text) <= most else f"{text[: most - 3]}..."


def unknown_name(noun: str, name: Any, known: Iterable[str], welded: Mapping[str, str] | None = None) -> str:
    """Message that no column, control or other thing (`noun`) has this name, with the nearest or the first known names.

    welded: for each body that is welded to another one, the body under whose name its columns are.
    """
    names = [*known]
    for body, root in (welded or {}).items():
        if str(name).startswith(f"{body}_") and not any(known_name.startswith(f"{body}_") for known_name in names):
            return f"no {noun} {name!r}; {body} is welded to {root}: they are one body, whose names begin with {root}_"
    if near := get_close_matches(str(name), names, 3):
        return f"no {noun} {name!r}; did you mean {' or '.join(near)}?"
    more = f", and {len(names) - MOST_NAMES} more" if len(names) > MOST_NAMES else ""
    return f"no {noun} {name!r}; there are: {', '.join(names[:MOST_NAMES]) or 'none'}{more}"


def of_type(name: str, value: Any, types: type | tuple[type, ...], allowed: str) -> None:
    """Check that an argument of a public function has one of these types.

    Raises
    ------
    TypeError
        It has not. The message has its name, the value and what is allowed, in one line.
    """
    if not isinstance(value, types):
        text = short(" ".join(repr(value).split()))
        raise TypeError(f"{name}: got {text} of type {type(value).__name__}; allowed is {allowed}")


def listed(name: str, values: Any, item_type: type, allowed: str) -> None:
    """Check that an argument is a list of items of a type, and no text; raises as `of_type`."""
    of_type(name, values, () if isinstance(values, str) else Sequence, allowed)
    for item in values:
        of_type(name, item, item_type, allowed)


def callables(**functions: Any) -> None:
    """Check that arguments are functions or None; raises as `of_type`."""
    for name, function in functions.items():
        if function is not None and not callable(function):
            of_type(name, function, (), "a function, or None")


def whole(name: str, value: Any, least: int, none: bool = False) -> None:
    """Check that an argument is a whole number of at least `least`, or None if `none` is true.

    Raises
    ------
    TypeError, ValueError
        It is no whole number, or a smaller one; the message is like that of `of_type`.
    """
    if value is None and none:
        return
    allowed = f"a whole number from {least} on" + ", or None" * none
    of_type(name, value, Integral, allowed)
    if isinstance(value, bool) or value < least:
        raise ValueError(f"{name}: got {value!r}; allowed is {allowed}")


class FigureWarning(UserWarning):
    """A figure, film or overview could not be drawn: its file is missing, but all data are saved."""


@contextmanager
def missing_figures(report: Callable[[str], object]) -> Iterator[None]:
    """Pass the text of each `FigureWarning` of the block to a function; Python handles other warnings as usual."""
    with warnings.catch_warnings():
        warnings.simplefilter("always", FigureWarning)
        show_other = warnings.showwarning

        def show(message: Warning | str, category: type[Warning], *args: Any, **kwargs: Any) -> None:
            if issubclass(category, FigureWarning):
                report(str(message))
            else:
                show_other(message, category, *args, **kwargs)

        warnings.showwarning = show
        yield


def scene_fault(key: str, message: str) -> Fault:
    """A fault of a scene, with its key but without file."""
    return Fault("", None, key, message)


def scene_error(key: str, message: str) -> SceneError:
    """A SceneError with one fault."""
    return SceneError([scene_fault(key, message)])
