"""Programs without code of this project, to measure the gain of two processes over one on a machine.

Each function does a fixed amount of work and returns the processor time (s) that it took. `exudyn_alone` is most
similar to the runner's environment: five bodies, implicit steps, and motors and ground as simple Python functions.
"""

from __future__ import annotations

import math
import time
from pathlib import Path
from typing import Any

import exudyn as exu
import numpy as np
from exudyn import itemInterface as items

NUMBERS = 3_000_000  # numbers to add
CALLS = 40_000  # of each of five NumPy functions
STEPS, STEP = 400, 1e-3  # number and size (s) of the engine's steps
PERIODS, SKIP = 600, 5  # number of MuJoCo's observations, and steps between them, as in Gymnasium's environments
_HELD: dict[str, Any] = {}  # models of this process, which are built once


def count() -> float:
    """Add numbers, with almost no use of memory."""
    began, total = time.process_time(), 0
    for number in range(NUMBERS):
        total += number
    return time.process_time() - began


def small_arrays() -> float:
    """Call NumPy functions on small arrays."""
    began, a = time.process_time(), np.linspace(0.0, 1.0, 12)
    for _ in range(CALLS):
        b = a * 0.5
        b += a
        a = np.minimum(b, 1.0)
        b.dot(a)
        a = np.concatenate([a[6:], a[:6]])
    return time.process_time() - began


def mujoco_ant() -> float:
    """Simulate Gymnasium's ant in MuJoCo, with torques computed from observations."""
    if "ant" not in _HELD:
        import gymnasium
        import mujoco

        path = Path(gymnasium.__file__).parent / "envs" / "mujoco" / "assets" / "ant.xml"
        model = mujoco.MjModel.from_xml_path(str(path))
        _HELD["ant"] = mujoco, model, mujoco.MjData(model)
    mujoco, model, data = _HELD["ant"]
    mujoco.mj_resetData(model, data)
    began = time.process_time()
    for _ in range(PERIODS):
        observation = np.concatenate([data.qpos[2:], data.qvel, np.clip(data.cfrc_ext, -1.0, 1.0).ravel()])
        data.ctrl[:] = np.sin(observation[5:13] + 10.0 * data.time)
        mujoco.mj_step(model, data, nstep=SKIP)
    return time.process_time() - began


def _motor(mbs: Any, t: float, item: int, angle: float, rate: float, *given: float) -> float:  # noqa: ARG001
    """Torque of a motor that rotates a leg."""
    return 0.01 * (rate - 10.0) + 0.05 * math.sin(angle)


def _ground(mbs: Any, t: float, item: int, q: Any, v: Any) -> Any:  # noqa: ARG001
    """Forces of the ground on a leg with coordinates q and velocities v."""
    q, v = np.array(q), np.array(v)
    under = np.maximum(-(q[1] + 0.03 * np.sin(q[2] + np.linspace(0.0, 1.5, 16))), 0.0)
    force = np.array([-5.0 * v[0], 400.0, 0.0]) * under.sum() - np.array([0.0, 2.0, 1e-4]) * v
    return force.tolist()


def _walker() -> Any:
    """Build a trunk on four legs in Exudyn."""
    system = exu.SystemContainer()
    mbs = system.AddSystem()
    trunk = _body(mbs, 0.05, 0.2)
    for place in (-0.08, -0.03, 0.03, 0.08):
        leg = _body(mbs, 0.05, 0.01, place)
        hip = [
            mbs.AddMarker(items.MarkerBodyRigid(bodyNumber=trunk, localPosition=[place, 0.0, 0.0])),
            mbs.AddMarker(items.MarkerBodyRigid(bodyNumber=leg)),
        ]
        mbs.AddObject(items.ObjectJointRevolute2D(markerNumbers=hip))
        mbs.AddObject(
            items.ObjectConnectorTorsionalSpringDamper(
                markerNumbers=hip, stiffness=0.0, damping=0.0, springTorqueUserFunction=_motor
            )
        )
        node = mbs.GetObject(leg)["nodeNumber"]
        mbs.AddObject(
            items.ObjectGenericODE2(
                nodeNumbers=[node],
                massMatrix=1e-9 * np.eye(3),
                stiffnessMatrix=np.zeros((3, 3)),
                dampingMatrix=np.zeros((3, 3)),
                forceVector=np.zeros(3),
                forceUserFunction=_ground,
            )
        )
    mbs.Assemble()
    return system, mbs


def _body(mbs: Any, height: float, mass: float, x: float = 0.0) -> Any:
    """Add a rigid body under gravity."""
    start = [x, height, 0.0]
    node = mbs.AddNode(items.NodeRigidBody2D(referenceCoordinates=start))
    body = mbs.AddObject(items.ObjectRigidBody2D(physicsMass=mass, physicsInertia=1e-3 * mass, nodeNumber=node))
    centre = mbs.AddMarker(items.MarkerBodyMass(bodyNumber=body))
    mbs.AddLoad(items.LoadMassProportional(markerNumber=centre, loadVector=[0.0, -9.81, 0.0]))
    return body


def exudyn_alone() -> float:
    """Make steps of the engine."""
    if "engine" not in _HELD:
        settings = exu.SimulationSettings()
        settings.timeIntegration.numberOfSteps = STEPS
        settings.timeIntegration.endTime = STEPS * STEP
        settings.timeIntegration.verboseMode = settings.displayStatistics = 0
        settings.solutionSettings.writeSolutionToFile = False
        settings.timeIntegration.generalizedAlpha.spectralRadius = 0.8
        settings.linearSolverType = exu.LinearSolverType.EigenSparse
        _HELD["engine"] = (*_walker(), settings)
    _, mbs, settings = _HELD["engine"]
    began = time.process_time()
    mbs.SolveDynamic(settings)
    return time.process_time() - began


# Functions by their name in the table, with their amount of work in units of the table.
PROGRAMS = {
    "Exudyn alone, s of motion": (exudyn_alone, STEPS * STEP),
    "MuJoCo alone, thousands of steps": (mujoco_ant, 1e-3 * PERIODS * SKIP),
    "small arrays of NumPy, thousands of calls": (small_arrays, 5e-3 * CALLS),
    "counting, millions": (count, 1e-6 * NUMBERS),
}
