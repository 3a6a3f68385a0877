"""A scene as a Gymnasium environment: what is seen and rewarded, what is drawn anew at each reset, and pictures."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from granular_contact.config import Given, loaded
from granular_contact.controllers import checked_rate, finite
from granular_contact.errors import ControlError
from granular_contact.report.figures.animation import still
from granular_contact.results import FINISHED, Results, Snapshot
from granular_contact.results.observation import surface
from granular_contact.results.observed import Observations
from granular_contact.simulation import Simulation
from granular_contact.simulation_state import State

Array = NDArray[np.float32]
Observe = Sequence[str] | Callable[[Observations], Any]
Reward = Callable[[Observations, Observations], float]
Draw = tuple[float, float] | Callable[[np.random.Generator], Any]


@dataclass(frozen=True)
class EnvState:
    """State of an environment: of its simulation, and of the generator that resets draw from."""

    simulation: State
    random: dict[str, Any]


class GranularEnv(gymnasium.Env[Array, Array]):
    """A scene whose `external` drives an agent sets; the observations are what the user says.

    Actions are from -1 to 1, from the least to the greatest value of the `range` of each drive. An episode is truncated
    at `solver.end_time_s`, or where the solve fails (`info["status"]` tells why).

    Parameters
    ----------
    config : Scenario, Loaded, str, path or mapping
        What to simulate.
    observation : sequence of str, or callable
        Names of observations (see `granular_contact.results.observed`), or a function of them that gives numbers.
    reward : str or callable
        The name of an observation, whose increase is the reward, as `trunk_x_m`; or `reward(before, after)`: of a
        step, from what is seen before and after it.
    terminated : callable, optional
        `terminated(seen)`: whether the episode ends there for good, as where a walker has fallen.
    control_rate_Hz : float
        Steps in a second; the solver's own are chosen as in any run.
    vary : mapping, optional
        Drawn anew at each reset: by dotted key of the config a range, from which numbers are drawn evenly, or a
        function of the random generator. `reset(options={...})` sets values by their keys.
    render_mode : "rgb_array", optional
        What `render` gives: a picture (height, width, 3).

    Raises
    ------
    ControlError
        There is nothing to set, or a drive has no range; the rate is no number above 0; what to vary is no range.
    KeyError
        An observation is not there.
    ConfigError, SceneError, SolveError
        As of `load` and `Simulation`.
    """

    metadata = {"render_modes": ["rgb_array"], "render_fps": 25}  # noqa: RUF012  # as the base class has it

    def __init__(
        self,
        config: Given,
        *,
        observation: Observe,
        reward: str | Reward,
        terminated: Callable[[Observations], bool] | None = None,
        control_rate_Hz: float = 50.0,
        vary: Mapping[str, Draw] | None = None,
        render_mode: Literal["rgb_array"] | None = None,
    ) -> None:
        if render_mode not in (None, "rgb_array"):
            raise ControlError(f"render_mode: got {render_mode!r}, allowed are rgb_array and None")
        pause = 1.0 / checked_rate(control_rate_Hz)
        for key, how in (vary or {}).items():
            if not callable(how) and (np.shape(how) != (2,) or None in map(finite, how) or how[0] > how[1]):
                raise ControlError(f"vary: {key}: got {how!r}, allowed is (least, greatest) or a function")
        scenario = loaded(config)
        self.simulation = Simulation(scenario)
        self.render_mode, self.metadata = render_mode, self.metadata | {"render_fps": control_rate_Hz}
        self._observation, self._terminated = observation, terminated
        self._pause, self._vary = pause, dict(vary or {})
        bounds = self.simulation.bounds
        if not len(bounds) or not np.isfinite(bounds).all():
            names = [name for name, pair in zip(self.simulation.controls, bounds, strict=True) if np.isinf(pair).any()]
            without = f"without a range: {', '.join(names)}" if names else "none is in this scene"
            raise ControlError(f"drives that an agent sets need {{type: external, range: [..., ...]}}; {without}")
        self._middle, self._half = bounds.mean(axis=1), 0.5 * np.ptp(bounds, axis=1)
        self._seen = self.simulation.observe()
        self._reward = _increase(self._seen, reward) if isinstance(reward, str) else reward
        self.action_space = spaces.Box(-1.0, 1.0, (len(bounds),), np.float32)
        self.observation_space = spaces.Box(-np.inf, np.inf, self._observed().shape, np.float32)

    def _observed(self) -> Array:
        """What the agent sees now."""
        what = self._observation
        found = what(self._seen) if callable(what) else self._seen.array(what)
        return np.asarray(found, np.float32)

    def _info(self) -> dict[str, Any]:
        ended = self.simulation.ended
        return {"time_s": self._seen.time, "status": "" if ended is None else ended.message}

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Array, dict[str, Any]]:
        """Begin an episode.

        Parameters
        ----------
        seed : int, optional
            Of the random numbers.
        options : dict, optional
            Values by dotted key of the config, for this episode.

        Returns
        -------
        tuple
            What is seen, and a dict with the time and the status.
        """
        super().reset(seed=seed)
        drawn = {key: self._drawn(how) for key, how in self._vary.items()}
        self._seen = self.simulation.reset(**(drawn | (options or {})))
        return self._observed(), self._info()

    def _drawn(self, how: Draw) -> Any:
        return how(self.np_random) if callable(how) else self.np_random.uniform(*how)

    def step(self, action: Array) -> tuple[Array, float, bool, bool, dict[str, Any]]:
        """Set the drives and go on for one period of control.

        Parameters
        ----------
        action : (drives,) array
            From -1 to 1, the range of each drive. As in Gymnasium's own environments what lies beyond is set to the end
            of the range; `simulation.results()` warns of it.

        Returns
        -------
        tuple
            What is seen, the reward, whether the episode is terminated, whether it is truncated, and a dict.

        Raises
        ------
        ControlError
            The action has another shape or is not finite, or as of `Simulation.step`.
        """
        before = self._seen
        try:
            given = np.asarray(action, float)
        except (TypeError, ValueError):
            raise ControlError(f"action: got {action!r:.80}, allowed is an array of numbers") from None
        if given.shape != self._middle.shape:
            raise ControlError(f"action: got the shape {given.shape}, allowed is {self._middle.shape}")
        self._seen = self.simulation.step(self._middle + self._half * given, self._pause)
        fell = self._terminated is not None and bool(self._terminated(self._seen))
        info, reward = self._info(), float(self._reward(before, self._seen))
        return self._observed(), reward, fell, self.simulation.ended is not None and not fell, info

    @property
    def failed(self) -> bool:
        """Whether the solve of this episode failed."""
        ended = self.simulation.ended
        return ended is not None and ended.code not in FINISHED

    def render(self) -> Any:
        """A picture of the present state.

        Returns
        -------
        array
            (height, width, 3), 0 to 255; None without a render mode.
        """
        if self.render_mode is None:
            return None
        return picture(self.simulation)

    def close(self) -> None:
        """Let go of the engine's memory."""
        self.simulation.close()

    # ---- back to an earlier state ----

    def state(self) -> EnvState:
        """The present state, of the friction too.

        Returns
        -------
        EnvState
            It can be pickled.
        """
        return EnvState(self.simulation.state(), dict(self.np_random.bit_generator.state))

    def restore(self, state: EnvState) -> Array:
        """Go back to a state of this environment, or of another one of the same scene.

        Parameters
        ----------
        state : EnvState
            What `state` gave.

        Returns
        -------
        array
            What is seen there.

        Raises
        ------
        ControlError
            It is a state of another scene.
        """
        self._seen = self.simulation.restore(state.simulation)
        self.np_random.bit_generator.state = state.random
        return self._observed()


def _increase(seen: Observations, name: str) -> Reward:
    """The reward by how much an observation grows in a step; KeyError where there is none of that name."""
    seen[name]
    return lambda before, after: after[name] - before[name]


WIDE = 2.5  # times the length of the mechanism is what a picture shows


def picture(simulation: Simulation) -> NDArray[np.uint8]:
    """A picture (height, width, 3) of the present state; the view goes along with the mechanism."""
    scene, outlines = simulation.scene, simulation.outlines()
    now = Results(
        name=scene.name,
        status=simulation.ended or simulation.standing,
        columns=(),
        table=np.zeros((0, 0)),
        summary={},
        scenario={},
        snapshots=(),
        surface=surface(scene),
        frames=(Snapshot("frame", simulation.time, outlines),),
    )
    return still(now, WIDE * scene.length)
