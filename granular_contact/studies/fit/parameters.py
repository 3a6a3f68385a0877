"""Make parameters with start, bounds and scale from requests; explain why a key cannot be a parameter."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from granular_contact.config.export import scenario_to_dict, value_at
from granular_contact.config.messages import unknown
from granular_contact.config.overrides import Override
from granular_contact.config.tree import Scalar
from granular_contact.errors import ConfigError, Fault
from granular_contact.studies.fit.problem import Parameter
from granular_contact.studies.fit.responses import Simulator
from granular_contact.studies.fit.specification import ParameterRequest, RunRequest

# Keys that are no property of the sand or the mechanism.
NOT_FITTED = ("solver", "method", "output", "name")
# Default bounds: the start times (or divided by) the largest of these factors that the schema allows on that side.
FACTORS = (10.0, 3.0, 1.5, 1.1)
LOG_FROM = 10.0  # from this ratio of the bounds on the scale is logarithmic


@dataclass(frozen=True)
class Choice:
    """A parameter and the request for it."""

    parameter: Parameter
    request: ParameterRequest


def choose(requests: Sequence[ParameterRequest], simulators: Sequence[Simulator], faults: list[Fault]) -> list[Choice]:
    """Parameters shared by all runs; they do not act on runs whose config lacks the key, unless all lack it."""
    runs = dict(enumerate(simulators))
    choices = [_choice(request, runs, "", faults) for request in requests]
    return [choice for choice in choices if choice is not None]


def choose_of_run(run: RunRequest, index: int, simulator: Simulator, faults: list[Fault]) -> list[Choice]:
    """Parameters of one run alone."""
    choices = [_choice(request, {index: simulator}, f" @ {run.name}", faults) for request in run.parameters]
    return [choice for choice in choices if choice is not None]


def _choice(
    request: ParameterRequest, simulators: dict[int, Simulator], suffix: str, faults: list[Fault]
) -> Choice | None:
    plains = {i: scenario_to_dict(simulator.load(()).scenario) for i, simulator in simulators.items()}
    values = {i: value_at(plain, request.key, _MISSING) for i, plain in plains.items()}
    numbers = {i: float(value) for i, value in values.items() if isinstance(value, float)}
    range_or_fault: Bounded | str | None = _refusal(request, list(values.values()), list(plains.values()))
    if range_or_fault is None and request.bounds.start is None and len(set(numbers.values())) > 1:
        listed = ", ".join(f"{value:g}" for value in sorted(set(numbers.values())))
        range_or_fault = f"the runs have different values, {listed}: give it a start in a fit file"
    if range_or_fault is None:
        start = next(iter(numbers.values())) if request.bounds.start is None else request.bounds.start
        range_or_fault = _bounded(request, start, [simulators[i] for i in numbers])
    if isinstance(range_or_fault, str):
        faults.append(request.position.fault((request.name,), range_or_fault))
        return None
    return Choice(Parameter(request.key, tuple(numbers), *range_or_fault, request.name + suffix), request)


def _refusal(request: ParameterRequest, values: Sequence[Any], plains: Sequence[dict[str, Any]]) -> str | None:
    """Reason why this key cannot be fitted, with keys that can be; None if it can."""
    if request.key[0] in NOT_FITTED:
        return f"says how a run is computed, not what is measured; {unknown('', sorted(_keys(plains[0])))}"
    if any(isinstance(value, float) for value in values):
        return None
    whole = next((value for value in values if isinstance(value, int) and not isinstance(value, bool)), None)
    if whole is not None:
        return f"is a whole number, {whole}; only real numbers can be fitted"
    present = next((value for value in values if value is not _MISSING), _MISSING)
    hint = unknown(request.name, sorted(_keys(plains[0])))
    if present is _MISSING:
        null_key = _null_above(plains[0], request.key)
        return f"is below {null_key}, which is null" if null_key else f"the run has no such key; {hint}"
    kind = "null" if present is None else "a mapping" if isinstance(present, dict) else f"{present!r}"
    return f"is not a number but {kind}; {hint}"


_MISSING = object()


def _null_above(plain: dict[str, Any], key: Sequence[str]) -> str | None:
    """The first of the keys above this one whose value is null, for example `medium`; None if there is none."""
    above = (key[:count] for count in range(1, len(key)))
    return next((".".join(parent) for parent in above if value_at(plain, parent, _MISSING) is None), None)


def _keys(plain: Any, path: str = "") -> Iterator[str]:
    """Dotted keys of all numbers that a message proposes; keys of the mechanism are left out."""
    items = plain.items() if isinstance(plain, dict) else enumerate(plain) if isinstance(plain, list) else ()
    for key, value in items:
        if not path and (key in NOT_FITTED or key == "model"):
            continue
        name = f"{path}.{key}" if path else str(key)
        if isinstance(value, float):
            yield name
        else:
            yield from _keys(value, name)


Bounded = tuple[float, float, float, bool]


def _bounded(request: ParameterRequest, start: float, simulators: Sequence[Simulator]) -> Bounded | str:
    """Lower and upper bound, start, and whether the scale is logarithmic; or the fault of the request.

    If the value of the config is outside the given bounds, the search starts in their middle.
    """
    if start == 0.0 and (request.bounds.low is None or request.bounds.high is None):
        return "starts at 0, from which no default bounds follow: give it bounds, from and to in a fit file"
    given = request.bounds
    low = _default(request, start, -1, simulators) if given.low is None else given.low
    high = _default(request, start, +1, simulators) if given.high is None else given.high
    for name, value, written in (("from", low, given.low), ("to", high, given.high), ("start", start, start)):
        if written is not None and (fault := _value_fault(request, value, simulators)) is not None:
            return f"{name}: {fault}"
    if not low < high:
        return f"has no room between its bounds, {low:g} and {high:g}; give it from and to"
    log = request.bounds.scale == "log" or (request.bounds.scale is None and low > 0.0 and high / low >= LOG_FROM)
    if log and low <= 0.0:
        return f"has the lower bound {low:g}; on a log scale it must be above 0"
    if not low <= start <= high:
        start = (low * high) ** 0.5 if log else 0.5 * (low + high)
    return low, high, start, log


def _default(request: ParameterRequest, start: float, side: int, simulators: Sequence[Simulator]) -> float:
    """Default bound below (side -1) or above (+1) the start: the farthest of `FACTORS` that the schema allows."""
    for factor in FACTORS:
        ratio = factor if (start > 0.0) == (side > 0) else 1.0 / factor
        if _value_fault(request, start * ratio, simulators) is None:
            return start * ratio
    return start


def _value_fault(request: ParameterRequest, value: float, simulators: Sequence[Simulator]) -> str | None:
    """Fault of a value of this key by the schema; None if it is allowed."""
    at = request.position
    override = Override(request.key, Scalar(at, float(value), f"{value:g}"), at)
    try:
        for simulator in simulators:
            simulator.load((), [override])
    except ConfigError as error:
        return error.faults[0].message
    return None
