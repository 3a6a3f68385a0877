"""What acts in joints by their coordinates: springs, dampers, stops, dry friction, and drives but for motions.

All of it is computed in one compiled call, `kernels.joint_loads`, and reaches the bodies with the bed's forces, see
`joint_actions`. Signals are asked for once in an instant.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from granular_contact.kernels import joint_laws, joint_loads
from granular_contact.kernels.entry import entry
from granular_contact.multibody.coordinates import Coordinate
from granular_contact.multibody.overlay import Overlay
from granular_contact.scene.joint_law import JointLaw
from granular_contact.scene.types import Drive, Vector


def fill(record: NDArray[np.void], law: JointLaw, drive: Drive | None) -> None:
    """Write what acts in a joint into its record (1,)."""
    for name in joint_loads.LAW:
        record[name] = getattr(law, name)
    if drive is not None:
        control = joint_laws.RATE_CONTROL if drive.of_rate else joint_laws.CONTROL
        record["drive"] = joint_laws.LOAD if drive.kind == "load" else control
        for name in joint_loads.DRIVE:
            record[name] = getattr(drive, name)


def setpoint(drive: Drive, t: float) -> tuple[float, float]:
    """Signal of a drive at a time, and the rate that it wants; before t = 0 its clock stands, and it wants none."""
    if t < 0.0:
        return (0.0, 0.0) if drive.of_rate else (drive.signal.value(0.0), 0.0)
    value = drive.signal.value(t)
    return value, value if drive.of_rate else drive.signal.rate(t) if drive.kind == "control" else 0.0


def held(drive: Drive, value: float) -> tuple[float, float]:
    """What a drive that is set from outside wants while it is set to a value, and the rate that it wants."""
    return value, value if drive.of_rate else 0.0


class JointLoad:
    """What acts in one joint; `nodes` are those of parent and child, without the ground's.

    state (5,): see `kernels.joint_loads`, a row of those of all joints once there are such. first_anchor: of its
    bristle, at the start.
    """

    def __init__(self, coordinate: Coordinate, nodes: list[int], law: JointLaw, drive: Drive | None) -> None:
        self.coordinate, self.nodes, self.law, self.drive = coordinate, nodes, law, drive
        self.record, self.state = coordinate.record, np.zeros(5)
        fill(self.record, law, drive)
        self.state[joint_loads.TURNS :] = coordinate.last_angles
        self.anchor = self.first_anchor = coordinate.joint.start
        self.where = np.zeros(0, int)  # places of its nodes' coordinates in the assembled system
        self._set_to: float | None = None
        if drive is not None and drive.sets:
            self.set_to = drive.signal.value(0.0)

    @property
    def anchor(self) -> float:
        """Where the bristle of dry friction is held."""
        return float(self.state[joint_loads.ANCHOR])

    @anchor.setter
    def anchor(self, place: float) -> None:
        self.state[joint_loads.ANCHOR] = place

    @property
    def last_angles(self) -> Vector:
        """Angles (2,) rad of its ends found last."""
        return self.state[joint_loads.TURNS :]

    @property
    def set_to(self) -> float | None:
        """What a drive that is set from outside is set to, None of all others."""
        return self._set_to

    @set_to.setter
    def set_to(self, value: float | None) -> None:
        self._set_to = value
        if self.drive is not None and value is not None:
            self.want(held(self.drive, value))

    def want(self, values: tuple[float, float]) -> None:
        """Let the drive want a value and a rate."""
        self.state[joint_loads.VALUE], self.state[joint_loads.RATE] = values

    def slope(self, q: Vector) -> Vector:
        """Gradient of the coordinate by those at `where`, in the system's state q."""
        kernels = self.coordinate.kernels
        place, still, slope = np.zeros((3, kernels.MOST))
        place[: len(self.where)] = q[self.where]
        kernels.single(self.record, np.zeros(2), place, still, slope)
        gradient: Vector = slope[: len(self.where)]
        return gradient


class JointLoads:
    """What acts in all joints of a system, through an overlay on their nodes; made before that is attached."""

    def __init__(self, loads: Sequence[JointLoad], overlay: Overlay) -> None:
        self.loads, self.overlay = loads, overlay
        self._kernels = loads[0].coordinate.kernels
        self.state = np.stack([load.state for load in loads])
        self.places = np.zeros((len(loads), self._kernels.MOST, 2), np.int64)
        for load, state, places in zip(loads, self.state, self.places, strict=True):
            load.state = state  # from now on a row of one table
            load.coordinate.last_angles = load.last_angles
            sizes = [size for size in (load.record["parent"][0], load.record["child"][0]) if size]
            each = [overlay.coordinates([node], size)[0] for node, size in zip(load.nodes, sizes, strict=True)]
            places[: sum(sizes), 1] = np.concatenate(each)
        records = np.concatenate([load.record for load in loads])
        self._arguments = records, self.state, self.places
        # Adds the generalised forces at q and v (of the whole system) to out, the coordinates of the overlay.
        self.add_forces: Callable[[Vector, Vector, Vector], None]  # from `start` on
        self._rubs = bool(records["friction"].any())
        self._triplets = np.zeros((sum(load.coordinate.size**2 for load in loads), 3))
        self._asked: dict[Any, tuple[Drive, list[JointLoad]]] = {}  # drives that want the same are asked once
        for load in loads:
            if load.drive is not None and load.set_to is None:
                same = load.drive.signal, load.drive.kind, load.drive.of_rate
                self._asked.setdefault(same, (load.drive, []))[1].append(load)

    def start(self) -> None:
        """Find the nodes' coordinates in the assembled system; kernels are compiled here, the first time."""
        data = self.overlay.mbs.systemData
        for load, places in zip(self.loads, self.places, strict=True):
            load.where = np.array([i for node in load.nodes for i in data.GetNodeLTGODE2(node)], dtype=int)
            places[: len(load.where), 0] = load.where
        q = np.zeros(data.ODE2Size())
        kernels = self._kernels
        self.add_forces = partial(entry(kernels.force, *self._arguments, q, q, q), *self._arguments)
        self._tangent = entry(kernels.tangent, q, q, *self._arguments, 1.0, 1.0, self._triplets)
        if self._rubs:
            self._accept = entry(kernels.accept, q, q, *self._arguments)

    def begin(self, t: float) -> None:
        """Forces are asked for at another time (s): learn what the drives want then."""
        for drive, loads in self._asked.values():
            values = setpoint(drive, t)
            for load in loads:
                load.want(values)

    def tangent(self, q: Vector, v: Vector, factor_q: float, factor_v: float) -> Vector:
        """Entries (row, column, value) of factor_q df/dq + factor_v df/dv, (k, 3); the next call overwrites them."""
        return self._triplets[: self._tangent(q, v, *self._arguments, factor_q, factor_v, self._triplets)]

    def accept(self, q: Vector, v: Vector) -> None:
        """End of a step at this state (all coordinates of the system, as the engine has them)."""
        if self._rubs:
            self._accept(q, v, *self._arguments)
