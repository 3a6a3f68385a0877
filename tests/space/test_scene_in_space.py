"""A mechanism in space from a mapping: faults of its schema, mass properties, placing, loops."""

from __future__ import annotations

import copy
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support_models import one_body
from support_refusals import CONFIG_OR_SCENE, message_of

from granular_contact import Box
from granular_contact.cli.common import read
from granular_contact.config import load
from granular_contact.config.schema.space import shapes as specs
from granular_contact.errors import SceneError
from granular_contact.geometry import rotations
from granular_contact.scene import build
from granular_contact.scene.homes import HomeNote
from granular_contact.scene.space.mass_properties import of_surface
from granular_contact.scene.space.shapes import build_shape
from granular_contact.scene.space.types import SpatialScene

BOX = {"type": "box", "size_m": [0.06, 0.04, 0.03]}
RUN: dict[str, Any] = {
    "model": one_body("box", {"type": "rigid", "density_kg_m3": 2000, "shapes": [BOX]}),
    "medium": "rft3d_sand",
    "surface_height_m": 0,
    "initial": {"joints": {"flight": {"z_m": 0.06, "rpy_deg": [20, 35, 10], "vx_m_s": 0.5, "vz_m_s": -1}}},
}


def changed(path: str, value: Any) -> dict[str, Any]:
    """The run with another value at a path."""
    run = copy.deepcopy(RUN)
    *way, last = path.split(".")
    node: Any = run
    for key in way:
        node = node[int(key) if isinstance(node, list) else key]
    node[last] = value
    return run


def scene_of(run: dict[str, Any]) -> SpatialScene:
    scene = build(load(run))
    assert isinstance(scene, SpatialScene)
    return scene


BEAM = {"type": "link", "length_m": 0.2, "diameter_m": 0.01, "density_kg_m3": 2000}
SOFT = {"youngs_modulus_Pa": 1e9, "elements": 4, "axial_stiffness_N": 1e5}
FIXED = {
    "in_space": True,
    "name": "held twice",
    "bodies": {
        "beam": BEAM | {"flexible": SOFT},
        "crank": BEAM,
    },
    "joints": {
        "clamp": {"type": "weld", "parent": "ground", "child": "beam"},
        "elbow": {
            "type": "hinge",
            "axis": [0, 1, 0],
            "parent": "beam",
            "child": "crank",
            "parent_point_m": [0.2, 0, 0],
        },
    },
    "closures": {"back": {"type": "ball", "parent": "crank", "child": "beam", "parent_point_m": [0.2, 0, 0]}},
}
TENSOR = {"xx": 1, "yy": 1, "zz": 3}
FAULTS = {
    "no body has it": (
        changed("model.bodies.box", {"type": "rigid", "mass_kg": 1, "inertia_kg_m2": TENSOR}),
        "model.bodies.box.inertia_kg_m2: no body has the principal moments 1, 1, 3",
    ),
    "massless": (changed("model.bodies.box", {"type": "rigid"}), "model.bodies.box.density_kg_m3: is missing"),
    "two numbers": (
        changed("model.bodies.box.shapes", [BOX | {"size_m": [1, 2]}]),
        "model.bodies.box.shapes.0.size_m: got a list of 2 items; allowed is a list of 3 numbers",
    ),
    "two orientations": (
        changed("initial.joints.flight.quaternion", [1, 0, 0, 0]),
        "initial.joints.flight.quaternion: stands beside rpy_deg",
    ),
    "key without its unit": (changed("initial.joints.flight.z", 1.0), "flight.z: unknown key; did you mean z_m?"),
    "key of the plane": (changed("initial.joints.flight.angle_deg", 3), "flight is a free joint; allowed are x_m"),
    "method": (changed("method", "reduced"), "method.reduced.modes: got 1, but the model has no link that bends"),
    "no mesh": (
        changed("model.bodies.box.shapes", [{"type": "mesh", "file": "nowhere.stl"}]),
        "model.bodies.box.shapes.0.file: there is no such file",
    ),
    "closure to what is fixed": (
        RUN | {"model": FIXED, "initial": {}},
        "model.closures.back.child: beam is fixed to the ground: make it the parent",
    ),
    "law of bars": (
        changed("medium", "hill_cylinders"),
        "model.bodies.box: its box can get into the sand, but in space hill_cylinders takes bars; "
        "laws for it are rft, drft, rft3d, pressure_sinkage, reece, table; in_sand: false leaves a shape out",
    ),
}


@pytest.mark.parametrize("name", FAULTS)
def test_faults_name_their_key(name: str) -> None:
    run, message = FAULTS[name]
    assert message in message_of(CONFIG_OR_SCENE, scene_of, run)


MESHED = """model:
  in_space: true
  name: rock
  bodies:
    rock:
      type: rigid
      density_kg_m3: 2000
      shapes:
        - type: mesh
          file: rock.obj
  joints: {flight: {type: free, parent: ground, child: rock}}
medium: rft3d_sand
surface_height_m: 0
initial: {joints: {flight: {z_m: 0.06}}}
"""


def test_a_mesh_in_pieces_is_reported_at_its_key(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Two boxes of which one stands half in the other: loaded with notices; one alone silently."""
    for name, move in (("one", None), ("two", [0.03, 0.004, 0.005])):
        corners = Box((0.06, 0.04, 0.03)).corners(0.02)
        corners = corners if move is None else np.concatenate([corners, corners + move])
        points = "\n".join("v " + " ".join(f"{x:.9g}" for x in point) for point in corners.reshape(-1, 3))
        lines = "\n".join(f"f {3 * i + 1} {3 * i + 2} {3 * i + 3}" for i in range(len(corners)))
        (tmp_path / "rock.obj").write_text(f"{points}\n{lines}\n")
        (tmp_path / "run.yaml").write_text(MESHED)
        _, scene = read(str(tmp_path / "run.yaml"))
        printed = capsys.readouterr().err.splitlines()
        assert (len(printed), len(scene.notes)) == ((0, 0) if name == "one" else (2, 2))
    assert all(
        f"run.yaml:{MESHED.splitlines().index('          file: rock.obj') + 1}: model.bodies.rock" in t for t in printed
    )
    assert "of its area lies inside it" in printed[0]
    assert 15 < int(printed[0].split("about ")[1].split(" %")[0]) < 40  # 25 % of it, by 64 points
    assert "2 loose parts" in printed[1]


SHAPES = [
    specs.SpatialBox(type="box", size_m=(0.1, 0.2, 0.3)),
    specs.SpatialCylinder(type="cylinder", diameter_m=0.1, length_m=0.3),
    specs.SpatialSphere(type="sphere", diameter_m=0.2),
    specs.SpatialCapsule(type="capsule", diameter_m=0.1, length_m=0.2),
    specs.SpatialCone(type="cone", diameter_m=0.1, height_m=0.2),
    specs.SpatialPolygon(type="polygon", points_m=((0, 0), (0.1, 0), (0.1, 0.1), (0.05, 0.02), (0, 0.1)), width_m=0.05),
]


@pytest.mark.parametrize("spec", SHAPES, ids=lambda spec: spec.type)
def test_mass_properties_are_those_of_the_surface(spec: Any) -> None:
    shape, mass_properties = build_shape(spec)
    seen = of_surface(shape.corners(0.01))  # round ones are many-sided, with as much area in every section
    np.testing.assert_allclose(mass_properties.mass, seen.mass, rtol=5e-4)
    np.testing.assert_allclose(mass_properties.center, seen.center, atol=1e-9)
    np.testing.assert_allclose(mass_properties.inertia, seen.inertia, atol=1e-3 * mass_properties.inertia.max())


def test_rotations_turn_back() -> None:
    random = np.random.default_rng(2)
    for _ in range(20):
        R = rotations.of_quaternion(random.normal(size=4))
        np.testing.assert_allclose(rotations.of_quaternion(rotations.quaternion_of(R)), R, atol=1e-14)
        np.testing.assert_allclose(rotations.of_rpy(rotations.rpy_of(R)), R, atol=1e-14)
        np.testing.assert_allclose(rotations.of_vector(rotations.vector_of(R)), R, atol=1e-13)
        axis = random.normal(size=3)
        np.testing.assert_allclose(rotations.to_axis(axis)[:, 2], axis / np.linalg.norm(axis), atol=1e-15)


def test_welded_bodies_are_one_whatever_frames_they_are_written_in() -> None:
    """Two halves of a box, the second in a frame of its own that is turned and moved, are the box."""
    half = {"type": "rigid", "density_kg_m3": 2000, "shapes": [{**BOX, "size_m": [0.03, 0.04, 0.03]}]}
    turned = copy.deepcopy(half)
    turned["shapes"][0] |= {"center_m": [0.01, 0.02, 0.03], "rpy_deg": [0, 0, 90]}
    behind = half | {"shapes": [half["shapes"][0] | {"center_m": [-0.015, 0, 0]}]}
    run = changed("model.bodies", {"box": behind, "other": turned})
    # The shape's own frame is turned by 90 degrees in its body, so the body is turned back.
    run["model"]["joints"]["weld"] = {
        "type": "weld",
        "parent": "box",
        "child": "other",
        "parent_point_m": [0.015, 0, 0],
        "child_point_m": [0.01, 0.02, 0.03],
        "rpy_deg": [0, 0, -90],
    }
    body, welded = scene_of(RUN).rigid[0], scene_of(run).rigid[0]
    assert welded.name == "box+other"
    np.testing.assert_allclose(welded.mass, body.mass)
    np.testing.assert_allclose(welded.inertia, body.inertia, atol=1e-12)
    np.testing.assert_allclose(welded.motion.position, body.motion.position, atol=1e-12)


def four_bar(*homes: float) -> dict[str, Any]:
    """A run with a square of four bars, hinged about y, whose three hinges of the tree have these homes (deg)."""
    bar = {"type": "link", "length_m": 0.1, "diameter_m": 0.01, "density_kg_m3": 1000}
    along = {"type": "hinge", "axis": [0, 1, 0], "parent_point_m": [0.1, 0, 0]}
    run = copy.deepcopy(RUN)
    run["model"] = {
        "in_space": True,
        "name": "four_bar",
        "bodies": {"a": bar, "b": bar, "c": bar},
        "joints": {
            "one": {"type": "hinge", "axis": [0, 1, 0], "parent": "ground", "child": "a", "home_deg": homes[0]},
            "two": along | {"parent": "a", "child": "b", "home_deg": homes[1]},
            "three": along | {"parent": "b", "child": "c", "home_deg": homes[2]},
        },
        "closures": {
            "four": {"type": "hinge", "axis": [0, 1, 0], "parent": "ground", "parent_point_m": [0.1, 0, 0]}
            | {"child": "c", "child_point_m": [0.1, 0, 0]}
        },
    }
    run["initial"] = {"joints": {"one": {"angle_deg": 70, "rate_rad_s": 2}}}
    return run


def test_a_four_bar_of_hinges_keeps_the_constraints_it_needs() -> None:
    """Three hinges of a chain and one that closes it: in space three of its five constraints are held already."""
    scene = scene_of(four_bar(90, -90, -90))
    assert sum(scene.joints[-1].constrained) == 2
    a, _, c = scene.rigid  # a parallelogram: opposite sides turn alike
    np.testing.assert_allclose(a.motion.rate, c.motion.rate, atol=1e-12)
    np.testing.assert_allclose(a.motion.rate, [0, 2, 0], atol=1e-12)
    assert abs(scene.joints[-1].rate) == pytest.approx(2.0)


def test_a_loop_in_space_is_closed_from_rough_homes_with_the_least_change() -> None:
    """A square sheared by s has the angles 90 - s, s - 90, -90 - s: least squares from 80, -85, -85 by hand."""
    scene = scene_of(four_bar(80, -85, -85))
    shear = sum((10.0, 5.0, -5.0)) / 3.0  # the mean of what each of the three asks for
    expected = [90.0 - shear, shear - 90.0, -90.0 - shear]
    homes = {note.key.split(".")[2]: note.home for note in scene.notes if isinstance(note, HomeNote)}
    np.testing.assert_allclose([homes[name] for name in ("one", "two", "three")], expected, atol=1e-4)
    a, _, c = scene.rigid
    np.testing.assert_allclose(a.motion.rate, c.motion.rate, atol=1e-9)


def test_a_medium_of_surfaces_that_leaves_out_round_links_is_reported() -> None:
    """Round links are bars for one medium and would be surfaces for the other: they were left out without a word."""
    run = changed("model.bodies.arm", BEAM)
    run["model"]["joints"]["shoulder"] = {"type": "ball", "parent": "box", "child": "arm"}
    (note,) = scene_of(run | {"medium": ["rft3d_sand", "play_sand"]}).notes
    assert note.key == "medium.0"
    assert note.message.startswith("it does not act on round links, which are bars for play_sand")
    assert scene_of(run).notes == ()
    run["model"]["bodies"]["box"] = {"type": "rigid", "mass_kg": 1, "inertia_kg_m2": {"xx": 1, "yy": 1, "zz": 1}}
    with pytest.raises(SceneError, match="nothing of the kind; round links are bars if another medium takes bars"):
        scene_of(run | {"medium": ["rft3d_sand", "play_sand"]})
