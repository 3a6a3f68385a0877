"""pressure_sinkage and reece: the printed formulas, shear that grows along the path, and plane against space."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from support_laws import BEKKER, REECE, TRUE_SIGN, G, Strip, element, strip_force

from granular_contact.laws.pressure_sinkage import PressureSinkage
from granular_contact.laws.static_friction import Elastoplastic
from granular_contact.sand.contact_lines import Body, polyline
from granular_contact.sand.load import GranularLoad
from granular_contact.sand.space.load import SpatialLoad
from granular_contact.sand.space.shapes import Box

TAN = math.tan(math.radians(29.0))


def test_bekker_and_reece_are_the_printed_formulas() -> None:
    for medium, p in (
        (BEKKER, lambda z, b: (2e3 / b + 9e5) * z**1.3),
        (REECE, lambda z, b: (300.0 * 3.0 + 1330.0 * G * b * 20.0) * (z / b) ** 1.2),
    ):
        for z, b in ((0.02, 0.05), (0.3, 0.01)):
            s = element(0, 60, depth=z)  # a level plate: its depth is one
            plate = Strip(s.P, s.V, b)
            f = strip_force(plate, medium.record(TRUE_SIGN, G)).sum(axis=1)
            # An area of b times one metre; all shear is there, against the motion to the right. Round-off.
            np.testing.assert_allclose(f[0], [0.0, b * p(z, b)], rtol=1e-12, atol=1e-9)
            np.testing.assert_allclose(f[1], [-b * (300.0 + p(z, b) * TAN), 0.0], rtol=1e-12, atol=1e-9)


def test_the_power_of_the_depth_is_integrated_from_the_surface() -> None:
    s = Strip(np.array([[0.0, 0.01], [0.03, -0.04]]), np.array([[0.1, -1.0]] * 2), 0.05)
    f = strip_force(s, PressureSinkage(1e6, 1.3, 0.0).record(TRUE_SIGN, G)).sum(axis=(0, 1))
    # The integral of z^n over the height times the width; against the motion, along the normal (0.05, 0.03) / length.
    want = 1e6 * 0.04**2.3 / 2.3 * np.array([0.05, 0.03])
    np.testing.assert_allclose(f, want, rtol=6e-4)  # three points, as the docstring of `plates` has it


def pushed(load: Any, place: np.ndarray, way: float, steps: int = 1) -> np.ndarray:
    """Forces of the shear after a horizontal way (m) at a depth."""
    q, v = place.copy(), np.zeros_like(place)
    load.start(q)
    v[0] = 0.1
    for i in range(steps):
        q[0] = place[0] + way * (i + 1) / steps
        load.accept(i + 1.0, q, v)
    sheared: np.ndarray = load.history.terms[-1, 1]
    return sheared


def test_the_shear_grows_with_the_way_in_the_plane_and_in_space() -> None:
    # A plate that is dragged with its front end up, so that the shear is along it, and a box likewise.
    medium = PressureSinkage(9e5, 1.2, 30.0, shear_deformation_modulus=0.01, plate_width=0.04)
    static = Elastoplastic(1e-6, 1e-3)
    plane, tilt = GranularLoad(medium, 0.0, static=static), math.radians(10.0)
    plane.add(polyline(Body("plate", [0, 1, 2]), [[-0.05, 0.0], [0.05, 0.0]], width=0.04, strips=8))
    most = -pushed(plane, np.array([0.0, -0.05, tilt]), 0.2, 40)[0]
    way = 0.006
    for steps in (1, 60):
        got = -pushed(plane, np.array([0.0, -0.05, tilt]), way, steps)[0] / most
        assert got == pytest.approx(1.0 - math.exp(-way * math.cos(tilt) / 0.01), rel=1e-3)  # u_y, within a step
    space = SpatialLoad(medium, 0.0, static=static)
    space.add_shape(Body("box", range(6)), Box([0.1, 0.04, 0.004]), facet_size=0.01)
    whole = pushed(space, np.array([0.0, 0.0, -0.05, 0.0, -tilt, 0.0]), 0.2, 40)[0]
    part = pushed(space, np.array([0.0, 0.0, -0.05, 0.0, -tilt, 0.0]), way, 3)[0]
    assert whole < 0.0
    assert part / whole == pytest.approx(1.0 - math.exp(-way * math.cos(tilt) / 0.01), rel=2e-2)  # its short sides, too


def test_shear_displacement_starts_anew_after_leaving_the_medium() -> None:
    medium = PressureSinkage(9e5, 1.2, 30.0, shear_deformation_modulus=0.01)
    load = GranularLoad(medium, 0.0)
    load.add(polyline(Body("plate", [0, 1, 2]), [[-0.05, 0.0], [0.05, 0.0]], width=0.04, strips=2))
    ways = []
    q, v = np.array([0.0, -0.01, 0.2]), np.zeros(3)
    load.start(q)
    for i, y in enumerate((-0.02, -0.03, 0.1, -0.02)):
        q[:2] = 0.01 * i, y
        load.accept(0.1 * i, q, v)
        ways.append(load.batches[0].anchors[:, 2].copy())
    assert (ways[1] > ways[0]).all()
    assert not ways[2].any()
    assert (load.batches[0].anchors[:, 3] > 0.1).all()  # the whole way goes on


@pytest.mark.parametrize("medium", [BEKKER, REECE], ids=["bekker", "reece"])
def test_pressure_on_a_facet_is_independent_of_its_leading_centroid(medium: Any) -> None:
    """Where it leads in part: the sign of n . u at its centroid turned the pressure round, a jump that ended runs."""
    m = medium.model_copy(update={"plate_width": 0.05}).record(TRUE_SIGN, G).view(np.recarray)[0]
    n, t = np.array([0.6, 0.0, -0.8]), np.array([0.8, 0.0, 0.6])
    leads, trails = (np.array(medium.facet_traction(0.02, n, t + across * n, 1.0, 0.01, m)) for across in (1e-9, -1e-9))
    # The pressure does not know the direction, the shear follows it: its change is some 1e-9 of it.
    np.testing.assert_allclose(trails, leads, rtol=1e-6)
    assert leads[0] @ n < 0.0
