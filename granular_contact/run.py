"""One scene, by the engine, in minimal coordinates or by the reduced model: Scene -> Results."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

from granular_contact.config import Loaded, Scenario, scenario_to_dict
from granular_contact.config.changed import checked
from granular_contact.config.differences import differing_keys
from granular_contact.errors import scene_error
from granular_contact.kernels.compiling import announced
from granular_contact.laws.kinds import WORDS
from granular_contact.results import Compiling, Progress, Results
from granular_contact.results.observation import Observation, results
from granular_contact.scene.build import build as build_scene
from granular_contact.scene.types import Reduced, Scene

if TYPE_CHECKING:
    from granular_contact.multibody.system import System, Trajectory


def run(
    scene: Scene | Scenario | Loaded,
    scenario: Scenario | None = None,
    progress: Progress | None = None,
    *,
    most_frames: int = 0,
    inspect: Callable[[System, Trajectory], None] | None = None,
    compiling: Compiling | None = None,
) -> Results:
    """Simulate a scene. However the run ends, what it reached is in the results; look at their status.

    Parameters
    ----------
    scene : Scene, Scenario or Loaded
        What `build` made of the scenario; or a scenario, or what `load` gave, of which the scene is built here.
    scenario : Scenario, optional
        What the scene was built from; the scene knows it, and any other is refused.
    progress : callable, optional
        Called now and then with the simulated time and the end time (s).
    most_frames : int
        From 2: the results get at most so many frames, for an animation.
    inspect : callable, optional
        Called with the engine's own system and trajectory after the solve; never for other methods, which have none.
    compiling : callable, optional
        Called with a sentence when kernels have to be compiled, which is the case the first time in an installation.

    Returns
    -------
    Results

    Raises
    ------
    SceneError
        The geometry contradicts itself; or the scenario is another one than the scene was built from; or the scene was
        not built from any.
    """
    if not isinstance(scene, Scene):
        scene = build_scene(scene)
    known = _scenario_of(scene, scenario)
    if isinstance(scene.method, Reduced):
        seen = _by_modes(scene, scene.method, progress, compiling)
    else:
        seen = _by_coordinates(scene, progress, inspect, compiling)
    return results(seen, scenario_to_dict(known), most_frames)


def _scenario_of(scene: Scene, given: Scenario | None) -> Scenario:
    """The scenario that a scene was built from, which results may name; a given one has to be the same."""
    built = scene.scenario
    if built is None:
        why = "the scene was changed after it was built, so no scenario tells what it is"
        raise scene_error("scene", f"{why}; change the scenario with its replace() and build that")
    if given is None or given is built or given == built or checked(given) == built:
        return built
    keys = differing_keys(scenario_to_dict(given), scenario_to_dict(built))
    raise scene_error("scenario", f"is not the one that the scene was built from: they differ in {keys}; leave it out")


def uninterrupted(results: Results) -> Results:
    """The same results, for those who make several and want all; raises KeyboardInterrupt where that ended a run."""
    if results.status.code == "interrupted":
        raise KeyboardInterrupt
    return results


def _compiled(scene: Scene) -> str:
    """What there is to compile for a scene, in words."""
    laws = ", ".join(dict.fromkeys(medium.law for medium in scene.media))
    kinds = {shape.kind for body in scene.rigid for shape in body.shapes if shape.in_sand}
    kinds |= {link.kind for link in scene.links}
    shapes = " and ".join(words.partition(" (")[0] for kind, words in WORDS.items() if kind in kinds)
    return f"the law {laws} for {shapes}" if laws else "the equations of motion"


def _trajectory(scene: Scene, progress: Progress | None, compiling: Compiling | None) -> tuple[System, Trajectory]:
    """By the engine, or in minimal coordinates: either way in the coordinates of the engine."""
    if scene.method is None:
        from granular_contact.multibody.build import build
        from granular_contact.multibody.solve import solve

        system = build(scene)
        with announced(compiling, _compiled(scene)):
            return system, solve(system, progress)
    from granular_contact.minimal.solve import solve as solve_tree
    from granular_contact.minimal.tree import tree

    made = tree(scene)
    with announced(compiling, _compiled(scene)):
        return made.system, solve_tree(made, progress)


def _by_coordinates(
    scene: Scene,
    progress: Progress | None,
    inspect: Callable[[System, Trajectory], None] | None,
    compiling: Compiling | None,
) -> Observation:
    """By the engine, again with shorter strips where it is to choose them by their error; or in minimal coordinates."""
    from granular_contact.multibody.observe import observe

    system, trajectory = _trajectory(scene, progress, compiling)
    if scene.method is not None:
        return observe(system, trajectory)
    if trajectory.load is not None:
        from granular_contact.multibody.kinematics import Kinematics
        from granular_contact.multibody.strip_error import finer

        spent = trajectory.cost.solve_s
        while (shorter := finer(Kinematics(system, trajectory))) is not None:
            system, trajectory = _trajectory(shorter, progress, compiling)
            spent += trajectory.cost.solve_s
        trajectory = replace(trajectory, cost=replace(trajectory.cost, solve_s=spent))
    if inspect is not None:
        inspect(system, trajectory)
    return observe(system, trajectory)


def _by_modes(scene: Scene, method: Reduced, progress: Progress | None, compiling: Compiling | None) -> Observation:
    from granular_contact.reduced.model import model
    from granular_contact.reduced.observe import observe
    from granular_contact.reduced.solve import solve

    reduced = model(scene, method)
    with announced(compiling, _compiled(scene)):
        return observe(reduced, solve(reduced, progress))
