"""Beams of an Exudyn script in sand: cables and geometrically exact beams, in the plane and in space."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import exudyn as exu
import exudyn.itemInterface as items
import numpy as np
import pytest
from support_models import one_body
from support_refusals import message_of

from granular_contact import GranularBed, load, preset, simulate
from granular_contact.errors import SceneError
from granular_contact.geometry import rotations
from granular_contact.sand.contact_lines import Body
from granular_contact.sand.space import cables
from granular_contact.sand.space.load import SpatialLoad
from validation.spatial_beam import implicit

# A rod of soft plastic, clamped to a wall, falls onto sand.
LENGTH, DIAMETER, YOUNG, DENSITY, SURFACE, END, STEP = 0.4, 0.006, 2e9, 1200.0, -0.008, 0.1, 5e-4
AREA, SECOND, SHEAR = np.pi / 4 * DIAMETER**2, np.pi / 64 * DIAMETER**4, 2e9 / 2.6
STIFF = {"bendingStiffness": YOUNG * SECOND, "axialStiffness": YOUNG * AREA}
PLANAR = {"cable2d", "exact2d"}


def nodes_of(mbs: Any, kind: str, count: int, turn: float) -> list[Any]:
    """Nodes of a rod along x, in space turned about the vertical."""
    c, s, half = np.cos(turn), np.sin(turn), 0.5 * turn
    make: dict[str, tuple[Any, list[float]]] = {
        "cable": (items.NodePointSlope1, [c, s, 0]),
        "exact": (items.NodeRigidBodyEP, [np.cos(half), 0, 0, np.sin(half)]),
        "cable2d": (items.NodePoint2DSlope1, [1, 0]),
        "exact2d": (items.NodeRigidBody2D, [0]),
    }
    node, more = make[kind]
    places = [[x, 0] if kind in PLANAR else [x * c, x * s, 0] for x in np.linspace(0, LENGTH, count + 1)]
    return [mbs.AddNode(node(referenceCoordinates=[*place, *more])) for place in places]


def element(mbs: Any, kind: str, nodes: Any, length: float) -> Any:
    line: dict[str, Any] = {"nodeNumbers": list(nodes), "length": length}
    if kind != "exact":
        line |= STIFF | {"massPerLength": DENSITY * AREA}
    if kind == "exact":
        data = exu.BeamSection()
        stretch, shear, torsion, bending = YOUNG * AREA, SHEAR * AREA, 2 * SHEAR * SECOND, YOUNG * SECOND
        data.stiffnessMatrix = np.diag([stretch, shear, shear, torsion, bending, bending])
        data.inertia, data.massPerLength = DENSITY * np.diag([2 * SECOND, SECOND, SECOND]), DENSITY * AREA
        return mbs.AddObject(items.ObjectBeamGeometricallyExact(**line, sectionData=data))
    if kind == "exact2d":
        more = {"crossSectionInertia": DENSITY * SECOND, "shearStiffness": SHEAR * AREA}
        return mbs.AddObject(items.ObjectBeamGeometricallyExact2D(**line, **more))
    made = items.ObjectANCFCable if kind == "cable" else items.ObjectANCFCable2D
    return mbs.AddObject(made(**line))


def fallen(kind: str, count: int, medium: str, turn: float = 0.0, **options: Any) -> tuple[np.ndarray, GranularBed]:
    """Times and height of the axis at the tip (2, n), and the bed."""
    mbs = exu.SystemContainer().AddSystem()
    nodes = nodes_of(mbs, kind, count, turn)
    ground = mbs.AddMarker(items.MarkerNodeCoordinate(nodeNumber=mbs.AddNode(items.NodePointGround()), coordinate=0))
    held = [0, 1, 2, 4, 5, 6] if kind == "exact" else range(len(mbs.GetNode(nodes[0])["referenceCoordinates"]))
    for i in held:  # the norm of Euler parameters holds the fourth
        marker = mbs.AddMarker(items.MarkerNodeCoordinate(nodeNumber=nodes[0], coordinate=i))
        mbs.AddObject(items.ObjectConnectorCoordinate(markerNumbers=[ground, marker]))
    elements = [element(mbs, kind, pair, LENGTH / count) for pair in pairwise(nodes)]
    down = [0, -9.81, 0] if kind in PLANAR else [0, 0, -9.81]
    for number in elements:
        marker = mbs.AddMarker(items.MarkerBodyMass(bodyNumber=number))
        mbs.AddLoad(items.LoadMassProportional(markerNumber=marker, loadVector=down))
    up = {} if kind in PLANAR else {"up": (0, 0, 1)}
    bed = GranularBed(mbs, preset(medium), SURFACE, **up)
    bed.add_cables(elements, DIAMETER, name="rod", **options)
    bed.attach()
    position = exu.OutputVariableType.Position
    sensor = mbs.AddSensor(items.SensorNode(nodeNumber=nodes[-1], storeInternal=True, outputVariableType=position))
    mbs.Assemble()
    mbs.SolveDynamic(implicit(END, STEP))
    kept = mbs.GetSensorStoredData(sensor)
    return np.array([kept[:, 0], kept[:, 2 if kind in PLANAR else 3]]), bed


def scene(medium: str) -> Any:
    """The same rod as a scene of 16 rigid elements."""
    flexible = {"youngs_modulus_Pa": YOUNG, "elements": 16}
    rod = {"type": "link", "length_m": LENGTH, "diameter_m": DIAMETER, "density_kg_m3": DENSITY, "flexible": flexible}
    model = one_body("rod", rod, "wall", "weld")
    solver = {"end_time_s": END, "step_s": STEP, "spectral_radius": 0.9, "rest_time_s": None}
    return simulate(load({"model": model, "solver": solver, "medium": medium, "bed": {"height_m": SURFACE}}))


@pytest.mark.slow
@pytest.mark.parametrize("medium", ["play_sand", "rft3d_sand"])
def test_a_rod_of_a_script_falls_as_that_of_a_scene(medium: str) -> None:
    """Elements of 1/16 of the length are off by some 2e-3 of the way in the air, see validation/spatial_beam.py.

    Sand stops the tip 8 mm below; facets of a length are met at another instant than others of it, some 50 um apart.
    """
    results = scene(medium)
    for kind, count in (("cable", 8), ("exact", 16)):
        (t, z), bed = fallen(kind, count, medium)
        off = np.abs(np.interp(results["time_s"], t, z) - results["rod_deflection_z_m"]).max()
        way = np.abs(np.diff(results["rod_deflection_z_m"])).sum()
        assert off < (0.01 if medium == "play_sand" else 0.1) * way
        assert bed.work == pytest.approx(results["granular_work_J"][-1], rel=0.03 if medium == "play_sand" else 0.2)
        assert bed.work < -1e-4


@pytest.mark.slow
def test_beams_of_the_plane_fall_as_those_in_space() -> None:
    """All have errors of less than 1 % of the way; without sand they fall 9 mm farther."""
    (_, first), bed = fallen("cable2d", 8, "play_sand")
    way = np.abs(np.diff(first)).sum()
    for kind, count in (("exact2d", 16), ("cable", 8)):
        (_, z), other = fallen(kind, count, "play_sand")
        assert np.abs(z - first).max() < 0.01 * way
        assert other.work == pytest.approx(bed.work, rel=0.03)


@pytest.mark.parametrize("kind", ["cable", "exact"])
def test_a_beam_turned_about_the_vertical_falls_the_same(kind: str) -> None:
    """To what Newton's method leaves open: 1e-5 N on a rod of 3 E I / L^3 = 6 N/m."""
    (_, z), _ = fallen(kind, 4, "play_sand")
    (_, turned), _ = fallen(kind, 4, "play_sand", turn=0.7)
    np.testing.assert_allclose(turned, z, atol=2e-6)


# ---- a piece of a cable, without an engine ----


def cable(medium: str, strips: int = 1) -> tuple[SpatialLoad, np.ndarray]:
    """A load on one cubic element of 0.1 m in the sand, bent and turned, and its coordinates."""
    made, L = SpatialLoad(preset(medium), 0.0), 0.1
    straight = np.array([[0, 0, 0, 1, 0, 0], [L, 0, 0, 1, 0, 0]], float)
    cables.add(made, cables.cubic("c", np.arange(12).reshape(2, 6), straight, [L], strips), 0.01, 4, True)
    q = np.array([0, 0, -0.02, 0.9, 0.3, -0.2, 0.09, 0.03, -0.05, 0.8, 0.5, -0.4])
    return made, q


@pytest.mark.parametrize("medium", ["play_sand", "rft3d_sand"])
def test_a_piece_of_a_cable_is_met_as_a_rigid_body_at_its_place(medium: str) -> None:
    """The same wrench, and the power of the generalised forces is that of the wrench."""
    made, q = cable(medium)
    v = np.array([0.1, -0.2, -0.3, 0.5, 1.0, -2.0, 0.2, 0.1, -0.4, 1.0, -1.0, 0.7])
    made.start(q)
    made.accept(0.0, q, v)
    f = made.force(q, v, np.zeros(12))
    shape = np.array(made.lines[0].body.piece.shape).reshape(2, 4)
    (x, slope), (u, rate) = shape @ q.reshape(4, 3), shape @ v.reshape(4, 3)
    spin, axis = np.cross(slope, rate) / (slope @ slope), slope / np.linalg.norm(slope)
    rigid, turn = SpatialLoad(preset(medium), 0.0), np.cross([1, 0, 0], axis)
    turn *= np.arcsin(np.linalg.norm(turn)) / np.linalg.norm(turn)
    e = rotations.quaternion_of(rotations.of_vector(turn))
    body = cables.Piece(Body("c", range(7)), np.array([-0.05, 0, 0]), np.array([0.05, 0, 0]), np.zeros(3))
    cables.add(rigid, [body], 0.01, 4, True)
    coordinates, rates = np.concatenate([x, e]), np.concatenate([u, rotations.quaternion_rates(e, spin)])
    rigid.start(coordinates)
    rigid.accept(0.0, coordinates, rates)
    assert np.linalg.norm(f) > 0.1
    np.testing.assert_allclose(made.history.bodies[-1], rigid.history.bodies[-1], rtol=1e-9, atol=1e-9)
    assert f @ v == pytest.approx(rigid.force(coordinates, rates, np.zeros(7)) @ rates, rel=1e-9)


@pytest.mark.parametrize(("medium", "near"), [("play_sand", 1e-3), ("rft3d_sand", 0.05)])
def test_tangent_of_a_cable_is_the_derivative_of_its_forces(medium: str, near: float) -> None:
    """Production takes one-sided differences, which facets that begin to lead within them change by some per cent."""
    made, q = cable(medium, 2)
    v = np.array([0.1, -0.2, -0.3, 0.5, 1.0, -2.0, 0.2, 0.1, -0.4, 1.0, -1.0, 0.7])
    made.start(q)
    made.accept(0.0, q, v)
    fq, fv, d = 1.0, 0.01, 1e-7
    K = np.zeros((12, 12))
    for i, j, value in made.tangent(q, v, fq, fv):
        K[int(i), int(j)] += value
    for j in range(12):
        e = np.eye(12)[j] * d
        ahead = made.force(q + fq * e, v + fv * e, np.zeros(12))
        back = made.force(q - fq * e, v - fv * e, np.zeros(12))
        np.testing.assert_allclose(K[:, j], (ahead - back) / (2 * d), rtol=near, atol=near * np.abs(K).max())


# ---- what is refused ----


def refused(kind: str, up: Any = None, **options: Any) -> str:
    mbs = exu.SystemContainer().AddSystem()
    nodes = nodes_of(mbs, kind, 2, 0.0)
    elements = [element(mbs, kind, pair, 0.2) for pair in pairwise(nodes)]
    bed = GranularBed(mbs, preset("play_sand"), 0.0, up=up)
    return message_of(SceneError, bed.add_cables, elements, **options)


def test_beams_that_do_not_fit_the_bed_are_refused() -> None:
    up = (0, 0, 1)
    assert "allowed is ANCFCable or BeamGeometricallyExact3D" in refused("cable2d", up, diameter=0.01)
    assert "allowed is ANCFCable2D or BeamGeometricallyExact2D" in refused("cable", diameter=0.01)
    assert "no frame of its section" in refused("cable", up, section=(0.01, 0.02))
    assert "give diameter or section" in refused("exact", up)
    assert "got width" in refused("exact", up, width=0.01)
    assert "section: got" in refused("exact", up, section=(0.01, -1.0))
    assert "nothing acts on a Beam" in refused("exact", up, section=(0.01, 0.02))  # the medium is one of bars
    assert "got section" in refused("cable2d", diameter=0.01, section=(0.01, 0.02))


def test_surface_medium_beside_a_bar_medium_warns_that_it_does_not_act() -> None:
    """A round beam is a bar for the one, and left out by the other, which alone would act on its skin."""
    mbs = exu.SystemContainer().AddSystem()
    row = [element(mbs, "cable", nodes_of(mbs, "cable", 1, 0.0), LENGTH)]
    bed = GranularBed(mbs, [preset("play_sand"), preset("rft3d_sand")], SURFACE, up=(0, 0, 1))
    with pytest.warns(UserWarning, match="rod is met as a bar, by play_sand: rft3d_sand does not act on it"):
        bed.add_cables(row, DIAMETER, name="rod")


def test_cables_need_elements_of_one_kind_with_two_nodes() -> None:
    mbs = exu.SystemContainer().AddSystem()
    row = [element(mbs, kind, nodes_of(mbs, kind, 1, 0.0), LENGTH) for kind in ("cable", "exact")]
    three = element(mbs, "exact2d", nodes_of(mbs, "exact2d", 2, 0.0), LENGTH)
    with pytest.raises(SceneError, match=r"allowed is ANCFCable$"):
        GranularBed(mbs, preset("play_sand"), 0.0, up=(0, 0, 1)).add_cables(row, 0.01)
    with pytest.raises(SceneError, match="has 3 nodes, allowed are 2"):
        GranularBed(mbs, preset("play_sand"), 0.0).add_cables([three], 0.01)
    bed = GranularBed(mbs, preset("play_sand"), 0.0, form="resultant")
    beam = element(mbs, "exact2d", nodes_of(mbs, "exact2d", 1, 0.0), LENGTH)
    with pytest.raises(SceneError, match="resultant"):
        bed.add_cables([beam], 0.01)


def test_two_rods_of_the_same_name_are_separate_bodies() -> None:
    """Two rods in space by one name: each is met where it is."""
    made = SpatialLoad(preset("play_sand"), 0.0)
    for first in (0, 7):
        piece = cables.Piece(Body("rod", range(first, first + 7)), np.zeros(3), np.array([0.1, 0, 0]), np.zeros(3))
        cables.add(made, [piece], 0.01, 4, True)
    q = np.array([0, 0, -0.1, 1, 0, 0, 0, 0, 0, 0.1, 1, 0, 0, 0])
    v = np.tile([0, 0, -0.1, 0, 0, 0, 0], 2)
    made.start(q)
    made.accept(0.0, q, v)
    f = made.force(q, v, np.zeros(14))
    assert f[2] > 0.1
    assert not f[7:].any()
