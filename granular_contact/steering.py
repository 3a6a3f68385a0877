"""Simulation in one call, with or without a controller."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from os import PathLike
from typing import TYPE_CHECKING, Any

from granular_contact.config import Loaded, Scenario, load
from granular_contact.controllers import Controller
from granular_contact.errors import callables, of_type, whole
from granular_contact.results import Compiling, Progress, Results
from granular_contact.results.frames import MOST
from granular_contact.run import run, scenario_of
from granular_contact.scene.build import build
from granular_contact.scene.types import Scene
from granular_contact.simulation import Simulation

if TYPE_CHECKING:
    from granular_contact.laws.law import Law
    from granular_contact.mechanics.system import System, Trajectory


def simulate(
    scene: Scene | Scenario | Loaded | str | PathLike[str] | Mapping[str, Any],
    scenario: Scenario | Loaded | None = None,
    progress: Progress | None = None,
    *,
    laws: Sequence[type[Law]] = (),
    control: Controller | None = None,
    control_rate_Hz: float = 1000.0,
    most_frames: int = MOST,
    inspect: Callable[[System, Trajectory], None] | None = None,
    compiling: Compiling | None = None,
) -> Results:
    """Simulate a scene, steered by a controller if there is one.

    Check the status of the results: they contain all steps up to the end of the run, however it ended. Only an
    exception of the controller is raised.

    Parameters
    ----------
    scene : Scene, Scenario, Loaded, str, path or mapping
        The result of `load`, the scenario in it, or an argument of `load`; or the result of `build`.
    scenario : Scenario or Loaded, optional
        The scenario that the scene was built from. The scene knows it, so it may be left out; another one is refused.
    progress : callable, optional
        Called from time to time with the simulated time and the end time (s).
    laws : sequence of types of Law
        Laws of your own that a config names by their tags, as for `load`.
    control : callable, optional
        `control(t, observations)` gives the controls from the time t (s) on, see `Simulation.step`. It is called at the
        start and then at its rate. Steps chosen by their error end at each call. The strips are those of the scene:
        the run is not repeated with shorter ones.
    control_rate_Hz : float
        Number of calls of `control` per second of simulated time.
    most_frames : int
        Largest number of pictures of the motion, for the player of a report and for animations; each takes 0.1 to
        0.6 ms. 0 for none.
    inspect : callable, optional
        Called with the system and the trajectory after the run; not for a run with a controller.
    compiling : callable, optional
        Called with a sentence when kernels have to be compiled.

    Returns
    -------
    Results
        Time series, summary, status and warnings; also of a run that failed or was interrupted.

    Raises
    ------
    TypeError, ValueError
        An argument has another type than listed above, or `most_frames` is negative.
    ConfigError
        The config is faulty, as for `load`.
    SceneError
        The scene was built from another scenario, or was changed after it was built.
    ControllerError
        The controller raised an exception, which is the cause of this one, or gave an unknown name or a number that is
        not finite. `results` are the results up to this instant, with the status failed.
    ControlError
        The rate is no number above 0, or too high for the run.

    Examples
    --------
    >>> results = simulate("pendulum_rigid")
    >>> results.status.code, f"{1e3 * results.summary['stopping_time_s']:.1f} ms"
    ('rest', '25.5 ms')
    """
    kinds = (Scene, Scenario, Loaded, str, PathLike, Mapping)
    of_type("scene", scene, kinds, "the name of a config, as 'pendulum', its file, a mapping, or what `load` gives")
    callables(progress=progress, control=control, inspect=inspect, compiling=compiling)
    whole("most_frames", most_frames, 0)
    if isinstance(scene, str | PathLike | Mapping):
        scene = load(scene, laws=laws)
    if isinstance(scene, Loaded | Scenario):
        scene = build(scene)
    if control is None:
        return run(scene, scenario, progress, most_frames=most_frames, inspect=inspect, compiling=compiling)
    simulation = Simulation(scenario_of(scene, scenario), compiling=compiling)
    try:
        return simulation.run(control, control_rate_Hz, progress=progress, most_frames=most_frames)
    finally:
        simulation.close()
