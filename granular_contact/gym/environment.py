"""A scene as a Gymnasium environment: observations, rewards, random values at each reset, and pictures."""

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
Distribution = tuple[float, float] | Callable[[np.random.Generator], Any]  # uniform in a range, or a function


@dataclass(frozen=True)
class EnvState:
    """State of an environment: of its simulation, and of the random generator that resets use."""

    simulation: State
    random: dict[str, Any]


class GranularEnv(gymnasium.Env[Array, Array]):
    """A scene whose `external` drives an agent sets, with observations and rewards that the user chooses.

    Actions are from -1 to 1, for the least and the greatest value of the `range` of each drive. An episode is truncated
    at `solver.end_time_s`, or if the solve fails (`info["status"]` has the reason).

    Parameters
    ----------
    config : Scenario, Loaded, str, path or mapping
        The scenario.
    observation : sequence of str, or callable
        Names of observations (see `granular_contact.results.observed`), or a function of the observations that returns
        numbers.
    reward : str or callable
        Name of an observation, as `trunk_x_m`: the reward of a step is its increase. Or a function
        `reward(before, after)` of the observations before and after a step.
    terminated : callable, optional
        `terminated(observations)`: whether the episode is terminated, as when a walker has fallen.
    control_rate_Hz : float
        Steps of the environment per second; the step sizes of the solver are chosen as in any run.
    vary : mapping, optional
        Random values at each reset: by dotted key of the config, a range of a uniform distribution, or a function of
        the random generator. `reset(options={...})` sets values by the same keys.
    render_mode : "rgb_array", optional
        `render` returns a picture (height, width, 3).

    Raises
    ------
    ControlError
        No drive can be set, or one has no range; the rate is not a number above 0; a value of `vary` is not a range.
    KeyError
        There is no observation with a given name.
    ConfigError, SceneError, SolveError
        As `load` and `Simulation`.
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
        vary: Mapping[str, Distribution] | None = None,
        render_mode: Literal["rgb_array"] | None = None,
    ) -> None:
        if render_mode not in (None, "rgb_array"):
            raise ControlError(f"render_mode: got {render_mode!r}, allowed are rgb_array and None")
        period = 1.0 / checked_rate(control_rate_Hz)
        for key, values in (vary or {}).items():
            if callable(values):
                continue
            if np.shape(values) != (2,) or None in map(finite, values) or values[0] > values[1]:
                raise ControlError(f"vary: {key}: got {values!r}, allowed is (least, greatest) or a function")
        scenario = loaded(config)
        self.simulation = Simulation(scenario)
        self.render_mode, self.metadata = render_mode, self.metadata | {"render_fps": control_rate_Hz}
        self._observation, self._terminated = observation, terminated
        self._period, self._vary = period, dict(vary or {})
        bounds = self.simulation.bounds
        if not len(bounds) or not np.isfinite(bounds).all():
            names = [name for name, pair in zip(self.simulation.controls, bounds, strict=True) if np.isinf(pair).any()]
            without = f"without a range: {', '.join(names)}" if names else "none is in this scene"
            raise ControlError(f"drives that an agent sets need {{type: external, range: [..., ...]}}; {without}")
        self._middle, self._half = bounds.mean(axis=1), 0.5 * np.ptp(bounds, axis=1)
        self._observations = self.simulation.observe()
        self._reward = _increase(self._observations, reward) if isinstance(reward, str) else reward
        self.action_space = spaces.Box(-1.0, 1.0, (len(bounds),), np.float32)
        self.observation_space = spaces.Box(-np.inf, np.inf, self._observed().shape, np.float32)

    def _observed(self) -> Array:
        """Observation of the agent at the current instant."""
        chosen, every = self._observation, self._observations
        return np.asarray(chosen(every) if callable(chosen) else every.array(chosen), np.float32)

    def _info(self) -> dict[str, Any]:
        ended = self.simulation.ended
        return {"time_s": self._observations.time, "status": "" if ended is None else ended.message}

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Array, dict[str, Any]]:
        """Begin an episode.

        Parameters
        ----------
        seed : int, optional
            Seed of the random generator.
        options : dict, optional
            Values by dotted key of the config, for this episode.

        Returns
        -------
        tuple
            The observation, and a dict with the time and the status.
        """
        super().reset(seed=seed)
        drawn = {key: self._draw(values) for key, values in self._vary.items()}
        self._observations = self.simulation.reset(**(drawn | (options or {})))
        return self._observed(), self._info()

    def _draw(self, values: Distribution) -> Any:
        return values(self.np_random) if callable(values) else self.np_random.uniform(*values)

    def step(self, action: Array) -> tuple[Array, float, bool, bool, dict[str, Any]]:
        """Set the drives and advance by one control period.

        Parameters
        ----------
        action : (drives,) array
            From -1 to 1, for the range of each drive. Values beyond are set to the end of the range, as in Gymnasium's
            own environments; `simulation.results()` then has a warning.

        Returns
        -------
        tuple
            The observation, the reward, whether the episode is terminated, whether it is truncated, and a dict with the
            time and the status.

        Raises
        ------
        ControlError
            The action has another shape or is not finite, or as `Simulation.step`.
        """
        before = self._observations
        try:
            actions = np.asarray(action, float)
        except (TypeError, ValueError):
            raise ControlError(f"action: got {action!r:.80}, allowed is an array of numbers") from None
        if actions.shape != self._middle.shape:
            raise ControlError(f"action: got the shape {actions.shape}, allowed is {self._middle.shape}")
        self._observations = after = self.simulation.step(self._middle + self._half * actions, self._period)
        terminated = self._terminated is not None and bool(self._terminated(after))
        truncated = self.simulation.ended is not None and not terminated
        info, reward = self._info(), float(self._reward(before, after))
        return self._observed(), reward, terminated, truncated, info

    @property
    def failed(self) -> bool:
        """Whether the solve of this episode failed."""
        ended = self.simulation.ended
        return ended is not None and ended.code not in FINISHED

    def render(self) -> Any:
        """Draw a picture of the current state.

        Returns
        -------
        array
            (height, width, 3), 0 to 255; None without a render mode.
        """
        if self.render_mode is None:
            return None
        return picture(self.simulation)

    def close(self) -> None:
        """Free the memory of the engine."""
        self.simulation.close()

    # ---- back to an earlier state ----

    def state(self) -> EnvState:
        """Current state, with the friction of the sand.

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
            As `state()` returns it.

        Returns
        -------
        array
            The observation in this state.

        Raises
        ------
        ControlError
            The state is one of another scene.
        """
        self._observations = self.simulation.restore(state.simulation)
        self.np_random.bit_generator.state = state.random
        return self._observed()


def _increase(observations: Observations, name: str) -> Reward:
    """Reward function: the increase of an observation in a step; KeyError if there is none with this name."""
    observations[name]
    return lambda before, after: after[name] - before[name]


WIDE = 2.5  # width of a picture over the length of the mechanism


def picture(simulation: Simulation) -> NDArray[np.uint8]:
    """Picture (height, width, 3) of the current state; the view follows the mechanism."""
    scene, outlines = simulation.scene, simulation.outlines()
    instant = Results(
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
    return still(instant, WIDE * scene.length)
