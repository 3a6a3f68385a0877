"""State of a solve under way, and the two ways to carry it on: the project's own stepper, or one of scipy's."""

from __future__ import annotations

import copy
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from granular_contact.kernels import events
from granular_contact.kernels import march as kernels
from granular_contact.kernels.modal_load import rest
from granular_contact.kernels.modal_motion import decide, follow, rates
from granular_contact.reduced.model import Model
from granular_contact.reduced.world import world
from granular_contact.scene.types import Vector

SHARE = 4096  # steps between two looks at the progress bar and at the clock
SLOW_SHARE = 128  # of scipy's, each a hundred times slower
# A bristle yields at the end of a step, so its steps must be short; the true sign has no such memory.
LONGEST = 50.0
MOST_STILL = 1e-5  # of the speed of the scene


class March:
    """State of a solve, as `kernels.march` keeps it up to date; the arrays are explained there."""

    def __init__(self, model: Model) -> None:
        solver, method = model.scene.solver, model.method
        self.model = model
        self.size = method.modes + 1
        self.world = world(model)
        self.true_sign = bool(self.world.pendulum["true_sign"][0])
        self.y = model.start.copy()
        self.regime = np.ones(min(2, self.size))
        self.stopped = np.zeros(len(self.regime), dtype=bool)
        lengths = np.array([1.0] + [model.reach] * method.modes)
        self.allowed = method.rtol * np.concatenate([lengths, lengths * model.speed / model.reach])
        self.control = np.zeros(1, kernels.CONTROL)
        self.control["end"], self.control["interval"] = solver.end_time_s, solver.step_s
        bristles = len(self.world.lines) > 0 and not self.true_sign
        self.control["longest"] = solver.step_s if bristles else LONGEST * solver.step_s
        self.control["reach"], self.control["rest_speed"] = model.reach, solver.rest_speed_m_s
        self.control["rest_time"] = np.inf if solver.rest_time_s is None else solver.rest_time_s
        self.clock = np.array([0.0, 0.1 * solver.step_s, 0.0])
        self.counts = np.zeros(4, dtype=np.int64)
        self.watch = np.array([0.0, 0.0, np.nan, np.nan, 0.0, np.nan])
        self.rows = np.zeros((1024, 1 + len(self.y) + 9))
        self._rest_bristles()
        self.decide()
        self.warm()

    def _rest_bristles(self) -> None:
        w, q = self.world, self.y[: self.size]
        for first, end in zip(w.starts[:-1], w.starts[1:], strict=True):
            rest(q, w.geometry[first:end], w.anchors[first:end])

    @property
    def time(self) -> float:
        """Time reached (s)."""
        return float(self.clock[kernels.NOW])

    def speed(self) -> float:
        """Greatest speed (m/s) in any one coordinate."""
        lever = np.array([self.model.reach] + [1.0] * (self.size - 1))
        return float(np.max(np.abs(lever * self.y[self.size : 2 * self.size])))

    def blur(self) -> bool:
        """Let ten times the speed count as none, to get out of chattering; False if it would be too much."""
        still = self.world.pendulum["still"]
        still *= 10.0
        return bool(still[0] <= MOST_STILL * self.model.speed)

    def decide(self) -> None:
        """Choose the regime to go on with."""
        if self.true_sign:
            decide(self.y, self.regime, self.stopped, self.world)

    def go_on(self) -> int:
        """March until something is to be decided, and make room for more rows; why is one of the kernels' codes."""
        code = self._march()
        if self.counts[kernels.ROWS] >= len(self.rows):
            self.rows = np.concatenate([self.rows, np.zeros_like(self.rows)])
        return code

    def warm(self) -> None:
        """Compile what the march needs, or load it, which is no part of a solve; nothing is changed."""
        self._march(0)
        kernels.write_row(self.time, self.y, self.regime, self.world, np.zeros_like(self.rows[0]))

    def _march(self, share: int = SHARE) -> int:
        return int(
            kernels.march(
                share, self.y, self.regime, self.world, self.control, self.allowed, self.clock, self.rows, self.counts,
                self.watch, self.stopped,
            )
        )  # fmt: skip

    def table(self) -> Vector:
        """Rows so far, and one for the instant reached if it is not the last of them."""
        count = int(self.counts[kernels.ROWS])
        rows = self.rows[:count]
        if count and rows[-1, 0] >= self.time:
            return rows.copy()
        return np.vstack([rows, self.now()])

    def now(self) -> Vector:
        """Row of the instant reached, which the table need not have room for."""
        row: Vector = np.zeros_like(self.rows[0])
        kernels.write_row(self.time, self.y, self.regime, self.world, row)
        return row

    def kept(self) -> dict[str, NDArray[Any]]:
        """Copies of all that its future and its rows depend on."""
        held = {name: array.copy() for name, array in self._changing().items()}
        return held | {"rows": self.rows[: int(self.counts[kernels.ROWS])].copy()}

    def restore(self, kept: dict[str, NDArray[Any]]) -> None:
        """Go back to what was kept."""
        for name, array in self._changing().items():
            array[...] = kept[name]
        used = len(kept["rows"])
        if used >= len(self.rows):
            self.rows = np.zeros((2 * used, self.rows.shape[1]))
        self.rows[:used] = kept["rows"]

    def _changing(self) -> dict[str, NDArray[Any]]:
        own = {name: getattr(self, name) for name in ("y", "regime", "stopped", "clock", "counts", "watch")}
        return own | {"anchors": self.world.anchors, "still": self.world.pendulum["still"]}


# scipy's interpolants are read at these places of a step, and taken on as polynomials.
NODES = 0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, 9))
FIT = np.linalg.inv(np.vander(NODES, increasing=True))
ANY = 1e6  # J: the two works are found from the motion, and do not limit the step
RTOL = 1e-13  # the error allowed is absolute, see `March.allowed`; scipy wants some of the other kind


class _Standing:
    """A stepper of scipy's after a step in which nothing moved."""

    t_old, t = 0.0, 1e-12

    def __init__(self, y: Vector) -> None:
        self.y = y.copy()

    def dense_output(self) -> Callable[[Vector], Vector]:
        """States (size, times) at times (s)."""
        return lambda times: np.repeat(self.y[:, None], len(times), axis=1)


class ScipyMarch(March):
    """The same march with a stepper of `scipy.integrate`, for comparison: many times slower, but implicit ones too."""

    def warm(self) -> None:
        """Compile or load what a step calls, by a step that goes nowhere, of a copy."""
        from scipy import integrate  # noqa: F401  # a fifth of a second

        super().warm()
        still = copy.deepcopy(self)
        follow(still.y, still.regime, still.world)
        sigma, slopes = np.zeros_like(still.regime), np.empty_like(still.y)
        rates(still.y, still.regime, still.world, sigma, np.zeros((3, 3)), slopes)
        still._take(_Standing(still.y))
        events.shorten(np.ascontiguousarray(FIT @ np.tile(still.y, (len(NODES), 1))), 1.0)
        kernels.rests(still.y, still.regime, still.world, still.control[0], still.clock)

    def _march(self, share: int = SLOW_SHARE) -> int:
        if share == 0:
            return super()._march(0)
        try:
            return self._steps()
        except FloatingPointError:
            return kernels.FAILED

    def _steps(self) -> int:
        """`_march`; raises FloatingPointError where the motion has no finite rate."""
        from scipy import integrate

        control, clock = self.control[0], self.clock
        slopes, sigma, totals = np.empty_like(self.y), np.zeros_like(self.regime), np.zeros((3, 3))

        def slope(_: float, y: Vector) -> Vector:
            self.counts[kernels.RATES] += 1
            rates(np.ascontiguousarray(y), self.regime, self.world, sigma, totals, slopes)
            if not np.isfinite(slopes).all():
                raise FloatingPointError  # scipy would shorten its step for ever
            return slopes.copy()

        stepper = getattr(integrate, self.model.method.integrator)(
            slope,
            self.time,
            self.y,
            float(control["end"]),
            first_step=float(min(clock[kernels.STEP], control["end"] - self.time)),
            max_step=float(control["longest"]),
            rtol=RTOL,
            atol=np.concatenate([self.allowed, [ANY, ANY]]),
        )
        for _ in range(SLOW_SHARE):
            if self.counts[kernels.ROWS] >= len(self.rows):
                return kernels.PAUSE
            if self.true_sign:
                follow(self.y, self.regime, self.world)
            if stepper.step() is not None:
                return kernels.FAILED
            if self._take(stepper):
                return kernels.REGIME_END
            if kernels.rests(self.y, self.regime, self.world, control, clock):
                return kernels.REST
            if stepper.status == "finished":
                return kernels.END
        return kernels.PAUSE

    def _take(self, stepper: Any) -> bool:
        """Accept a step up to its end or that of a regime; whether it was the latter."""
        start, h = stepper.t_old, stepper.t - stepper.t_old
        path = np.ascontiguousarray(FIT @ stepper.dense_output()(start + NODES * h).T)
        theta = events.regime_end(path, self.regime, self.world, self.stopped) if self.true_sign else 2.0
        if theta <= 1.0:
            events.shorten(path, theta)
            h *= theta
        kernels.finish(start, h, path, self.regime, self.world, self.control[0], self.rows, self.counts, self.watch)
        self.y[:] = path.sum(axis=0) if theta <= 1.0 else stepper.y
        self.clock[kernels.NOW] = start + h
        self.clock[kernels.STEP] = h
        self.counts[kernels.STEPS] += 1
        return theta <= 1.0
