"""Wong and Reece's rigid wheel, driven and braked, by an independent quadrature: its shear turns back."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import quad

from granular_contact.laws.pressure_sinkage import PressureSinkage
from granular_contact.laws.static_friction import Elastoplastic
from granular_contact.laws.surface_pressure import FADE, SHALLOW
from granular_contact.sand.contact_lines import Body, outline
from granular_contact.sand.kernels.plates import EDGE
from granular_contact.sand.load import GranularLoad
from granular_contact.sand.space.load import SpatialLoad
from granular_contact.sand.space.round_shapes import Cylinder

RADIUS, WIDTH, DEPTH, SPEED = 0.058, 0.05, 0.019, 0.02
ENTRY = math.acos(1.0 - DEPTH / RADIUS)
SAND = PressureSinkage(8e6, 1.46, 29.0, cohesion=1000.0, shear_deformation_modulus=0.021, plate_width=WIDTH)
SHARP = Elastoplastic(1e-9, 1e-3)  # what yields at a nanometre is at its yield
SLIPS = (-0.5, -0.2, -0.02, 0.001, 0.2, 0.5, 0.9)


def rim_speed(slip: float) -> float:
    return SPEED / (1.0 - slip) if slip >= 0.0 else SPEED * (1.0 + slip)


def by_hand(slip: float) -> np.ndarray:
    """Force ahead and upward (N) and moment against its rolling (N m) of a wheel that rolls to the right.

    theta: from the lowest point, ahead; the rim moves along the surface at v cos theta - r omega, ahead.
    """
    rim = rim_speed(slip)
    turns = math.acos(rim / SPEED) if rim < SPEED else 0.0  # where the shear turns back
    starts = (turns, ENTRY) if turns < ENTRY else (ENTRY,)

    def stresses(theta: float) -> tuple[float, float]:
        z, along = RADIUS * (math.cos(theta) - math.cos(ENTRY)), SPEED * math.cos(theta) - rim
        speed = math.hypot(along, SPEED * math.sin(theta))
        start = min(angle for angle in starts if angle >= theta)
        j = RADIUS / rim * abs(SPEED * (math.sin(start) - math.sin(theta)) - rim * (start - theta))
        p = SAND.k_phi * z**SAND.exponent
        c = SAND.cohesion * min(1.0, z / (SHALLOW * WIDTH))
        tau = (c + p * math.tan(math.radians(29.0))) * (1.0 - math.exp(-j / SAND.shear_deformation_modulus))
        faded = min(1.0, SPEED * math.sin(theta) / speed / EDGE)
        return faded * p, -faded * tau * max(-1.0, min(1.0, along / speed / FADE))

    def integral(of: object, lever: float = 1.0) -> float:
        points = [angle for angle in (0.01, turns) if 0.0 < angle < ENTRY]
        value: float = quad(lambda a: of(*stresses(a), a), 0.0, ENTRY, points=points, limit=500)[0]  # type: ignore[operator]
        return value * RADIUS * WIDTH * lever

    ahead = integral(lambda p, tau, a: -p * math.sin(a) + tau * math.cos(a))
    upward = integral(lambda p, tau, a: p * math.cos(a) + tau * math.sin(a))
    return np.array([ahead, upward, integral(lambda p, tau, a: tau, RADIUS)])  # noqa: ARG005


def rolled(load: GranularLoad, slip: float, size: int, steps: int = 300) -> np.ndarray:
    """The same of a load with one wheel, after it has turned by more than its contact; in the plane or in space."""
    rim, up = rim_speed(slip), size // 3
    q, v = np.zeros(size), np.zeros(size)
    q[up], v[0], v[-2 if size == 6 else -1] = RADIUS - DEPTH, SPEED, rim / RADIUS * (1.0 if size == 6 else -1.0)
    end = 1.3 * ENTRY * RADIUS / rim
    load.start(q)
    for i in range(steps + 1):
        load.accept(end * i / steps, q + v * (end * i / steps), v)
    f = load.force(q + v * end, v, np.zeros(size))
    return np.array([f[0], f[up], -f[-2] if size == 6 else f[2]])


def test_driven_and_braked_wheels_are_those_of_the_quadrature() -> None:
    sides = 192
    angles = np.linspace(0.0, 2.0 * np.pi, sides, endpoint=False)
    circle = RADIUS * np.column_stack([np.cos(angles), np.sin(angles)])
    for slip in SLIPS:
        load = GranularLoad(SAND, 0.0, static=SHARP)
        turns = np.full(sides, 2.0 * np.pi / sides)
        load.add(outline(Body("wheel", [0, 1, 2]), circle, WIDTH, turns=turns, strips=sides))
        want, got = by_hand(slip), rolled(load, slip, 3)
        # A strip is 2 % of the contact and a step 0.4 %; the waterline cuts one, and the shear turns back within one.
        np.testing.assert_allclose(got[:2], want[:2], atol=3e-3 * want[1], err_msg=str(slip))
        assert got[2] == pytest.approx(want[2], abs=3e-3 * RADIUS * want[1]), slip


@pytest.mark.slow
def test_rolling_wheel_in_space_matches_quadrature() -> None:
    tilt = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])  # its axis across
    for slip in (-0.02, 0.2):
        load = SpatialLoad(SAND, 0.0, static=SHARP)
        shape = Cylinder(2.0 * RADIUS, WIDTH)
        load.add_shape(Body("wheel", range(6)), shape, rotation=tilt, facet_size=0.004)
        got, want = rolled(load, slip, 6, steps=150), by_hand(slip)
        # A facet is a twelfth of the contact long; the end faces, which slide along, take some shear.
        np.testing.assert_allclose(got[:2], want[:2], atol=0.03 * want[1], err_msg=str(slip))


def test_the_pull_goes_over_into_braking_without_a_jump() -> None:
    pulls = [by_hand(slip)[0] for slip in (1e-4, -1e-4, -1e-3)]
    load = by_hand(0.0)[1]
    assert abs(pulls[1] - pulls[0]) < 0.02 * load  # as the root of the slip: 0.2 at 4 %, 0.1 of it here
    assert abs(pulls[2] - pulls[0]) < 0.06 * load
