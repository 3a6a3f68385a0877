"""What joints do in a system at an instant: forces that act in them, and prescribed motions that are constraints.

The engine asks one object for forces, so all of it goes through the overlay of the bed, or one of its own without a
bed. A hinge of rigid bodies that follows a signal is the engine's own constraint; its offset is set once an instant,
while forces are asked for, which the engine does before it looks at constraints.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from granular_contact.engines.exudyn.overlay import Overlay
from granular_contact.scene.signals import Signal

if TYPE_CHECKING:
    from granular_contact.mechanics.joint_loads import JointLoad

Vector = NDArray[np.float64]


class Turning(NamedTuple):
    """A constraint object between the angles of two bodies, what it follows, and the coordinate (rad) at its start."""

    object: int
    signal: Signal
    start: float


class JointActions:
    """What the joints of a system do, through an overlay on their nodes; made before that is attached.

    acts: whether there are forces. time (s): the instant looked at last. state, places: see
    `mechanics.kernels.joint_loads`.
    """

    def __init__(self, overlay: Overlay, loads: Sequence[JointLoad], turning: Sequence[Turning]) -> None:
        self.overlay, self.mbs, self.loads, self.acts = overlay, overlay.mbs, loads, bool(loads)
        self.time = math.nan
        # Adds the generalised forces at q and v (of the whole system) to out, the coordinates of the overlay.
        self.add_forces: Callable[[Vector, Vector, Vector], None]  # from `start` on, where forces act
        self.state = np.array([load.state for load in loads])
        self.places = np.zeros((len(loads), max((sum(load.sizes) for load in loads), default=0), 2), np.int64)
        for load, state, places in zip(loads, self.state, self.places, strict=True):
            load.state = state  # from now on a row of one table
            each = [overlay.coordinates([node], size)[0] for node, size in zip(load.nodes, load.sizes, strict=True)]
            places[: sum(load.sizes), 1] = np.concatenate(each)
        self._rubs = any(load.law.friction > 0.0 for load in loads)
        self._turning: dict[Signal, list[Turning]] = {}  # a signal that several follow is asked once
        for one in turning:
            self._turning.setdefault(one.signal, []).append(one)
        self._asked: dict[Any, list[JointLoad]] = {}  # drives that want the same are asked once
        for load in loads:
            if load.drive is not None and not load.drive.sets:
                same = load.drive.signal, load.drive.kind, load.drive.of_rate
                self._asked.setdefault(same, []).append(load)

    def start(self) -> None:
        """In the assembled system, before anything is asked for; kernels are compiled here, the first time."""
        if not self.loads:
            return
        from granular_contact.jit.compiled import ready
        from granular_contact.mechanics.kernels import joint_loads as kernels

        data = self.mbs.systemData
        for load, places in zip(self.loads, self.places, strict=True):
            load.where = np.array([i for node in load.nodes for i in data.GetNodeLTGODE2(node)], dtype=int)
            places[: len(load.where), 0] = load.where
        records = np.concatenate([load.record for load in self.loads])
        self._arguments = records, self.state, self.places
        self._triplets = np.zeros((sum(sum(load.sizes) ** 2 for load in self.loads), 3))
        q = np.zeros(data.ODE2Size())
        self.add_forces = partial(ready(kernels.force, *self._arguments, q, q, q), *self._arguments)
        self._tangent = ready(kernels.tangent, q, q, *self._arguments, 1.0, 1.0, self._triplets)
        if self._rubs:
            self._accept = ready(kernels.accept, q, q, *self._arguments)

    def begin(self, t: float) -> None:
        """Look at another instant (s): learn what drives want then; before t = 0 clocks stand."""
        self.time = t
        for loads in self._asked.values():
            values = loads[0].setpoint(t)
            for load in loads:
                load.want(values)
        for signal, followers in self._turning.items():
            angle = signal.value(max(t, 0.0))
            for one in followers:  # the engine counts angles from the start
                self.mbs.SetObjectParameter(one.object, "offset", angle - one.start)

    def tangent(self, q: Vector, v: Vector, factor_q: float, factor_v: float) -> Vector:
        """Entries (row, column, value) of factor_q df/dq + factor_v df/dv, (k, 3); the next call overwrites them.

        Of joints in which forces act; q, v: as of `add_forces`.
        """
        return self._triplets[: self._tangent(q, v, *self._arguments, factor_q, factor_v, self._triplets)]

    def accept(self, q: Vector, v: Vector) -> None:
        """End of a step at this state (all coordinates of the system, as the engine has them)."""
        if self._rubs:
            self._accept(q, v, *self._arguments)

    def attach(self, constant: Mapping[int, ArrayLike]) -> None:
        """Put the overlay into the system for joints alone, with generalised forces that act all the time."""
        self.overlay.attach(constant, self._due, self._jacobian if self.acts else None)

    def _due(self, _mbs: Any, t: float, *_: Any) -> list[float]:
        if t != self.time:
            self.begin(t)
        if self.acts:
            data, overlay = self.mbs.systemData, self.overlay
            overlay.forces[:] = overlay.constant
            self.add_forces(data.GetODE2Coordinates(copy=False), data.GetODE2Coordinates_t(copy=False), overlay.forces)
            overlay.send()
        return self.overlay.nothing

    def _jacobian(self, t: float, factor_q: float, factor_v: float) -> Any:
        if t != self.time:
            self.begin(t)
        data = self.mbs.systemData
        q, v = data.GetODE2Coordinates(copy=False), data.GetODE2Coordinates_t(copy=False)
        # The engine keeps these on the left-hand side, opposite in sign to the force.
        return self.overlay.matrix(self.tangent(q, v, -factor_q, -factor_v))
