"""A posteriori control of strips and facets: their error in a run, a warning, and a scene with smaller ones.

`strip_departure` estimates the error in the plane, `space.facet_departure` in space. With `solver.accuracy` strips and
facets have to meet the accuracy as steps do: where their error is larger, the whole run is repeated with smaller ones,
unless they are at their least size already. In space this holds without an accuracy too, for an error of `FACET_ERROR`,
by which the size of facets is chosen, unless the config gives sizes.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from granular_contact.mechanics.kinematics import Kinematics
from granular_contact.results import FINISHED
from granular_contact.results.accuracy import AccuracyWarning
from granular_contact.scene.types import Load, Scene

ERROR = 5e-3  # of the path, from which a warning is given
DOUBTFUL = 0.1  # of the allowed error: a first estimate above it is made more exact
SAFE = 3.0  # safety factor: errors near the allowed one are up to four times the estimate
SAFE_IN_SPACE, DOUBTFUL_IN_SPACE = 1.2, 0.5  # the same for facets
LEAST_SHARE, LEAST_BY_DEFAULT = 1.0 / 8.0, 1.0 / 4.0  # of the size of facets; the latter without an accuracy
# Ratios of the size of new facets to the old: only a few, so that the round-off of an estimate changes no facets. After
# one run the first is used: the more two runs differ in their facets, the less the errors of steps count between them.
STEPS = 0.5, 0.35, 0.25
MOST = 128, 32  # greatest number of strips of a rigid part and of an element
WHOLE = "all"  # key of a scene in the plane, whose strips are chosen together
Errors = dict[str, float]
STALLED = 0.8  # ratio of two successive errors above which strips are not the cause; their first-order error leaves 2/3


def run_track(observer: Kinematics, estimated: Errors) -> Any:
    """Track of a run in space, for `errors` of its repetition, None in the plane; estimated: errors of the run."""
    if not observer.scene.in_space:
        return None
    from granular_contact.mechanics.space import facet_departure

    return facet_departure.track(observer, estimated)


def strip_error(observer: Kinematics, allowed: float | None = None) -> float:
    """Greatest of `errors`; the value in the trajectory, if it was estimated before."""
    known = observer.trajectory.strip_error
    return max(errors(observer, allowed).values(), default=0.0) if known is None else known


def errors(observer: Kinematics, allowed: float | None = None, coarser: Any = None) -> Errors:
    """Estimated error of positions by strips or facets, over the path of the fastest point.

    In space of each mechanism, by the name of its first body. allowed: by default the accuracy, or `ERROR`; an error
    far below it is estimated less exactly. coarser: in space the `run_track` of the same run with larger facets.
    """
    t, scene = observer.trajectory, observer.scene
    if t.load is None or len(t.time) < 3 or not (t.load.depth > 0.0).any():
        return {}
    if scene.in_space:
        from granular_contact.mechanics.space import facet_departure

        return facet_departure.errors(observer, DOUBTFUL_IN_SPACE * (allowed or allowed_error(scene) or ERROR), coarser)
    from granular_contact.mechanics.strip_departure import estimate  # here, as the compiler comes with it

    return {WHOLE: estimate(observer, DOUBTFUL * (allowed or scene.solver.accuracy or ERROR))}


def finer(observer: Kinematics, estimated: Errors, before: Errors | None = None, by_two: bool = False) -> Scene | None:
    """Scene with smaller strips or facets where their error exceeds the allowed one; None if it does not.

    estimated: their `errors`; before: the errors with the former strips. Errors that have hardly decreased since are
    left alone, as strips are not their cause. by_two: whether the errors follow from two runs.
    """
    scene = observer.scene
    accuracy, t = allowed_error(scene), observer.trajectory
    if accuracy is None or t.status.code not in FINISHED:
        return None
    # Each strip longer than a grain has a random draw of its own. Other strips would be another sand of the same kind,
    # so the motion of a seed would not converge. Facets in space are chosen once for all draws, see `run`.
    if any(medium.scatters for medium in scene.media):
        return None
    safe = SAFE_IN_SPACE if scene.in_space else SAFE
    stalled = {name: STALLED * error for name, error in (before or {}).items()}
    decreasing = {name: error for name, error in estimated.items() if not error > stalled.get(name, math.inf)}
    excess = {name: safe * error / accuracy for name, error in decreasing.items() if safe * error > accuracy}
    changes = _smaller(scene, excess, by_two) if excess else {}
    if changes == {}:
        return None
    wall_s = None if scene.solver.max_wall_s is None else max(1e-3, scene.solver.max_wall_s - t.cost.solve_s)
    return replace(scene, **changes, solver=scene.solver.model_copy(update={"max_wall_s": wall_s}))


def allowed_error(scene: Any) -> float | None:
    """Error over the path for which strips or facets are chosen; None where they are not."""
    accuracy: float | None = scene.solver.accuracy
    if not scene.in_space or scene.solver.named is not None:
        return accuracy
    from granular_contact.sand.space.facets import FACET_ERROR

    return None if any(part.facet_size for body in scene.rigid for part in body.parts) else FACET_ERROR


def _smaller(scene: Any, factors: dict[str, float], by_two: bool) -> dict[str, Any]:
    """Changed fields of a scene that reduce errors by these factors; empty at the least size."""
    if scene.in_space:
        return _smaller_facets(scene, factors, by_two)
    load = shorter(scene.load, max(factors.values()))
    return {"load": load} if load != scene.load else {}


def _smaller_facets(scene: Any, factors: dict[str, float], by_two: bool) -> dict[str, Any]:
    """As `_smaller` in space; factors: by mechanism; by_two: whether the errors follow from two runs."""
    from granular_contact.mechanics.space.facet_departure import ORDER

    least = LEAST_BY_DEFAULT if scene.solver.named is None else LEAST_SHARE
    steps = STEPS if by_two else STEPS[:1]
    shares = dict(scene.facet_shares)
    for body, mechanism in scene.mechanisms.items():
        if mechanism in factors:
            step = next((ratio for ratio in steps if ratio**ORDER * factors[mechanism] < 1.0), steps[-1])
            shares[body] = max(least, shares.get(body, 1.0) * step)
    return {"facet_shares": shares} if shares != scene.facet_shares else {}


def shorter(load: Load, factor: float) -> Load:
    """Load with more strips, so that an error of second order is reduced by twice a factor."""
    ratio = math.sqrt(2.0 * max(1.0, factor))
    parts, elements = load.strips_per_rigid_part, load.strips_per_element
    finer = {
        "strips_per_rigid_part": max(parts, min(MOST[0], math.ceil(ratio * parts / 8) * 8)),
        "strips_per_element": max(elements, min(MOST[1], math.ceil(ratio * elements / 2) * 2)),
    }
    return load.model_copy(update=finer)


def strip_warnings(observer: Kinematics) -> Iterator[AccuracyWarning]:
    """Yield a sentence if the strips are too long or the facets too large."""
    scene = observer.scene
    allowed = max(ERROR, scene.solver.accuracy or 0.0)
    if not (error := strip_error(observer)) > allowed:
        return
    if scene.in_space:
        share = math.sqrt(allowed / (SAFE_IN_SPACE * error))
        yield AccuracyWarning(
            f"the facets on which the medium acts are too large: the error of the motion is about {error:.1%} of its "
            f"path; take facet_size_m of its shapes and links, {share:.2g} times their edges (facets in summary.json)",
            error,
        )
        return
    load, present = shorter(scene.load, error / allowed), scene.load
    keys = [f"load.strips_per_rigid_part: {load.strips_per_rigid_part} (now {present.strips_per_rigid_part})"]
    if observer.system.links:
        keys.append(f"load.strips_per_element: {load.strips_per_element} (now {present.strips_per_element})")
    yield AccuracyWarning(
        f"the strips on which the medium acts are too long: the error of the motion is about {error:.1%} of its "
        f"path; take {' and '.join(keys)}",
        error,
    )
