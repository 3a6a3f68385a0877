"""Requests -> parameters with start, bounds and scale, or why a key can't be a parameter."""

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

# How a run is computed is no property of the sand or the mechanism.
NOT_FITTED = ("solver", "method", "output", "name")
# Bounds where none are given: the widest of these factors on the start that the schema allows on that side.
FACTORS = (10.0, 3.0, 1.5, 1.1)
LOG_FROM = 10.0  # ratio of bounds from which on the scale is logarithmic


@dataclass(frozen=True)
class Choice:
    """A parameter, and where it was asked for."""

    parameter: Parameter
    request: ParameterRequest


def choose(request: Sequence[ParameterRequest], simulators: Sequence[Simulator], faults: list[Fault]) -> list[Choice]:
    """Parameters that all runs share; a run whose config lacks the key is left out, unless all lack it."""
    return [choice for one in request if (choice := _choice(one, dict(enumerate(simulators)), "", faults)) is not None]


def own_choices(request: RunRequest, index: int, simulator: Simulator, faults: list[Fault]) -> list[Choice]:
    """Parameters of one run alone."""
    found = [_choice(one, {index: simulator}, f" @ {request.name}", faults) for one in request.parameters]
    return [choice for choice in found if choice is not None]


def _choice(
    request: ParameterRequest, simulators: dict[int, Simulator], suffix: str, faults: list[Fault]
) -> Choice | None:
    plains = {i: scenario_to_dict(one.load(()).scenario) for i, one in simulators.items()}
    values = {i: value_at(plain, request.key, _MISSING) for i, plain in plains.items()}
    numbers = {i: float(v) for i, v in values.items() if isinstance(v, float)}
    found: Bounded | str | None = _refused(request, list(values.values()), list(plains.values()))
    if found is None and request.bounds.start is None and len(set(numbers.values())) > 1:
        shown = ", ".join(f"{value:g}" for value in sorted(set(numbers.values())))
        found = f"the runs have different values, {shown}: give it a start in a fit file"
    if found is None:
        start = next(iter(numbers.values())) if request.bounds.start is None else request.bounds.start
        found = _bounded(request, start, [simulators[i] for i in numbers])
    if isinstance(found, str):
        faults.append(request.position.fault((request.name,), found))
        return None
    return Choice(Parameter(request.key, tuple(numbers), *found, request.name + suffix), request)


def _refused(request: ParameterRequest, values: Sequence[Any], plains: Sequence[dict[str, Any]]) -> str | None:
    """Why no run can be fitted by this key, in words that name what can be."""
    if request.key[0] in NOT_FITTED:
        return f"says how a run is computed, not what is measured; {unknown('', sorted(_keys(plains[0])))}"
    if any(isinstance(value, float) for value in values):
        return None
    whole = next((value for value in values if isinstance(value, int) and not isinstance(value, bool)), None)
    if whole is not None:
        return f"is a whole number, {whole}; what can be fitted is not"
    present = next((value for value in values if value is not _MISSING), _MISSING)
    hint = unknown(request.name, sorted(_keys(plains[0])))
    if present is _MISSING:
        nothing = _null_above(plains[0], request.key)
        return f"is below {nothing}, which is null" if nothing else f"the run has no such key; {hint}"
    kind = "nothing there" if present is None else "a mapping" if isinstance(present, dict) else f"{present!r}"
    return f"is not a number but {kind}; {hint}"


_MISSING = object()


def _null_above(plain: dict[str, Any], key: Sequence[str]) -> str | None:
    """The key above this one, if the run has nothing there, as a medium of null."""
    above = (key[:count] for count in range(1, len(key)))
    return next((".".join(one) for one in above if value_at(plain, one, _MISSING) is None), None)


def _keys(plain: Any, path: str = "") -> Iterator[str]:
    """Dotted keys of all numbers that can be fitted; geometry of the mechanism is left out."""
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
    """Lower and upper bound, start and whether the scale is logarithmic; or what is wrong with them.

    Where the config's own value lies outside given bounds, the start is in the middle of them.
    """
    if start == 0.0 and (request.bounds.low is None or request.bounds.high is None):
        return "starts at 0, from which no bounds follow: give it bounds, from and to in a fit file"
    given = request.bounds
    low = _default(request, start, -1, simulators) if given.low is None else given.low
    high = _default(request, start, +1, simulators) if given.high is None else given.high
    for name, value, is_said in (("from", low, given.low), ("to", high, given.high), ("start", start, start)):
        if is_said is not None and (problem := _allowed(request, value, simulators)) is not None:
            return f"{name}: {problem}"
    if not low < high:
        return f"has no room between its bounds, {low:g} and {high:g}; give it from and to"
    log = request.bounds.scale == "log" or (request.bounds.scale is None and low > 0.0 and high / low >= LOG_FROM)
    if log and low <= 0.0:
        return f"has the lower bound {low:g}; on a log scale it must be above 0"
    if not low <= start <= high:
        start = (low * high) ** 0.5 if log else 0.5 * (low + high)
    return low, high, start, log


def _default(request: ParameterRequest, start: float, side: int, simulators: Sequence[Simulator]) -> float:
    """A bound on one side of the start, as far as the schema allows."""
    for factor in FACTORS:
        away = factor if (start > 0.0) == (side > 0) else 1.0 / factor
        if _allowed(request, start * away, simulators) is None:
            return start * away
    return start


def _allowed(request: ParameterRequest, value: float, simulators: Sequence[Simulator]) -> str | None:
    """The fault of a value of this key by the schema, or None."""
    at = request.position
    override = Override(request.key, Scalar(at, float(value), f"{value:g}"), at)
    try:
        for simulator in simulators:
            simulator.load((), [override])
    except ConfigError as error:
        return error.faults[0].message
    return None
