"""What makes the answer of a finished solve doubtful, from its own steps, and what to change.

Each sentence says what was measured on the trajectory. Silence is no proof: a run whose steps miss an event altogether
has nothing of it in its states. What a run left (depth, speed, floor) is found in `granular_contact.limits`, the energy
balance in `granular_contact.summary`.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from granular_contact.multibody.observe import Observer
from granular_contact.multibody.recorder import levers
from granular_contact.scene.types import Vector

STEP_ERROR = 5e-3  # of the way
FEW = 8  # steps from the touch to the stop
TURN = 0.5  # rad, of one element
ROUGH = 0.5  # mean square of second over first differences: at 6 steps a period both are as large
TREMBLE = 1e-3  # of a link's length
EXCESS = 1.0 / 9.0  # |beta - 1/6| at a spectral radius of 0.9, see `stepping`


def doubts(observer: Observer) -> Iterator[str]:
    """Sentences on steps, beams and vibration."""
    if len(observer.trajectory.time) < 4:
        return
    yield from _steps(observer)
    yield from _entry(observer)
    for name in observer.system.links:
        yield from _beam(observer, name)
        yield from _vibration(observer, name)


def step_error(time: Vector, speeds: Vector) -> float:
    """Estimated error of positions over their way, as in `stepping`; time (n,) s, speeds (n, k) m/s of points."""
    steps = np.diff(time)
    acceleration = np.diff(speeds, axis=0) / steps[:, None]
    change = np.abs(np.diff(acceleration, axis=0)).max(axis=1)
    way = float(np.sum(steps * np.abs(speeds).max(axis=1)[1:]))
    return EXCESS * float(np.sum(steps[1:] ** 2 * change)) / way if way > 0.0 else 0.0


def _steps(observer: Observer) -> Iterator[str]:
    lever = levers(observer.system)
    time, v = observer.trajectory.time, observer.trajectory.v
    if observer.trajectory.load is not None:
        # Only what meets the medium, or a short impact would drown in a long flight.
        met = observer.trajectory.load.depth > 0.0
        first = int(np.argmax(met)) if met.any() else 0
        time, v = time[max(0, first - 1) :], v[max(0, first - 1) :]
    if len(time) < 4:
        return
    error = step_error(time, (v * lever)[:, lever > 0.0])
    if error > STEP_ERROR:
        yield f"the steps are too long: they put the motion off by about {error:.1%} of its way; {_remedy(observer)}"


def _entry(observer: Observer) -> Iterator[str]:
    """Whether the first touch was passed over in a few steps."""
    load = observer.trajectory.load
    if load is None:
        return
    below = np.flatnonzero(load.depth > 0.0)
    if len(below) == 0 or below[-1] == below[0]:
        return
    first = int(below[0])
    deepest = int(first + np.argmax(load.depth[first:]))
    if deepest - first + 1 < FEW and load.depth[first] > 0.0 and first > 0:
        yield f"from the touch to the deepest point there are {deepest - first + 1} steps; {_remedy(observer)}"


def _beam(observer: Observer, name: str) -> Iterator[str]:
    nodes = np.array(observer.nodes(name))
    slopes = observer.trajectory.q[:, nodes[:, 2:]]
    a, b = slopes[:, :-1], slopes[:, 1:]
    turn = np.arctan2(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0], np.sum(a * b, axis=2))
    worst = float(np.abs(turn).max())
    if worst > TURN:
        elements = len(nodes) - 1
        wanted = int(np.ceil(elements * worst / (0.5 * TURN)))
        yield (
            f"an element of {name} bends by {np.degrees(worst):.0f} degrees, too much for one: take "
            f"model.bodies.{name}.flexible.elements: {wanted} (now {elements})"
        )


def _vibration(observer: Observer, name: str) -> Iterator[str]:
    bend = observer.bend(name)
    first, second = np.diff(bend), np.diff(bend, 2)
    size = float(np.sqrt(np.mean(first**2)))
    if size < TREMBLE * observer.system.links[name].link.length:
        return
    rough = float(np.sqrt(np.mean(second**2))) / (2.0 * size)
    if rough > ROUGH:
        yield f"{name} vibrates faster than the steps can show; {_remedy(observer)}"


def _remedy(observer: Observer) -> str:
    solver = observer.scene.solver
    if solver.accuracy is not None:
        return f"take a smaller solver.accuracy (now {solver.accuracy:g})"
    return f"take a smaller solver.step_s (now {solver.step:g}) or solver.accuracy: 1e-3"
