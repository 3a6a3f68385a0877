"""Run a scene with its method of solution: the engine, minimal coordinates or the reduced model. Scene -> Results."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from types import NoneType
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol, TypeVar

from granular_contact.config import Loaded, Scenario, scenario_to_dict
from granular_contact.config.changed import checked
from granular_contact.config.differences import differing_keys
from granular_contact.errors import of_type, scene_error
from granular_contact.jit.compiling import announced
from granular_contact.laws.kinds import SHAPE_NAMES
from granular_contact.results import Compiling, Outline, Progress, Results, Status
from granular_contact.results.observation import Observation, key_numbers, results
from granular_contact.results.observed import Observations
from granular_contact.scene.types import Minimal, Reduced, Scene

if TYPE_CHECKING:
    from granular_contact.engines.tree.tree import Tree
    from granular_contact.mechanics.equilibrium import Equilibrium
    from granular_contact.mechanics.system import System, Trajectory

Made = TypeVar("Made")


def run(
    scene: Scene,
    scenario: Scenario | Loaded | None = None,
    progress: Progress | None = None,
    *,
    most_frames: int = 0,
    inspect: Callable[[System, Trajectory], None] | None = None,
    compiling: Compiling | None = None,
) -> Results:
    """Simulate a scene. Check the status of the results: they contain all steps up to the end, however the run ended.

    Parameters
    ----------
    scene : Scene
        The result of `granular_contact.scene.build`.
    scenario : Scenario or Loaded, optional
        The scenario that the scene was built from. The scene knows it, so it may be left out; another one is refused.
    progress : callable, optional
        Called from time to time with the simulated time and the end time (s).
    most_frames : int
        Largest number of pictures for an animation; below 2 there are none.
    inspect : callable, optional
        Called with the system and the trajectory after the solve. In minimal coordinates the system has no engine. Not
        called for reduced models, which have neither.
    compiling : callable, optional
        Called with a sentence when kernels have to be compiled, once in an installation.

    Returns
    -------
    Results

    Raises
    ------
    SceneError
        The scene was built from another scenario, or was changed after it was built.
    """
    built_from = scenario_of(scene, scenario)
    with announced(compiling, kernels_of(scene)):
        begun, observation = _observed(scene, progress, inspect)
        run_results = results(observation, scenario_to_dict(built_from), most_frames)
    if inspect is None:  # else the caller may still use the system
        begun.solving.close()
    return run_results


def summary_of(scene: Scene, further: Callable[[Observation], dict[str, Any]] = lambda _: {}) -> dict[str, Any]:
    """Summary of a scene's run, as `run` gives it, without the time series and pictures, which a sweep does not keep.

    further: gives further entries of the summary from the observation.
    """
    begun, observation = _observed(scene, None, None)
    summary, _ = key_numbers(observation)
    summary |= further(observation)
    begun.solving.close()
    return summary


def summaries_of(scenes: Sequence[Scene]) -> list[dict[str, Any] | Exception]:
    """Summary of each scene as `summary_of` gives it, or the exception that its run raised.

    Scenes with the reduced model are solved together, in one call that lets other threads of Python run.
    """
    from granular_contact.engines.modal.batch import summaries
    from granular_contact.engines.modal.model import Models

    model_of, reduced = Models(), [i for i, scene in enumerate(scenes) if isinstance(scene.method, Reduced)]
    models: dict[int, Any] = {i: tried(model_of, scenes[i]) for i in reduced}
    valid = [i for i in reduced if not isinstance(models[i], Exception)]
    batch: Any = tried(summaries, [models[i] for i in valid])
    if isinstance(batch, Exception):  # from one of the runs, or from too little memory for all: solve them one by one
        batch = [tried(lambda model: summaries([model])[0], models[i]) for i in valid]
    outcomes = models | dict(zip(valid, batch, strict=True))
    return [outcomes[i] if i in outcomes else tried(summary_of, scene) for i, scene in enumerate(scenes)]


def tried(function: Callable[..., Made], *arguments: Any) -> Made | Exception:
    """Result of a function, or the exception that it raises."""
    try:
        return function(*arguments)
    except Exception as error:
        return error


def scenario_of(scene: Scene, scenario: Scenario | Loaded | None = None) -> Scenario:
    """The scenario that a scene was built from.

    Raises
    ------
    SceneError
        The scene was changed after it was built, or `scenario` is another one.
    """
    built_from = scene.scenario
    if built_from is None:
        reason = "the scene was changed after it was built, so no scenario says what it is"
        raise scene_error("scene", f"{reason}; change the scenario with its replace() and build that")
    allowed = "what the scene was built from; values to change go into load(config, ...)"
    of_type("scenario", scenario, (Scenario, Loaded, NoneType), allowed)
    given = scenario.scenario if isinstance(scenario, Loaded) else scenario
    if given is None or given is built_from or given == built_from or checked(given) == built_from:
        return built_from
    keys = differing_keys(scenario_to_dict(given), scenario_to_dict(built_from))
    raise scene_error("scenario", f"is not the one that the scene was built from: they differ in {keys}; leave it out")


def uninterrupted(results: Results) -> Results:
    """The same results; KeyboardInterrupt if the user interrupted the run, so that no further runs follow."""
    if results.status.code == "interrupted":
        raise KeyboardInterrupt
    return results


def kernels_of(scene: Scene) -> str:
    """Words for the kernels that are compiled for a scene: its laws and its kinds of bodies."""
    laws = ", ".join(dict.fromkeys(medium.law for medium in scene.media))
    if scene.in_space:
        return f"the law {laws} for bodies in space" if laws else "the equations of motion"
    kinds = {shape.kind for body in scene.rigid for shape in body.shapes if shape.in_sand}
    kinds |= {link.kind for link in scene.links}
    shapes = " and ".join(words.partition(" (")[0] for kind, words in SHAPE_NAMES.items() if kind in kinds)
    return f"the law {laws} for {shapes}" if laws else "the equations of motion"


class Solving(Protocol):
    """Solve of one scene by any engine: what the class `Solve` in the room of an engine has to provide.

    A new solve stands at t = 0 with the initial state accepted; its constructor raises SolveError if there is none.
    After each call of `advance` the solve stands at the end of an accepted step. Failure, time limit and Ctrl-C end a
    solve without an error: `status` tells them, and all steps up to then are kept. A solve whose drives controllers may
    set also has `set_to(joint, value)`.
    """

    @property
    def time(self) -> float:
        """Time (s) of the present state."""

    @property
    def spent(self) -> float:
        """Wall time (s) spent so far; `solver.max_wall_s` limits it."""

    @property
    def over(self) -> bool:
        """Whether the solve has ended: at the end time, at rest, by a limit, by Ctrl-C or by a failure."""

    def advance(self, until: float = ...) -> None:
        """Integrate to a time (s), at most to the scene's end time; do nothing if the solve is over."""

    def observe(self) -> Observations:
        """Observed quantities at the present state, by name, in SI units."""

    def outlines(self) -> tuple[Outline, ...]:
        """Outlines of the mechanism at the present state, for drawings."""

    def state(self) -> Any:
        """Copy of the present state: all that later steps and the results depend on."""

    def restore(self, kept: Any) -> None:
        """Return to a state that `state` gave, in this solve or in another one of the same scene."""

    def trajectory(self) -> Any:
        """All accepted steps so far, in the coordinates of the engine."""

    def status(self) -> Status:
        """How the solve ended, as its trajectory has it, without making the trajectory."""

    def close(self) -> None:
        """Release the engine's memory; no other method may be called afterwards."""


class Begun(NamedTuple):
    """A solve at its start.

    observe: makes the observation of the solve's trajectory. system: the system that is solved, None for the reduced
    model.
    """

    solving: Solving
    observe: Callable[[Any], Observation]
    system: System | None


def begin(scene: Scene, progress: Progress | None = None, *, pauses: bool = False) -> Begun:
    """Set up the solve of a scene by its method; pauses: whether the solve is observed and steered on the way."""
    if scene.method is None:
        return _by_engine(scene, progress, pauses)
    return _OTHERS[type(scene.method)](scene, progress)


def _by_engine(scene: Any, progress: Progress | None, pauses: bool) -> Begun:
    """Solve by Exudyn."""
    from granular_contact.engines.exudyn.solve import Solve

    if scene.in_space:
        from granular_contact.engines.exudyn.build_in_space import build as build_in_space

        system: System = build_in_space(scene)
    else:
        from granular_contact.engines.exudyn.build import build

        system = build(scene)
    return Begun(Solve(system, progress, pauses=pauses), system.observe, system)


def _by_minimal(scene: Any, progress: Progress | None) -> Begun:
    """Solve in minimal coordinates; the engine finds the static equilibrium that a scene may begin from."""
    from granular_contact.engines.tree.solve import Solve

    rest = _rest(scene) if scene.settle else None
    if scene.in_space:
        from granular_contact.engines.tree.space_tree import tree as tree_in_space

        scene_tree: Tree = tree_in_space(scene, rest)
    else:
        from granular_contact.engines.tree.tree import tree

        scene_tree = tree(scene, rest)
    return Begun(Solve(scene_tree, progress), scene_tree.system.observe, scene_tree.system)


def _rest(scene: Scene) -> Equilibrium:
    """Static equilibrium of a scene, found by the engine."""
    from granular_contact.mechanics.equilibrium import equilibrium

    begun = _by_engine(replace(scene, method=None), None, False)
    assert begun.system is not None
    rest = equilibrium(begun.system.kinematics(begun.solving.trajectory()))
    begun.solving.close()
    return rest


def _by_modes(scene: Scene, progress: Progress | None) -> Begun:
    """Solve by the reduced model."""
    from granular_contact.engines.modal.model import model
    from granular_contact.engines.modal.observe import observe
    from granular_contact.engines.modal.solve import Solve

    assert isinstance(scene.method, Reduced)
    reduced = model(scene, scene.method)
    return Begun(Solve(reduced, progress), partial(observe, reduced), None)


_OTHERS = {Minimal: _by_minimal, Reduced: _by_modes}  # methods other than the engine, by the class of their options


def _solved(scene: Scene, progress: Progress | None) -> tuple[Begun, Any]:
    """Solve a scene to its end; return the solve and its trajectory."""
    begun = begin(scene, progress)
    begun.solving.advance()
    return begun, begun.solving.trajectory()


def _observed(
    scene: Scene,
    progress: Progress | None,
    inspect: Callable[[System, Trajectory], None] | None,
) -> tuple[Begun, Observation]:
    """Solve a scene to its end, with strips or facets chosen by their error; return the solve and its observation."""
    if scene.in_space and any(medium.scatters for medium in scene.media):
        shares, error = _nominal_facets(scene, progress)
        begun, trajectory = _solved(replace(scene, facet_shares=shares), progress)  # type: ignore[call-arg]
        trajectory = replace(trajectory, strip_error=error)
    else:
        begun, trajectory = _chosen(scene, progress)
    if inspect is not None and begun.system is not None:
        inspect(begun.system, trajectory)
    return begun, begun.observe(trajectory)


_NOMINAL: dict[str, Any] = {}  # `_nominal_facets` of the last scenario, for other members of its ensemble


def _nominal_facets(scene: Any, progress: Progress | None) -> Any:
    """Sizes of facets (relative to the usual ones) and their error, chosen for a scene in space without scatter.

    All members of an ensemble use these sizes. With its own scatter each member would choose other sizes, although
    scatter is no error of facets.
    """
    key = "" if scene.scenario is None else json.dumps(_unscattered(scenario_to_dict(scene.scenario)), default=str)
    if not key or key not in _NOMINAL:
        begun, trajectory = _chosen(scene.without_scatter(), progress)
        _NOMINAL.clear()
        _NOMINAL[key] = begun.system.scene.facet_shares, trajectory.strip_error  # type: ignore[union-attr]
        begun.solving.close()
    return _NOMINAL[key]


def _unscattered(tree: Any) -> Any:
    """A scenario as plain data, without the scatter of its media."""
    if isinstance(tree, dict):
        return {key: _unscattered(value) for key, value in tree.items() if key != "scatter"}
    return [_unscattered(item) for item in tree] if isinstance(tree, (list, tuple)) else tree


def _chosen(scene: Scene, progress: Progress | None) -> tuple[Begun, Any]:
    """Solve a scene to its end, again with smaller strips or facets while their estimated error is too large.

    Return the last solve and its trajectory, whose cost is the wall time of all solves.
    """
    begun, trajectory = _solved(scene, progress)
    if begun.system is None or trajectory.load is None:
        return begun, trajectory
    from granular_contact.mechanics.strip_error import errors, finer, run_track

    spent, errors_before, coarser = trajectory.cost.solve_s, None, None
    while begun.system:
        motion = begun.system.kinematics(trajectory)
        strip_errors = errors(motion, coarser=coarser)
        trajectory = replace(trajectory, strip_error=max(strip_errors.values(), default=0.0))
        finer_scene = finer(motion, strip_errors, errors_before, coarser is not None)
        if finer_scene is None:
            break
        # An estimate from one run can't be compared with an estimate from two runs.
        errors_before = None if scene.in_space and coarser is None else strip_errors
        coarser = run_track(motion, strip_errors)
        finer_solve, finer_trajectory = _solved(finer_scene, progress)
        spent += finer_trajectory.cost.solve_s
        if scene.in_space and finer_trajectory.status.code in ("time_limit", "failed"):
            finer_solve.solving.close()
            break  # the last complete run is kept, with a warning of its error
        begun.solving.close()
        begun, trajectory = finer_solve, finer_trajectory
    return begun, replace(trajectory, cost=replace(trajectory.cost, solve_s=spent))
