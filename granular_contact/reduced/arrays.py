"""Model -> PendulumArrays: records and stations as the kernels read them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from granular_contact.kernels import modal_calls, modal_motion, slip
from granular_contact.kernels.forces import medium_record
from granular_contact.kernels.law import LAW, LINE
from granular_contact.kernels.modal import MODAL_STATION
from granular_contact.kernels.modal_load import PendulumArrays
from granular_contact.kernels.pendulum import PENDULUM
from granular_contact.laws.static_friction import Elastoplastic
from granular_contact.reduced.model import Bar, Model

# The true sign is aimed, not computed from a bristle: see `kernels.modal_load`.
AIMED = Elastoplastic(yield_displacement=1.0, damping_time=0.0)
STILL = 1e-10  # what counts as no speed, of the speed of the scene
STRETCH = 1.02  # a bent link may reach a little farther than a straight one


def arrays_of(reduced: Model) -> PendulumArrays:
    """Mass properties, and stations, lines and medium of all that can reach the surface."""
    scene = reduced.scene
    pairs = zip(reduced.bars, reduced.stations, strict=True)
    met = [(bar, stations) for bar, stations in pairs if _reaches(reduced, bar)]
    starts = np.cumsum([0, *(len(stations) for _, stations in met)])
    geometry, lines = np.zeros(starts[-1], MODAL_STATION), np.zeros(len(met), LINE)
    for i, (bar, stations) in enumerate(met):
        geometry[starts[i] : starts[i + 1]] = stations
        line = lines[i]
        line["width"], line["cap"] = bar.diameter, scene.load.end_cap and bar.free
        line["resultant"] = scene.load.form == "resultant"
    record = _pendulum(reduced)
    record["true_sign"] = reduced.method.static == "true_sign" and len(lines) > 0
    parts = {"rates": modal_motion.rates}
    if record["true_sign"]:
        parts |= {"margins": modal_motion.margins, "hold": slip.hold}
    modal_calls.provide(record, parts)
    static = AIMED if reduced.method.static == "true_sign" else scene.static
    medium = np.zeros(1, LAW)
    if scene.media:
        own = scene.media[0].record(static, scene.gravity)
        medium = medium_record(own, lines, paths=False, bodies=False)
    profile = np.array([[0.0, -np.inf if scene.surface is None else scene.surface]])
    anchors, most = np.zeros((starts[-1], 2)), max((len(stations) for _, stations in met), default=0)
    room, depths = np.zeros((6, most, 2)), np.zeros(most)
    return PendulumArrays(record, geometry, starts, lines, profile, medium, anchors, room, depths)


def _pendulum(reduced: Model) -> NDArray[np.void]:
    """Inertia, static moments, stiffness and damping ."""
    record = np.zeros(1, PENDULUM)
    n = reduced.method.modes
    root = reduced.scene.rigid[0]
    center = reduced.view.of(root, np.zeros(2))
    record["modes"], record["g"], record["still"] = n, reduced.scene.gravity, STILL * reduced.speed
    record["J"] = root.inertia + root.mass * float(center @ center)
    record["S_e"], record["S_n"] = root.mass * center
    link = reduced.link
    if link is None:
        return record
    a, b = reduced.bars[-1].start
    middle = a + 0.5 * link.length
    # The engine's beam has no rotary inertia of its section; its rigid bar has.
    section = 0.0 if n else link.thickness**2 / 16.0
    record["J"] += link.mass * (middle**2 + b**2 + link.length**2 / 12.0 + section)
    record["S_e"] += link.mass * middle
    record["S_n"] += link.mass * b
    record["b"], record["m"] = b, 0.25 * link.mass
    mean, first, bending = reduced.modes.mean(), reduced.modes.first_moment(), reduced.modes.bending()
    record["p"][0, :n] = link.mass * mean
    record["c"][0, :n] = link.mass * (a * mean + link.length * first)
    record["k"][0, :n] = link.bending_stiffness * bending
    record["d"][0, :n] = link.bending_damping * bending
    return record


def _reaches(reduced: Model, bar: Bar) -> bool:
    """Whether a part can get below the surface, however the pendulum turns and its link bends."""
    scene = reduced.scene
    if not scene.media:
        return False
    reach = max(float(np.linalg.norm(bar.start)), float(np.linalg.norm(bar.end)))
    return bool(reduced.view.pivot[1] - STRETCH * reach < scene.surface)
