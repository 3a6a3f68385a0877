"""Analytic tangents against finite differences, for every law on every kind of run, away from kinks."""

from __future__ import annotations

from collections import Counter

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from support_properties import COMMON, Array, State, floors, states

from granular_contact.media.static_friction import Smooth

STEP = 1e-6  # m and m/s: next to bristles of 1 mm and more, strips of 5 mm, v_eps of 1 mm/s


SOFT = states(COMMON, yields=(1e-3, 1e-1))


def moved(body: State, x: Array) -> Array:
    """Station forces (2n,) at positions and velocities x (4n,), the anchors held."""
    P, V = x.reshape(2, -1, 2)
    return body.with_(P=np.ascontiguousarray(P), V=np.ascontiguousarray(V)).forces()[0].ravel()


def differences(body: State, steps: Array) -> Array:
    """Jacobian (2n, 4n) by central differences of fourth order."""
    x = np.concatenate([body.P.ravel(), body.V.ravel()])
    columns = []
    for j, h in enumerate(steps):
        d = np.zeros(x.size)
        d[j] = h
        near, far = moved(body, x + d) - moved(body, x - d), moved(body, x + 2 * d) - moved(body, x - 2 * d)
        columns.append((8 * near - far) / (12 * h))
    return np.stack(columns, axis=-1)


def blocks(J: Array, n: int) -> tuple[Array, Array]:
    return J[:, : 2 * n], J[:, 2 * n :]


def test_tangents_are_the_derivatives_of_the_forces() -> None:
    met: Counter[str] = Counter()

    @settings(max_examples=400, deadline=None)
    @given(st.one_of(SOFT, SOFT, SOFT, floors(COMMON)))
    def check(body: State) -> None:
        run = body.run.copy()
        run["resultant"] = False  # whose tangents are differences themselves
        body = body.with_(run=run)
        n = len(body.P)
        steps = np.repeat([STEP, 1e-2 * STEP if isinstance(body.static, Smooth) else STEP], 2 * n)
        rough, fine = differences(body, steps), differences(body, 0.5 * steps)
        for got, coarse, exact in zip(body.tangents(), blocks(rough, n), blocks(fine, n), strict=True):
            scale = float(np.abs(exact).max())
            force = float(np.abs(body.forces()[0]).max())
            # Round-off of the difference: 1e-16 of a force (1e-14 for depth integrals) over the step.
            noise = 1e-13 * force / float(steps.min()) + 1e-9
            if float(np.abs(coarse - exact).max()) > 1e-6 * scale + noise:
                met["kink"] += 1  # in the stencil: a halved step sees another slope
                continue
            np.testing.assert_allclose(got, exact, atol=1e-5 * scale + 10.0 * noise)
            met["loaded" if scale > 0.0 else "idle"] += 1

    check()
    # The property would hold on nothing: most states must be under load and smooth.
    assert met["loaded"] > 0.4 * sum(met.values())
    assert met["kink"] < 0.3 * sum(met.values())
