"""Runs in one call, with or without a controller that steers them."""

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

    However the run ends, what it reached is in the results; look at their status. What a controller raises is raised.

    Parameters
    ----------
    scene : Scene, Scenario, Loaded, str, path or mapping
        What `load` gave, or takes; or the scenario in it; or what `build` made of one.
    scenario : Scenario or Loaded, optional
        What the scene was built from; the scene knows it, and any other is refused.
    progress : callable, optional
        Called now and then with the simulated time and the end time (s).
    laws : sequence of types of Law
        Laws of your own that a config names by their tags, as of `load`.
    control : callable, optional
        `control(t, observations)` gives the controls from the time t (s) on, see `Simulation.step`. It is called at the
        start and then at its rate. Steps chosen by their error end where it is called, and strips are those of the
        scene: the run is not repeated with shorter ones.
    control_rate_Hz : float
        Calls in a second.
    most_frames : int
        Pictures of the motion at most, for the player of a report and for animations; each takes 0.1 to 0.6 ms.
        0 for none.
    inspect : callable, optional
        Called with the system and the trajectory of the engine; not of a run with a controller.
    compiling : callable, optional
        Called with a sentence where forces are to be compiled.

    Returns
    -------
    Results
        Time series, summary, status and warnings; also of a run that failed or was interrupted.

    Raises
    ------
    TypeError, ValueError
        An argument is of another type than stands above, or no number of pictures.
    ConfigError
        The config is at fault, as of `load`.
    SceneError
        The scenario is another one than the scene was built from, or the scene was not built from any.
    ControllerError
        The controller raised, or gave what can't be set: a name that is not there, no finite number. What it raised is
        the cause; `results` are what was reached, with the status failed.
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
