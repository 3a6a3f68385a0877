"""What joints do in a system at an instant: forces that act in them, and prescribed motions that are constraints.

The engine asks one object for forces, so all of it goes through the overlay of the bed, or one of its own without a
bed. A hinge of rigid bodies that follows a signal is the engine's own constraint; its offset is set once an instant,
while forces are asked for, which the engine does before it looks at constraints.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from granular_contact.multibody.overlay import Overlay
from granular_contact.scene.signals import Signal

if TYPE_CHECKING:
    from granular_contact.multibody.joint_loads import JointLoads

Vector = NDArray[np.float64]


class Turning(NamedTuple):
    """A constraint object between the angles of two bodies, what it follows, and the coordinate (rad) at its start."""

    object: int
    signal: Signal
    start: float


class JointActions:
    """What the joints of a system do; acts: whether there are forces. time (s): the instant looked at last."""

    def __init__(self, mbs: Any, loads: JointLoads | None, turning: Sequence[Turning]) -> None:
        self.mbs, self.loads, self.acts = mbs, loads, loads is not None
        self.time = math.nan
        # Adds the generalised forces at q and v (of the whole system) to out, the coordinates of the overlay.
        self.add_forces: Callable[[Vector, Vector, Vector], None]  # from `start` on, where forces act
        self._turning: dict[Signal, list[Turning]] = {}  # a signal that several follow is asked once
        for one in turning:
            self._turning.setdefault(one.signal, []).append(one)

    def start(self) -> None:
        """In the assembled system, before anything is asked for."""
        if self.loads is not None:
            self.loads.start()
            self.add_forces = self.loads.add_forces

    def begin(self, t: float) -> None:
        """Look at another instant (s); before t = 0 clocks stand."""
        self.time = t
        if self.loads is not None:
            self.loads.begin(t)
        for signal, followers in self._turning.items():
            angle = signal.value(max(t, 0.0))
            for one in followers:  # the engine counts angles from the start
                self.mbs.SetObjectParameter(one.object, "offset", angle - one.start)

    def tangent(self, q: Vector, v: Vector, factor_q: float, factor_v: float) -> Vector:
        """Entries (row, column, value) of factor_q df/dq + factor_v df/dv, (k, 3)."""
        return np.zeros((0, 3)) if self.loads is None else self.loads.tangent(q, v, factor_q, factor_v)

    def accept(self, q: Vector, v: Vector) -> None:
        """End of a step at this state."""
        if self.loads is not None:
            self.loads.accept(q, v)

    def attach(self, overlay: Overlay, constant: Mapping[int, ArrayLike]) -> None:
        """Put an overlay into the system for joints alone, with generalised forces that act all the time."""
        self._overlay = overlay
        overlay.attach(constant, self._due, self._jacobian if self.acts else None)

    def _due(self, _mbs: Any, t: float, *_: Any) -> list[float]:
        if t != self.time:
            self.begin(t)
        if self.acts:
            data, overlay = self.mbs.systemData, self._overlay
            overlay.forces[:] = overlay.constant
            self.add_forces(data.GetODE2Coordinates(copy=False), data.GetODE2Coordinates_t(copy=False), overlay.forces)
            overlay.send()
        return self._overlay.nothing

    def _jacobian(self, t: float, factor_q: float, factor_v: float) -> Any:
        if t != self.time:
            self.begin(t)
        data = self.mbs.systemData
        q, v = data.GetODE2Coordinates(copy=False), data.GetODE2Coordinates_t(copy=False)
        # The engine keeps these on the left-hand side, opposite in sign to the force.
        return self._overlay.matrix(self.tangent(q, v, -factor_q, -factor_v))
