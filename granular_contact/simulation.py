"""A scene that goes on step by step, under the hands of a program.

One path with runs in one call: both go on by the same solve, which here pauses where it is asked to.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from granular_contact.config import Given, scenario_to_dict
from granular_contact.control_values import ControlValues
from granular_contact.controllers import Controller, Controls, checked_rate, finite, steer
from granular_contact.errors import ControlError, ControllerError
from granular_contact.jit.compiling import announced
from granular_contact.results import Compiling, Outline, Progress, Results, Status
from granular_contact.results.observation import results
from granular_contact.results.observed import Observations
from granular_contact.results.stopping import ended, paused
from granular_contact.run import Begun, Solving, begin, kernels_of, scenario_of
from granular_contact.scene.build import build
from granular_contact.scene.types import Scene
from granular_contact.simulation_state import State

SHORTEST = 1e-4  # of solver.step_s: a shorter pause is no step


class Simulation:
    """A scene as an object that steps.

    Parameters
    ----------
    scenario : Scenario, Loaded, str, path or mapping
        What `load` gave, or takes.
    compiling : callable, optional
        Called with a sentence when kernels have to be compiled.

    Attributes
    ----------
    scenario, scene
        Of the run under way: those given, but for the changes of the last `reset`.
    controls : tuple of str
        Names of what can be set, `JOINT_torque_Nm` for a drive `{type: external, torque_Nm: 0}` of JOINT.
    random : numpy.random.Generator
        Seeded by `reset`; a simulation draws from it only for changes that are functions.

    Raises
    ------
    ConfigError, SceneError, SolveError
        As of `replace`, `build` and `simulate`.

    Examples
    --------
    >>> from granular_contact import load
    >>> simulation = Simulation(load("pendulum_rigid"))
    >>> seen = simulation.step(None, 0.01)
    >>> f"{seen['pivot_angle_deg']:.1f} deg, {1e3 * seen['depth_m']:.1f} mm deep"
    '33.9 deg, 11.2 mm deep'
    """

    def __init__(self, scenario: Given, *, compiling: Compiling | None = None) -> None:
        self._compiling = compiling
        self._begun: Begun | None = None
        self.random = np.random.default_rng(0)
        self._take(build(scenario))
        self._base = self.scenario

    def __repr__(self) -> str:
        if self._begun is None:
            return f"<simulation of {self.scene.name}: closed>"
        reached = f"{self.time:g} of {self._end:g} s"
        return f"<simulation of {self.scene.name}: {reached}, controls: {', '.join(self.controls) or 'none'}>"

    def _take(self, scene: Scene) -> None:
        """Begin with a scene; where that fails, the simulation stays as it was."""
        with announced(self._compiling, kernels_of(scene)):
            begun = begin(scene, pauses=True)
        self.close()
        self._begun = begun
        self.scene, self.scenario = scene, scenario_of(scene)
        self._values = ControlValues(scene)
        self.controls = self._values.names
        self._failed: Status | None = None
        self._end = self.scenario.solver.end_time_s
        self._shortest = SHORTEST * scene.solver.step_s
        self._start = self.state()

    @property
    def _solving(self) -> Solving:
        if self._begun is None:
            raise ControlError("the simulation was closed: reset() begins anew")
        return self._begun.solving

    # ---- time ----

    @property
    def time(self) -> float:
        """Time reached (s)."""
        return self._solving.time

    @property
    def ended(self) -> Status | None:
        """How the run ended; None while it goes on."""
        solving = self._solving
        return solving.status() if self._failed is None and solving.over else self._failed

    def reset(self, *, seed: int | None = None, **changes: Any) -> Observations:
        """Begin anew, from the scenario that the simulation was made of.

        Parameters
        ----------
        seed : int, optional
            Of `random`; without one the generator goes on as it is.
        **changes
            Other values by dotted key, as of `Scenario.replace`: `reset(**{"medium.eta_d": 5})`. A function is called
            with `random`, and gives the value.

        Returns
        -------
        Observations
            Of the start.
        """
        if seed is not None:
            self.random = np.random.default_rng(seed)
        values = {key: value(self.random) if callable(value) else value for key, value in changes.items()}
        scenario = self._base.replace(values) if values else self._base
        drawn = self.random.bit_generator.state
        if self._begun is not None and (scenario is self.scenario or scenario == self.scenario):
            self.restore(self._start)
        else:
            self._take(build(scenario))
        self.random.bit_generator.state = drawn
        return self.observe()

    def step(self, controls: Controls, dt: float) -> Observations:
        """Go on by a time, with controls that stay set; the solver chooses its steps on the way as in any run.

        Parameters
        ----------
        controls : mapping, array or None
            What to set, by name, or all in the order of `controls`; what is not named stays as it is set. Angles also
            in radians, `JOINT_angle_rad`. What lies beyond the `range` of a drive is set to the end of it, as a motor
            gives no more than it can; the results warn of it.
        dt : float
            Time to go (s); the run ends at `solver.end_time_s`.

        Returns
        -------
        Observations
            Of the instant reached: `dt` ahead, or where the run ended.

        Raises
        ------
        ControlError
            Controls of other names or another number, or not finite; no time; the run is over. Nothing was changed.
        """
        time = dt if type(dt) is float else finite(dt)
        if time is None or not self._shortest <= time < math.inf:
            raise ControlError(f"dt: got {dt!r}, allowed is a time of at least {self._shortest:g} s")
        return self._go_on(controls, self._solving.time + time)

    def run(
        self,
        control: Controller | None = None,
        control_rate_Hz: float = 1000.0,
        *,
        progress: Progress | None = None,
        most_frames: int = 0,
    ) -> Results:
        """Go on from here to the end of the run, steered by a controller if there is one.

        Parameters
        ----------
        control, control_rate_Hz, progress, most_frames
            As of `simulate`; the controller is called first at the present time.

        Returns
        -------
        Results
            Of the whole run.

        Raises
        ------
        ControllerError
            The controller raised, or gave what can't be set; its `results` are what was reached.
        ControlError
            The rate is no number above 0 or too high, or the run is over.
        """
        raised = None
        if control is None or self.ended is not None:
            self._go_on(None, math.inf)
        else:
            rate, wall = checked_rate(control_rate_Hz, self._shortest), self.scenario.solver.max_wall_s
            left = math.inf if wall is None else wall - self._solving.spent
            raised = steer(self, control, rate, self._end, left, progress)
        found = self.results(most_frames)
        if raised is not None:
            raise ControllerError(found.status.message, found) from raised
        return found

    def _go_on(self, controls: Controls, until: float) -> Observations:
        """`step` to a time (s)."""
        solving = self._solving
        if (self._failed is not None or solving.over) and (over := self.ended) is not None:
            raise ControlError(f"the run is over ({over.message}): reset() begins anew, restore() goes back")
        if controls is not None:
            values = self._values
            for joint, given in values.checked(controls).items():
                value = values.within(joint, given)
                solving.set_to(joint, value)  # type: ignore[attr-defined]  # reduced models have no drives
                values.set_to[joint] = value
        solving.advance(until if self._end - until > self._shortest else math.inf)
        return solving.observe()

    # ---- what is seen ----

    def observe(self) -> Observations:
        """What is seen of the present state.

        Returns
        -------
        Observations
            Numbers by name, as those of the columns of results; as arrays in SI units.
        """
        return self._solving.observe()

    def outlines(self) -> tuple[Outline, ...]:
        """The mechanism as it is drawn, at the present state.

        Returns
        -------
        tuple of Outline
            One for each part, with points in the world frame (m).
        """
        return self._solving.outlines()

    @property
    def standing(self) -> Status:
        """How the run stands while it has not ended."""
        return paused(self.time, self.scenario.solver)

    @property
    def bounds(self) -> NDArray[np.float64]:
        """Ranges (controls, 2) within which controls can be set, in the units of their names; infinite for any."""
        return self._values.bounds

    def results(self, most_frames: int = 0) -> Results:
        """Results of the run so far.

        Parameters
        ----------
        most_frames : int
            Pictures for a player or an animation; 0 for none.

        Returns
        -------
        Results
            As of `simulate`.
        """
        trajectory = self._solving.trajectory()
        status = self._failed or (None if self._solving.over else self.standing)
        if status is not None:
            trajectory = replace(trajectory, status=status)
        assert self._begun is not None  # or there were no trajectory
        seen = replace(self._begun.observe(trajectory), steered=self._values.warnings)
        return results(seen, scenario_to_dict(self.scenario), most_frames)

    # ---- back to an earlier state ----

    def state(self) -> State:
        """The present state, with all that the future depends on: `restore` goes on from it bit for bit.

        Returns
        -------
        State
            It can be sent to another process.
        """
        random = self.random.bit_generator.state
        set_to = tuple(self._values.set_to.values())
        beyond = dict(self._values.beyond)
        return State(self.time, self.scenario, self._solving.state(), set_to, beyond, dict(random), self._failed)

    def restore(self, state: State) -> Observations:
        """Go back to a state of this simulation, or of another one of the same scenario.

        Parameters
        ----------
        state : State
            What `state` gave.

        Returns
        -------
        Observations
            What is seen there.

        Raises
        ------
        ControlError
            It is a state of another scene. Nothing was changed.
        """
        if not isinstance(state, State):
            raise ControlError(f"restore: got {state!r:.40}, allowed is what state() gave")
        state.check_is_of(self.scenario)
        self._solving.restore(state.solve)
        self._values.set_to = dict(zip(self._values.set_to, state.controls, strict=True))
        self._values.beyond = dict(state.beyond)
        self.random.bit_generator.state = state.random
        self._failed = state.failed
        return self.observe()

    def close(self) -> None:
        """Let go of the engine's memory. Only `reset` can be asked for afterwards; results that were made stay."""
        if self._begun is not None:
            self._begun.solving.close()
        self._begun = None

    def fail(self, message: str) -> None:
        """End the run as failed.

        Parameters
        ----------
        message : str
            Why, as the status of its results says it.
        """
        self._failed = Status("failed", message)

    def run_out(self) -> None:
        """End the run as its wall time is over."""
        self._failed = ended("time_limit", self.time, self.scenario.solver)

    def interrupt(self) -> None:
        """End the run as interrupted."""
        self._failed = ended("interrupted", self.time, self.scenario.solver)
