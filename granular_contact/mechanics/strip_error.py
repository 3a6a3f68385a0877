"""Strips and facets that are too large: the error of a run by them, a warning, a scene with smaller ones.

It is estimated by `strip_departure`, in space by `space.facet_departure`. Steps of a run with `solver.accuracy` are
chosen so that positions are as exact. So are its strips and facets: where they are off by more, the scene is solved
once more with smaller ones, to the end, unless they are small enough already. In space that holds without an accuracy,
too, for an error of `FACET_ERROR`, as the size of facets follows from it; unless the config gives sizes.
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

ERROR = 5e-3  # of the distance, that is reported
DOUBTFUL = 0.1  # of what is allowed: where a first estimate is above it, it is made more exact
SAFE = 3.0  # errors near what is asked for are up to four times the estimate
SAFE_IN_SPACE, DOUBTFUL_IN_SPACE = 1.2, 0.5  # the same of facets
LEAST_SHARE, LEAST_BY_DEFAULT = 1.0 / 8.0, 1.0 / 4.0  # of the size of facets; the latter where no accuracy is asked for
# That are taken: a few, so that round-off of an estimate changes no facets. After one run the first: in the difference
# of two the errors of steps count the less, the farther the facets are apart.
STEPS = 0.5, 0.35, 0.25
MOST = 128, 32  # strips of a rigid part and of an element, to which they are chosen
WHOLE = "all"  # of a scene in the plane, whose strips are chosen together
Errors = dict[str, float]
STALLED = 0.8  # part of the error before that is left where it is not of the strips; by theirs of first order 2/3 is


def way(observer: Kinematics, found: Errors) -> Any:
    """What `errors` needs of a run in space that is repeated; found: its errors."""
    if not observer.scene.in_space:
        return None
    from granular_contact.mechanics.space import facet_departure

    return facet_departure.track(observer, found)


def strip_error(observer: Kinematics, allowed: float | None = None) -> float:
    """The greatest of `errors`; as it was found of a run that was estimated before."""
    known = observer.trajectory.strip_error
    return max(errors(observer, allowed).values(), default=0.0) if known is None else known


def errors(observer: Kinematics, allowed: float | None = None, coarser: Any = None) -> Errors:
    """Estimated error of positions by the strips, as a part of the distance that the fastest point travels.

    In space of each mechanism, by the name of its first body. allowed: by default what the steps are asked for, or
    `ERROR`. Where it is far below that it is less exact. coarser: in space the way of the same run with larger facets.
    """
    t, scene = observer.trajectory, observer.scene
    if t.load is None or len(t.time) < 3 or not (t.load.depth > 0.0).any():
        return {}
    if scene.in_space:
        from granular_contact.mechanics.space import facet_departure

        return facet_departure.errors(observer, DOUBTFUL_IN_SPACE * (allowed or asked(scene) or ERROR), coarser)
    from granular_contact.mechanics.strip_departure import estimate  # here, as the compiler comes with it

    return {WHOLE: estimate(observer, DOUBTFUL * (allowed or scene.solver.accuracy or ERROR))}


def finer(observer: Kinematics, found: Errors, before: Errors | None = None, by_two: bool = False) -> Scene | None:
    """The scene with smaller strips or facets, where these are off by more than is allowed.

    found: their errors, see `errors`; before: those with the strips before; where nearly as much is left, it is not of
    the strips. by_two: whether two runs tell them.
    """
    scene = observer.scene
    accuracy, t = asked(scene), observer.trajectory
    if accuracy is None or t.status.code not in FINISHED:
        return None
    # Each strip longer than a grain has a draw of its own: other strips would be another sand of the same kind, and a
    # seed no motion that finer steps converge to. Facets in space are chosen once for all draws, see `run`.
    if any(medium.scatters for medium in scene.media):
        return None
    safe = SAFE_IN_SPACE if scene.in_space else SAFE
    stalled = {name: STALLED * error for name, error in (before or {}).items()}
    able = {name: error for name, error in found.items() if not error > stalled.get(name, math.inf)}
    large = {name: safe * error / accuracy for name, error in able.items() if safe * error > accuracy}
    smaller = _smaller(scene, large, by_two) if large else {}
    if smaller == {}:
        return None
    left = None if scene.solver.max_wall_s is None else max(1e-3, scene.solver.max_wall_s - t.cost.solve_s)
    return replace(scene, **smaller, solver=scene.solver.model_copy(update={"max_wall_s": left}))


def asked(scene: Any) -> float | None:
    """The error that strips or facets are chosen for, as a part of the distance travelled."""
    named: float | None = scene.solver.accuracy
    if not scene.in_space or scene.solver.named is not None:
        return named
    from granular_contact.sand.space.facets import FACET_ERROR

    return None if any(part.facet_size for body in scene.rigid for part in body.parts) else FACET_ERROR


def _smaller(scene: Any, factors: dict[str, float], by_two: bool) -> dict[str, Any]:
    """What of a scene changes for errors smaller by these factors; nothing where it is as small as can be."""
    if scene.in_space:
        return _smaller_facets(scene, factors, by_two)
    load = shorter(scene.load, max(factors.values()))
    return {"load": load} if load != scene.load else {}


def _smaller_facets(scene: Any, factors: dict[str, float], by_two: bool) -> dict[str, Any]:
    """The same in space, by mechanism; by_two: whether two runs tell the errors."""
    from granular_contact.mechanics.space.facet_departure import ORDER

    least = LEAST_BY_DEFAULT if scene.solver.named is None else LEAST_SHARE
    steps = STEPS if by_two else STEPS[:1]
    shares = dict(scene.facet_shares)
    for body, of in scene.mechanisms.items():
        if of in factors:
            step = next((one for one in steps if one**ORDER * factors[of] < 1.0), steps[-1])
            shares[body] = max(least, shares.get(body, 1.0) * step)
    return {"facet_shares": shares} if shares != scene.facet_shares else {}


def shorter(load: Load, factor: float) -> Load:
    """Strips with which an error of second order is smaller by twice a factor."""
    more = math.sqrt(2.0 * max(1.0, factor))
    parts, elements = load.strips_per_rigid_part, load.strips_per_element
    finer = {
        "strips_per_rigid_part": max(parts, min(MOST[0], math.ceil(more * parts / 8) * 8)),
        "strips_per_element": max(elements, min(MOST[1], math.ceil(more * elements / 2) * 2)),
    }
    return load.model_copy(update=finer)


def strip_warnings(observer: Kinematics) -> Iterator[AccuracyWarning]:
    """A sentence where the strips are too long, or the facets too large."""
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
    load, now = shorter(scene.load, error / allowed), scene.load
    keys = [f"load.strips_per_rigid_part: {load.strips_per_rigid_part} (now {now.strips_per_rigid_part})"]
    if observer.system.links:
        keys.append(f"load.strips_per_element: {load.strips_per_element} (now {now.strips_per_element})")
    yield AccuracyWarning(
        f"the strips on which the medium acts are too long: the error of the motion is about {error:.1%} of its "
        f"path; take {' and '.join(keys)}",
        error,
    )
