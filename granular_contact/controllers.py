"""Controllers: functions of the time and of what is seen that steer a run, and how they are called."""

from __future__ import annotations

import math
import time
import traceback
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Protocol

from numpy.typing import ArrayLike

from granular_contact.errors import ControlError
from granular_contact.results import Progress, Status
from granular_contact.results.observed import Observations

Controls = Mapping[str, float] | ArrayLike | None
Controller = Callable[[float, Observations], Controls]


class Steered(Protocol):
    """A run that is steered, as `Simulation` is."""

    @property
    def ended(self) -> Status | None:
        """How it ended; None while it goes on."""

    def observe(self) -> Observations:
        """What is seen of the present state."""

    def _go_on(self, controls: Controls, until: float) -> Observations:
        """Set controls and go on to a time (s)."""

    def fail(self, message: str) -> None:
        """End as failed."""

    def run_out(self) -> None:
        """End as its wall time is over."""

    def interrupt(self) -> None:
        """End as interrupted."""


def steer(
    run: Steered, control: Controller, rate: float, end: float, left: float, progress: Progress | None
) -> Exception | None:
    """Go on to the end of a run (s), with controls from a controller that is called so many times a second.

    left: wall time (s) that it may take, the controller's own included. What the controller raises ends the run, and is
    given back; None where it raises nothing.
    """
    deadline = time.perf_counter() + left
    seen, calls = run.observe(), 0
    began = seen.time
    while run.ended is None:
        calls += 1
        try:
            seen = run._go_on(control(seen.time, seen), began + calls / rate)
        except KeyboardInterrupt:
            run.interrupt()
        except Exception as error:  # whatever the controller of a user raises
            run.fail(f"the controller failed at {seen.time:.6g} s: {_words(error)}")
            return error
        if progress is not None:
            progress(seen.time, end)
        if run.ended is None and time.perf_counter() > deadline:
            run.run_out()
    return None


def checked_rate(control_rate_Hz: Any, shortest: float = 0.0) -> float:
    """A rate as a number; ControlError where it is none above 0, or has a period below the `shortest` (s)."""
    rate = finite(control_rate_Hz)
    if rate is None or rate <= 0.0:
        raise ControlError(f"control_rate_Hz: got {control_rate_Hz!r}, allowed is a finite number above 0")
    if rate * shortest > 1.0:
        raise ControlError(f"control_rate_Hz: got {rate:g}, allowed is at most {1.0 / shortest:g} in this run")
    return rate


def _words(error: Exception) -> str:
    """An error in one sentence, with the place in the controller where it was raised."""
    if isinstance(error, ControlError):
        return str(error).replace("\n", "; ")
    frames: Sequence[traceback.FrameSummary] = traceback.extract_tb(error.__traceback__)
    return f"{type(error).__name__}: {error} ({frames[-1].filename}:{frames[-1].lineno})"


def finite(value: Any) -> float | None:
    """A value as a number; None if it is none, or not finite."""
    try:
        number = float(value)
    except (TypeError, ValueError):
        return None
    return number if math.isfinite(number) and not isinstance(value, bool | str) else None
