"""What acts in a joint by its coordinate: spring, damper, stops, dry friction, and drives but for prescribed motions.

Laid over the joint's two nodes as a massless `ObjectGenericODE2` with an analytic tangent, as the granular bed is.
"""

from __future__ import annotations

import math
from typing import Any

import exudyn as exu
import numpy as np
from exudyn import itemInterface as items

from granular_contact.multibody.coordinates import Hinge, Numbers, Slider
from granular_contact.multibody.joint_laws import Force, drive_force, follow, friction, held, stop, sum_of, wanted
from granular_contact.scene.types import Drive, JointLaw, Vector


class JointLoad:
    """What acts in one joint; `nodes` are those of parent and child, without the ground's.

    set_to: what a drive that is set from outside is set to, None of all others.
    """

    def __init__(self, coordinate: Hinge | Slider, nodes: list[int], law: JointLaw, drive: Drive | None) -> None:
        self.coordinate, self.nodes, self.law, self.drive = coordinate, nodes, law, drive
        self.anchor = self.first_anchor = coordinate.joint.start
        self._time, self._wanted = math.nan, (0.0, 0.0)
        self.set_to = drive.signal.value(0.0) if drive is not None and drive.sets else None
        self._springs = law.stiffness > 0.0 or law.damping > 0.0
        self._stops, self._rubs = law.has_stops, law.friction > 0.0
        self._nothing, self._only_drive = Force(0.0), drive is not None and law.is_idle
        # A hinge of rigid bodies does not change with their places: nor does what its tangent is made of.
        slope = coordinate.constant_slope
        self._outer = None if slope is None else np.outer(slope, slope)

    def add(self, mbs: Any) -> None:
        """Put it into a system, before it is assembled."""
        mbs.AddObject(
            items.ObjectGenericODE2(
                nodeNumbers=[exu.NodeIndex(node) for node in self.nodes],
                forceUserFunction=self._force,
                jacobianUserFunction=self._jacobian,
                visualization=items.VObjectGenericODE2(show=False),
            )
        )

    def total(self, t: float, s: float, rate: float) -> Force:
        """All that acts along the coordinate."""
        if self._only_drive and self.drive is not None:
            return self._of_drive(self.drive, t, s, rate)
        law = self.law
        total = self._nothing
        if self._springs:
            total = Force(-law.stiffness * (s - law.rest) - law.damping * rate, -law.stiffness, -law.damping)
        if self._stops:
            total = sum_of(total, stop(law, s, rate)[1])
        if self._rubs:
            total = sum_of(total, friction(law, s, rate, self.anchor))
        if self.drive is not None:
            force = self._of_drive(self.drive, t, s, rate)
            total = force if total is self._nothing else sum_of(total, force)
        return total

    def _of_drive(self, drive: Drive, t: float, s: float, rate: float) -> Force:
        if self.set_to is not None:
            return drive_force(drive, *held(drive, self.set_to), s, rate)
        if t != self._time:  # all iterations of a step ask for the same instant
            self._time, self._wanted = t, wanted(drive, t)
        return drive_force(drive, *self._wanted, s, rate)

    def accept(self, q: Vector, v: Vector) -> None:
        """End of a step at this state (all coordinates of the system, as the engine has them)."""
        if self.law.friction > 0.0:
            s, _, _ = self.coordinate.at(q[self.where].tolist(), v[self.where].tolist())
            self.anchor = follow(self.law, s, self.anchor)

    def start(self, mbs: Any) -> None:
        """Find the nodes' coordinates in the assembled system."""
        data = mbs.systemData
        self.where = np.array([i for node in self.nodes for i in data.GetNodeLTGODE2(node)], dtype=int)

    def _force(self, mbs: Any, t: float, item: int, q: Numbers, v: Numbers) -> Numbers:  # noqa: ARG002
        s, rate, slope = self.coordinate.at(q, v)
        force = self.total(t, s, rate)[0]
        return [force * g for g in slope]

    def _jacobian(
        self,
        mbs: Any,  # noqa: ARG002
        t: float,
        item: int,  # noqa: ARG002
        q: Numbers,
        v: Numbers,
        factor_q: float,
        factor_v: float,
    ) -> Any:
        container = exu.MatrixContainer()
        # The engine keeps these on the left-hand side, opposite in sign to the force.
        if self._outer is not None:
            force = self.total(t, *self.coordinate.at(q, v)[:2])
            factor = -factor_q * force.by_place - factor_v * force.by_rate
            container.SetWithDenseMatrix(factor * self._outer, useDenseMatrix=False)
            return container
        q, v = list(q), list(v)
        s, rate, slope = self.coordinate.at(q, v)
        force, gradient, second = self.total(t, s, rate), np.array(slope), self.coordinate.second(q)
        by_q = np.outer(gradient, force.by_place * gradient + force.by_rate * (second @ np.array(v)))
        by_q += force.value * second
        by_v = force.by_rate * np.outer(gradient, gradient)
        container.SetWithDenseMatrix(-factor_q * by_q - factor_v * by_v, useDenseMatrix=False)
        return container
