"""Model of a measured run: the run of a config for given parameters, as smooth curves of the measured columns."""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.interpolate import CubicSpline

from granular_contact.config import scenario_to_dict
from granular_contact.config.overrides import Override, effective
from granular_contact.config.template import Loaded, Template
from granular_contact.config.tree import Position, Scalar
from granular_contact.errors import ConfigError, SceneError, SolveError
from granular_contact.results import FINISHED, Results
from granular_contact.run import run
from granular_contact.scene.steps import steps
from granular_contact.scene.variants import Builder
from granular_contact.values.arrays import Vector

Key = tuple[str, ...]

_KEPT = 64  # greatest number of cached runs of one config
HERE = Position("fit", None)
# Curves need every accepted step.
_ALL_ROWS = (Override(("output", "interval_s"), Scalar(HERE, None, "null"), HERE),)


class ModelFailed(Exception):
    """The model cannot be computed for these parameters; the text gives the reason."""


@dataclass(frozen=True)
class Response:
    """Curves of a run over its time (s), from 0 to `end`, and constant after it.

    rests: whether the run ended at rest. before: curves over the time before the start, counted backwards, in free
    flight; None if no data lie there.
    """

    curves: CubicSpline
    end: float
    rests: bool
    before: CubicSpline | None = None

    def at(self, time: Vector) -> Vector:
        """Values (n, columns) at times (n,) s."""
        values: Vector = self.curves(np.clip(time, 0.0, self.end))
        early = time < 0.0
        if self.before is not None and np.any(early):
            values[early] = self.before(-time[early])
        return values


class Simulator:
    """Runs of one config for given values of some of its keys; the latest runs are cached.

    template: of `config.changed.filled`. columns: of the time series that become curves. early: time (s) before the
    start for which curves are needed.
    """

    def __init__(self, template: Template, keys: Sequence[Key] = (), columns: Sequence[str] = ()) -> None:
        self._template, self._keys = template, tuple(keys)
        self.columns, self.early = tuple(columns), 0.0
        self._responses: dict[tuple[float, ...], Response] = {}
        self._build = Builder()
        self._settings: tuple[Override, ...] = ()

    def __getstate__(self) -> dict[str, object]:
        """State for a worker, without the cached runs, which a worker computes faster than it receives them."""
        return self.__dict__ | {"_responses": {}}

    def load(self, values: Sequence[float], more: Sequence[Override] = ()) -> Loaded:
        """Scenario for values of the keys; raises ConfigError if a value is not allowed."""
        varied = [_override(key, float(value)) for key, value in zip(self._keys, values, strict=True)]
        return self._template.make(effective([*varied, *_ALL_ROWS, *self._settings, *more]))

    def refined(self, values: Sequence[float], factor: float) -> Simulator | None:
        """Simulator of the same runs with the accuracy or the fixed step times `factor`; None of a reduced model."""
        scenario = self.load(values).scenario
        if scenario.is_modal:
            return None
        solver = steps(scenario)
        key, size = ("step_s", solver.step_s) if solver.accuracy is None else ("accuracy", solver.accuracy)
        finer = copy(self)
        finer._responses, finer._build = {}, Builder()
        finer._settings = (_override(("solver", key), factor * size),)
        return finer

    def results(self, values: Sequence[float], more: Sequence[Override] = ()) -> Results:
        """Results of the run for values of the keys.

        Raises
        ------
        ModelFailed
            The run fails for these values.
        """
        try:
            scenario = self.load(values, more).scenario
            results = run(self._build(scenario))
        except (ConfigError, SceneError, SolveError) as error:
            raise ModelFailed(str(error)) from error
        if results.status.code not in FINISHED:
            if results.status.code == "interrupted":
                raise KeyboardInterrupt
            raise ModelFailed(results.status.message)
        return results

    def response(self, values: tuple[float, ...]) -> Response:
        """Curves of the run for values of the keys; raises ModelFailed."""
        if values not in self._responses:
            if len(self._responses) >= _KEPT:
                self._responses.pop(next(iter(self._responses)))
            results = self.results(values)
            before = self._curves(self._approach(values)) if self.early > 0.0 else None
            end, rests = float(results["time_s"][-1]), results.status.code == "rest"
            self._responses[values] = Response(self._curves(results), end, rests, before)
        return self._responses[values]

    def _curves(self, results: Results) -> CubicSpline:
        return CubicSpline(results["time_s"], np.column_stack([results[name] for name in self.columns]))

    def _approach(self, values: tuple[float, ...]) -> Results:
        """Motion before the start: a run in vacuum with reversed rate, because free flight is reversible in time."""
        scenario = self.load(values).scenario
        changes = {
            ("medium",): None,
            ("initial", "impact_speed_rad_s"): -scenario.initial.impact_speed_rad_s,
            ("solver", "end_time_s"): max(self.early, 2.0 * steps(scenario).step_s),
            ("solver", "rest_time_s"): None,
        }
        if "depth_m" in self.columns:
            changes["surface_height_m",] = self._build(scenario).surface
        if "bed" in scenario_to_dict(scenario):
            changes["bed",] = None
        return self.results(values, [_override(key, value) for key, value in changes.items()])


def _override(key: Key, value: Any) -> Override:
    """Override of a key by a value that no file gives."""
    return Override(key, Scalar(HERE, value, repr(value)), HERE)
