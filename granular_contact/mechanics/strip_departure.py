"""Discretisation error of a motion in the plane by its strips: Richardson extrapolation of a departure.

The departure of the motion with strips of another length is computed by `mechanics.departure`. Forces converge with
the square of the strip length: the error is a third of the departure with strips joined in pairs, and four thirds of
the departure with strips of half the length. Where strips are far too long, either estimate may be a tenth of the error
or less, rarely both (`validation/strip_estimates.py`).
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from granular_contact.mechanics.departure import Instant, PlanarCoordinates, departures, pieces
from granular_contact.mechanics.freedoms import freedoms
from granular_contact.mechanics.kinematics import Kinematics
from granular_contact.sand.contact_lines import ELEMENTS_PER_LINE, Body, ContactLine, beam, coarser
from granular_contact.sand.from_scene import lines_from_shape, load_from_scene, section_size
from granular_contact.sand.load import GranularLoad
from granular_contact.scene.workspace import immersible, immersible_elements

OF_JOINED, OF_HALVED = 1.0 / 3.0, 4.0 / 3.0
GLANCE, LOOK = 24, 160  # number of instants of the first estimate, and of the more exact one


def estimate(observer: Kinematics, doubtful: float) -> float:
    """Estimated error of positions, over the path of the fastest point.

    First from few instants; where that estimate is above `doubtful`, from more instants.
    """
    own, halved = _load(observer), _load(observer, 2)
    first = departures(observer, _motion(observer, GLANCE), own, [halved], PlanarCoordinates())
    error = OF_HALVED * float(first.max())
    if error > doubtful:
        joined = _load_of_lines(observer, [coarser(line) for line in own.lines])
        with_halved, with_joined = departures(
            observer, _motion(observer, LOOK), own, [halved, joined], PlanarCoordinates()
        )
        error = max(OF_HALVED * float(with_halved.max()), OF_JOINED * float(with_joined.max()))
    return error


def _motion(observer: Kinematics, count: int) -> Iterator[Instant]:
    """Yield the motion at `count` instants, with its degrees of freedom."""
    for t in pieces(observer, observer.trajectory, count):
        free = freedoms(type(observer)(observer.system, t))
        for i, time in enumerate(t.time.tolist()):
            yield Instant(time, t.q[i], t.v[i], free.W[i], t.mass, free.K[i], free.D[i])


def _load(observer: Kinematics, split: int = 1) -> GranularLoad:
    """Load on the coordinates of a trajectory, with each strip divided into `split` strips."""
    scene, system = observer.scene, observer.system
    assert scene.bed is not None
    strips, whole = scene.load, scene.load.form == "resultant"
    lines: list[ContactLine] = []
    for body, shape in immersible(scene.bed, scene.rigid):
        on_body = Body(body.name, system.places(body.name, np.zeros(2)))
        lines += lines_from_shape(on_body, shape, strips.strips_per_rigid_part, split)
    for name, handle in system.links.items():
        link, nodes = handle.link, np.array(observer.nodes(name), np.int64)
        elements = immersible_elements(scene.bed, link)
        lines += beam(
            name,
            nodes[elements.start : elements.stop + 1],
            [link.length / link.elements] * len(elements),
            strips_per_element=split * strips.strips_per_element,
            free_end=link.free,
            elements_per_line=link.elements if whole else ELEMENTS_PER_LINE,
            **section_size(link),
        )
    return _load_of_lines(observer, lines)


def _load_of_lines(observer: Kinematics, lines: list[ContactLine]) -> GranularLoad:
    """Load on contact lines, without scatter: each strip would have a random draw of its own."""
    load = load_from_scene(observer.scene)
    load.add(lines)
    load.close()
    for batch in load.batches:
        batch.records["scatter"] = 0.0
    return load
