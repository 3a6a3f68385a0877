"""One scene, by the engine, in minimal coordinates or by the reduced model: Scene -> Results."""

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
    """Simulate a scene. However the run ends, what it reached is in the results; look at their status.

    Parameters
    ----------
    scene : Scene
        What `granular_contact.scene.build` made of the scenario.
    scenario : Scenario or Loaded, optional
        What the scene was built from; the scene knows it, and any other is refused.
    progress : callable, optional
        Called now and then with the simulated time and the end time (s).
    most_frames : int
        From 2: the results get at most so many frames, for an animation.
    inspect : callable, optional
        Called with the system and the trajectory after the solve; in minimal coordinates the system has no engine.
        Never for reduced models, which have neither.
    compiling : callable, optional
        Called with a sentence when kernels have to be compiled, which is the case the first time in an installation.

    Returns
    -------
    Results

    Raises
    ------
    SceneError
        The scenario is another one than the scene was built from, or the scene was not built from any.
    """
    known = scenario_of(scene, scenario)
    with announced(compiling, kernels_of(scene)):
        begun, seen = _observed(scene, progress, inspect)
        made = results(seen, scenario_to_dict(known), most_frames)
    if inspect is None:  # whose caller may go on with the system
        begun.solving.close()
    return made


def summary_of(scene: Scene, more: Callable[[Observation], dict[str, Any]] = lambda _: {}) -> dict[str, Any]:
    """The summary of a scene's run, as `run` gives it, without the table and pictures that a sweep does not keep.

    more: what the summary has besides, from what was observed.
    """
    begun, seen = _observed(scene, None, None)
    summary, _ = key_numbers(seen)
    summary |= more(seen)
    begun.solving.close()
    return summary


def summaries_of(scenes: Sequence[Scene]) -> list[dict[str, Any] | Exception]:
    """As `summary_of`, of several scenes; or what went wrong with one. Those of the reduced model march together.

    While they march other threads of Python go on.
    """
    from granular_contact.engines.modal.batch import summaries
    from granular_contact.engines.modal.model import Models

    of, places = Models(), [i for i, scene in enumerate(scenes) if isinstance(scene.method, Reduced)]
    found: dict[int, Any] = {i: tried(of, scenes[i]) for i in places}
    fine = [i for i in places if not isinstance(found[i], Exception)]
    together: Any = tried(summaries, [found[i] for i in fine])
    if isinstance(together, Exception):  # of one of them, or of memory for all
        together = [tried(lambda one: summaries([one])[0], found[i]) for i in fine]
    found.update(zip(fine, together, strict=True))
    return [found[i] if i in found else tried(summary_of, scene) for i, scene in enumerate(scenes)]


def tried(function: Callable[..., Made], *given: Any) -> Made | Exception:
    """What a function gives, or the exception that it raises."""
    try:
        return function(*given)
    except Exception as error:
        return error


def scenario_of(scene: Scene, given: Scenario | Loaded | None = None) -> Scenario:
    """The scenario that a scene was built from, which results may name; a given one has to be the same."""
    built = scene.scenario
    if built is None:
        why = "the scene was changed after it was built, so no scenario says what it is"
        raise scene_error("scene", f"{why}; change the scenario with its replace() and build that")
    told = "what the scene was built from; values to change go into load(config, ...)"
    of_type("scenario", given, (Scenario, Loaded, NoneType), told)
    given = given.scenario if isinstance(given, Loaded) else given
    if given is None or given is built or given == built or checked(given) == built:
        return built
    keys = differing_keys(scenario_to_dict(given), scenario_to_dict(built))
    raise scene_error("scenario", f"is not the one that the scene was built from: they differ in {keys}; leave it out")


def uninterrupted(results: Results) -> Results:
    """The same results, for those who make several and want all; raises KeyboardInterrupt where that ended a run."""
    if results.status.code == "interrupted":
        raise KeyboardInterrupt
    return results


def kernels_of(scene: Scene) -> str:
    """What is compiled for a scene, in words: its laws and its kinds of bodies."""
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
    from granular_contact.engines.exudyn.solve import Solve

    if scene.in_space:
        from granular_contact.engines.exudyn.build_in_space import build as build_in_space

        system: System = build_in_space(scene)
    else:
        from granular_contact.engines.exudyn.build import build

        system = build(scene)
    return Begun(Solve(system, progress, pauses=pauses), system.observe, system)


def _by_minimal(scene: Any, progress: Progress | None) -> Begun:
    from granular_contact.engines.tree.solve import Solve

    if scene.in_space:
        from granular_contact.engines.tree.space_tree import tree as tree_in_space

        made: Tree = tree_in_space(scene)
    else:
        from granular_contact.engines.tree.tree import tree

        made = tree(scene)
    return Begun(Solve(made, progress), made.system.observe, made.system)


def _by_modes(scene: Scene, progress: Progress | None) -> Begun:
    from granular_contact.engines.modal.model import model
    from granular_contact.engines.modal.observe import observe
    from granular_contact.engines.modal.solve import Solve

    assert isinstance(scene.method, Reduced)
    reduced = model(scene, scene.method)
    return Begun(Solve(reduced, progress), partial(observe, reduced), None)


_OTHERS = {Minimal: _by_minimal, Reduced: _by_modes}  # than the engine, by their options


def _solved(scene: Scene, progress: Progress | None) -> tuple[Begun, Any]:
    """A solve at its end, with its trajectory."""
    begun = begin(scene, progress)
    begun.solving.advance()
    return begun, begun.solving.trajectory()


def _observed(
    scene: Scene,
    progress: Progress | None,
    inspect: Callable[[System, Trajectory], None] | None,
) -> tuple[Begun, Observation]:
    """Solve to the end, with strips or facets that are chosen by their error."""
    if scene.in_space and any(medium.scatters for medium in scene.media):
        shares, error = _nominal_facets(scene, progress)
        begun, trajectory = _solved(replace(scene, facet_shares=shares), progress)  # type: ignore[call-arg]
        trajectory = replace(trajectory, strip_error=error)
    else:
        begun, trajectory = _chosen(scene, progress)
    if inspect is not None and begun.system is not None:
        inspect(begun.system, trajectory)
    return begun, begun.observe(trajectory)


_NOMINAL: dict[str, Any] = {}  # what was found of the scenario that ran last, for other members of its ensemble


def _nominal_facets(scene: Any, progress: Progress | None) -> Any:
    """Shares of the size of facets, and their error, that are chosen for a scene in space without what scatters.

    Each member of an ensemble would choose others by its own draws, which are no errors of facets.
    """
    key = "" if scene.scenario is None else json.dumps(_unscattered(scenario_to_dict(scene.scenario)), default=str)
    if not key or key not in _NOMINAL:
        begun, trajectory = _chosen(scene.without_scatter(), progress)
        _NOMINAL.clear()
        _NOMINAL[key] = begun.system.scene.facet_shares, trajectory.strip_error  # type: ignore[union-attr]
        begun.solving.close()
    return _NOMINAL[key]


def _unscattered(tree: Any) -> Any:
    """A scenario as a tree, without what scatters."""
    if isinstance(tree, dict):
        return {key: _unscattered(value) for key, value in tree.items() if key != "scatter"}
    return [_unscattered(one) for one in tree] if isinstance(tree, (list, tuple)) else tree


def _chosen(scene: Scene, progress: Progress | None) -> tuple[Begun, Any]:
    """A solve at its end; solved again with smaller strips or facets where they are to be chosen by their error."""
    begun, trajectory = _solved(scene, progress)
    if begun.system is None or trajectory.load is None:
        return begun, trajectory
    from granular_contact.mechanics.strip_error import errors, finer, way

    spent, before, coarser = trajectory.cost.solve_s, None, None
    while begun.system:
        motion = begun.system.kinematics(trajectory)
        found = errors(motion, coarser=coarser)
        trajectory = replace(trajectory, strip_error=max(found.values(), default=0.0))
        shorter = finer(motion, found, before, coarser is not None)
        if shorter is None:
            break
        # An estimate from one run is no measure for one that two runs tell.
        before = None if scene.in_space and coarser is None else found
        coarser = way(motion, found)
        again, longer = _solved(shorter, progress)
        spent += longer.cost.solve_s
        if scene.in_space and longer.status.code in ("time_limit", "failed"):
            again.solving.close()
            break  # what ended is kept, with the warning of its error
        begun.solving.close()
        begun, trajectory = again, longer
    return begun, replace(trajectory, cost=replace(trajectory.cost, solve_s=spent))
