"""Bodies of MuJoCo models in sand: energy, the other engine's motion, standing, forces of both kinds of bed."""

from __future__ import annotations

import sys
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from support_mujoco import BOX, GRAVITY, SAND, energy, go, model_of, thrown
from support_runs import ROOT

from granular_contact import Albert, Bar, Floor, Layer, LeeMarghitu, Poncelet, Rft, Sphere, VerticalResistance, preset
from granular_contact.laws.scatter import Scatter
from granular_contact.sand.contact_lines import Body, outline, polyline

mujoco = pytest.importorskip("mujoco", reason="MuJoCo is not installed")
from granular_contact.mujoco import MujocoBed  # noqa: E402

pytestmark = pytest.mark.slow

PLAY = LeeMarghitu(2500.0, 6.5, 8.0, VerticalResistance(22.0, 1.1))
FALLS: dict[str, tuple[Any, str, float]] = {
    "box": (SAND, BOX, 0.12),
    "bar": (PLAY, '<geom name="box" type="capsule" size="0.004 0.15" euler="0 80 0" density="2700"/>', 0.12),
    "ball": (Poncelet(40.0, 2.0), '<geom name="box" type="sphere" size="0.05" density="2700"/>', 0.12),
}


@pytest.mark.parametrize("name", FALLS)
def test_the_energy_that_a_body_loses_is_the_work_of_the_sand(name: str) -> None:
    medium, geom, seconds = FALLS[name]
    model = model_of(geom, step=2.5e-4)
    data, bed = thrown(model), MujocoBed(model, medium)
    bed.add_geoms("box")
    before = energy(model, data)
    go(model, data, bed, seconds)
    lost = before - energy(model, data)
    assert lost > 0.2 * before
    kept = bed.apply(data)
    # MuJoCo's steps put v h^2 g / 2 into a fall at v: at most 2e-3 of what is lost here.
    assert -kept.work == pytest.approx(lost, rel=5e-3)
    assert kept.works["body"] == kept.work
    assert kept.depth > 0.002


BEDS: dict[str, tuple[Any, Floor | None]] = {
    "sand": (SAND, None),
    "layers and a floor": ((Layer(SAND, 0.0, 0.006), Layer(Rft(zeta=3.0), 0.006)), Floor(-0.012, 2e6, 0.3)),
    "scattering": (SAND.model_copy(update={"scatter": Scatter(0.5, 0.02, 1)}), None),
}


@pytest.mark.parametrize("name", BEDS)
def test_mujoco_motion_converges_to_exudyn_with_order_one(name: str) -> None:
    pytest.importorskip("exudyn")
    from validation.falling_box import FallingBox, order

    medium, floor = BEDS[name]
    box = FallingBox((0.1, 0.08, 0.06), 0.1, (0.5, 0.2, -1.0, 1.0, 2.0, 3.0), medium, floor)
    # On a floor, whose springs are stiff, longer steps are not yet those of order one.
    steps = np.array([4e-4, 2e-4, 1e-4]) / (1.0 if floor is None else 2.0)
    reference = box.by_exudyn(0.1, 400)
    errors = [float(np.linalg.norm(box.by_mujoco(0.1, step) - reference)) for step in steps.tolist()]
    assert 0.8 < order(steps.tolist(), errors) < 1.3, errors
    assert errors[0] < 12.5 * steps[0] * 0.1  # of the way
    if name == "scattering":  # which matters more
        assert np.linalg.norm(box.in_medium(SAND).by_mujoco(0.1, steps[0]) - reference) > 10 * errors[-1]


@pytest.mark.parametrize("geom", ["box", "ball"])
def test_bodies_on_a_stiff_floor_settle_at_spring_depth_at_any_step(geom: str) -> None:
    """At the longer step the springs would turn by more than a radian; the medium above the floor bears nothing."""
    stiffness, mass, area = 1e7, 0.8, 0.1 * 0.08
    size, medium, depth = "0.05 0.04 0.03", Rft(zeta=1e-9), mass * GRAVITY / (stiffness * area)
    if geom == "ball":
        size, medium, depth = "0.03", Poncelet(1e-9, 1e-9), np.sqrt(mass * GRAVITY / (stiffness * np.pi * 0.03))
    kind = "sphere" if geom == "ball" else "box"
    for step in (1e-3, 5e-3):
        body = f'<geom name="box" type="{kind}" size="{size}" mass="{mass}"/>'
        model = model_of(body, step=step, place="0 0 -0.06")
        data, bed = mujoco.MjData(model), MujocoBed(model, medium, floor=Floor(-0.1, stiffness, 3.0))
        bed.add_geoms("box")
        go(model, data, bed, 0.6)
        assert -0.07 - data.qpos[2] == pytest.approx(depth, rel=5e-3)
        np.testing.assert_allclose(bed.apply(data).force, [0.0, 0.0, mass * GRAVITY], atol=2e-2)
        assert bed.of(data).depth == pytest.approx(0.1 + depth, abs=2e-5)  # below the surface, not below the floor


@pytest.mark.parametrize(("size", "mass"), [("0.1 0.05 0.02", 5.0), ("0.03 0.03 0.02", 0.4)])
def test_step_error_of_a_released_foot_is_estimated_and_true(size: str, mass: float) -> None:
    """By energy it sinks by 2 m g / k, k of the stiffness times the area; what the bed tells follows from no such look.

    The bristles' first 10 um, of some 0.5 mm, are softer, so that shares of 0.03 are no error of the step. What is told
    counts all work along the slope, and some of it is the true change of the force: it is at most 3.2 times.
    """
    medium = preset("rft3d_sand")
    a, b, _ = (float(half) for half in size.split())
    depth = 2.0 * mass * GRAVITY / (1.039e7 * 4.0 * a * b)
    for step in (1e-3, 2e-3, 4e-3):
        model = model_of(f'<geom name="box" type="box" size="{size}" mass="{mass}"/>', step=step, place="0 0 0.02")
        data, bed, lowest = mujoco.MjData(model), MujocoBed(model, medium), 0.02
        bed.add_geoms("box")
        for _ in range(round(0.1 / step)):
            go(model, data, bed, step)
            lowest = min(lowest, data.qpos[2])
        off, estimate = (0.02 - lowest) / depth - 1.0, bed.of(data).error
        assert off > 0.05
        assert off - 0.03 < estimate < 3.2 * off + 0.03, (step, off, estimate)
        assert off < 0.35  # a step that ends elsewhere than predicted is made again: 0.2 to 1.5 without that


def test_the_error_of_facets_is_reported_a_ball_that_is_thrown() -> None:
    """Facets of 10 mm against those of 2 mm, of a ball of 40 mm: the depth where it stops, over which work is done."""

    def made(size: float) -> tuple[float, Any]:
        model = model_of('<geom name="ball" type="sphere" size="0.02" density="2000"/>', step=2e-4, place="0 0 0.02")
        data, bed, lowest = mujoco.MjData(model), MujocoBed(model, preset("rft3d_sand")), 0.02
        bed.add_geoms("ball", facet_size=size)
        data.qvel[:] = 0.5, 0.0, -1.0, 0.0, 10.0, 0.0
        for _ in range(300):
            go(model, data, bed, 2e-4)
            lowest = min(lowest, data.qpos[2])
        return 0.02 - lowest, bed.of(data)

    (fine, kept), (coarse, estimate) = made(0.002), made(0.01)
    off = abs(coarse / fine - 1.0)
    assert off > 2e-3
    assert off / 5.0 < estimate.facet_error < 10.0 * off
    assert kept.facet_error < 0.2 * estimate.facet_error
    assert estimate.error == estimate.facet_error + estimate.step_error


@pytest.fixture(scope="module")
def hexapod() -> Any:
    sys.path.insert(0, str(ROOT / "examples" / "mujoco"))
    import hexapod

    return hexapod


@pytest.mark.parametrize("step", [1e-3, 2e-3])
def test_a_robot_stands_still_under_its_servos(hexapod: Any, step: float) -> None:
    model, bed = hexapod.make(step)
    data = mujoco.MjData(model)
    go(model, data, bed, 1.5)  # what moves is left by a hundredth in half a second at 2 ms
    before = data.qpos.copy()
    go(model, data, bed, 0.5)
    np.testing.assert_allclose(data.qpos, before, rtol=0, atol=1e-8)
    weight = GRAVITY * model.body_mass.sum()
    np.testing.assert_allclose(bed.of(data).force, [0.0, 0.0, weight], atol=1e-4 * weight)


def test_a_robot_walks_as_far_with_steps_of_two_milliseconds(hexapod: Any) -> None:
    far = []
    for step in (2e-3, 1e-3):
        model, bed = hexapod.make(step)
        data = mujoco.MjData(model)
        for _ in range(round(1.6 / step)):
            data.ctrl[:] = hexapod.angles(data.time)
            bed.apply(data)
            mujoco.mj_step(model, data)
        far.append(data.qpos[0])
    assert far[1] > 0.2
    assert far[0] == pytest.approx(far[1], rel=0.02)


def assert_at_rest(model: Any, data: Any, bed: MujocoBed, after: float) -> None:
    """Go on for `after` (s): then nothing moves for 0.2 s, and the sand carries the weight."""
    go(model, data, bed, after)
    before = data.qpos.copy()
    go(model, data, bed, 0.2)
    np.testing.assert_allclose(data.qpos, before, rtol=0, atol=1e-7)
    assert bed.of(data).force[2] == pytest.approx(GRAVITY * model.body_mass.sum(), rel=1e-6)


@pytest.mark.parametrize("step", [1e-3, 2e-3, 4e-3])
def test_robot_dropped_on_round_legs_comes_to_rest(step: float) -> None:
    """Faces of the legs' sides rest beside their bristles' yield: whether they are loaded must not go to and fro."""
    leg = '<geom name="leg_{0}" type="capsule" fromto="0 {1} 0 0 {1} -0.06" size="0.012"/>'
    trunk = '<geom name="trunk" type="box" size="0.08 0.05 0.02" density="800"/>'
    model = model_of(trunk + leg.format("left", 0.06) + leg.format("right", -0.06), step=step, place="0 0 0.08")
    bed, data = MujocoBed(model, preset("rft3d_sand")), mujoco.MjData(model)
    bed.add_geoms("trunk|leg_.*")
    assert_at_rest(model, data, bed, after=0.6)


@pytest.mark.parametrize("height", [0.0, 0.1])
def test_a_flat_box_that_was_dropped_comes_to_rest(height: float) -> None:
    """It rises a little before it rests. A step whose predicted end is above the sand must not be a fall of 10 um."""
    model = model_of(
        '<geom name="box" type="box" size="0.1 0.1 0.02" mass="1"/>', step=1e-3, place=f"0 0 {0.02 + height}"
    )
    bed, data = MujocoBed(model, preset("rft3d_sand")), mujoco.MjData(model)
    bed.add_geoms("box")
    assert_at_rest(model, data, bed, after=0.8)


def test_a_box_on_a_slope_is_held() -> None:
    tilt = np.radians(10.0)
    model = model_of('<geom name="box" type="box" size="0.05 0.04 0.03" density="2700"/>', step=2e-3, place="0 0 0.025")
    model.opt.gravity[:] = GRAVITY * np.sin(tilt), 0.0, -GRAVITY * np.cos(tilt)
    data = mujoco.MjData(model)
    bed = MujocoBed(model, SAND, up=(0, 0, 1))
    bed.add_geoms("box")
    go(model, data, bed, 0.5)
    before = data.qpos.copy()
    go(model, data, bed, 1.0)
    np.testing.assert_allclose(data.qpos, before, rtol=0, atol=1e-9)
    force = model.body_mass[1] * GRAVITY * np.array([-np.sin(tilt), 0.0, np.cos(tilt)])
    np.testing.assert_allclose(bed.of(data).force, force, atol=1e-6)


LINES: dict[str, Any] = {
    "rft": (
        Rft(zeta=0.3),
        lambda body: outline(body, [[-0.05, -0.02], [0.05, -0.02], [0.04, 0.03], [-0.05, 0.02]], 0.06),
    ),
    "albert": (Albert(1600.0, 8.0), lambda body: polyline(body, [[-0.05, 0.0], [0.05, -0.01]], diameter=0.01)),
}


@pytest.mark.parametrize("name", LINES)
def test_a_planar_bed_has_the_forces_of_the_load_without_an_engine(name: str) -> None:
    from granular_contact.sand.load import GranularLoad

    medium, lines = LINES[name]
    # The body turns in the plane of y and z of the world, about its own x axis.
    joints = '<joint type="slide" axis="0 1 0"/><joint type="slide" axis="0 0 1"/><joint type="hinge" axis="1 0 0"/>'
    model = model_of(BOX, joint=joints, place="0 0 0", step=1e-5)
    bed = MujocoBed(model, medium, plane=(0.0, 1.0, 0.0))
    bed.add_lines(lines(bed.body("body")))
    load = GranularLoad(medium, 0.0)
    load.add(lines(Body("body", [0, 1, 2])))
    data = mujoco.MjData(model)
    q, v = np.array([0.0, -0.03, 0.2]), np.array([0.05, -0.1, 0.5])
    load.start(q)
    load.accept(0.0, q, v)
    for i in range(60):
        # The force of a step is that where it ends; so short a step ends where it starts.
        data.qpos[:], data.qvel[:], data.time = q, v, 1e-5 * i
        kept = bed.apply(data)
        if i:
            load.accept(1e-5 * i, q, v)
        q = q + 1e-5 * v
    wrench = kept.wrenches["body"]
    expected = load.force(q, v, np.zeros(3))
    x, y, _ = q
    about_origin = expected[2] + x * expected[1] - y * expected[0]
    got = [wrench[1], wrench[2], wrench[3]]
    np.testing.assert_allclose(
        got, [*expected[:2], about_origin], rtol=0.02, atol=0.02 * np.abs(expected[:2]).max() * 0.05
    )
    assert np.abs(expected).max() > 0.3


IN_SPACE: dict[str, tuple[Any, str, Any, list[float]]] = {
    "bar": (
        PLAY,
        '<geom name="g" type="capsule" fromto="-0.06 0 0.01 0.05 -0.02 -0.02" size="0.004" mass="1"/>',
        Bar([[-0.06, 0.0, 0.01], [0.05, -0.02, -0.02]], 0.008),
        [0.0, 0.0, 0.0],
    ),
    "ball": (
        Poncelet(40.0, 2.0),
        '<geom name="g" type="sphere" pos="0.02 -0.03 0.01" size="0.04" mass="1"/>',
        Sphere(0.08),
        [0.02, -0.03, 0.01],
    ),
}


@pytest.mark.parametrize("name", IN_SPACE)
def test_a_bed_in_space_has_the_wrench_of_the_load_without_an_engine(name: str) -> None:
    """The force of a step is that where it ends; so short a step ends where it starts."""
    from granular_contact.sand.space.load import SpatialLoad

    medium, geom, shape, center = IN_SPACE[name]
    step, velocity, spin = 1e-5, np.array([0.05, 0.02, -0.1]), np.array([0.5, -0.3, 0.8])
    model = model_of(geom, place="0 0 0", step=step)
    bed, data = MujocoBed(model, medium), mujoco.MjData(model)
    bed.add_geoms("g")
    load = SpatialLoad(medium, 0.0)
    load.add_shape(Body("body", range(7)), shape, center, mass=1.0)
    for i in range(60):
        turn = Rotation.from_rotvec(i * step * spin) * Rotation.from_rotvec([0.2, 0.3, -0.4])
        e = np.roll(turn.as_quat(), 1)  # Euler parameters, the real one first
        q = np.array([0.1, 0.0, -0.03, *e]) + i * step * np.append(velocity, np.zeros(4))
        v = np.array([*velocity, -0.5 * spin @ e[1:], *(0.5 * (e[0] * spin + np.cross(spin, e[1:])))])
        if i == 0:
            load.start(q)
        load.accept(i * step, q, v)
        data.qpos[:], data.qvel[:3], data.qvel[3:], data.time = q, velocity, turn.inv().apply(spin), i * step
        kept = bed.apply(data)
    expected = load.history.bodies[-1, 0]
    for part in (slice(3), slice(3, 6)):  # within what a step of 60 adds to the bristle
        np.testing.assert_allclose(
            kept.wrenches["body"][part], expected[part], atol=0.02 * np.abs(expected[part]).max()
        )
    assert np.abs(expected[:3]).min() > 0.1
    assert np.abs(expected[3:]).min() > 1e-3


def test_a_bristle_below_its_yield_is_felt_exactly() -> None:
    """A ball in a law with a constant force alone: F = -F0 (e + tau v) / u_y, so v_1 has a closed form."""
    model = model_of(
        '<geom name="box" type="sphere" size="0.05" mass="1"/>',
        place="0 0 0",
        joint='<joint type="slide" axis="1 0 0"/>',
    )
    data = mujoco.MjData(model)
    bed = MujocoBed(model, Poncelet(40.0, 0.0))
    bed.add_geoms("box")
    data.qvel[0] = v = 1e-4
    h, k, c, e = 1e-3, 40.0 / 1e-5, 40.0 / 1e-5 * 1e-3, 0.0
    for _ in range(6):
        go(model, data, bed, h)
        v = (v - h * k * e) / (1.0 + h * c + h * h * k)
        e += h * v
        np.testing.assert_allclose([data.qvel[0], data.qpos[0]], [v, e], rtol=1e-6, atol=1e-13)
