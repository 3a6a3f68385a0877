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
ROUGH_BEAM = 0.05  # of the way: jumps of curvature times the square of an element; positions are off by less
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
    """Whether a link bends within single elements: what cubics miss shows as jumps of curvature from one to the next.

    At a free end the curvature jumps to zero. A jump over elements of length l puts positions off by some part of its
    l^2; in 35 beams of 1 to 16 elements, EI from 1e-6 to 1 times the source's, it was a sixteenth to one.
    """
    t, link = observer.trajectory, observer.system.links[name].link
    nodes = np.array(observer.nodes(name))
    elements, length = len(nodes) - 1, link.length / (len(nodes) - 1)
    first, last = curvatures(t.q[:, nodes], length)
    jump = np.abs(first[:, 1:] - last[:, :-1]).sum(axis=1)
    if link.free:
        jump = np.maximum(jump, np.abs(last[:, -1]))
    lever = levers(observer.system)
    way = float(np.sum(np.diff(t.time) * np.abs(t.v * lever).max(axis=1)[1:]))
    size = float(jump.max()) * length**2
    if way > 0.0 and size > ROUGH_BEAM * way:
        more = min(elements * int(np.ceil(np.sqrt(size / way / ROUGH_BEAM) + 1.0)), 1024)
        yield (
            f"{name} bends too much within its elements: take model.bodies.{name}.flexible.elements: {more} "
            f"(now {elements})"
        )


def curvatures(q: Vector, length: float) -> tuple[Vector, Vector]:
    """Curvature (1/m) at both ends of every element (instants, elements); q (instants, nodes, 4); length of one (m)."""
    place, slope = q[..., :2], q[..., 2:]
    chord = 6.0 * np.diff(place, axis=1)
    a, b = slope[:, :-1], slope[:, 1:]
    found = []
    for at, second in ((a, chord - length * (4.0 * a + 2.0 * b)), (b, length * (2.0 * a + 4.0 * b) - chord)):
        turn = at[..., 0] * second[..., 1] - at[..., 1] * second[..., 0]
        found.append(turn / length**2 / np.sum(at**2, axis=2) ** 1.5)
    return found[0], found[1]


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
