"""One run of the model for given parameters, as smooth curves of what was measured."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

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

_KEPT = 64  # runs of one config that are remembered
HERE = Position("fit", None)
# Every accepted step is needed; pictures are not.
_ALL_ROWS = (Override(("output", "interval_s"), Scalar(HERE, None, "null"), HERE),)


class ModelFailed(Exception):
    """The model gives no curve for these parameters; the text says why."""


@dataclass(frozen=True)
class Response:
    """Curves of a run over its time (s), from 0 to `end`; at rest they stay where they are.

    before: the same motion backwards in free flight, over the time before the start; None if nothing is asked there.
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
    """The runs of one config, by the values of some of its keys; the latest are remembered.

    template: of `config.changed.filled`. columns: which of the time series are kept. early: time (s) before the start
    for which curves are needed.
    """

    def __init__(self, template: Template, keys: Sequence[Key] = (), columns: Sequence[str] = ()) -> None:
        self._template, self._keys = template, tuple(keys)
        self.columns, self.early = tuple(columns), 0.0
        self._responses: dict[tuple[float, ...], Response] = {}
        self._build = Builder()

    def __getstate__(self) -> dict[str, object]:
        """What is sent to a worker: all but the cached runs, which it computes faster than it receives them."""
        return self.__dict__ | {"_responses": {}}

    def load(self, values: Sequence[float], more: Sequence[Override] = ()) -> Loaded:
        """Scenario for values of the keys; raises ConfigError for a value that is not allowed."""
        varied = [
            Override(key, Scalar(HERE, float(value), repr(float(value))), HERE)
            for key, value in zip(self._keys, values, strict=True)
        ]
        return self._template.make(effective([*varied, *_ALL_ROWS, *more]))

    def results(self, values: Sequence[float], more: Sequence[Override] = ()) -> Results:
        """A whole run.

        Raises
        ------
        ModelFailed
            There is none for these values.
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
        """What came before the start: free flight is the same backwards, a run in vacuum at the turned rate."""
        scenario = self.load(values).scenario
        turned = {
            ("medium",): None,
            ("initial", "impact_speed_rad_s"): -scenario.initial.impact_speed_rad_s,
            ("solver", "end_time_s"): max(self.early, 2.0 * steps(scenario).step_s),
            ("solver", "rest_time_s"): None,
        }
        if "depth_m" in self.columns:
            turned["surface_height_m",] = self._build(scenario).surface
        if "bed" in scenario_to_dict(scenario):
            turned["bed",] = None
        return self.results(values, [Override(key, Scalar(HERE, v, repr(v)), HERE) for key, v in turned.items()])
