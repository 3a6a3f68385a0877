"""Forces in space: those of the plane on extruded bodies, published stresses, turned and mirrored scenes, tangents."""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from support_space import FLAT, PAIRS, PLAY, SAND, WAY, Array, Motion, both, driven, load_on, prism, state

from granular_contact import Bar, Box, Capsule, Cone, Cylinder, Drft, Mesh, Plate, Rft, Rft3d, Sphere
from granular_contact.laws.rft3d import C
from granular_contact.laws.static_friction import Elastoplastic, Smooth
from granular_contact.sand import state as kept
from granular_contact.sand.contact_lines import Body, outline, polyline
from granular_contact.sand.kernels import space_sand
from granular_contact.sand.load import GranularLoad
from granular_contact.sand.space.facets import half_sides
from granular_contact.sand.space.load import SpatialLoad
from granular_contact.sand.space.shapes import Shape
from granular_contact.sand.space.triangles import clusters_of

DISC = 0.05 * np.column_stack([np.cos(a := np.linspace(0, 2 * np.pi, 48, endpoint=False)), np.sin(a)])


MEDIA = {"rft": Rft(zeta=0.3), "drft": Drft(density=1600.0, lam=1.1, surface_drop=3e-3), "rft3d": SAND}


@pytest.mark.parametrize("static", [Elastoplastic(1e-3, 1e-3), Smooth(0.05)], ids=["bristles", "smooth"])
@pytest.mark.parametrize("law", MEDIA)
def test_a_dragged_plate_is_that_of_the_plane(law: str, static: Any) -> None:
    flat = GranularLoad(MEDIA[law], 0.0, static=static)
    flat.add(polyline(FLAT, [[-0.05, 0.0], [0.05, 0.0]], width=0.06))
    space = load_on(MEDIA[law], Plate((0.1, 0.06)), static=static)
    planar, spatial = both(flat, space, spin=0.0)
    assert np.abs(planar).max() > 0.5
    np.testing.assert_allclose(spatial, planar, rtol=1e-10, atol=1e-10)


@pytest.mark.slow
@pytest.mark.parametrize("law", MEDIA)
def test_a_disc_is_that_of_the_plane(law: str) -> None:
    # What only moves on is the same to round-off; where it turns both are cut finely, and come together.
    static = Elastoplastic(1e-6, 1e-3)
    for spin, strips, size, off in ((0.0, 48, 1.0, 1e-12), (3.0, 1536, 5e-3, 2e-3)):
        flat, space = (
            GranularLoad(MEDIA[law], 0.0, static=static),
            load_on(MEDIA[law], prism(DISC, 0.06), size, static=static),
        )
        flat.add(outline(FLAT, DISC, 0.06, strips=strips))
        planar, spatial = both(flat, space, spin)
        assert np.abs(planar).max() > 1.0
        np.testing.assert_allclose(spatial, planar, rtol=0.0, atol=off * np.abs(planar).max())


@pytest.mark.parametrize("static", [Elastoplastic(1e-3, 1e-3), Smooth(0.05)], ids=["bristles", "smooth"])
@pytest.mark.parametrize("law", ["lee_marghitu", "albert", "hill"])
def test_a_bar_is_that_of_the_plane(law: str, static: Any) -> None:
    medium = PAIRS[law][0]
    ends = np.array([[-0.08, 0.0], [0.08, 0.0]])
    flat = GranularLoad(medium, 0.0, static=static, end_cap=True)
    flat.add(polyline(FLAT, ends, diameter=0.008))
    space = load_on(
        medium, Bar(np.column_stack([ends[:, 0], 0 * ends[:, 0], ends[:, 1]]), 0.008), static=static, end_cap=True
    )
    planar, spatial = both(flat, space, spin=4.0)
    assert np.abs(planar).max() > 0.05
    np.testing.assert_allclose(spatial, planar, rtol=1e-9, atol=1e-9 * np.abs(planar).max())


def published(beta: float, gamma: float, psi: float) -> Array:
    """Generic response alpha_r, alpha_theta, alpha_z of the source, from the angles (rad) as it is printed there."""
    x = np.array(
        [1.0, np.sin(gamma), np.cos(beta), np.cos(psi) * np.cos(gamma) * np.sin(beta) + np.sin(gamma) * np.cos(beta)]
    )
    constant, a, b, c = x
    terms = [constant, a, b, c, a * a, b * b, c * c, a * b, b * c, c * a, a**3, b**3, c**3]
    terms += [a * b * b, b * a * a, b * c * c, c * b * b, c * a * a, a * c * c, a * b * c]
    f1, f2, f3 = np.array(terms) @ np.array(C)
    r = f1 * np.sin(beta) * np.cos(psi) + f2 * np.cos(gamma)
    return np.array([r, f1 * np.sin(beta) * np.sin(psi), -f1 * np.cos(beta) - f2 * np.sin(gamma) - f3])


def stress(medium: Any, normal: Array, direction: Array) -> Array:
    """Stress per depth (N/m3) of a law in space, one face leading or the other."""
    load = load_on(medium, Mesh(*_square(normal), thin=True), static=Elastoplastic(1e-12, 1.0))
    q, v = state(np.array([0.0, 0.0, -1.0]), Rotation.identity(), np.asarray(direction), np.zeros(3))
    load.start(q)
    load.accept(0.0, q, v)
    return load.force(q, v, np.zeros(7))[:3] / 1e-4


def _square(normal: Array) -> tuple[Array, Array]:
    """Vertices and faces of a square of 0.01 m with this normal."""
    helper = np.eye(3)[np.abs(normal).argmin()]
    a = np.cross(normal, helper)
    a /= np.linalg.norm(a)
    b = np.cross(normal, a)
    return 0.005 * np.array([-a - b, a - b, a + b, b - a]), np.array([[0, 1, 2], [0, 2, 3]])


@pytest.mark.slow
def test_3d_rft_has_the_published_values() -> None:
    rough = Rft3d(1600.0, 0.5, 1e6)  # without the limit on the tangential part
    for beta, gamma, shown in ((0, 45, (-0.199, 0.761)), (90, 0, (-0.192, 0.075)), (45, 45, (-0.342, 0.583))):
        np.testing.assert_allclose(published(*np.radians([beta, gamma, 0]))[[0, 2]], shown, atol=6e-4)
    tried = 0
    for beta in np.radians([5.0, 30.0, 60.0, 85.0]):
        for gamma in np.radians([-60.0, -10.0, 20.0, 70.0]):
            for psi in np.radians([-150.0, -90.0, -30.0, 0.0, 45.0, 90.0, 135.0]):
                n = np.array([np.sin(beta) * np.cos(psi), np.sin(beta) * np.sin(psi), -np.cos(beta)])
                u = np.array([np.cos(gamma), 0.0, -np.sin(gamma)])
                alpha = published(beta, gamma, psi)
                if alpha @ u > 0.0:  # which the medium here drops
                    continue
                np.testing.assert_allclose(stress(rough, n, u) / SAND.stiffness(9.81), alpha, atol=1e-9)
                tried += 1
    assert tried > 80


def test_friction_of_the_surface_limits_the_tangential_part() -> None:
    n, u = np.array([0.6, 0.0, -0.8]), np.array([0.6, 0.64, -0.48])
    whole, less = stress(Rft3d(1600.0, 0.5, 1e6), n, u), stress(SAND, n, u)
    along, limited = whole - whole @ n * n, less - less @ n * n
    np.testing.assert_allclose(less @ n, whole @ n, rtol=1e-12)
    assert np.linalg.norm(limited) == pytest.approx(0.3 * abs(less @ n))
    np.testing.assert_allclose(limited / np.linalg.norm(limited), along / np.linalg.norm(along), atol=1e-9)


def test_rft_is_taken_in_the_vertical_plane_of_the_motion() -> None:
    # A facet beside its motion: as wide for its slices as it is seen along them, at the angle that they have.
    medium, turn = Rft(zeta=0.3), np.radians(40.0)
    n, u = np.array([0.6 * np.cos(turn), 0.6 * np.sin(turn), -0.8]), np.array([0.8, 0.0, -0.6])
    w = np.hypot(n[0], n[2])
    section = stress(medium, np.array([n[0] / w, 0.0, n[2] / w]), u)
    np.testing.assert_allclose(stress(medium, n, u), w * section, rtol=1e-9)
    side = stress(medium, np.array([0.0, 1.0, 0.0]), u)
    assert np.abs(side).max() < 1e-9 * np.abs(section).max()
    # Straight down it is that of the plane of the normal, and turns to it steadily.
    down = [stress(medium, n, np.array([s, 0.0, -1.0]) / np.hypot(s, 1.0)) for s in (0.0, 1e-6, -1e-6)]
    np.testing.assert_allclose(down[1:], [down[0]] * 2, rtol=1e-4, atol=1e-4 * np.abs(down[0]).max())


def test_force_on_a_sliding_ball_is_the_integral_over_its_front() -> None:
    """A ball below the surface, against the integral of the law over its front; slowly it has up to 4 % less lift."""
    u, sand = np.array([1.0, 0.0, 0.0]), SimpleNamespace(xi_n=SAND.stiffness(9.81), mu_surf=SAND.mu_surf)
    cosines, weights = np.polynomial.legendre.leggauss(60)
    angles, whole = (np.arange(120) + 0.5) * np.pi / 60, np.zeros(3)
    for c, weight in zip(0.5 * (cosines + 1.0), 0.5 * weights, strict=True):  # of the angle to the motion
        for n in ((c, np.sqrt(1.0 - c * c) * np.cos(a), np.sqrt(1.0 - c * c) * np.sin(a)) for a in angles):
            area = 2.0 * np.pi * 0.02**2 * weight / len(angles)
            whole += area * (0.03 - 0.02 * n[2]) * np.array(Rft3d.facet_stress(tuple(n), tuple(u), sand))
    for speed, least in ((1.0, 0.999), (0.01, 0.99), (1e-5, 0.95)):
        load = load_on(SAND, Sphere(0.04, 2.0), 0.001)
        load.start(state(np.array([0.0, 0.0, -0.03]), Rotation.identity(), speed * u, np.zeros(3))[0])
        for x in np.linspace(0.0, 3e-5, 31)[1:]:  # three yield displacements
            load.accept(x / speed, *state(np.array([x, 0.0, -0.03]), Rotation.identity(), speed * u, np.zeros(3)))
        for k in (0, 2):
            assert abs(whole[k]) > 1.0
            assert least < load.last.bodies[0, 0, k] / whole[k] < 1.001  # facets of 1 mm


@pytest.mark.parametrize("name", PAIRS)
def test_a_turned_scene_gives_turned_forces(name: str) -> None:
    motion = Motion(3)
    plain = driven(load_on(*PAIRS[name]), motion).history
    about, any_way = Rotation.from_rotvec([0.0, 0.0, 1.1]), Rotation.from_rotvec([0.7, -1.9, 0.4])
    for turn, up in ((about, (0, 0, 1)), (any_way, any_way.apply([0, 0, 1]))):
        turned = driven(load_on(*PAIRS[name], up=up), motion, around=turn).history
        for k in (slice(0, 3), slice(3, 6)):
            expected = turn.apply(plain.bodies[:, 0, k])
            np.testing.assert_allclose(turned.bodies[:, 0, k], expected, atol=1e-10 * max(1.0, np.abs(expected).max()))
        np.testing.assert_allclose(turned.work, plain.work, atol=1e-10)
    assert np.abs(plain.bodies[:, 0, :3]).max() > 0.1


def test_a_slope_is_the_tilted_height_of_the_plane() -> None:
    rise = 0.3
    flat = GranularLoad(SAND, 0.0, slope=rise)
    flat.add(outline(FLAT, DISC, 0.06, strips=48))
    space = load_on(SAND, prism(DISC, 0.06), 1.0, slope=(rise, 0.0, 0.0))
    planar, spatial = both(flat, space, 0.0)
    np.testing.assert_allclose(spatial, planar, rtol=0.0, atol=1e-10 * np.abs(planar).max())


@pytest.mark.parametrize("name", ["rft3d", "rft", "lee_marghitu"])
def test_mirror_images(name: str) -> None:
    medium, shape = PAIRS[name]
    if isinstance(shape, Bar):
        other: Any = Bar(np.asarray(shape.points) * [1, -1, 1], shape.diameter)
        first: Any = shape
    else:
        corners = shape.corners(10.0).reshape(-1, 3)
        faces = np.arange(len(corners)).reshape(-1, 3)
        first, other = Mesh(corners, faces), Mesh(corners * [1, -1, 1], faces[:, ::-1])
    mirror, axial = np.array([1, -1, 1]), np.array([-1, 1, -1])
    place, turn = np.array([0.0, 0.01, -0.02]), np.array([0.3, -0.5, 0.8])
    v, w = np.array([0.1, -0.07, -0.05]), np.array([1.0, -2.0, 0.5])
    histories = []
    for body, a, b in ((first, 1, 1), (other, mirror, axial)):
        load = load_on(medium, body)
        q, rates = state(place * a, Rotation.from_rotvec(turn * b), v * a, w * b)
        load.start(q)
        load.accept(0.0, q, rates)
        histories.append(load.history.bodies[0, 0] * np.concatenate([np.ones(3) * a, np.ones(3) * b]))
    np.testing.assert_allclose(histories[1], histories[0], rtol=1e-9, atol=1e-10)
    assert np.abs(histories[0]).max() > 0.1


def test_a_box_of_twelve_triangles_is_cut_fine_enough() -> None:
    sides = (0.1, 0.08, 0.06)
    corners = Box(sides).corners(10.0)
    assert len(corners) == 12
    mesh = Mesh(corners.reshape(-1, 3), np.arange(36).reshape(-1, 3))
    forces = {}
    for key, shape, size in (("mesh", mesh, None), ("box", Box(sides), None), ("fine", Box(sides), 0.003)):
        load = load_on(SAND, shape, size, static=Smooth(0.01))
        q, v = Motion(5, way=0.1).state(0.3)
        load.start(q)
        load.accept(0.0, q, v)
        forces[key] = load.history.bodies[0, 0]
    for name in ("mesh", "box"):
        assert np.linalg.norm((forces[name] - forces["fine"])[:3]) < 2e-3 * np.linalg.norm(forces["fine"][:3])


@pytest.mark.slow
@pytest.mark.parametrize(
    ("shape", "coarse"), [(Sphere(0.1), 0.02), (Box((0.1, 0.08, 0.06)), 0.04)], ids=["sphere", "box"]
)
def test_finer_facets_converge_with_their_square(shape: Any, coarse: float) -> None:
    sizes, forces = coarse * np.array([1.0, 0.5, 0.25]), []
    # Over several motions, in which single facets that come into the lead do not count.
    for size in (*sizes, coarse / 16):
        resultants = []
        for seed in range(6):
            load = load_on(SAND, shape, size, static=Smooth(0.01))
            q, v = Motion(seed, way=0.1).state(0.2)
            load.start(q)
            load.accept(0.0, q, v)
            resultants.append(load.history.bodies[0, 0, :3])
        forces.append(np.array(resultants))
    errors = [float(np.linalg.norm(coarser - forces[-1])) for coarser in forces[:-1]]
    slope = np.polyfit(np.log(sizes), np.log(errors), 1)[0]
    assert 1.8 < slope < 2.4, (errors, slope)


@pytest.mark.parametrize("size", [7, 6], ids=["euler", "angles"])
@pytest.mark.parametrize("name", PAIRS)
def test_tangent_is_that_of_differences(name: str, size: int) -> None:
    medium, shape = PAIRS[name]
    load = SpatialLoad(medium, 0.0, static=Elastoplastic(1e-3, 1e-2))
    load.add_shape(Body("body", list(range(size))), shape, mass=1.0)
    random = np.random.default_rng(7)
    turn = np.array([0.9, 0.3, -0.2, 0.25]) / np.linalg.norm([0.9, 0.3, -0.2, 0.25]) if size == 7 else [0.3, -0.2, 0.4]
    q, v = np.array([0.0, 0.0, -0.03, *turn]), 0.1 * random.normal(size=size)
    load.start(q)
    load.accept(0.0, q, v)
    load.update_active(1e-2)
    q = q + 3e-3 * v  # bristles half stretched
    before = load.force(q, v, np.zeros(size))
    fq, fv = 0.7, 0.02
    entries = load.tangent(q, v, fq, fv).copy()
    differences = np.zeros((size, size))
    np.add.at(differences, (entries[:, 0].astype(int), entries[:, 1].astype(int)), entries[:, 2])
    expected, d = np.zeros((size, size)), 1e-8
    for j in range(size):
        e = d * np.eye(size)[j]
        ahead = load.force(q + fq * e, v + fv * e, np.zeros(size))
        behind = load.force(q - fq * e, v - fv * e, np.zeros(size))
        expected[:, j] = (ahead - behind) / (2 * d)
    for slopes in (
        (differences, expected) if size == 7 else ()
    ):  # what Euler parameters change along themselves is no motion
        slopes -= np.outer(slopes[:, 3:] @ q[3:], np.append(np.zeros(3), q[3:])) / (q[3:] @ q[3:])
    # Where a layer ends the part of a facet within it changes, too.
    np.testing.assert_allclose(
        differences, expected, atol=(5e-3 if name == "layers" else 2e-3) * np.abs(expected).max()
    )
    # Forces at other states have left nothing behind.
    np.testing.assert_array_equal(load.force(q, v, np.zeros(size)), before)


@pytest.mark.parametrize("slope", [(0.0, 0.0, 0.0), (0.4, -0.3, 0.0)], ids=["level", "slope"])
def test_tangent_holds_the_change_of_depth_under_translation(slope: tuple[float, float, float]) -> None:
    """With bristles so soft that what depth does is seen: 2 % of the tangent is that of the slope."""
    load, turn = load_on(*PAIRS["rft3d"], slope=slope, static=Elastoplastic(0.03, 0.0)), Rotation.random(random_state=7)
    velocity = np.array([0.1, -0.05, -0.1])
    start, v = state(np.array([0.0, 0.0, -0.03]), turn, velocity, np.zeros(3))
    load.start(start)
    q = start + 0.05 * v  # to a fourth of the yield displacement
    entries, differences, d = load.tangent(q, v, 1.0, 0.0).copy(), np.zeros((7, 7)), 1e-8
    np.add.at(differences, (entries[:, 0].astype(int), entries[:, 1].astype(int)), entries[:, 2])
    ahead, behind = (np.array([load.force(q + s * e, v, np.zeros(7)) for e in np.eye(7)[:3]]).T for s in (d, -d))
    expected = (ahead - behind) / (2.0 * d)
    # Differences of forces over 2e-8 m of depths of 3 cm: 1e-5 of them.
    np.testing.assert_allclose(differences[:, :3], expected, atol=1e-4 * np.abs(expected).max())


def test_a_state_in_a_strided_array_needs_no_compilation() -> None:
    medium, shape = PAIRS["rft3d"]
    load, q = load_on(medium, shape), np.array([0.0, 0.0, -0.03, 1.0, 0.0, 0.0, 0.0])
    load.start(q)
    before = [len(kernel.signatures) for kernel in (space_sand.force, space_sand.accept, space_sand.tangent)]
    load.start(np.array([q, q]).T[:, 0])
    after = [len(kernel.signatures) for kernel in (space_sand.force, space_sand.accept, space_sand.tangent)]
    assert after == before


@pytest.mark.parametrize("name", PAIRS)
def test_forces_that_come_with_a_tangent_are_those_of_their_state(name: str) -> None:
    medium, shape = PAIRS[name]
    turn, v = Rotation.from_euler("xyz", [0.2, -0.1, 0.3]), np.array([0.05, -0.02, -0.1])
    began, rates = state(np.array([0.0, 0.0, -0.02]), turn, v, np.array([0.4, 0.1, -0.6]))
    q, found = began + 0.05 * rates, []  # bristles are stretched by some mm, over their yield
    for first in (True, False):
        load = load_on(medium, shape)
        load.start(began)
        if first:
            load.tangent(q, rates, 1.0, 1.0)
        force = load.force(q, rates, np.zeros(7)).copy()
        load.accept(0.0, q, rates)
        assert np.linalg.norm(force[:3]) > 1e-3  # N
        found.append((force, load.table.row.copy(), np.concatenate([batch.anchors for batch in load.batches])))
    for alone, with_tangent in zip(*found, strict=True):
        np.testing.assert_array_equal(alone, with_tangent)


@pytest.mark.slow
@pytest.mark.parametrize("name", PAIRS)
def test_sand_never_drives_what_moves_through_it(name: str) -> None:
    # Bodies that come back to where they were, bristles and all: on the second round sand has only taken energy. A law
    # whose force is not along the motion may give some back on a round within the yield of its bristles, where they are
    # no springs with a potential: less than they hold, and nothing that is as fast as their damping.
    medium, shape = PAIRS[name]
    yields = 1e-5
    for seed in range(2):
        for way, rate, most in ((0.03, 1.0, -1e-3), (1e-6, 1.0, 1.0), (1e-7, 1000.0, 0.0)):
            motion = Motion(seed, depth=0.06, closed=True, way=way)
            load = load_on(medium, shape, 0.03, static=Elastoplastic(yields, 1e-3))
            load.start(motion.state(0.0)[0])
            for i in range(81):
                q, v = motion.state(i / 40)
                load.accept(i / 40 / rate, q, rate * v)
            history = load.history
            gained = history.work[80] - history.work[40]
            if most == 1.0:
                assert gained < 0.5 * yields * np.linalg.norm(history.bodies[:, 0, :3], axis=1).max()
            else:
                assert gained < most
            if way == 0.03:
                assert (history.power[5:] < 0.02 * np.abs(history.power).max()).all()


def test_clusters_out_of_reach_are_inactive_without_change_of_forces() -> None:
    loads = [load_on(SAND, Box((0.1, 0.07, 0.05)), 0.012) for _ in range(2)]
    seen = []
    for i in range(61):
        t = i / 60
        q, v = state(
            np.array([0.1 * t, 0.0, 0.3 - 0.32 * t]),
            Rotation.from_rotvec([t, 2 * t, 0]),
            np.array([0.1, 0, -0.32]),
            np.array([1.0, 2.0, 0.0]),
        )
        for load in loads:
            if i == 0:
                load.start(q)
            load.accept(t, q, v)
        loads[0].update_active(1 / 240)
        seen.append(int(loads[0].batches[0].active.sum()))
    assert seen[0] == 0
    assert max(seen[:55]) > 0
    np.testing.assert_array_equal(loads[0].history.bodies, loads[1].history.bodies)
    assert np.abs(loads[0].history.bodies).max() > 0.1


@pytest.mark.parametrize("name", ["rft3d", "lee_marghitu", "ball"])
def test_accepted_step_is_independent_of_earlier_force_evaluations(name: str) -> None:
    """Forces found at the end of a step are taken for it, but not those of another state, anchor or active cluster."""
    motion = Motion(3, way=0.05)

    def accepted(asked: bool) -> list[Array]:
        medium, shape = PAIRS[name]
        load, rows = load_on(medium, shape, 0.008, static=Elastoplastic(1e-3, 1e-3)), []
        load.start(motion.state(0.0)[0])
        load.accept(0.0, *motion.state(0.0))
        before = kept.state(load)

        def end(step: float, at: float, *asks: float) -> None:
            """A step to the place in the motion `at`, with forces asked for at others."""
            for evaluation in asks if asked else ():
                load.force(*motion.state(evaluation), np.zeros(7))
            load.update_active(step)
            load.accept(load.time + 1e-3, *motion.state(at))
            rows.extend([load.table.row.copy(), load.batches[0].anchors.copy()])

        end(1.0, 0.02, 0.03, 0.02)  # found at its end, and known
        end(1.0, 0.02)  # where anchors have followed
        end(1.0, 0.04, 0.04, 0.03)
        if asked:
            load.force(*motion.state(0.06), np.zeros(7))
        kept.restore(load, before)  # other anchors
        end(1.0, 0.06)
        high = motion.state(0.0)[0] + 0.04 * np.eye(7)[2]
        load.start(high)
        load.accept(0.0, high, np.zeros(7))
        load.update_active(1e-9)
        active = load.batches[0].active
        assert name != "rft3d" or 0 < active.sum() < len(active)
        end(1.0, 0.1, 0.1)
        return rows

    with_forces, without = accepted(True), accepted(False)
    for ours, theirs in zip(with_forces, without, strict=True):
        np.testing.assert_array_equal(ours, theirs)
    assert np.abs(without[0]).max() > 1.0  # N


@pytest.mark.parametrize("shape", [Box((0.3, 0.2, 0.02)), Sphere(0.1), Cone(0.08, 0.06)], ids=["box", "sphere", "cone"])
def test_how_facets_are_kept_together_changes_nothing(shape: Shape) -> None:
    # In one cluster all facets are looked at, in clusters of eight those alone that may touch the surface.
    random, loads = np.random.default_rng(3), []
    for each in (10**6, 8):
        load = load_on(SAND, shape, 0.012, surface=0.01, slope=(0.2, -0.1, 0.0))
        rows = load.lines[0].rows
        together = clusters_of(rows[:, :3], rows[:, 3], half_sides(rows), each)
        load.lines[0] = replace(load.lines[0], clusters=together)
        loads.append(load)
    q = state(np.array([0.0, 0.0, -0.01]), Rotation.from_rotvec([0.3, -0.2, 0.4]), np.zeros(3), np.zeros(3))[0]
    for load in loads:
        load.start(q)
    for i in range(40):
        place, spin = np.append(random.normal(size=2), random.uniform(-0.06, 0.06)), random.normal(size=3)
        q, v = state(place, Rotation.random(random_state=i), random.normal(size=3), spin)
        for load in loads:
            load.accept(1e-3 * i, q, v)
    single, many = (load.history for load in loads)
    scale = np.abs(single.bodies).max()
    np.testing.assert_allclose(many.bodies, single.bodies, atol=1e-12 * scale)  # sums in another order
    np.testing.assert_allclose(many.depth, single.depth, rtol=1e-12)
    np.testing.assert_allclose(loads[1].batches[0].anchors, loads[0].batches[0].anchors, atol=1e-15)
    assert (single.bodies[:, 0, 2] == 0.0).any()
    assert scale > 1.0


CIRCLE = np.column_stack([np.cos(a := np.linspace(0.0, 2.0 * np.pi, 4000)), np.sin(a), 0.0 * a])
HALF = np.array(list(product((-0.5, 0.5), repeat=3)))
WEDGE = prism(np.array([[0.0, 0.0], [0.1, 0.02], [0.03, 0.08]]), 0.05)
# Shapes with points of which one is the deepest, or with the radius of a sphere around them (m).
EXTREMES: dict[str, tuple[Any, Shape, Any, float]] = {
    "box": (SAND, Box((0.1, 0.07, 0.05)), HALF * [0.1, 0.07, 0.05], 0.0),
    "plate": (SAND, Plate((0.1, 0.06)), HALF * [0.1, 0.06, 0.0], 0.0),
    "mesh": (SAND, WEDGE, WEDGE.vertices, 0.0),
    "cylinder": (SAND, Cylinder(0.06, 0.1), np.vstack([0.03 * CIRCLE + [0.0, 0.0, z] for z in (-0.05, 0.05)]), 0.0),
    "cone": (SAND, Cone(0.08, 0.06), np.vstack([np.zeros(3), 0.04 * CIRCLE + [0.0, 0.0, 0.06]]), 0.0),
    "capsule": (SAND, Capsule(0.05, 0.08), np.array([[0.0, 0.0, -0.04], [0.0, 0.0, 0.04]]), 0.025),
    "sphere": (SAND, Sphere(0.08), np.zeros((1, 3)), 0.04),
    "bar": (PLAY, Bar(WAY, 0.008), np.array(WAY), 0.0),
}


@pytest.mark.parametrize("slope", [(0.0, 0.0, 0.0), (0.3, -0.2, 0.0)], ids=["level", "slope"])
@pytest.mark.parametrize("name", EXTREMES)
def test_depth_speed_and_lowest_point_are_those_of_the_points_of_a_body(
    name: str, slope: tuple[float, float, float]
) -> None:
    medium, shape, points, radius = EXTREMES[name]
    size, random = 0.01, np.random.default_rng(5)
    load = load_on(medium, shape, None if name == "bar" else size, slope=slope)
    rise, steep = np.array([*slope[:2], -1.0]), np.sqrt(1.0 + slope[0] ** 2 + slope[1] ** 2)
    for seed in range(4):
        place, turn = np.array([0.02, -0.03, -0.2]), Rotation.random(random_state=seed)
        velocity, spin = random.normal(size=3), 3.0 * random.normal(size=3)
        q, v = state(place, turn, velocity, spin)
        load.start(q)
        load.update_active(1e-3)
        load.accept(0.0, q, v)
        arms, seen = turn.apply(points), load.history
        # Of circles the 4000 points miss pi^2 / 2 / 4000^2 of the radius at most.
        assert seen.depth[-1] == pytest.approx(((place + arms) @ rise).max() + radius * steep, abs=2e-8)
        assert seen.lowest[-1] == pytest.approx((place + arms)[:, 2].min() - radius, abs=2e-8)
        fastest = np.linalg.norm(velocity + np.cross(spin, arms), axis=1).max()
        # Of facets the speed is that of centroids, which no corner of theirs is farther from than the size.
        off = 0.0 if name == "bar" else (size + radius) * np.linalg.norm(spin)
        assert abs(seen.speed[-1] - fastest) < off + 1e-9


@pytest.mark.parametrize("name", ["rft3d", "lee_marghitu"])
def test_repeated_force_evaluations_follow_the_velocity(name: str) -> None:
    """What is kept of the last forces serves the same motion alone."""
    motion, forces = Motion(3), []
    q, v = motion.state(0.3)
    for asked_before in (v, -v):
        load = load_on(*PAIRS[name])
        load.start(motion.state(0.29)[0])
        load.force(q, asked_before, np.zeros(7))
        forces.append(load.force(q, v, np.zeros(7)))
    np.testing.assert_array_equal(*forces)
    assert np.abs(load.force(q, -v, np.zeros(7)) - forces[0]).max() > 1e-3 * np.abs(forces[0]).max()


def test_a_flat_body_close_above_the_surface_is_out_of_reach() -> None:
    # Its clusters are flat: spheres around them would reach 30 mm and more below it.
    load = load_on(SAND, Box((0.3, 0.2, 0.02)), 0.02)
    q, v = state(np.array([0.0, 0.0, 0.015]), Rotation.identity(), np.array([0.1, 0.0, 0.0]), np.zeros(3))
    load.start(q)
    load.accept(0.0, q, v)
    assert load.batches[0].proximity[0, 0] > 0.1  # (the sphere around the body, in the sand)
    assert not load.update_active(2e-3)
    load.accept(1e-3, q, v)
    assert load.history.depth[-1] == pytest.approx(-0.005, abs=1e-9)  # of its lower face, though none is looked at
    q[2] = 0.0105
    load.accept(2e-3, q, v)
    assert load.update_active(2e-3)
