"""`GranularBed` in a user's own Exudyn script, in the plane."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import partial
from inspect import signature
from typing import Any

import exudyn as exu
import numpy as np
import pytest
from exudyn import itemInterface as items
from exudyn.rigidBodyUtilities import RigidBodyInertia, RotationMatrixX, RotationMatrixY, RotationMatrixZ
from support_parts import called, rigid_stations
from support_refusals import message_of
from support_runs import order

from granular_contact import Floor, preset
from granular_contact.engines.exudyn import created
from granular_contact.engines.exudyn.bed import GranularBed
from granular_contact.errors import SceneError
from granular_contact.laws.layer import Layer
from granular_contact.laws.lee_marghitu import LeeMarghitu, VerticalResistance
from granular_contact.laws.static_friction import Elastoplastic, Smooth
from granular_contact.sand.contact_lines import ELEMENTS_PER_LINE
from granular_contact.sand.kernels import kinematics, lines, strips
from granular_contact.sand.kernels.forces import medium_record

SAND = LeeMarghitu(2500.0, 6.5, 8.0, VerticalResistance(22.0, 1.1), VerticalResistance(22.0, 1.1))
GRAVEL = LeeMarghitu(1600.0, 3.0, 4.0, VerticalResistance(10.0, 1.4), VerticalResistance(0.5, 1.7))
HALF, DIAMETER, G = 0.1, 0.006, 9.81
MASS, INERTIA = 0.06, 2e-4
STIFFNESS, PULL = 40.0, np.array([0.05, -0.1])
START, STARTING = np.array([0.0, 0.06, -1.0]), np.array([0.3, -1.0, 2.0])


@dataclass
class Script:
    """A user's model: a thrown rod, and a second one on a spring with a constant pull and an own post-step function."""

    mbs: Any
    container: Any
    first: Any
    second: Any
    states: list[np.ndarray] = field(default_factory=list)

    def table(self) -> np.ndarray:
        """(n, 13): time, coordinates and rates of every accepted step, as the user's own function saw them."""
        return np.array(self.states)


def script(rods: int = 2) -> Script:
    container = exu.SystemContainer()
    mbs = container.AddSystem()
    bodies = []
    for i in range(rods):
        node = mbs.AddNode(
            items.NodeRigidBody2D(
                referenceCoordinates=[*(START + np.array([i, 0, 0.2 * i]))], initialVelocities=[*STARTING]
            )
        )
        body = mbs.AddObject(items.ObjectRigidBody2D(mass=MASS, inertia=INERTIA, nodeNumber=node, name=f"rod{i}"))
        weight = mbs.AddMarker(items.MarkerBodyMass(bodyNumber=body))
        mbs.AddLoad(items.LoadMassProportional(markerNumber=weight, loadVector=[0, -G, 0]))
        bodies.append(body)
    if rods == 2:
        ground = mbs.AddMarker(
            items.MarkerNodeCoordinate(nodeNumber=mbs.AddNode(items.NodePointGround()), coordinate=0)
        )
        place = mbs.AddMarker(items.MarkerNodeCoordinate(nodeNumber=1, coordinate=1))
        mbs.AddObject(items.ObjectConnectorCoordinateSpringDamper(markerNumbers=[ground, place], stiffness=STIFFNESS))
        middle = mbs.AddMarker(items.MarkerBodyPosition(bodyNumber=bodies[1]))
        mbs.AddLoad(items.LoadForceVector(markerNumber=middle, loadVector=[*PULL, 0]))
    made = Script(mbs, container, bodies[0], bodies[-1])

    def after_step(mbs: Any, t: float) -> bool:
        data = mbs.systemData
        made.states.append(np.concatenate([[t], data.GetODE2Coordinates(), data.GetODE2Coordinates_t()]))
        return True

    mbs.SetPostStepUserFunction(after_step)
    return made


def settings(step: float, end: float = 0.04) -> Any:
    s = exu.SimulationSettings()
    s.timeIntegration.endTime, s.timeIntegration.numberOfSteps = end, round(end / step)
    s.timeIntegration.verboseMode = 0
    s.timeIntegration.newton.useModifiedNewton = True
    s.solution.file.write = False
    return s


def bed_on(mbs: Any, body: Any, surface: float = -0.03, medium: LeeMarghitu = SAND, **options: Any) -> GranularBed:
    bed = GranularBed(mbs, medium, surface, **options)
    bed.add_rigid(body, [-HALF, 0.0], [HALF, 0.0], DIAMETER)
    return bed


def attached(step: float, end: float = 0.04) -> tuple[Script, GranularBed, GranularBed]:
    """The script with two beds, solved."""
    made = script()
    beds = bed_on(made.mbs, made.first), bed_on(made.mbs, made.second, -0.01, GRAVEL)
    for bed in beds:
        bed.attach()
    made.mbs.Assemble()
    made.mbs.SolveDynamic(settings(step, end))
    return made, *beds


def energy(table: np.ndarray) -> np.ndarray:
    """Energy (n, 2) J of both rods, with the potentials of weight, spring and pull."""
    q, v = table[:, 1:7].reshape(-1, 2, 3), table[:, 7:].reshape(-1, 2, 3)
    out = 0.5 * (MASS * (v[..., :2] ** 2).sum(axis=2) + INERTIA * v[..., 2] ** 2) + MASS * G * q[..., 1]
    out[:, 1] += 0.5 * STIFFNESS * q[:, 1, 1] ** 2 - q[:, 1, :2] @ PULL
    return out


# ---- what it does ----


def test_work_is_the_loss_of_energy() -> None:
    steps, errors = [2e-4, 1e-4, 5e-5], []
    for step in steps:
        made, *beds = attached(step)
        change = np.diff(energy(made.table())[[0, -1]], axis=0)[0]
        errors.append(max(abs(change[i] - beds[i].work) for i in range(2)))
        for i in range(2):
            assert beds[i].work < -0.01  # J
            assert beds[i].history.work[-1] == beds[i].work
    # Work is summed by trapezoids and the integrator is of second order; the force has kinks (touch, yield), each of
    # which costs a step of a small change of power. Motion changes over some 5 ms: (1e-4 / 5e-3)^2 / 12 = 3e-5 of 0.05
    # J.
    assert order(steps, errors) > 1.5
    assert errors[1] < 3e-5 * 0.05


def test_forces_are_what_accelerates_the_rods() -> None:
    made, first, second = attached(1e-5, 0.02)
    table = made.table()
    v = table[:, 7:].reshape(-1, 2, 3)
    for i, bed in enumerate((first, second)):
        load = bed.history.terms.sum(axis=1)
        q = table[:, 1 + 3 * i : 4 + 3 * i] + START + np.array([i, 0, 0.2 * i])
        other = np.tile([0.0, -MASS * G], (len(q), 1))
        if i == 1:
            other[:, 1] -= STIFFNESS * (q[:, 1] - START[1])
            other += PULL
        impulse = np.diff(MASS * v[:, i, :2], axis=0)
        mean = 0.5 * ((load[:, :2] + other)[1:] + (load[:, :2] + other)[:-1]) * 1e-5
        # Momentum balance step by step, and moment about the centre of mass; trapezoids against the integrator's
        # weights: a step of the change of force in it. Summed up it has to be second order: 1e-4 of the whole impulse.
        np.testing.assert_allclose(mean.sum(axis=0), impulse.sum(axis=0), atol=1e-4 * np.abs(impulse).sum())
        moment = load[:, 2] - (q[:, 0] * load[:, 1] - q[:, 1] * load[:, 0])
        turn = np.diff(INERTIA * v[[0, -1], i, 2])[0]
        assert np.sum(0.5 * (moment[1:] + moment[:-1])) * 1e-5 == pytest.approx(turn, abs=1e-4 * abs(turn) + 1e-8)
        np.testing.assert_allclose(bed.force, load[-1, :2])
        np.testing.assert_allclose(sum(bed.terms.values())[:2], bed.force)


def test_two_beds_do_not_meddle_with_each_other() -> None:
    """With both beds each rod moves as with its own alone: nothing couples the two."""
    both, *_ = attached(1e-4)
    for i in range(2):
        made = script()
        bed = bed_on(made.mbs, made.second, -0.01, GRAVEL) if i else bed_on(made.mbs, made.first)
        bed.attach()
        made.mbs.Assemble()
        made.mbs.SolveDynamic(settings(1e-4))
        # Newton's method stops on the residual of the whole system: to its tolerance of 1e-8 relative.
        np.testing.assert_allclose(
            made.table()[:, 1 + 3 * i : 4 + 3 * i], both.table()[:, 1 + 3 * i : 4 + 3 * i], atol=1e-8
        )
        other = 1 - i
        # and the rod without a bed falls on: it is elsewhere by millimetres.
        far = made.table()[-1, 1 + 3 * other : 4 + 3 * other] - both.table()[-1, 1 + 3 * other : 4 + 3 * other]
        assert np.abs(far).max() > 1e-3


def test_depth_is_that_of_the_lower_end() -> None:
    made, first, _ = attached(1e-4)
    q = made.table()[:, 1:4] + START
    # The same sum in another order: round-off.
    np.testing.assert_allclose(first.history.depth, -0.03 - (q[:, 1] - HALF * np.abs(np.sin(q[:, 2]))), atol=1e-14)


def test_nothing_else_of_the_script_changes() -> None:
    made = script()
    mbs = made.mbs
    parts = (
        ("NumberOfNodes", "GetNode"),
        ("NumberOfMarkers", "GetMarker"),
        ("NumberOfLoads", "GetLoad"),
        ("NumberOfObjects", "GetObject"),
    )
    counts = {get: getattr(mbs.systemData, count)() for count, get in parts}
    before = {get: [repr(getattr(mbs, get)(i)) for i in range(n)] for get, n in counts.items()}
    mbs.variables["mine"] = 7
    bed_on(mbs, made.first).attach()
    for count, get in parts:
        added = 2 if get == "GetObject" else 0  # the overlay: bell and carrier
        assert getattr(mbs.systemData, count)() == counts[get] + added
        assert [repr(getattr(mbs, get)(i)) for i in range(counts[get])] == before[get]
    assert mbs.GetObject(counts["GetObject"])["objectType"] == "GenericODE2"
    assert mbs.variables == {"mine": 7}


def test_own_post_step_function_is_called_for_every_step() -> None:
    made, first, second = attached(1e-4)
    times = made.table()[:, 0]
    assert len(times) == 401
    for bed in (first, second):
        np.testing.assert_array_equal(bed.history.time, times)


def test_bed_that_is_never_reached_changes_no_digit() -> None:
    free, dry = script(), script()
    bed = bed_on(dry.mbs, dry.first, surface=-5.0)
    bed.attach()
    for made in (free, dry):
        made.mbs.Assemble()
        made.mbs.SolveDynamic(settings(1e-3))
    np.testing.assert_array_equal(free.table(), dry.table())
    assert bed.work == 0.0
    assert not bed.force.any()


@pytest.mark.parametrize(
    "options", [{}, {"static": Smooth(0.1)}, {"form": "resultant"}, {"end_cap": True}, {"gravity": 20.0}], ids=str
)
def test_options_have_an_effect(options: dict[str, Any]) -> None:
    ends = []
    for chosen in ({}, options):
        made = script(1)
        bed = bed_on(made.mbs, made.first, **chosen)
        bed.attach()
        made.mbs.Assemble()
        made.mbs.SolveDynamic(settings(1e-4))
        ends.append(made.table()[-1, 1:4])
    moved = float(np.abs(ends[1] - ends[0]).max())
    # Newton's tolerance leaves 1e-8 m.
    assert (moved == 0.0) if not options else (moved > 1e-6)


# ---- restart, rejected steps, explicit integrators ----


def test_same_system_solved_twice_has_the_same_history() -> None:
    made = script()
    bed = bed_on(made.mbs, made.first)
    bed.attach()
    made.mbs.Assemble()
    histories = []
    for _ in range(2):
        made.mbs.SolveDynamic(settings(2e-4))
        h = bed.history
        histories.append([np.copy(x) for x in (h.time, h.work, h.power, h.depth, h.terms)])
    for first, second in zip(*histories, strict=True):
        np.testing.assert_array_equal(first, second)
    assert len(histories[0][0]) == 201


def test_a_history_is_kept_when_the_system_is_solved_again() -> None:
    made = script()
    bed = bed_on(made.mbs, made.first)
    bed.attach()
    made.mbs.Assemble()
    made.mbs.SolveDynamic(settings(2e-4))
    history = bed.history
    kept = np.copy(history.work)
    made.mbs.systemData.SetODE2Coordinates_t([0.0] * 6, exu.ConfigurationType.Initial)
    made.mbs.SolveDynamic(settings(2e-4))
    np.testing.assert_array_equal(history.work, kept)


def test_bristles_rest_where_a_solve_starts() -> None:
    """Somebody linearises the system first, then moves the rod and solves: there is no load, so it has to stay."""
    mbs = exu.SystemContainer().AddSystem()
    node = mbs.AddNode(items.NodeRigidBody2D(referenceCoordinates=[0, -0.05, 0]))
    body = mbs.AddObject(items.ObjectRigidBody2D(mass=MASS, inertia=INERTIA, nodeNumber=node))
    bed_on(mbs, body, surface=0.0).attach()
    mbs.Assemble()
    mbs.ComputeLinearizedSystem(settings(1e-4))
    mbs.systemData.SetODE2Coordinates([0.0, -0.01, 0.0], exu.ConfigurationType.Initial)
    mbs.SolveDynamic(settings(1e-4, 0.01))
    # It moved by 17 um.
    np.testing.assert_allclose(mbs.systemData.GetODE2Coordinates(), [0.0, -0.01, 0.0], atol=1e-10)


def replay(table: np.ndarray, bed: GranularBed, surface: float) -> np.ndarray:
    """Power (n,) W at the accepted states, anchors dragged along from one to the next."""
    geometry = rigid_stations(np.array([[-HALF, 0.0], [HALF, 0.0]]), 16)
    run, power, anchors = np.zeros(1, lines.LINE), np.zeros(len(table)), None
    run["width"], profile = DIAMETER, np.array([[0.0, surface]])
    medium = medium_record(bed.load.records[0])[0]
    P, V, F = (np.zeros((17, 2)) for _ in range(3))
    for i, state in enumerate(table):
        called(kinematics.stations)(state[1:4] + START, state[4:7], geometry, P, V)
        anchors = P.copy() if anchors is None else anchors
        called(strips.distributed_forces)(P, V, anchors, run[0], profile, medium, F, np.zeros((3, 3)))
        power[i] = (F * V).sum()
        called(lines.drag_anchors)(P, anchors, run[0], profile, medium)
    return power


@pytest.mark.slow
@pytest.mark.parametrize("newton", [6, 30])
def test_rejected_steps_leave_no_trace(newton: int) -> None:
    """What the bed keeps follows from the accepted states alone, however often the engine tried."""
    made = script(1)
    bed = bed_on(made.mbs, made.first)
    bed.attach()
    made.mbs.Assemble()
    s = settings(2e-3)
    s.timeIntegration.newton.maxIterations = s.timeIntegration.newton.maxModifiedNewtonIterations = newton
    s.timeIntegration.minimumStepSize = 1e-6
    solver = exu.MainSolverImplicitSecondOrder()
    assert solver.SolveSystem(made.mbs, s)
    table = made.table()
    if newton == 6:
        assert len(table) > 22  # 20 steps were asked for; what was rejected was repeated in smaller ones
    np.testing.assert_array_equal(bed.history.time, table[:, 0])
    power = replay(table, bed, -0.03)
    # The same kernels on the same states: bitwise but for the order of sums; one stale anchor would cost per cents.
    np.testing.assert_allclose(bed.history.power, power, rtol=1e-9, atol=1e-9 * np.abs(power).max())
    work = np.concatenate([[0.0], np.cumsum(0.5 * (power[1:] + power[:-1]) * np.diff(table[:, 0]))])
    np.testing.assert_allclose(bed.history.work, work, atol=1e-9 * np.abs(work).max())


def solved_with(wrap: Any = None, reader: Any = None) -> tuple[np.ndarray, GranularBed]:
    """States and bed of one rod; `wrap` goes around the force function, `reader` is called in every load evaluation."""
    made = script(1)
    bed = bed_on(made.mbs, made.first)
    if wrap is not None:
        bed.coupling._force = wrap(bed, bed.coupling._force)  # type: ignore[method-assign]
    middle = made.mbs.AddMarker(items.MarkerBodyPosition(bodyNumber=made.first))

    def load(mbs: Any, t: float, vector: list[float]) -> list[float]:  # noqa: ARG001
        if reader is not None:
            reader(bed)
        return vector

    made.mbs.AddLoad(items.LoadForceVector(markerNumber=middle, loadVector=[0, -1e-3, 0], loadVectorUserFunction=load))
    bed.attach()
    made.mbs.Assemble()
    made.mbs.SolveDynamic(settings(1e-3))
    return made.table(), bed


def test_repeated_tries_of_a_step_advance_nothing() -> None:
    def thrice(_bed: GranularBed, force: Any) -> Any:
        def force_three_times(mbs: Any, t: float, *given: Any) -> list[float]:
            start = mbs.systemData.GetTime(exu.ConfigurationType.StartOfStep)
            for part in (0.5, 0.25) if t > start else ():
                force(mbs, start + part * (t - start), *given)
            return list(force(mbs, t, *given))

        return force_three_times

    (table, bed), (table_again, bed_again) = solved_with(), solved_with(thrice)
    assert bed_again.load_calls > 2.5 * bed.load_calls
    np.testing.assert_array_equal(table_again, table)
    np.testing.assert_array_equal(bed_again.history.power, bed.history.power)


def test_reading_during_a_step_changes_nothing() -> None:
    """The docstring promises that work, force and history can be read at any time, during a solve too."""
    (table, bed), (table_read, bed_read) = solved_with(), solved_with(reader=lambda bed: bed.work)
    np.testing.assert_array_equal(bed_read.history.time, bed.history.time)
    np.testing.assert_array_equal(bed_read.history.power, bed.history.power)
    np.testing.assert_array_equal(table_read, table)


@pytest.mark.slow
def test_explicit_integrator_agrees_with_the_implicit_one() -> None:
    ends, works = [], []
    for step, kind in ((5e-6, exu.DynamicSolverType.GeneralizedAlpha), (2e-5, exu.DynamicSolverType.RK44)):
        made = script(1)
        bed = bed_on(made.mbs, made.first)
        bed.attach()
        made.mbs.Assemble()
        made.mbs.SolveDynamic(settings(step), solverType=kind)
        ends.append(made.table()[-1, 1:])
        works.append(bed.work)
    # The implicit one is of second order: (5e-6 / 5e-3)^2 / 12 = 1e-7 of 0.3 rad and 8 rad/s; both lose an order at
    # kinks.
    np.testing.assert_allclose(ends[0], ends[1], atol=1e-5)
    assert works[0] == pytest.approx(works[1], rel=1e-5)


def test_static_law_needs_no_motion_to_hold() -> None:
    """A rod that lies in the sand at a fraction of its strength stays where it is, within the yield displacement."""
    container = exu.SystemContainer()
    mbs = container.AddSystem()
    node = mbs.AddNode(items.NodeRigidBody2D(referenceCoordinates=[0, -0.05, 0]))
    body = mbs.AddObject(items.ObjectRigidBody2D(mass=MASS, inertia=INERTIA, nodeNumber=node))
    weight = mbs.AddMarker(items.MarkerBodyMass(bodyNumber=body))
    mbs.AddLoad(items.LoadMassProportional(markerNumber=weight, loadVector=[0, -G, 0]))
    bed = bed_on(mbs, body, surface=0.0, static=Elastoplastic(1e-5, 1e-3))
    bed.attach()
    mbs.Assemble()
    mbs.SolveDynamic(settings(1e-3, 0.5))
    bound = 2.1 * 22.0 * G * 2500.0 * np.pi / 4 * DIAMETER**2 * (0.05 / DIAMETER) ** 1.1 * 2 * HALF
    # A bristle of stiffness bound / u_y carries the weight; depth changes by 1e-5 / 0.05 of the bound.
    sag = -mbs.systemData.GetODE2Coordinates()[1]
    assert sag == pytest.approx(1e-5 * MASS * G / bound, rel=1e-3)
    np.testing.assert_allclose(bed.force, [0.0, MASS * G], atol=1e-6 * MASS * G)


# ---- what it refuses ----


refused = partial(message_of, SceneError)


def cables(mbs: Any, elements: int = 3) -> list[Any]:
    nodes = [mbs.AddNode(items.NodePoint2DSlope1(referenceCoordinates=[0.1 * i, 0, 1, 0])) for i in range(elements + 1)]
    return [
        mbs.AddObject(
            items.ObjectANCFCable2D(
                length=0.1, massPerLength=0.2, bendingStiffness=1.0, axialStiffness=1e4, nodeNumbers=nodes[i : i + 2]
            )
        )
        for i in range(elements)
    ]


def test_wrong_kinds_of_body_are_refused() -> None:
    made = script()
    elements = cables(made.mbs)
    bed = GranularBed(made.mbs, SAND, 0.0)
    assert "ANCFCable2D" in refused(bed.add_rigid, elements[0], [0, 0], [0.1, 0], 0.01)
    message = refused(bed.add_cables, [made.first], 0.01)
    assert "RigidBody2D" in message
    assert "rod0" in message


def test_cables_that_do_not_follow_one_another_are_refused() -> None:
    made = script()
    a, b, c = cables(made.mbs)
    bed = GranularBed(made.mbs, SAND, 0.0)
    assert "neighbour" in refused(bed.add_cables, [a, c], 0.01)
    assert "neighbour" in refused(bed.add_cables, [b, a], 0.01)
    bed.add_cables([a, b, c], 0.01)


@pytest.mark.parametrize("diameter", [0.0, -0.01, np.nan, np.inf])
def test_bad_diameters_are_refused(diameter: float) -> None:
    made = script()
    bed = GranularBed(made.mbs, SAND, 0.0)
    assert str(diameter) in refused(bed.add_rigid, made.first, [0, 0], [0.1, 0], diameter)
    assert str(diameter) in refused(bed.add_cables, cables(made.mbs), diameter)


def test_cylinder_without_a_length_is_refused() -> None:
    made = script()
    assert "0.1" in refused(GranularBed(made.mbs, SAND, 0.0).add_rigid, made.first, [0.1, 0], [0.1, 0], 0.01)


def test_attach_comes_once_and_last() -> None:
    made = script()
    bed = GranularBed(made.mbs, SAND, 0.0)
    assert "no body" in refused(bed.attach)
    bed.add_rigid(made.first, [0, 0], [0.1, 0], 0.01)
    bed.attach()
    assert "attached already" in refused(bed.attach)
    assert "attached already" in refused(bed.add_rigid, made.second, [0, 0], [0.1, 0], 0.01)
    assert "attached already" in refused(bed.add_cables, cables(made.mbs), 0.01)


def test_long_beams_have_one_free_end() -> None:
    """However many pieces a beam is evaluated in, its end face is at the last element, and counts once."""
    made = script()
    elements = cables(made.mbs, 30)
    bed = GranularBed(made.mbs, SAND, 0.0, end_cap=True)
    bed.add_cables(elements, 0.01)
    lines = bed.load.lines
    assert len(lines) > 1
    last = max(line.body.coordinates[-1] for line in lines)
    assert [line.body.coordinates[-1] == last for line in lines] == [bool(line.record["cap"][0]) for line in lines]
    assert sum(len(line.body.coordinates) // 4 - 1 for line in lines) == 30
    bound = GranularBed(made.mbs, SAND, 0.0, end_cap=True)
    bound.add_cables(elements, 0.01, free_end=False)
    assert not any(line.record["cap"][0] for line in bound.load.lines)


def test_no_cables_are_refused() -> None:
    assert "at least one" in refused(GranularBed(script().mbs, SAND, 0.0).add_cables, [], 0.01)


@pytest.mark.parametrize("strips", [0, -1, 2.5, float("nan")])
def test_strips_are_counted(strips: float) -> None:
    system = script()
    bed = GranularBed(system.mbs, SAND, 0.0)
    message = refused(bed.add_rigid, system.first, [0, 0], [0.1, 0], 0.01, strips=strips)
    assert f"strips: got {strips}" in message


def test_points_lie_in_the_plane() -> None:
    system = script()
    bed = GranularBed(system.mbs, SAND, 0.0)
    assert "z = 0.2 m" in refused(bed.add_rigid, system.first, [0, 0, 0.2], [0.1, 0, 0], 0.01)
    assert "shape (1, 1)" in refused(bed.add_ball, system.first, [0.0], 0.01)
    bed.add_rigid(system.first, [0, 0, 0], [0.1, 0, 0], 0.01)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: replace(SAND, density=-2500.0), r"^LeeMarghitu.density: got -2500.0, allowed is a number above 0$"),
        (lambda: VerticalResistance(np.nan, 1.1), r"eta_v: got nan, allowed is a number of at least 0"),
        (lambda: Elastoplastic(-1e-5), r"yield_displacement: got -1e-05, allowed is a number above 0"),
        (lambda: Elastoplastic(0.0), "above 0"),
        (lambda: Smooth(-1e-3), r"Smooth.reference_speed"),
        (lambda: Layer(SAND, 0.1, 0.05), r"top 0.1 and bottom 0.05"),
        (lambda: Smooth(np.inf), r"reference_speed: got inf"),
    ],
)
def test_faulty_media_in_python_are_refused(make: Callable[[], Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        make()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"form": "distributd"}, "distributd"),
        ({"surface": np.nan}, "surface"),
        ({"gravity": np.inf}, "gravity"),
    ],
)
def test_bad_numbers_and_words_are_refused(options: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        GranularBed(script().mbs, SAND, **({"surface": 0.0} | options))


def test_work_and_force_are_zero_before_a_solve() -> None:
    made = script()
    bed = bed_on(made.mbs, made.first)
    bed.attach()
    made.mbs.Assemble()
    assert bed.work == 0.0
    assert not bed.force.any()
    assert len(bed.history.time) == 0


def dropped(spatial: bool, step: float) -> tuple[np.ndarray, GranularBed]:
    """Tip (2,) m after 0.1 s of a slanted stick thrown into the sand, as a planar body or as a spatial one."""
    mbs = exu.SystemContainer().AddSystem()
    if spatial:
        body = mbs.CreateRigidBody(
            inertia=RigidBodyInertia(mass=MASS, inertiaTensor=np.diag([1e-5, INERTIA, INERTIA])),
            referencePosition=[0, 0.15, 0],
            referenceRotationMatrix=RotationMatrixZ(-1.0),
            initialVelocity=[0.5, -2, 0],
            initialAngularVelocity=[0, 0, 3],
            gravity=[0, -G, 0],
        )
    else:
        node = mbs.AddNode(
            items.NodeRigidBody2D(referenceCoordinates=[0, 0.15, -1.0], initialVelocities=[0.5, -2.0, 3.0])
        )
        body = mbs.AddObject(items.ObjectRigidBody2D(mass=MASS, inertia=INERTIA, nodeNumber=node))
        middle = mbs.AddMarker(items.MarkerBodyMass(bodyNumber=body))
        mbs.AddLoad(items.LoadMassProportional(markerNumber=middle, loadVector=[0, -G, 0]))
    bed = bed_on(mbs, body, 0.0)
    bed.attach()
    mbs.Assemble()
    mbs.SolveDynamic(settings(step, 0.1))
    tip = mbs.GetObjectOutputBody(body, exu.OutputVariableType.Position, localPosition=[HALF, 0, 0])
    return np.array(tip)[:2], bed


@pytest.mark.slow
def test_spatial_bodies_move_as_planar_ones() -> None:
    (flat, flat_bed), (deep, deep_bed) = dropped(False, 1e-4), dropped(True, 1e-4)
    # Rates of Euler parameters are integrated to second order too: at half the step the two are four times closer.
    finer = np.linalg.norm(dropped(False, 5e-5)[0] - dropped(True, 5e-5)[0])
    assert finer < 1e-6
    assert np.linalg.norm(deep - flat) < 6 * finer + 1e-9
    assert deep_bed.work == pytest.approx(flat_bed.work, rel=1e-5)
    # The resultant of the load on the body is what the bed keeps under its name.
    np.testing.assert_allclose(next(iter(deep_bed.bodies.values()))[:2], deep_bed.force, rtol=1e-12)


def test_spatial_bodies_of_other_parametrisations_are_refused() -> None:
    mbs = exu.SystemContainer().AddSystem()
    body = mbs.CreateRigidBody(
        inertia=RigidBodyInertia(mass=MASS, inertiaTensor=np.diag([1e-5, INERTIA, INERTIA])),
        nodeType=exu.NodeType.RotationRotationVector,
    )
    assert "RigidBodyEP" in refused(GranularBed(mbs, SAND, 0.0).add_rigid, body, [0, 0], [0.1, 0], 0.01)


@pytest.mark.parametrize(
    ("turn", "velocity", "spin", "planar"),
    [
        (np.eye(3), [0, -1, 0], [0, 0, 2], True),
        (RotationMatrixX(np.pi), [0, -1, 0], [0, 0, 2], True),  # upside down: its z axis points the other way
        (RotationMatrixY(0.8), [0, -1, 0], [0, 0, 0], False),
        (np.eye(3), [0, -1, 0.3], [0, 0, 0], False),
        (np.eye(3), [0, -1, 0], [0, 5, 0], False),
        (RotationMatrixX(np.pi), [0, -1, 0], [0, 5, 0], False),
    ],
)
def test_spatial_bodies_start_in_the_plane(turn: Any, velocity: Any, spin: Any, planar: bool) -> None:
    mbs = exu.SystemContainer().AddSystem()
    body = mbs.CreateRigidBody(
        inertia=RigidBodyInertia(mass=MASS, inertiaTensor=np.diag([1e-5, INERTIA, INERTIA])),
        referenceRotationMatrix=turn,
        initialVelocity=velocity,
        initialAngularVelocity=spin,
    )
    bed = GranularBed(mbs, SAND, 0.0)
    if planar:
        bed.add_rigid(body, [0, 0], [0.1, 0], 0.01)
    else:
        assert "does not move in the x-y plane" in refused(bed.add_rigid, body, [0, 0], [0.1, 0], 0.01)


def test_a_spatial_body_that_leaves_the_plane_ends_the_solve() -> None:
    mbs = exu.SystemContainer().AddSystem()
    body = mbs.CreateRigidBody(
        inertia=RigidBodyInertia(mass=MASS, inertiaTensor=np.diag([1e-5, INERTIA, INERTIA])),
        referencePosition=[0, 0.15, 0],
        initialVelocity=[0, -2, 0],
    )
    side = mbs.AddMarker(items.MarkerBodyRigid(bodyNumber=body, localPosition=[0.1, 0, 0]))
    mbs.AddLoad(items.LoadForceVector(markerNumber=side, loadVector=[0, 0, 0.05]))
    bed = GranularBed(mbs, SAND, 0.0)
    bed.add_rigid(body, [-HALF, 0], [HALF, 0], DIAMETER)
    bed.attach()
    mbs.Assemble()
    settings = exu.SimulationSettings()
    settings.solution.file.write = False
    settings.timeIntegration.numberOfSteps, settings.timeIntegration.endTime = 1000, 0.4
    with pytest.raises(exu.ExudynError, match="a body has left the x-y plane"):
        mbs.SolveDynamic(settings)
    # 0.005 N m on 2e-4 kg m2 turn it by 0.01 rad in 28 ms.
    assert bed.history.time[-1] == pytest.approx(0.028, abs=2e-3)


def test_an_outline_whose_sides_cross_is_refused() -> None:
    system = script()
    corners = [[0, 0], [0.1, 0.1], [0.1, 0], [0, 0.2]]
    bed = GranularBed(system.mbs, preset("rft_generic"), 0.0)
    assert "cross" in refused(bed.add_outline, system.first, corners, 0.01)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"medium": "play_sand"}, "preset"),
        ({"medium": None}, "preset"),
        ({"medium": []}, "at least one"),
        ({"static": "elastoplastic"}, r"Elastoplastic\(\)"),
        ({"floor": -0.1}, "a Floor"),
        ({"gravity": [0, -9.81, 0]}, "magnitude"),
        ({"gravity": "9.81"}, "gravity: got '9.81', allowed is a finite number"),
        ({"gravity": None, "up": (0, 0, 1)}, "gravity: got None, allowed is a finite number"),
        ({"surface": "0"}, "surface: got '0', allowed are finite numbers"),
        ({"surface": "0", "up": (0, 0, 1)}, "surface: got '0', allowed in space is a finite number"),
        ({"surface": None, "up": (0, 0, 1)}, "surface: got None, allowed in space is a finite number"),
        ({"slope": "0", "up": (0, 0, 1)}, "slope: got 0, allowed in space are three finite numbers"),
        ({"up": "z"}, "up: got 'z', allowed is a direction of three finite numbers"),
        ({"floor": Floor(0.1, 1e6)}, r"floor: got a height of 0\.1 m, with the surface at 0 m; allowed is below it"),
        ({"floor": Floor(0.0), "up": (0, 0, 1)}, "floor: got a height of 0 m, with the surface at 0 m"),
    ],
)
def test_arguments_of_the_wrong_type_are_refused(options: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        GranularBed(script().mbs, **({"medium": SAND, "surface": 0.0} | options))


def test_a_floor_of_impossible_numbers_is_refused() -> None:
    """Of damping below 0 it would give energy, of stiffness below 0 pull."""
    for numbers, message in (
        ((float("nan"),), "height of nan, allowed is a finite number"),
        ((-0.1, -1e6), "stiffness of -1000000.0, allowed is a number above 0, or None"),
        ((-0.1, 1e6, -0.5), "damping of -0.5, allowed is 0 or more"),
    ):
        with pytest.raises(ValueError, match=message):
            Floor(*numbers)
    steep = GranularBed(script().mbs, SAND, 0.0, slope=0.1, floor=Floor(0.1, 1e6))  # below it from x = 1 m on
    assert steep.load.floor is not None


@pytest.mark.parametrize(("up", "first"), [(None, "add_rigid"), ((0, 0, 1), "add_body")])
def test_a_bed_without_bodies_names_the_method_that_adds_them(up: Any, first: str) -> None:
    bed = GranularBed(script().mbs, SAND if up is None else preset("rft3d_sand"), 0.0, up=up)
    assert f"no body was named: use {first} or add_cables first" in refused(bed.attach)


def test_a_beam_in_several_pieces_is_one_body() -> None:
    mbs = exu.SystemContainer().AddSystem()
    bed = GranularBed(mbs, SAND, 0.0)
    bed.add_cables(cables(mbs, 2 * ELEMENTS_PER_LINE + 1), 0.01)
    assert len(bed.load.lines) == 3
    bed.attach()
    assert list(bed.bodies) == [mbs.GetObject(0)["name"]]


# ---- one solve after another ----


def solved(system: Script, start: float, end: float, *, goes_on: bool = False) -> None:
    settings = exu.SimulationSettings()
    settings.solution.file.write = False
    settings.timeIntegration.startTime, settings.timeIntegration.endTime = start, end
    settings.timeIntegration.numberOfSteps = round((end - start) / 2e-4)
    system.mbs.SolveDynamic(settings, updateInitialValues=goes_on)


def in_sand() -> tuple[Script, GranularBed]:
    system = script(1)
    bed = GranularBed(system.mbs, SAND, 0.05)
    bed.add_rigid(system.first, [-HALF, 0], [HALF, 0], DIAMETER)
    bed.attach()
    system.mbs.Assemble()
    return system, bed


def test_a_solve_from_a_later_time_starts_a_new_history() -> None:
    system, bed = in_sand()
    solved(system, 0.0, 0.1)
    first = bed.history
    solved(system, 1.0, 1.1)
    second = bed.history
    assert len(second.time) == len(first.time)
    # Times differ by round-off of 1 + t, and what is integrated over them.
    assert bed.work == pytest.approx(first.work[-1], rel=1e-9)
    assert second.time[0] == 1.0


def test_a_solve_that_goes_on_keeps_what_was() -> None:
    system, bed = in_sand()
    solved(system, 0.0, 0.05, goes_on=True)
    solved(system, 0.05, 0.1)
    in_two, work = len(bed.history.time), bed.work
    system, bed = in_sand()
    solved(system, 0.0, 0.1)
    assert in_two == len(bed.history.time)
    # The engine's accelerations start from zero in the second solve: an error of its first step.
    assert work == pytest.approx(bed.work, rel=1e-3)


def test_numbers_read_in_every_step_are_those_of_the_history() -> None:
    system, bed = in_sand()
    seen: list[tuple[float, float, float]] = []

    def after_step(*_: Any) -> bool:
        seen.append((bed.work, *bed.force))
        return True

    system.mbs.SetPostStepUserFunction(after_step)
    solved(system, 0.0, 0.1)
    history = bed.history
    expected = np.column_stack([history.work, history.terms[:, :, :2].sum(axis=1)])[-len(seen) :]
    # Sums of the same numbers in another order.
    np.testing.assert_allclose(seen, expected, rtol=1e-12, atol=1e-12 * np.abs(expected).max())


# ---- as a method of Exudyn's systems ----


def test_the_method_of_systems_is_the_bed() -> None:
    import granular_contact.exudyn  # noqa: F401

    pushes = []
    for create in (
        lambda mbs: GranularBed(mbs, preset("play_sand"), 0.01),
        lambda mbs: mbs.CreateGranularBed("play_sand", 0.01),
    ):
        model = script(1)
        bed = create(model.mbs)
        bed.add_rigid(model.first, [-HALF, 0], [HALF, 0], DIAMETER)
        bed.attach()
        model.mbs.Assemble()
        model.mbs.SolveDynamic(settings(1e-3))
        pushes.append(bed.force)
    assert np.linalg.norm(pushes[0]) > 0.1
    np.testing.assert_array_equal(*pushes)
    created.bind()  # once more is nothing
    assert "CreateGranularBed" in dir(exu.MainSystem)
    arguments = list(signature(exu.MainSystem.CreateGranularBed).parameters)
    assert arguments == list(signature(GranularBed).parameters)


@pytest.mark.parametrize("how", ["taken", "absent", "idle"])
def test_exudyn_without_extensions_of_systems_is_refused_with_advice(how: str, monkeypatch: pytest.MonkeyPatch) -> None:
    class System:
        """As those of Exudyn."""

    if how == "taken":
        System.CreateGranularBed = lambda _: None  # type: ignore[attr-defined]
    elif how == "absent":
        monkeypatch.delattr("exudyn.misc.extensionRegistry.extends")
    else:
        monkeypatch.setattr("exudyn.misc.extensionRegistry.install", lambda: None)
    with pytest.raises(ImportError, match=r"GranularBed\(mbs, \.\.\.\) is the same"):
        created.bind(System)
