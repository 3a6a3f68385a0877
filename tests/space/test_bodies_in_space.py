"""Bodies of Exudyn scripts in a bed in space: falls, rest on a slope, motion as in the plane, faults."""

from __future__ import annotations

from functools import partial
from typing import Any

import exudyn as exu
import numpy as np
import pytest
from exudyn import itemInterface as items
from exudyn.rigidBodyUtilities import InertiaCuboid, RotXYZ2RotationMatrix
from numpy.typing import NDArray
from support_refusals import message_of
from support_space import PLAY, SAND, prism

from granular_contact import Bar, Box, Cone, GranularBed, Poncelet, Rft3d, Sphere
from granular_contact.errors import SceneError

Array = NDArray[np.float64]
EULER, ANGLES, LIE = (
    exu.NodeType.RotationEulerParameters,
    exu.NodeType.RotationRxyz,
    exu.NodeType.RotationRotationVector,
)
GRAVITY = 9.81
SIDES = (0.1, 0.08, 0.06)
INERTIA = InertiaCuboid(2700.0, SIDES)


class Thrown:
    """A body thrown into sand, with its energy before and after."""

    def __init__(self, medium: Any, shape: Any, **given: Any) -> None:
        self.mbs = exu.SystemContainer().AddSystem()
        self.down = -np.asarray(given.pop("gravity_up", [0.0, 0.0, 1.0]), float)
        self.inertia = given.pop("inertia", INERTIA)
        turn, place = given.pop("turn", [0.3, 0.2, 0.1]), given.pop("place", [0.0, 0.0, 0.09])
        velocity, spin = given.pop("velocity", [0.5, 0.2, -1.0]), given.pop("spin", [1.0, 2.0, 3.0])
        self.body = self.mbs.CreateRigidBody(
            inertia=self.inertia,
            referencePosition=place,
            referenceRotationMatrix=RotXYZ2RotationMatrix(turn),
            initialVelocity=velocity,
            initialAngularVelocity=spin,
            gravity=list(GRAVITY * self.down),
            nodeType=given.pop("node", EULER),
        )
        self.bed = GranularBed(self.mbs, medium, 0.0, up=given.pop("up", (0.0, 0.0, 1.0)), **given)
        self.bed.add_body(self.body, shape, name="body")
        self.bed.attach()
        self.mbs.Assemble()
        self.time = 0.0

    def solve(self, duration: float, step: float) -> Thrown:
        settings = exu.SimulationSettings()
        settings.solution.file.write = False
        settings.timeIntegration.startTime = self.time
        self.time += duration
        settings.timeIntegration.endTime = self.time
        settings.timeIntegration.numberOfSteps = round(duration / step)
        settings.timeIntegration.newton.useModifiedNewton = True
        settings.timeIntegration.generalizedAlpha.spectralRadius = 0.7
        settings.timeIntegration.verboseMode = 0
        self.mbs.SolveDynamic(settings, updateInitialValues=True)
        return self

    def output(self, variable: Any) -> Array:
        return np.asarray(self.mbs.GetObjectOutputBody(self.body, variable, [0.0, 0.0, 0.0]))

    @property
    def place(self) -> Array:
        return self.output(exu.OutputVariableType.Position)

    @property
    def energy(self) -> float:
        kind = exu.OutputVariableType
        v, w = self.output(kind.Velocity), self.output(kind.AngularVelocityLocal)
        m = self.inertia.Mass()
        return float(0.5 * m * v @ v + 0.5 * w @ self.inertia.InertiaCOM() @ w - m * GRAVITY * self.down @ self.place)

    def imbalance(self, duration: float, step: float) -> float:
        before = self.energy
        self.solve(duration, step)
        return abs(self.energy - before - self.bed.work) / (before - self.energy)


FALLS: dict[str, tuple[Any, Any, dict[str, Any]]] = {
    "box": (SAND, Box(SIDES), {}),
    "cone": (SAND, Cone(0.1, 0.12), {"place": [0, 0, 0.01]}),
    "bar": (PLAY, Bar([[-0.15, 0, 0], [0.15, 0, 0]], 0.008), {"inertia": InertiaCuboid(2700.0, [0.3, 0.008, 0.008])}),
    "ball": (Poncelet(40.0, 2.0), Sphere(0.1), {}),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", FALLS)
def test_the_energy_of_a_fall_is_balanced(name: str) -> None:
    medium, shape, given = FALLS[name]
    thrown = Thrown(medium, shape, **given)
    assert thrown.energy == pytest.approx(thrown.bed.work + thrown.energy)
    assert thrown.imbalance(0.15, 5e-4) < 1e-3
    assert thrown.bed.work < -0.05
    # What sand does to the body is the wrench about the origin of the world.
    wrench = thrown.bed.bodies["body"]
    np.testing.assert_allclose(thrown.bed.force, wrench[:3])


@pytest.mark.slow
def test_the_kind_of_coordinates_and_the_direction_of_up_do_not_matter() -> None:
    plain = Thrown(SAND, Box(SIDES)).solve(0.1, 2.5e-4).place
    angles = Thrown(SAND, Box(SIDES), node=ANGLES).solve(0.1, 2.5e-4).place
    np.testing.assert_allclose(angles, plain, atol=1e-7)
    # y up and x ahead, as in the plane: (x, y, z) -> (x, z, -y).
    turn = np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]])
    rotation = turn @ RotXYZ2RotationMatrix([0.3, 0.2, 0.1])
    angle = [
        np.arctan2(-rotation[1, 2], rotation[2, 2]),
        np.arcsin(rotation[0, 2]),
        np.arctan2(-rotation[0, 1], rotation[0, 0]),
    ]
    given = {
        name: list(turn @ value)
        for name, value in (("velocity", [0.5, 0.2, -1]), ("spin", [1, 2, 3]), ("place", [0, 0, 0.09]))
    }
    turned = Thrown(SAND, Box(SIDES), turn=angle, up=(0, 1, 0), gravity_up=[0, 1, 0], **given).solve(0.1, 2.5e-4).place
    np.testing.assert_allclose(turned, turn @ plain, atol=1e-7)


def test_shorter_steps_converge_with_their_square() -> None:
    # Into a light sand along a steep `up`: nothing stops meanwhile, and bodies move by some 30 mm.
    slope = np.radians(50.0)
    given = {
        "place": [0, 0, 0.02],
        "velocity": [1.0, 0, -0.2],
        "spin": [0, 0, 0],
        "up": (-np.sin(slope), 0, np.cos(slope)),
    }
    light, steps = Rft3d(100.0, 0.5, 0.3), 0.03 / np.array([8.0, 16.0, 32.0])
    ends = [Thrown(light, Sphere(0.1), **given).solve(0.03, step) for step in (*steps, 0.03 / 256)]
    assert np.linalg.norm(ends[-1].output(exu.OutputVariableType.Velocity)) > 0.3
    errors = [np.linalg.norm(end.place - ends[-1].place) for end in ends[:-1]]
    order = np.polyfit(np.log(steps), np.log(errors), 1)[0]
    assert 1.8 < order < 2.3, (errors, order)


def test_a_body_stands_still_on_a_slope() -> None:
    tilt = np.radians(10.0)
    up = (np.sin(tilt), 0.0, np.cos(tilt))
    standing = Thrown(
        SAND, Box(SIDES), up=up, place=[0, 0, 0.032], turn=[0, tilt, 0], velocity=[0, 0, 0], spin=[0, 0, 0]
    )
    standing.solve(1.0, 1e-3)
    before, weight = standing.place, GRAVITY * INERTIA.Mass()
    np.testing.assert_allclose(standing.bed.force, [0.0, 0.0, weight], atol=1e-3 * weight)
    standing.solve(20.0, 2e-2)
    assert np.linalg.norm(standing.place - before) / 20.0 < 1e-6
    np.testing.assert_allclose(standing.bed.force, [0.0, 0.0, weight], atol=1e-6 * weight)
    # It would slide if it were not held: a slope of 10 degrees pulls with a sixth of its weight.
    assert standing.bed.force @ np.array([np.cos(tilt), 0.0, -np.sin(tilt)]) < -0.1 * weight


@pytest.mark.parametrize("kind", ["disc", "bar"])
def test_a_body_in_the_plane_moves_as_there(kind: str) -> None:
    medium = SAND if kind == "disc" else PLAY
    mbs = exu.SystemContainer().AddSystem()
    mass, inertia = 1.2, 2e-3
    node = mbs.AddNode(items.NodeRigidBody2D(referenceCoordinates=[0, 0.06, 0.5], initialVelocities=[0.6, -1.0, 3.0]))
    body = mbs.AddObject(items.ObjectRigidBody2D(mass=mass, inertia=inertia, nodeNumber=node))
    marker = mbs.AddMarker(items.MarkerBodyMass(bodyNumber=body))
    mbs.AddLoad(items.LoadMassProportional(markerNumber=marker, loadVector=[0, -GRAVITY, 0]))
    flat = GranularBed(mbs, medium, 0.0)
    angles = np.linspace(0, 2 * np.pi, 36, endpoint=False)
    disc = 0.05 * np.column_stack([np.cos(angles), np.sin(angles)])
    ends = np.array([[-0.1, 0.0], [0.1, 0.0]])
    if kind == "disc":
        flat.add_outline(body, disc, 0.05, strips=144)
    else:
        flat.add_rigid(body, *ends, 0.01)
    flat.attach()
    mbs.Assemble()
    settings = exu.SimulationSettings()
    settings.solution.file.write = False
    settings.timeIntegration.endTime, settings.timeIntegration.numberOfSteps = 0.2, 200
    settings.timeIntegration.newton.useModifiedNewton = True
    settings.timeIntegration.generalizedAlpha.spectralRadius = 0.7
    settings.timeIntegration.verboseMode = 0
    mbs.SolveDynamic(settings)
    x, y, _ = mbs.GetNodeOutput(node, exu.OutputVariableType.Position)

    # In space z is up; a turn from x to z is one about -y.
    shape: Any = prism(disc, 0.05) if kind == "disc" else Bar(ends[:, [0, 0, 1]] * [1, 0, 1], 0.01)
    block = InertiaCuboid(1000.0, [0.1, 0.1, 0.1])
    block.mass, block.inertiaTensor, block.com = mass, np.eye(3) * inertia, np.zeros(3)
    place, velocity = [0, 0, 0.06], [0.6, 0, -1.0]
    thrown = Thrown(medium, shape, inertia=block, place=place, turn=[0, -0.5, 0], velocity=velocity, spin=[0, -3.0, 0])
    thrown.solve(0.2, 1e-3)
    way = float(np.hypot(x, y - 0.06))
    np.testing.assert_allclose(thrown.place, [x, 0.0, y], atol=1e-3 * way)
    assert way > 0.04


refused = partial(message_of, (SceneError, ValueError))


def test_unusable_bodies_are_refused_in_space() -> None:
    mbs = exu.SystemContainer().AddSystem()
    bodies = [
        mbs.CreateRigidBody(inertia=INERTIA, nodeType=kind, name=name) for kind, name in ((EULER, "leg"), (LIE, "foot"))
    ]
    bed, flat = GranularBed(mbs, SAND, 0.0, up=(0, 0, 1)), GranularBed(mbs, SAND, 0.0)
    assert "bed.add_body: the bed is one in the plane: give it up=(x, y, z)" in refused(
        flat.add_body, bodies[0], Box(SIDES)
    )
    assert "bed.add_line: the bed is one in space (with up): use add_body" in refused(
        bed.add_line, bodies[0], [[0, 0], [1, 0]]
    )
    allowed = "the node of foot is a RigidBodyRotVecLG, allowed are RigidBodyEP and RigidBodyRxyz"
    assert allowed in refused(bed.add_body, bodies[1], Box(SIDES))
    assert "nothing acts on a Bar: rft3d takes surfaces" in refused(
        bed.add_body, bodies[0], Bar([[0, 0, 0], [1, 0, 0]], 0.1)
    )
    assert "allowed in space" in refused(GranularBed, mbs, SAND, 0.0, up=(0, 0, 1), form="resultant")
    assert "no body was named" in refused(bed.attach)
