"""Model -> PendulumArrays: records and stations as the kernels read them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from granular_contact.engines.modal.kernels import modal_calls, modal_motion, slip
from granular_contact.engines.modal.kernels.modal import MODAL_STATION
from granular_contact.engines.modal.kernels.modal_load import PendulumArrays
from granular_contact.engines.modal.model import Model
from granular_contact.laws.static_friction import Elastoplastic
from granular_contact.sand.kernels.forces import medium_record
from granular_contact.sand.kernels.law import LAW, LINE

# The true sign is aimed, not computed from a bristle: see `kernels.modal_load`.
AIMED = Elastoplastic(yield_displacement=1.0, damping_time=0.0)
STILL = 1e-10  # speed that counts as none, as a share of the speed of the scene


def arrays_of(reduced: Model) -> PendulumArrays:
    """Mass properties of a model, and the stations, lines and medium of the bars that can reach the surface."""
    scene = reduced.scene
    meets = [(reduced.bars[i], reduced.stations[i]) for i in reduced.met]
    starts = np.cumsum([0, *(len(stations) for _, stations in meets)])
    geometry, lines = np.zeros(starts[-1], MODAL_STATION), np.zeros(len(meets), LINE)
    for i, (bar, stations) in enumerate(meets):
        geometry[starts[i] : starts[i + 1]] = stations
        line = lines[i]
        line["width"], line["cap"] = bar.diameter, scene.load.end_cap and bar.free
        line["resultant"] = scene.load.form == "resultant"
    record = _pendulum(reduced)
    record["true_sign"] = reduced.method.static == "true_sign" and len(lines) > 0
    parts = {"rates": modal_motion.rates}
    if record["true_sign"]:
        parts |= {"margins": modal_motion.margins, "hold": slip.hold if reduced.method.modes else slip.hold_rigid}
    modal_calls.provide(record, parts)
    medium = np.zeros(1, LAW)
    if scene.media:
        medium = medium_record(_law(reduced), lines, paths=False, bodies=False)
    profile = np.array([[0.0, -np.inf if scene.surface is None else scene.surface]])
    anchors, most = np.zeros((starts[-1], 2)), max((len(stations) for _, stations in meets), default=0)
    return PendulumArrays(record, geometry, starts, lines, profile, medium, anchors, np.zeros((6, most, 2)))


def stacked(several: Sequence[Model]) -> PendulumArrays:
    """Arrays of models of equal array sizes, in the form that `kernels.march` takes for several runs."""
    like, count = several[0], len(several)
    first = arrays_of(like)
    if not all(_differs_in_numbers(like, other) for other in several):
        return joined([alone(first), *(alone(arrays_of(other)) for other in several[1:])])
    made = first._replace(**{name: np.repeat(getattr(alone(first), name), count, axis=0) for name in _OF_A_RUN})
    made.pendulum["still"] = [STILL * reduced.speed for reduced in several]
    made.profile[:, 0, 1] = [-np.inf if reduced.scene.surface is None else reduced.scene.surface for reduced in several]
    if like.scene.media:
        laws = np.concatenate([_law(reduced) for reduced in several])
        numbers = made.medium["own"].view(np.uint8)
        numbers[:, : laws.itemsize] = laws.view(np.uint8).reshape(count, laws.itemsize)
    return made


def _differs_in_numbers(like: Model, other: Model) -> bool:
    """Whether two models share their parts, their static law and the law of the medium, so that only numbers differ."""
    same_law = list(map(type, like.scene.media)) == list(map(type, other.scene.media))
    alike = like.mechanics is other.mechanics and same_law
    return alike and like.scene.static == other.scene.static and like.met == other.met


def _law(reduced: Model) -> NDArray[np.void]:
    """Record (1,) of the law of the medium."""
    static = AIMED if reduced.method.static == "true_sign" else reduced.scene.static
    return reduced.scene.media[0].record(static, reduced.scene.gravity)


# Arrays that each run has of its own; runs share all others.
_OF_A_RUN = ("pendulum", "geometry", "lines", "profile", "medium", "anchors")


def alone(w: PendulumArrays) -> PendulumArrays:
    """Arrays of one run, in the form that `kernels.march` takes for several runs."""
    return w._replace(**{name: getattr(w, name)[None] for name in ("geometry", "lines", "profile", "anchors")})


def one_of(w: PendulumArrays, i: int) -> PendulumArrays:
    """Arrays of the i-th of several runs."""
    own = {name: getattr(w, name)[i] for name in ("geometry", "lines", "profile", "anchors")}
    return w._replace(pendulum=w.pendulum[i : i + 1], medium=w.medium[i : i + 1], **own)


def joined(several: Sequence[PendulumArrays]) -> PendulumArrays:
    """Arrays of several runs, from arrays of single runs with a first axis; the first run gives shared arrays."""
    made = {name: np.concatenate([getattr(arrays, name) for arrays in several]) for name in _OF_A_RUN}
    return several[0]._replace(**made)


def _pendulum(reduced: Model) -> NDArray[np.void]:
    """Record (1,) of PENDULUM: mass, stiffness and damping of a model, and the speed that counts as none."""
    record = reduced.mechanics.copy()
    record["still"] = STILL * reduced.speed
    return record
