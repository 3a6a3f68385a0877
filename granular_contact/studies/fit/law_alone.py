"""Model of a force test: forces of the law on a body in prescribed motion, without a run.

The motion is taken as steady: the resistance is fully mobilised in its direction, and earlier motion has no effect. For
laws with memory (shear that builds up along a contact), and for unsteady motions, give a table with times instead: its
model is a run (`config.schema.fit`).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from granular_contact.config import scenario_to_dict
from granular_contact.config.overrides import Override
from granular_contact.config.schema.fit import ForceTest
from granular_contact.config.template import Loaded, Template
from granular_contact.errors import ConfigError, SceneError
from granular_contact.laws.catalogue import LAWS
from granular_contact.laws.layer import Layer
from granular_contact.laws.scatter import Scatter
from granular_contact.sand.steady import SteadyBody
from granular_contact.scene import build
from granular_contact.studies.fit import measurements
from granular_contact.studies.fit.force_tests import direction_deg
from granular_contact.studies.fit.measurements import Measured
from granular_contact.studies.fit.responses import Key, ModelFailed, Simulator
from granular_contact.studies.fit.specification import search_range
from granular_contact.values.arrays import Vector

DEPTH_OFFSET: Key = ("depth_offset_m",)
FORCE_OFFSET: Key = ("force_offset_N",)
DEPTH_REACH, FORCE_REACH = 0.2, 0.2  # search range of zeros, relative to the largest depth and force in the table
CREEP = 1e-6  # m/s, of a test without a stated speed: lambda rho v^2 of sand is 1e-9 Pa
MEDIUM = "medium"
BODIES, SMALL = 400, 0.1  # number of equal bodies, and scatter of their medium, in the estimate of `LawAlone.share`


@dataclass(frozen=True)
class Motion:
    """Prescribed motion, by row (n,): depth of the lowest point (m), speed (m/s), rate (rad/s, clockwise).

    direction: of the velocity, below the horizontal (deg).
    """

    depth: Vector
    speed: Vector
    rate: Vector
    direction: float

    def at(self, rows: Vector) -> Motion:
        """Motion at row numbers (m,), interpolated linearly between whole numbers."""
        index = np.arange(len(self.depth), dtype=float)
        depth, speed, rate = (np.interp(rows, index, values) for values in (self.depth, self.speed, self.rate))
        return Motion(depth, speed, rate, self.direction)

    @property
    def along(self) -> Vector:
        """Unit vector (2,) of the velocity, y up."""
        angle = np.radians(self.direction)
        return np.array([np.cos(angle), -np.sin(angle)])


def prescribed_motion(columns: Mapping[str, Vector], test: ForceTest) -> Motion:
    """Motion from the prescribed columns of a test."""
    depth = columns[measurements.DEPTH]
    speed = columns.get(measurements.SPEED, np.full(len(depth), CREEP))
    return Motion(depth, np.maximum(speed, CREEP), columns[measurements.RATE], direction_deg(test))


def steady_forces(
    body: SteadyBody, motion: Motion, layers: Sequence[Layer] | None = None, scatter: Scatter | None = None
) -> dict[str, Vector]:
    """Forces (n,) of a steady motion, by name of the measured column; signs as in `measurements.SIGNS`."""
    velocity = motion.speed[:, None] * motion.along
    force = body.force(motion.depth, velocity, -motion.rate, layers, scatter)
    turn_sign = np.where(motion.rate == 0.0, 1.0, -np.sign(motion.rate))
    return {
        measurements.FORCE: -force[:, :2] @ motion.along,
        measurements.VERTICAL: force[:, 1],
        measurements.HORIZONTAL: force[:, 0],
        measurements.TORQUE: -force[:, 2] * turn_sign,
    }


@dataclass(frozen=True)
class SteadyResponse:
    """Forces of a test for one set of coefficients as functions of the row number, in place of `responses.Response`."""

    body: SteadyBody
    motion: Motion
    layers: tuple[Layer, ...] | None
    names: tuple[str, ...]
    area: float
    depth_offset: float
    force_offset: float

    def at(self, rows: Vector) -> Vector:
        """Values (n, columns) at row numbers (n,)."""
        motion = self.motion.at(rows)
        corrected = replace(motion, depth=motion.depth - self.depth_offset)
        forces = steady_forces(self.body, corrected, self.layers)
        forces = {
            name: values + self.force_offset if name.endswith("_N") else values for name, values in forces.items()
        }
        forces[measurements.PRESSURE] = forces[measurements.FORCE] / self.area
        return np.column_stack([forces[name] for name in self.names])


class LawAlone(Simulator):
    """Simulator that evaluates the law on the body of a config, for values of keys, followed by values of fitted zeros.

    zeros: the fitted ones of depth_offset_m and force_offset_N.
    """

    def __init__(
        self,
        template: Template,
        keys: Sequence[Key],
        names: Sequence[str],
        test: ForceTest,
        motion: Motion,
        zeros: Sequence[Key] = (),
    ) -> None:
        super().__init__(template, keys, names)
        self.test, self.motion, self.zeros = test, motion, tuple(zeros)
        self._plain: Any = None
        self._body: SteadyBody | None = None
        self._layers: tuple[Layer, ...] = ()

    def __getstate__(self) -> dict[str, object]:
        """As `Simulator`, without the cached body."""
        return super().__getstate__() | {"_body": None, "_plain": None}

    def load(self, values: Sequence[float], more: Sequence[Override] = ()) -> Loaded:
        """Scenario for values of the keys; the values of zeros after them are ignored."""
        return super().load(list(values)[: len(self._keys)], more)

    def refined(self, values: Sequence[float], factor: float) -> None:  # the law takes no steps
        """None, because the law takes no time steps."""

    def response(self, values: tuple[float, ...]) -> Any:
        """Forces for values of the keys and zeros; raises ModelFailed."""
        zeros = dict(zip(self.zeros, values[len(self._keys) :], strict=True))
        body, layers = self._body_and_layers(values[: len(self._keys)])
        return SteadyResponse(
            body,
            self.motion,
            layers,
            self.columns,
            self.test.area_m2 or 1.0,
            zeros.get(DEPTH_OFFSET, fixed_zero(self.test.depth_offset_m)),
            zeros.get(FORCE_OFFSET, fixed_zero(self.test.force_offset_N)),
        )

    def ranges(self, values: tuple[float, ...]) -> tuple[list[float], list[float], list[float]]:
        """Speeds (m/s), depths (m) and sizes (m) of the test, for the range of the fitted medium."""
        response = self.response(values)
        depths = self.motion.depth - response.depth_offset
        rim = np.abs(self.motion.rate) * response.body.reach + self.motion.speed
        is_given = self.test.speed_m_s is not None or float(np.ptp(self.motion.speed)) > 0.0 or np.any(self.motion.rate)
        speeds = [float(rim.min()), float(rim.max())] if is_given else []
        return speeds, [0.0, max(float(depths.max()), 0.0)], list(response.body.sizes)

    def share(self, values: tuple[float, ...], length: float) -> float:
        """Ratio of the relative scatter of the body's force to that of a piece no longer than `length` (m).

        It is estimated at the largest force, from BODIES equal bodies at different places; its standard error is 4 %.
        """
        response = self.response(values)
        depth = self.motion.depth - response.depth_offset
        deepest = np.full(BODIES, int(np.argmax(depth * self.motion.speed)))
        rows = replace(
            self.motion, depth=depth[deepest], speed=self.motion.speed[deepest], rate=self.motion.rate[deepest]
        )
        forces = steady_forces(response.body, rows, response.layers, Scatter(SMALL, length))
        name = measurements.FORCE if self.columns[0] == measurements.PRESSURE else self.columns[0]
        return float(np.std(forces[name]) / abs(np.mean(forces[name])) / SMALL)

    def _body_and_layers(self, values: tuple[float, ...]) -> tuple[SteadyBody, tuple[Layer, ...] | None]:
        """Body and layers for values of the keys.

        If all keys belong to media, the body is built only once. If not, layers are None: those of the body's scene.
        """
        try:
            if any(key[0] != MEDIUM for key in self._keys):
                return SteadyBody(build(self.load(values).scenario), self.test.body), None
            if self._body is None:
                scenario = self.load(values).scenario
                scene = build(scenario)
                assert scene.bed is not None  # SteadyBody refuses scenes without a bed
                self._body, self._layers = SteadyBody(scene, self.test.body), scene.bed.layers
                self._plain = scenario_to_dict(scenario)[MEDIUM]
            return self._body, self._renewed(values)
        except (ConfigError, SceneError, ValueError) as error:
            raise ModelFailed(str(error)) from error

    def _renewed(self, values: tuple[float, ...]) -> tuple[Layer, ...]:
        """The layers, their media with the given coefficients."""
        plain = self._plain
        for key, value in zip(self._keys, values, strict=True):
            plain = _with(plain, key[1:], value)
        plain_media = plain if isinstance(plain, list) else [plain]
        media = [LAWS[medium["law"]].model_validate(medium) for medium in plain_media]
        renewed = [replace(layer, medium=medium) for layer, medium in zip(self._layers, media, strict=False)]
        return (*renewed, *self._layers[len(plain_media) :])  # the rest are deeper layers, of bed.layers


def _with(plain: Any, path: Key, value: float) -> Any:
    """Copy of plain data with a number at a path; parts off the path are not copied."""
    if not path:
        return value
    if isinstance(plain, list):
        return [_with(entry, path[1:], value) if str(i) == path[0] else entry for i, entry in enumerate(plain)]
    return {**plain, path[0]: _with(plain.get(path[0]), path[1:], value)}


def fixed_zero(zero: Any) -> float:
    """Value of a given zero of depth or force; 0 for a zero that is fitted."""
    return float(zero) if isinstance(zero, float) else 0.0


def fitted_zeros(test: ForceTest, measured: Measured) -> list[tuple[Key, float, float, float]]:
    """Zeros of depth (m) and force (N) that are fitted: key, lower bound, upper bound and start."""
    zeros = []
    force = max((float(np.max(np.abs(values))) * factor for values, factor in _forces(test, measured)), default=1.0)
    depth = float(np.max(np.abs(measured.prescribed[measurements.DEPTH])))
    for key, zero, reach in (
        (DEPTH_OFFSET, test.depth_offset_m, DEPTH_REACH * depth),
        (FORCE_OFFSET, test.force_offset_N, FORCE_REACH * force),
    ):
        if (bounds_and_start := search_range(zero, reach)) is not None:
            zeros.append((key, *bounds_and_start))
    return zeros


def _forces(test: ForceTest, measured: Measured) -> Iterator[tuple[Vector, float]]:
    """Columns that are forces or pressures, with the factor to N."""
    for name, values in zip(measured.columns, measured.values.T, strict=True):
        if name.endswith(("_N", "_Pa")):
            yield values, test.area_m2 or 1.0 if name == measurements.PRESSURE else 1.0
