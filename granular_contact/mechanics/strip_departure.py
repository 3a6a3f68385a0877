"""What a motion in the plane departs by with strips of another length, and the error that this stands for.

Forces converge with the square of the strip: a motion is off by a third of what it departs by with strips joined in
pairs, and by four thirds of what it departs by with strips of half the length. Where strips are far too long either may
be a tenth of the error or less, rarely both (`validation/strip_estimates.py`). The departure: `mechanics.departure`.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from granular_contact.mechanics.departure import Flat, Instant, departures, pieces
from granular_contact.mechanics.freedoms import freedoms
from granular_contact.mechanics.kinematics import Kinematics
from granular_contact.sand.contact_lines import ELEMENTS_PER_LINE, Body, ContactLine, beam, coarser
from granular_contact.sand.from_scene import lines_from_shape, load_from_scene, section_size
from granular_contact.sand.load import GranularLoad
from granular_contact.scene.workspace import immersible, immersible_elements

OF_JOINED, OF_HALVED = 1.0 / 3.0, 4.0 / 3.0
GLANCE, LOOK = 24, 160  # of the motion at which its departure is followed: a glance, and a look


def estimate(observer: Kinematics, doubtful: float) -> float:
    """Estimated error of positions, as a part of the distance that the fastest point travels.

    A glance at few instants, and where that finds more than what is doubtful a look at more of them.
    """
    own, halved = _load(observer), _load(observer, 2)
    error = OF_HALVED * float(departures(observer, _motion(observer, GLANCE), own, [halved], Flat()).max())
    if error > doubtful:
        joined = _of_lines(observer, [coarser(line) for line in own.lines])
        of_halved, of_joined = departures(observer, _motion(observer, LOOK), own, [halved, joined], Flat())
        error = max(OF_HALVED * float(of_halved.max()), OF_JOINED * float(of_joined.max()))
    return error


def _motion(observer: Kinematics, count: int) -> Iterator[Instant]:
    """The motion at so many of its instants."""
    for t in pieces(observer, observer.trajectory, count):
        free = freedoms(type(observer)(observer.system, t))
        for i, time in enumerate(t.time.tolist()):
            yield Instant(time, t.q[i], t.v[i], free.W[i], t.mass, free.K[i], free.D[i])


def _load(observer: Kinematics, split: int = 1) -> GranularLoad:
    """A load on the coordinates of a trajectory, each strip divided into so many."""
    scene, system = observer.scene, observer.system
    assert scene.bed is not None
    strips, whole = scene.load, scene.load.form == "resultant"
    lines: list[ContactLine] = []
    for body, shape in immersible(scene.bed, scene.rigid):
        on = Body(body.name, system.places(body.name, np.zeros(2)))
        lines += lines_from_shape(on, shape, strips.strips_per_rigid_part, split)
    for name, handle in system.links.items():
        link, nodes = handle.link, np.array(observer.nodes(name), np.int64)
        reaching = immersible_elements(scene.bed, link)
        lines += beam(
            name,
            nodes[reaching.start : reaching.stop + 1],
            [link.length / link.elements] * len(reaching),
            strips_per_element=split * strips.strips_per_element,
            free_end=link.free,
            elements_per_line=link.elements if whole else ELEMENTS_PER_LINE,
            **section_size(link),
        )
    return _of_lines(observer, lines)


def _of_lines(observer: Kinematics, lines: list[ContactLine]) -> GranularLoad:
    """A load on lines, without what scatters: each strip has a draw of its own."""
    load = load_from_scene(observer.scene)
    load.add(lines)
    load.close()
    for batch in load.batches:
        batch.records["scatter"] = 0.0
    return load
