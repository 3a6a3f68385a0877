"""Tangents of rigid bodies against finer differences, for every law on every kind of run, away from kinks."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from support_parts import called
from support_properties import COMMON, Array, State, floors, states

from granular_contact.sand.kernels import kinematics, law, lines
from granular_contact.sand.kernels.forces import medium_record

SOFT = states(COMMON, yields=(1e-3, 1e-1))
D = 1e-8  # s: `lines.difference` moves positions by at most 10 nm and velocities by 1 um/s


def rigid(body: State) -> tuple[Array, Array, tuple]:
    """Coordinates and rates of a body that carries the stations, and what the kernels want besides."""
    center = body.P.mean(axis=0)
    r, n = body.P - center, len(body.P)
    geometry = np.zeros(n, kinematics.STATION)
    geometry["x"], geometry["y"] = r.T
    turns = np.column_stack([-r[:, 1], r[:, 0]])
    arm = float((turns**2).sum())
    rate = float((turns * (body.V - body.V.mean(axis=0))).sum()) / arm if arm > 0.0 else 3.0
    medium, room = medium_record(body.record), np.zeros((3, n, 2))
    around = law.Contact(geometry, body.run, body.profile, medium, body.anchors, *room)
    return np.array([*center, 0.0]), np.array([*body.V.mean(axis=0), rate]), around


def forces(q: Array, v: Array, around: law.Contact) -> Callable[[Array], Array]:
    """Generalised forces where coordinates and rates are x (6,) further on."""

    def at(x: Array) -> Array:
        out = np.zeros(3)
        called(lines.force)(q + x[:3], v + x[3:], around, np.zeros((law.TERMS, 3)), out)
        return out

    return at


def test_tangents_are_the_derivatives_of_the_forces() -> None:
    met: Counter[str] = Counter()

    @settings(max_examples=200, deadline=None)
    @given(st.one_of(SOFT, SOFT, SOFT, floors(COMMON)))
    def check(body: State) -> None:
        q, v, around = rigid(body)
        at = forces(q, v, around)
        force, h = at(np.zeros(6)), 20.0 * D
        for fq, fv in ((1.0, 0.0), (0.0, 1.0), (0.7, -1.3)):
            got, steps = np.zeros((3, 3)), np.vstack([fq * np.eye(3), fv * np.eye(3)])
            called(lines.differences)(q, v, v, around, np.zeros((3, 3)), force, fq, fv, got)
            d = min(D / max(fq, 1e-300), 1e-6 / max(abs(fv), 1e-300))
            h = 20.0 * d
            for j in range(3):
                f = {k: at(k * h * steps[:, j]) for k in (-2, -1, 1, 2)}
                near, far = (f[1] - f[-1]) / (2 * h), (f[2] - f[-2]) / (4 * h)
                bend = np.abs(f[1] - 2 * force + f[-1]).max() / h**2
                # As in tests/kernels: half the step times the second derivative, and round-off over the step.
                noise = (1e-13 * np.abs(force).max() + 1e-16 * np.abs(near).max()) / d + 1e-12
                if np.abs(near - far).max() > 1e-5 * np.abs(near).max() + 10.0 * noise:
                    met["kink"] += 1  # in the stencil: another step sees another slope
                    continue
                want = (4 * near - far) / 3
                np.testing.assert_allclose(got[:, j], want, rtol=0.0, atol=2.0 * d * bend + 4.0 * noise)
                met["loaded" if np.abs(want).max() > 100.0 * noise else "idle"] += 1

    check()
    # The property would hold on nothing: most states must be under load and smooth.
    assert met["loaded"] > 0.4 * sum(met.values())
    assert met["kink"] < 0.05 * sum(met.values())
