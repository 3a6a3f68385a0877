"""A box that is thrown into sand, by Exudyn and by MuJoCo, for `two_engines.py` and for tests."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import exudyn as exu
import mujoco
import numpy as np
from exudyn.rigidBodyUtilities import InertiaCuboid
from numpy.typing import NDArray

from granular_contact import Box, Floor, GranularBed, Rft3d
from granular_contact.mujoco import MujocoBed

Array = NDArray[np.float64]
GRAVITY = 9.81


@dataclass(frozen=True)
class FallingBox:
    """A box and its initial state: sides (m), height of its centre (m), velocity (m/s), angular velocity (rad/s)."""

    sides: tuple[float, float, float]
    height: float
    thrown: tuple[float, ...]
    medium: Any = field(default_factory=lambda: Rft3d(1600.0, 0.5, 0.3))
    floor: Floor | None = None
    density: float = 2700.0

    def in_medium(self, medium: Any) -> FallingBox:
        """Same box in another medium."""
        return replace(self, medium=medium)

    def by_exudyn(self, seconds: float, steps: int) -> Array:
        """Position (3,) m of the centre after a time (s), by a number of steps of Exudyn."""
        mbs = exu.SystemContainer().AddSystem()
        body = mbs.CreateRigidBody(
            inertia=InertiaCuboid(self.density, self.sides),
            referencePosition=[0, 0, self.height],
            initialVelocity=list(self.thrown[:3]),
            initialAngularVelocity=list(self.thrown[3:]),
            gravity=[0, 0, -GRAVITY],
            nodeType=exu.NodeType.RotationEulerParameters,
        )
        bed = GranularBed(mbs, self.medium, 0.0, up=(0, 0, 1), floor=self.floor)
        bed.add_body(body, Box(self.sides))
        bed.attach()
        mbs.Assemble()
        settings = exu.SimulationSettings()
        settings.solution.file.write = False
        settings.timeIntegration.endTime, settings.timeIntegration.numberOfSteps = seconds, steps
        settings.timeIntegration.newton.useModifiedNewton = True
        settings.timeIntegration.generalizedAlpha.spectralRadius = 0.7
        settings.timeIntegration.verboseMode = 0
        mbs.SolveDynamic(settings)
        return np.asarray(mbs.GetObjectOutputBody(body, exu.OutputVariableType.Position, [0.0, 0.0, 0.0]))

    def by_mujoco(self, seconds: float, step: float) -> Array:
        """Position (3,) m of the centre after a time (s), by MuJoCo with a step (s)."""
        half = " ".join(str(0.5 * side) for side in self.sides)
        model = mujoco.MjModel.from_xml_string(
            f'<mujoco><option timestep="{step}" gravity="0 0 -{GRAVITY}"/><worldbody><body pos="0 0 {self.height}">'
            f'<freejoint/><geom name="box" type="box" size="{half}" density="{self.density}"/></body></worldbody>'
            "</mujoco>"
        )
        bed, data = MujocoBed(model, self.medium, floor=self.floor), mujoco.MjData(model)
        bed.add_geoms("box")
        data.qvel[:] = self.thrown
        for _ in range(round(seconds / step)):
            bed.apply(data)
            mujoco.mj_step(model, data)
        place: Array = data.qpos[:3].copy()
        return place


def order(steps: Any, errors: Any) -> float:
    """Order of convergence: slope of the log of the errors over the log of the steps."""
    return float(np.polyfit(np.log(steps), np.log(errors), 1)[0])
