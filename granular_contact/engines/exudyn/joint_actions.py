"""Forces that act in joints, and prescribed motions of hinges, in an Exudyn system.

The forces reach the system through the overlay of the bed, or through an overlay of their own if there is no bed. A
prescribed motion of a hinge between rigid bodies is a constraint of the engine; its offset is set once per instant,
when the engine asks for forces. The engine does that before it evaluates constraints (`engine_checks`).
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


class HingeMotion(NamedTuple):
    """Prescribed motion of a hinge between rigid bodies.

    object: number of the constraint between the angles of the bodies. signal: prescribed coordinate (rad). start:
    coordinate (rad) in the initial state.
    """

    object: int
    signal: Signal
    start: float


class JointActions:
    """Forces and prescribed motions of the joints of a system; made before the overlay is attached.

    has_forces: whether forces act in any joint. time (s): instant of the present setpoints. states, places: see
    `mechanics.kernels.joint_loads`.
    """

    def __init__(self, overlay: Overlay, loads: Sequence[JointLoad], motions: Sequence[HingeMotion]) -> None:
        self.overlay, self.mbs, self.loads, self.has_forces = overlay, overlay.mbs, loads, bool(loads)
        self.time = math.nan
        # add_forces(q, v, out) adds the generalised forces at q and v (of the system) to out, which is numbered as the
        # overlay. `start` sets it if there are forces.
        self.add_forces: Callable[[Vector, Vector, Vector], None]
        self.states = np.array([load.state for load in loads])
        self.places = np.zeros((len(loads), max((sum(load.sizes) for load in loads), default=0), 2), np.int64)
        for load, state, places in zip(loads, self.states, self.places, strict=True):
            load.state = state  # a view of its row in the table of all joints
            ends = [overlay.coordinates([node], size)[0] for node, size in zip(load.nodes, load.sizes, strict=True)]
            places[: sum(load.sizes), 1] = np.concatenate(ends)
        self._followers: dict[Signal, list[HingeMotion]] = {}  # by signal, so that each signal is evaluated once
        for motion in motions:
            self._followers.setdefault(motion.signal, []).append(motion)
        self._driven: dict[Any, list[JointLoad]] = {}  # by setpoint, so that each setpoint is evaluated once
        for load in loads:
            if load.drive is not None and not load.drive.sets:
                setpoint = load.drive.signal, load.drive.kind, load.drive.of_rate
                self._driven.setdefault(setpoint, []).append(load)

    def start(self) -> None:
        """Bind the compiled kernels to the assembled system, before the first evaluation; they compile when missing."""
        if not self.loads:
            return
        from granular_contact.jit.compiled import ready
        from granular_contact.mechanics.kernels import joint_loads as kernels

        data = self.mbs.systemData
        for load, places in zip(self.loads, self.places, strict=True):
            load.where = np.array([i for node in load.nodes for i in data.GetNodeLTGODE2(node)], dtype=int)
            places[: len(load.where), 0] = load.where
        records = np.concatenate([load.record for load in self.loads])
        self._arguments = records, self.states, self.places
        self._triplets = np.zeros((sum(sum(load.sizes) ** 2 for load in self.loads), 3))
        q = np.zeros(data.ODE2Size())
        self.add_forces = partial(ready(kernels.force, *self._arguments, q, q, q), *self._arguments)
        self._tangent = ready(kernels.tangent, q, q, *self._arguments, 1.0, 1.0, self._triplets)
        self._accept = ready(kernels.accept, q, q, *self._arguments)

    def set_time(self, t: float) -> None:
        """Evaluate setpoints of drives and prescribed motions at the time t (s); before t = 0 signals are constant."""
        self.time = t
        for loads in self._driven.values():
            setpoint = loads[0].setpoint(t)
            for load in loads:
                load.want(setpoint)
        for signal, followers in self._followers.items():
            angle = signal.value(max(t, 0.0))
            for motion in followers:  # the engine counts angles from the initial state
                self.mbs.SetObjectParameter(motion.object, "offset", angle - motion.start)

    def tangent(self, q: Vector, v: Vector, factor_q: float, factor_v: float) -> Vector:
        """Triplets (k, 3) of factor_q df/dq + factor_v df/dv of the forces in joints: row, column, value.

        Rows and columns are numbered as the overlay; q, v: as in `add_forces`. The next call overwrites the triplets.
        """
        return self._triplets[: self._tangent(q, v, *self._arguments, factor_q, factor_v, self._triplets)]

    def accept(self, q: Vector, v: Vector) -> None:
        """Accept a state as the end of a step: update friction and whole turns of hinges.

        q, v (m,): all coordinates and rates of the system.
        """
        if self.has_forces:
            self._accept(q, v, *self._arguments)

    def attach(self, constant: Mapping[int, ArrayLike]) -> None:
        """Put the overlay into a system without a bed, with constant generalised forces by node number."""
        self.overlay.attach(constant, self._force, self._jacobian if self.has_forces else None)

    def _force(self, _mbs: Any, t: float, *_: Any) -> list[float]:
        """Force function of the trigger object."""
        if t != self.time:
            self.set_time(t)
        if self.has_forces:
            data, overlay = self.mbs.systemData, self.overlay
            overlay.forces[:] = overlay.constant
            self.add_forces(data.GetODE2Coordinates(copy=False), data.GetODE2Coordinates_t(copy=False), overlay.forces)
            overlay.send()
        return self.overlay.no_force

    def _jacobian(self, t: float, factor_q: float, factor_v: float) -> Any:
        """Tangent of the left-hand side, -(factor_q df/dq + factor_v df/dv), as the engine's sparse matrix."""
        if t != self.time:
            self.set_time(t)
        data = self.mbs.systemData
        q, v = data.GetODE2Coordinates(copy=False), data.GetODE2Coordinates_t(copy=False)
        return self.overlay.matrix(self.tangent(q, v, -factor_q, -factor_v))
