"""Controllers: functions of time and observations that give the controls of a run, and the loop that calls them."""

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
    """A run that a controller steers; `Simulation` is one."""

    @property
    def ended(self) -> Status | None:
        """How the run ended; None while it goes on."""

    def observe(self) -> Observations:
        """Observations of the present state."""

    def _go_on(self, controls: Controls, until: float) -> Observations:
        """Set controls and advance to a time (s)."""

    def fail(self, message: str) -> None:
        """End the run with the status failed."""

    def run_out(self) -> None:
        """End the run because its wall time is used up."""

    def interrupt(self) -> None:
        """End the run with the status interrupted."""


def steer(
    run: Steered, control: Controller, rate: float, end: float, left: float, progress: Progress | None
) -> Exception | None:
    """Run to the end with controls from a controller.

    Parameters
    ----------
    run
        The run, at its present state.
    control
        The controller, a function of time (s) and observations.
    rate
        Number of calls of the controller per second of simulated time.
    end
        End of the run (s), for `progress`.
    left
        Wall time (s) that is left for the run and its controller.
    progress
        Called after each call of the controller with the simulated time and the end (s).

    Returns
    -------
    Exception or None
        The exception that the controller raised, which ends the run as failed.
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
        except Exception as error:  # a controller of a user may raise anything
            run.fail(f"the controller failed at {seen.time:.6g} s: {_one_line(error)}")
            return error
        if progress is not None:
            progress(seen.time, end)
        if run.ended is None and time.perf_counter() > deadline:
            run.run_out()
    return None


def checked_rate(control_rate_Hz: Any, shortest: float = 0.0) -> float:
    """The rate as a number. ControlError if it is no number above 0, or if its period is below `shortest` (s)."""
    rate = finite(control_rate_Hz)
    if rate is None or rate <= 0.0:
        raise ControlError(f"control_rate_Hz: got {control_rate_Hz!r}, allowed is a finite number above 0")
    if rate * shortest > 1.0:
        raise ControlError(f"control_rate_Hz: got {rate:g}, allowed is at most {1.0 / shortest:g} in this run")
    return rate


def _one_line(error: Exception) -> str:
    """Message of an exception in one line, with the file and line that raised it."""
    if isinstance(error, ControlError):
        return str(error).replace("\n", "; ")
    frames: Sequence[traceback.FrameSummary] = traceback.extract_tb(error.__traceback__)
    return f"{type(error).__name__}: {error} ({frames[-1].filename}:{frames[-1].lineno})"


def finite(value: Any) -> float | None:
    """The value as a finite number; None if it is none."""
    try:
        number = float(value)
    except (TypeError, ValueError):
        return None
    return number if math.isfinite(number) and not isinstance(value, bool | str) else None
