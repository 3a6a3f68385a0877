"""Step-by-step simulation of a scene under the control of a program.

It uses the same solve as a run in one call. The solve pauses at each requested time.
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

SHORTEST = 1e-4  # of solver.step_s: the shortest time by which `step` may advance


class Simulation:
    """A scene that is simulated step by step.

    Parameters
    ----------
    scenario : Scenario, Loaded, str, path or mapping
        The result of `load`, or an argument of `load`.
    compiling : callable, optional
        Called with a sentence when kernels have to be compiled.

    Attributes
    ----------
    scenario, scene
        Scenario and scene of the present run: those given, with the changes of the last `reset`.
    controls : tuple of str
        Names of the controls, for example `JOINT_torque_Nm` for a drive `{type: external, torque_Nm: 0}` of JOINT.
    random : numpy.random.Generator
        Random generator, seeded by `reset`. A simulation uses it only for changes of `reset` that are functions.

    Raises
    ------
    ConfigError, SceneError, SolveError
        As `replace`, `build` and `simulate` raise them.

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
        """Begin the simulation of a scene. If that fails, the simulation does not change."""
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
        """Begin a new run, from the scenario that the simulation was made from.

        Parameters
        ----------
        seed : int, optional
            Seed of `random`. Without it the generator keeps its state.
        **changes
            Other values by dotted key, as for `Scenario.replace`: `reset(**{"medium.eta_d": 5})`. A function as a value
            is called with `random` and gives the value.

        Returns
        -------
        Observations
            Observations of the initial state.
        """
        if seed is not None:
            self.random = np.random.default_rng(seed)
        values = {key: value(self.random) if callable(value) else value for key, value in changes.items()}
        scenario = self._base.replace(values) if values else self._base
        random_state = self.random.bit_generator.state  # which `restore` below replaces
        if self._begun is not None and (scenario is self.scenario or scenario == self.scenario):
            self.restore(self._start)
        else:
            self._take(build(scenario))
        self.random.bit_generator.state = random_state
        return self.observe()

    def step(self, controls: Controls, dt: float) -> Observations:
        """Set controls, and advance by a time. The solver chooses its time steps in between as in any run.

        Parameters
        ----------
        controls : mapping, array or None
            Values by the name of the control, or an array in the order of `controls`. Controls that are not named keep
            their values. Angles may be given in radians too, as `JOINT_angle_rad`. A value outside the `range` of a
            drive is set to the nearer end, as a motor has limits too; the results have a warning of it.
        dt : float
            Time by which to advance (s). The run ends at `solver.end_time_s`.

        Returns
        -------
        Observations
            Observations after `dt`, or at the end of the run.

        Raises
        ------
        ControlError
            A name is unknown, the array has another length, a value is not finite, `dt` is too short, or the run is
            over. Nothing was changed.
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
        """Continue from the present time to the end of the run, steered by a controller if there is one.

        Parameters
        ----------
        control, control_rate_Hz, progress, most_frames
            As for `simulate`; the first call of the controller is at the present time.

        Returns
        -------
        Results
            Results of the whole run.

        Raises
        ------
        ControllerError
            The controller raised an exception, or gave invalid controls. Its `results` are those up to this instant.
        ControlError
            The rate is no number above 0, or too high; or the run is over.
        """
        raised = None
        if control is None or self.ended is not None:
            self._go_on(None, math.inf)
        else:
            rate, wall = checked_rate(control_rate_Hz, self._shortest), self.scenario.solver.max_wall_s
            left = math.inf if wall is None else wall - self._solving.spent
            raised = steer(self, control, rate, self._end, left, progress)
        all_results = self.results(most_frames)
        if raised is not None:
            raise ControllerError(all_results.status.message, all_results) from raised
        return all_results

    def _go_on(self, controls: Controls, until: float) -> Observations:
        """Set controls, and advance to the time `until` (s)."""
        solving = self._solving
        if (self._failed is not None or solving.over) and (status := self.ended) is not None:
            raise ControlError(f"the run is over ({status.message}): reset() begins anew, restore() goes back")
        if controls is not None:
            values = self._values
            for joint, requested in values.checked(controls).items():
                value = values.within(joint, requested)
                solving.set_to(joint, value)  # type: ignore[attr-defined]  # reduced models have no drives
                values.set_to[joint] = value
        solving.advance(until if self._end - until > self._shortest else math.inf)
        return solving.observe()

    # ---- observations and results ----

    def observe(self) -> Observations:
        """Observations of the present state.

        Returns
        -------
        Observations
            Numbers by name, with the names of the columns of results; as arrays in SI units.
        """
        return self._solving.observe()

    def outlines(self) -> tuple[Outline, ...]:
        """Outlines of the mechanism at the present state, for drawing.

        Returns
        -------
        tuple of Outline
            One for each part, with points in the world frame (m).
        """
        return self._solving.outlines()

    @property
    def standing(self) -> Status:
        """Status of the run while it has not ended."""
        return paused(self.time, self.scenario.solver)

    @property
    def bounds(self) -> NDArray[np.float64]:
        """Ranges (controls, 2) of the controls in the units of their names; infinite for a control without a range."""
        return self._values.bounds

    def results(self, most_frames: int = 0) -> Results:
        """Results of the run so far.

        Parameters
        ----------
        most_frames : int
            Largest number of pictures for a player or an animation; 0 for none.

        Returns
        -------
        Results
            As `simulate` gives them.
        """
        trajectory = self._solving.trajectory()
        status = self._failed or (None if self._solving.over else self.standing)
        if status is not None:
            trajectory = replace(trajectory, status=status)
        assert self._begun is not None  # since there is a trajectory
        observation = replace(self._begun.observe(trajectory), steered=self._values.warnings)
        return results(observation, scenario_to_dict(self.scenario), most_frames)

    # ---- states ----

    def state(self) -> State:
        """The complete present state. After `restore` the run continues from it bit for bit.

        Returns
        -------
        State
            The state; it can be sent to another process.
        """
        random = self.random.bit_generator.state
        set_to = tuple(self._values.set_to.values())
        beyond = dict(self._values.beyond)
        return State(self.time, self.scenario, self._solving.state(), set_to, beyond, dict(random), self._failed)

    def restore(self, state: State) -> Observations:
        """Return to a state of this simulation, or of another simulation of the same scenario.

        Parameters
        ----------
        state : State
            The result of `state`.

        Returns
        -------
        Observations
            Observations of this state.

        Raises
        ------
        ControlError
            It is a state of another scenario. Nothing was changed.
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
        """Free the memory of the solver. Afterwards only `reset` can be called; existing results stay valid."""
        if self._begun is not None:
            self._begun.solving.close()
        self._begun = None

    def fail(self, message: str) -> None:
        """End the run with the status failed.

        Parameters
        ----------
        message : str
            Reason, for the status of the results.
        """
        self._failed = Status("failed", message)

    def run_out(self) -> None:
        """End the run because its wall time is used up."""
        self._failed = ended("time_limit", self.time, self.scenario.solver)

    def interrupt(self) -> None:
        """End the run with the status interrupted."""
        self._failed = ended("interrupted", self.time, self.scenario.solver)
