"""A force test by the law alone: forces on a body in prescribed motion, by coefficients, without a run.

The motion is steady: the resistance is fully mobilised in its direction, and what was before does not matter. For laws
that remember (shear that builds up along a contact), and for motions that are not steady, a run of the scene is the
model: a table with times (`config.schema.fit`).
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
from granular_contact.studies.fit.force_tests import angle_of
from granular_contact.studies.fit.measurements import Measured
from granular_contact.studies.fit.responses import Key, ModelFailed, Simulator
from granular_contact.studies.fit.specification import looked_for
from granular_contact.values.arrays import Vector

DEPTH_OFFSET: Key = ("depth_offset_m",)
FORCE_OFFSET: Key = ("force_offset_N",)
DEPTH_REACH, FORCE_REACH = 0.2, 0.2  # of the largest in the table: how far zeros are looked for
CREEP = 1e-6  # m/s, of a test of no stated speed: lambda rho v^2 of sand is 1e-9 Pa
MEDIUM = "medium"
BODIES, SMALL = 400, 0.1  # equal bodies, and the scatter of their medium, from which that of a body follows


@dataclass(frozen=True)
class Motion:
    """What is prescribed, by rows (n,): depth of the lowest point (m), speed (m/s), rate (rad/s, clockwise).

    direction: of the speed, below the horizontal (deg).
    """

    depth: Vector
    speed: Vector
    rate: Vector
    direction: float

    def at(self, rows: Vector) -> Motion:
        """The same at numbers of rows (m,), between which it changes evenly."""
        index = np.arange(len(self.depth), dtype=float)
        depth, speed, rate = (np.interp(rows, index, one) for one in (self.depth, self.speed, self.rate))
        return Motion(depth, speed, rate, self.direction)

    @property
    def along(self) -> Vector:
        """Unit vector (2,) of the motion, y up."""
        angle = np.radians(self.direction)
        return np.array([np.cos(angle), -np.sin(angle)])


def motion_of(given: Mapping[str, Vector], test: ForceTest) -> Motion:
    """Motion of the columns that were prescribed."""
    depth = given[measurements.DEPTH]
    speed = given.get(measurements.SPEED, np.full(len(depth), CREEP))
    return Motion(depth, np.maximum(speed, CREEP), given[measurements.RATE], angle_of(test))


def measured(
    body: SteadyBody, motion: Motion, layers: Sequence[Layer] | None = None, scatter: Scatter | None = None
) -> dict[str, Vector]:
    """Forces (n,) of a steady motion, by the names of columns; see `measurements.SIGNS` for their signs."""
    velocity = motion.speed[:, None] * motion.along
    force = body.force(motion.depth, velocity, -motion.rate, layers, scatter)
    turning = np.where(motion.rate == 0.0, 1.0, -np.sign(motion.rate))
    return {
        measurements.FORCE: -force[:, :2] @ motion.along,
        measurements.VERTICAL: force[:, 1],
        measurements.HORIZONTAL: force[:, 0],
        measurements.TORQUE: -force[:, 2] * turning,
    }


@dataclass(frozen=True)
class SteadyResponse:
    """Forces of a test for one set of coefficients, by number of row; as `responses.Response` is of time."""

    body: SteadyBody
    motion: Motion
    layers: tuple[Layer, ...] | None
    names: tuple[str, ...]
    area: float
    depth_offset: float
    force_offset: float

    def at(self, rows: Vector) -> Vector:
        """Values (n, columns) at numbers of rows (n,)."""
        motion = self.motion.at(rows)
        moved = replace(motion, depth=motion.depth - self.depth_offset)
        found = measured(self.body, moved, self.layers)
        found = {name: one + self.force_offset if name.endswith("_N") else one for name, one in found.items()}
        found[measurements.PRESSURE] = found[measurements.FORCE] / self.area
        return np.column_stack([found[name] for name in self.names])


class LawAlone(Simulator):
    """The law alone on the body of a config, by the values of keys and, after them, of the zeros that are looked for.

    zeros: which of depth_offset_m and force_offset_N.
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
        """As of `Simulator`."""
        return super().__getstate__() | {"_body": None, "_plain": None}

    def load(self, values: Sequence[float], more: Sequence[Override] = ()) -> Loaded:
        """Scenario for values of the keys; those of zeros behind them are no part of it."""
        return super().load(list(values)[: len(self._keys)], more)

    def response(self, values: tuple[float, ...]) -> Any:
        """Forces for values of the keys and zeros; raises ModelFailed."""
        own, found = values[: len(self._keys)], values[len(self._keys) :]
        zeros = dict(zip(self.zeros, found, strict=True))
        body, layers = self._bodies(own)
        return SteadyResponse(
            body,
            self.motion,
            layers,
            self.columns,
            self.test.area_m2 or 1.0,
            zeros.get(DEPTH_OFFSET, known_zero(self.test.depth_offset_m)),
            zeros.get(FORCE_OFFSET, known_zero(self.test.force_offset_N)),
        )

    def seen(self, values: tuple[float, ...]) -> tuple[list[float], list[float], list[float]]:
        """Speeds (m/s), depths (m) and sizes (m) of the test: of the medium's range, see `medium.seen`."""
        response = self.response(values)
        depths = self.motion.depth - response.depth_offset
        rim = np.abs(self.motion.rate) * response.body.reach + self.motion.speed
        stated = self.test.speed_m_s is not None or float(np.ptp(self.motion.speed)) > 0.0 or np.any(self.motion.rate)
        speeds = [float(rim.min()), float(rim.max())] if stated else []
        return speeds, [0.0, max(float(depths.max()), 0.0)], list(response.body.sizes)

    def share(self, values: tuple[float, ...], length: float) -> float:
        """Scatter of the force over that of a piece no longer than `length` (m), where the force is largest.

        From as many equal bodies at places of their own: known to 4 %.
        """
        response = self.response(values)
        depth = self.motion.depth - response.depth_offset
        deepest = np.full(BODIES, int(np.argmax(depth * self.motion.speed)))
        rows = replace(
            self.motion, depth=depth[deepest], speed=self.motion.speed[deepest], rate=self.motion.rate[deepest]
        )
        found = measured(response.body, rows, response.layers, Scatter(SMALL, length))
        name = measurements.FORCE if self.columns[0] == measurements.PRESSURE else self.columns[0]
        return float(np.std(found[name]) / abs(np.mean(found[name])) / SMALL)

    def _bodies(self, values: tuple[float, ...]) -> tuple[SteadyBody, tuple[Layer, ...] | None]:
        """Body, and the media that act on it; the body is placed once if media are all that changes."""
        try:
            if any(key[0] != MEDIUM for key in self._keys):
                return SteadyBody(build(self.load(values).scenario), self.test.body), None
            if self._body is None:
                scenario = self.load(values).scenario
                scene = build(scenario)
                assert scene.bed is not None  # or a steady body would refuse it
                self._body, self._layers = SteadyBody(scene, self.test.body), scene.bed.layers
                self._plain = scenario_to_dict(scenario)[MEDIUM]
            return self._body, self._renewed(values)
        except (ConfigError, SceneError, ValueError) as error:
            raise ModelFailed(str(error)) from error

    def _renewed(self, values: tuple[float, ...]) -> tuple[Layer, ...]:
        """The layers with other coefficients of their media."""
        plain = self._plain
        for key, value in zip(self._keys, values, strict=True):
            plain = _with(plain, key[1:], value)
        many = plain if isinstance(plain, list) else [plain]
        media = [LAWS[one["law"]].model_validate(one) for one in many]
        renewed = [replace(layer, medium=one) for layer, one in zip(self._layers, media, strict=False)]
        return (*renewed, *self._layers[len(many) :])  # below them lie those of bed.layers


def _with(plain: Any, path: Key, value: float) -> Any:
    """Plain data with a number in its place; what is not on the way to it is shared."""
    if not path:
        return value
    if isinstance(plain, list):
        return [_with(one, path[1:], value) if str(i) == path[0] else one for i, one in enumerate(plain)]
    return {**plain, path[0]: _with(plain.get(path[0]), path[1:], value)}


def known_zero(zero: Any) -> float:
    """A zero of depth or force that is known; one that is looked for starts at 0."""
    return float(zero) if isinstance(zero, float) else 0.0


def zeros_of(test: ForceTest, held: Measured) -> list[tuple[Key, float, float, float]]:
    """Zeros of depth (m) and force (N) that are looked for: key, least, greatest and start."""
    found = []
    force = max((float(np.max(np.abs(one))) * size for one, size in _forces(test, held)), default=1.0)
    depth = float(np.max(np.abs(held.given[measurements.DEPTH])))
    for key, zero, reach in (
        (DEPTH_OFFSET, test.depth_offset_m, DEPTH_REACH * depth),
        (FORCE_OFFSET, test.force_offset_N, FORCE_REACH * force),
    ):
        if (span := looked_for(zero, reach)) is not None:
            found.append((key, *span))
    return found


def _forces(test: ForceTest, held: Measured) -> Iterator[tuple[Vector, float]]:
    """Columns that are forces, and what one of their units is in N."""
    for name, values in zip(held.columns, held.values.T, strict=True):
        if name.endswith(("_N", "_Pa")):
            yield values, test.area_m2 or 1.0 if name == measurements.PRESSURE else 1.0
