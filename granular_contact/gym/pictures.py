"""One picture of a simulation, as of the frames of an animation."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from granular_contact.report.figures.animation import still
from granular_contact.results import Results, Snapshot
from granular_contact.results.observation import surface
from granular_contact.simulation import Simulation

WIDE = 2.5  # times the length of the mechanism is what a picture shows


def picture(simulation: Simulation) -> NDArray[np.uint8]:
    """A picture (height, width, 3) of the present state; the view goes along with the mechanism."""
    scene, outlines = simulation.scene, simulation.outlines()
    now = Results(
        name=scene.name,
        status=simulation.ended or simulation.standing,
        columns=(),
        table=np.zeros((0, 0)),
        summary={},
        scenario={},
        snapshots=(),
        surface=surface(scene),
        frames=(Snapshot("frame", simulation.time, outlines),),
    )
    return still(now, WIDE * scene.length)
