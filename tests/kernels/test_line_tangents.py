"""Tangents of runs: differences of their forces, against finer differences, for every law on every kind of body."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from support_laws import BAR_LAWS, MASS, SCALAR_LAWS, SURFACE_LAWS, Array, G, label, stations
from support_parts import called, rigid_stations

from granular_contact.laws.floor import Floor
from granular_contact.laws.static_friction import Elastoplastic, Smooth
from granular_contact.sand.kernels import kinematics, law, lines
from granular_contact.sand.kernels.forces import medium_record
from granular_contact.sand.kernels.friction import SWITCH

STATES = 12
LEVEL = np.zeros((1, 2))
YIELD = 0.02
STATIC = (Elastoplastic(YIELD, 0.01), Smooth(1.0))
LINE_LAWS = (*BAR_LAWS[:3], *SURFACE_LAWS[1:5])
BALL_LAWS = (SCALAR_LAWS[2], SCALAR_LAWS[4], SCALAR_LAWS[5])  # with every term of a ball's law
Case = tuple[np.ndarray, Array, Array]  # geometry, coordinates, rates


def rigid(rng: np.random.Generator) -> Case:
    geometry = rigid_stations(np.array([[-0.12, 0.01], [0.13, -0.02]]), 5)
    q = np.array([*rng.uniform(-0.05, 0.05, 2), rng.uniform(-2.5, -0.4)])
    return geometry, q, rng.uniform(-1.0, 1.0, 3) * [1.0, 1.0, 4.0]


def in_space(planar: Case, rng: np.random.Generator) -> Case:
    geometry, q, v = planar
    e = np.array([np.cos(q[2] / 2), *rng.uniform(-0.2, 0.2, 2), np.sin(q[2] / 2)])
    rates = np.concatenate([v[:2], [0.0], rng.uniform(-2.0, 2.0, 4)])
    return kinematics.in_space(geometry), np.concatenate([q[:2], [0.0], e]), rates


def spatial_body(rng: np.random.Generator) -> Case:
    return in_space(rigid(rng), rng)


def cable(rng: np.random.Generator, elements: int = 3) -> Case:
    lengths = 0.3 * rng.uniform(0.6, 1.4, elements) / elements
    geometry = kinematics.cable_stations(lengths, 2)
    angles = rng.uniform(-1.3, -0.3) + np.cumsum(rng.uniform(-0.2, 0.2, elements + 1))
    slopes = np.column_stack([np.cos(angles), np.sin(angles)])
    places = np.cumsum(np.vstack([[-0.1, rng.uniform(0.03, 0.1)], lengths[:, None] * slopes[:-1]]), axis=0)
    q = np.hstack([places, slopes]).ravel()
    return geometry, q, np.tile([1.0, 1.0, 3.0, 3.0], elements + 1) * rng.uniform(-1.0, 1.0, q.size)


def ball(rng: np.random.Generator) -> Case:
    q, v = np.array([*rng.uniform([-0.05, -0.08], [0.05, 0.02]), rng.uniform(-3.0, 3.0)]), rng.uniform(-1.0, 1.0, 3)
    return kinematics.ball_stations(np.array([0.01, -0.02])), q, v * [1.0, 1.0, 4.0]


def spatial_ball(rng: np.random.Generator) -> Case:
    return in_space(ball(rng), rng)


class Sand:
    """A run at a state in a medium, its bristles short of their yield, which their damping may take them beyond."""

    def __init__(self, case: Case, record: np.ndarray, run: np.ndarray, rng: np.random.Generator) -> None:
        self.geometry, self.q, self.v = case
        n = len(self.geometry)
        anchors = np.zeros((n, 2))
        stations(self.q, self.v, self.geometry, anchors, np.zeros((n, 2)))
        anchors += rng.uniform(0.2, 0.7, (n, 2)) * YIELD * rng.choice([-1.0, 1.0], (n, 2))
        self.around = law.Contact(self.geometry, run, LEVEL, medium_record(record), anchors, *np.zeros((3, n, 2)))

    def force(self, q: Array, v: Array) -> Array:
        out = np.zeros(q.size)
        called(lines.force)(q, v, self.around, np.zeros((law.TERMS, 3)), out)
        return out

    def tangent(self, fq: float, fv: float) -> Array:
        out = np.zeros((self.q.size, self.q.size))
        self.add_tangent(fq, fv, out)
        return out

    def add_tangent(self, fq: float, fv: float, out: Array) -> None:
        geometry, run, profile, *_ = self.around
        total, places = self.force(self.q, self.v), np.zeros((len(geometry), 2))
        stations(self.q, self.v, geometry, places, np.zeros_like(places))
        if called(lines.immersed)(places, run[0], profile):
            room = np.zeros((3, self.q.size))
            called(lines.differences)(self.q, self.v, self.v, self.around, room, total, fq, fv, out)

    def moved(self, j: int, fq: float, fv: float) -> Array:
        """Force where coordinate j has gone on by fq, and its rate by fv."""
        q, v = self.q.copy(), self.v.copy()
        q[j] += fq
        v[j] += fv
        return self.force(q, v)


def step(q: Array, fq: float, fv: float) -> float:
    """By how much the kernel says that it moves q by fq, v by fv: 10 nm or 1 um/s, above the round-off of q."""
    largest_q, largest_v = max(abs(fq), 1e-300), max(abs(fv), 1e-300)
    d = min(1e-8 / largest_q, 1e-6 / largest_v)
    return max(d, 1e-12 * max(1.0, np.abs(q).max()) / max(largest_q, SWITCH * largest_v))


def run_of(resultant: bool, ball: bool = False) -> np.ndarray:
    run = np.zeros(1, law.LINE)
    run["width"], run["resultant"], run["cap"] = 0.008, resultant, not ball
    if ball:
        run["width"], run["drop"], run["mass"] = 0.0254, 0.0127, MASS
    return run


def check(case: Callable[[np.random.Generator], Case], record: np.ndarray, run: np.ndarray, seed: int) -> None:
    """Compare every column of tangents at random states with central differences of fourth order."""
    rng = np.random.default_rng(seed)
    loaded = 0
    for i in range(STATES):
        sand = Sand(case(rng), record, run, rng)
        # Any mixture, forces by positions alone, by velocities alone, and as time integration with 0.2 ms has it.
        fq, fv = [tuple(rng.uniform(-2.0, 2.0, 2)), (1.0, 0.0), (0.0, 1.0), (1.0, 1e4)][i % 4]
        got, d, force = sand.tangent(fq, fv), step(sand.q, fq, fv), sand.force(sand.q, sand.v)
        h = 20.0 * d
        stiffness = max(np.abs(sand.moved(j, 1e-8, 0.0) - force).max() / 1e-8 for j in range(sand.q.size))
        for j in range(sand.q.size):
            f = {k: sand.moved(j, k * h * fq, k * h * fv) for k in (-2, -1, 1, 2)}
            want = (8 * (f[1] - f[-1]) - (f[2] - f[-2])) / (12 * h)
            bend = np.abs(f[1] - 2 * force + f[-1]).max() / h**2
            # A forward difference is off by d / 2 times the second derivative (1 in place of 1/2: it varies over the
            # stencil), and by round-off over d: of forces (depth integrals cancel to 1e-13), and of positions of about
            # 1 m, which are seen through the stiffness.
            allowed = d * bend + (1e-13 * np.abs(force).max() + 2e-16 * stiffness) / d
            np.testing.assert_allclose(got[:, j], want, rtol=0.0, atol=allowed)
            loaded += np.abs(want).max() > 100.0 * allowed
    assert loaded > 0.25 * STATES * sand.q.size  # a ball stays what it was when its body turns


@pytest.mark.parametrize("static", STATIC, ids=["elastoplastic", "smooth"])
@pytest.mark.parametrize("resultant", [False, True], ids=["distributed", "resultant"])
@pytest.mark.parametrize("case", [rigid, spatial_body, cable])
@pytest.mark.parametrize("medium", LINE_LAWS, ids=label)
def test_tangents_are_the_derivatives_of_the_forces(
    medium: object, case: Case, resultant: bool, static: object
) -> None:
    check(case, medium.record(static, G), run_of(resultant), 14)


@pytest.mark.parametrize("static", STATIC, ids=["elastoplastic", "smooth"])
@pytest.mark.parametrize("case", [ball, spatial_ball])
@pytest.mark.parametrize("medium", BALL_LAWS, ids=label)
def test_tangents_of_balls_are_the_derivatives_of_the_forces(medium: object, case: Case, static: object) -> None:
    check(case, medium.record(static, G), run_of(False, ball=True), 15)


@pytest.mark.parametrize(("case", "kind"), [(rigid, "round"), (cable, "round"), (ball, "ball")])
def test_tangents_of_a_floor_are_the_derivatives_of_the_forces(case: Case, kind: str) -> None:
    check(case, Floor(0.0, 1e5, 0.3).record(kind), run_of(False, ball=kind == "ball"), 16)


@pytest.mark.parametrize("resultant", [False, True], ids=["distributed", "resultant"])
@pytest.mark.parametrize("elements", [1, 2, 3, 7, 12])
def test_coordinates_moved_together_give_what_each_alone_gives(elements: int, resultant: bool) -> None:
    """Entry by entry, to the last digit; the force on a node of a beam depends on it and on its neighbours only."""
    rng = np.random.default_rng(17)
    record = BAR_LAWS[0].record(STATIC[0], G)
    nodes = np.arange(4 * (elements + 1)) // 4
    apart = np.abs(nodes[:, None] - nodes) > 1
    seen = 0
    for _ in range(10):
        sand = Sand(cable(rng, elements), record, run_of(resultant), rng)
        fq, fv = rng.uniform(-2.0, 2.0, 2)
        d, force = step(sand.q, fq, fv), sand.force(sand.q, sand.v)
        columns = [(sand.moved(j, d * fq, d * fv) - force) / d for j in range(sand.q.size)]
        dense = np.stack(columns, axis=1)
        np.testing.assert_array_equal(sand.tangent(fq, fv), dense)
        seen += dense.any()
        if not resultant:  # one force, which moves with the whole immersed part
            assert not dense[apart].any()
    assert seen > 5


def test_tangent_of_a_sliding_sole_is_the_same_after_translation_by_1_km() -> None:
    """In a step of 6 us it is led by its rates: it begins to lead within 0.1 mm/s."""
    yields, fq, fv = 1e-5, 1.0, 2.0 / 6e-6
    record = SURFACE_LAWS[0].record(Elastoplastic(yields, 1e-4), G)
    run = run_of(False)
    run["width"], run["side"], run["cap"] = 0.05, -1.0, False
    sole = rigid_stations(np.array([[-0.05, 0.0], [0.05, 0.0]]), 4)
    tangents = []
    for x, y in ((0.0, 0.0), (800.0, 600.0)):
        case = sole, np.array([x, y - 0.01, 0.0]), np.array([0.01, -3e-6, 0.0])
        sand = Sand(case, record, run, np.random.default_rng(20))
        anchors, surface = sand.around.anchors, sand.around.profile
        behind = x - 2.0 * yields + np.linspace(-0.05, 0.05, len(sole))
        anchors[:, 0], anchors[:, 1] = behind, y - 0.01
        sand.around = sand.around._replace(profile=surface + np.array([x, y]))
        tangents.append(sand.tangent(fq, fv))
    at_origin, translated = tangents
    scale = np.abs(at_origin).max(axis=0)
    assert scale.min() > 1e3
    # Places there are known to 1e-13 m, and one is moved by 3 pm.
    np.testing.assert_allclose(translated / scale, at_origin / scale, rtol=0.0, atol=0.02)


def test_tangents_are_added_to_the_given_matrix() -> None:
    rng = np.random.default_rng(18)
    sand = Sand(cable(rng), BAR_LAWS[0].record(STATIC[0], G), run_of(False), rng)
    tangent, out = sand.tangent(1.0, 0.5), np.full((16, 16), 3.0)
    sand.add_tangent(1.0, 0.5, out)
    # Round-off of a sum of up to 1e4.
    np.testing.assert_allclose(out, 3.0 + tangent, rtol=1e-12)


def test_no_tangent_above_the_surface() -> None:
    rng = np.random.default_rng(19)
    geometry, q, v = rigid(rng)
    q[1] = 1.0
    sand = Sand((geometry, q, v), BAR_LAWS[0].record(STATIC[0], G), run_of(False), rng)
    assert not sand.tangent(1.0, 1.0).any()
