"""The granular load driven by poses and velocities from plain arrays, without an engine."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from granular_contact import preset
from granular_contact.errors import SceneError
from granular_contact.laws import probe
from granular_contact.laws.floor import Floor
from granular_contact.laws.static_friction import Elastoplastic
from granular_contact.sand import state
from granular_contact.sand.contact_lines import Body, ball, outline, polyline
from granular_contact.sand.kernels import batches
from granular_contact.sand.kernels.law import TERMS
from granular_contact.sand.load import GranularLoad

SAND, SIZE, SPEED, STEP = preset("poppy_seeds_loose"), 0.1, 0.1, 1e-4
HALF = 0.5 * SIZE
PLATE = [[-HALF, 0.0], [HALF, 0.0]]
# Yields after 1e-5 m, which a plate at 0.1 m/s has behind it after one step; undamped.
STATIC = Elastoplastic(1e-5, 0.0)


def plate_load(**options: object) -> GranularLoad:
    load = GranularLoad(SAND, 0.0, static=STATIC, **options)  # type: ignore[arg-type]
    load.add(polyline(Body("plate", [0, 1, 2]), PLATE, width=SIZE))
    return load


def pushed(load: GranularLoad, steps: int, angle: float = 0.0, start: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Drive a plate straight down from a height of `start`; its pose and velocity at the end."""
    pose, velocity = np.array([0.0, start, angle]), np.array([0.0, -SPEED, 0.0])
    load.start(pose)
    load.accept(0.0, pose, velocity)
    for i in range(1, steps + 1):
        load.update_active(STEP)
        pose[1] = start - i * STEP * SPEED
        load.accept(i * STEP, pose, velocity)
    return pose, velocity


@pytest.mark.parametrize("angle", [0.0, 30.0, -60.0])
def test_force_on_a_pushed_plate_is_that_of_the_law(angle: float) -> None:
    load = plate_load()
    pose, velocity = pushed(load, 4000, np.radians(angle), HALF)
    wrench = load.force(pose, velocity, np.zeros(3))
    # Its middle ends at 10 mm above the surface, its lower end below it: the part in the sand is the probe's.
    whole = probe.plate(-pose[1], angle, SIZE)
    expected = probe.force(SAND, whole, velocity).sum(axis=0)
    # The probe yields after 1e-12 m, the load is 1e-5 m behind; forces are proportional to the depth of the strip.
    np.testing.assert_allclose(wrench[:2], expected, rtol=1e-9, atol=1e-9)
    assert (expected[1] > 0.1) == (angle != 0.0)
    np.testing.assert_allclose(load.history.bodies[-1, 0, :2], wrench[:2], rtol=1e-12)


def test_accepted_step_is_independent_of_earlier_force_evaluations() -> None:
    """Forces found at the end of a step are taken for it, but not those of another state, anchor or coefficient."""

    def accepted(asked: bool) -> list[np.ndarray]:
        load = GranularLoad(SAND, 0.0, static=Elastoplastic(1e-3, 1e-3))
        load.add(polyline(Body("plate", [0, 1, 2]), PLATE, width=SIZE))
        pose, velocity = np.array([0.0, -0.01, 0.3]), np.array([0.02, -SPEED, 1.0])
        load.start(pose)
        load.accept(0.0, pose, velocity)
        before, rows = state.state(load), []

        def end(t: float, way: float, ask: float | None) -> None:
            """A step to `way` down, with forces asked for at `ask` where any are."""
            for at in (ask, None if ask is None else way) if asked else ():
                if at is not None:
                    load.force(pose - [0.0, at, 0.0], velocity, np.zeros(3))
                    load.tangent(pose - [0.0, 0.5 * at, 0.0], velocity, 1.0, 1.0)
            load.accept(t, pose - [0.0, way, 0.0], velocity)
            rows.extend([load.table.row.copy(), load.batches[0].anchors.copy()])

        end(1e-3, 4e-4, 4e-4)  # found at its end, and known
        end(2e-3, 9e-4, 6e-4)
        if asked:
            load.force(pose - [0.0, 3e-3, 0.0], velocity, np.zeros(3))
        state.restore(load, before)  # other anchors
        end(1e-3, 3e-3, None)
        if asked:
            load.force(pose - [0.0, 4e-3, 0.0], velocity, np.zeros(3))
        softer = preset("poppy_seeds_close")
        load.renew([replace(load.layers[0], medium=softer)], Elastoplastic(1e-3, 1e-3), 9.81)
        end(2e-3, 4e-3, None)
        return rows

    for ours, theirs in zip(accepted(True), accepted(False), strict=True):
        np.testing.assert_array_equal(ours, theirs)


def test_lines_out_of_reach_within_a_step_are_inactive() -> None:
    """In 10 ms at four times 0.1 m/s, and as much as it may become faster meanwhile: from 9 mm above it on."""
    for height, may in ((0.02, False), (0.0052, True)):
        load = plate_load()
        pose, velocity = np.array([0.0, height, 0.0]), np.array([0.0, -SPEED, 0.0])
        load.start(pose)
        load.accept(0.0, pose, velocity)
        assert bool(load.update_active(0.01)) == may


def test_work_on_a_level_plate_is_half_of_final_force_times_depth() -> None:
    load = plate_load()
    pose, velocity = pushed(load, 2000)
    depth, force = -pose[1], load.force(pose, velocity, np.zeros(3))[1]
    # The bristle yields within 1e-5 of 2e-2 m, and the force is then proportional to the depth.
    assert load.history.work[-1] == pytest.approx(-0.5 * force * depth, rel=1e-3)
    assert load.history.depth[-1] == pytest.approx(depth, rel=1e-12)
    assert load.history.immersed == {("plate", "flat", SIZE)}


def test_wrenches_are_added_at_the_coordinates_of_each_body() -> None:
    """Two plates far apart, the second of which has its coordinates first; the same in a larger system of a caller."""
    load = GranularLoad(SAND, 0.0, static=STATIC)
    load.add(polyline(Body("right", [3, 4, 5]), PLATE, width=SIZE))
    load.add(polyline(Body("left", [0, 1, 2]), PLATE, width=SIZE))
    q, v = np.array([-1.0, -0.01, 0.0, 1.0, -0.02, 0.0]), np.tile([0.0, -SPEED, 0.0], 2)
    load.start(q)
    # Put down by a millimetre, so that both bristles have yielded.
    moved = q - 1e-3 * np.tile([0.0, 1.0, 0.0], 2)
    load.accept(0.0, moved, v)
    wrenches = load.force(moved, v, np.zeros(6)).reshape(2, 3)
    for wrench, depth in zip(wrenches, (0.011, 0.021), strict=True):
        expected = probe.force(SAND, probe.plate(depth, 0.0, SIZE), v[:3]).sum(axis=0)
        np.testing.assert_allclose(wrench[:2], expected, rtol=1e-9, atol=1e-9)

    where, reference = np.array([7, 1, 2, 8, 4, 5]), np.full(9, 0.5)
    system, rates = np.full(9, np.nan), np.full(9, np.nan)
    system[where], rates[where] = q - 0.5, v
    load.start(system, where, reference)
    system[where] = moved - 0.5
    np.testing.assert_allclose(load.force(system, rates, np.zeros(6)).reshape(2, 3), wrenches, atol=1e-9)


def test_tangent_of_lines_of_unequal_length_is_the_derivative_of_forces() -> None:
    """In the sand on bristles that are stretched by a fifth of their yield, where forces are smooth."""
    load = GranularLoad(SAND, 0.0, static=Elastoplastic(1e-2, 1e-3))
    load.add(polyline(Body("right", [3, 4, 5]), PLATE, width=SIZE, strips=3))
    load.add(polyline(Body("left", [0, 1, 2]), PLATE, width=SIZE, strips=8))
    load.start(np.array([-1.0, -0.08, 0.4, 1.0, -0.12, -0.3]))
    state_ = np.array([-0.9996, -0.082, 0.406, 0.999, -0.1216, -0.304, 0.02, -0.1, 0.3, -0.05, -0.08, -0.2])
    slopes = np.zeros((6, 12))
    for j, step in enumerate(1e-7 * np.eye(12)):
        ahead, behind = (load.force(*np.split(state_ + at, 2), np.zeros(6)) for at in (step, -step))
        slopes[:, j] = (ahead - behind) / 2e-7
    for factors, want in zip(np.eye(2), np.split(slopes, 2, axis=1), strict=True):
        rows, columns, values = load.tangent(*np.split(state_, 2), *factors).T
        differences = np.zeros((6, 6))
        np.add.at(differences, (rows.astype(int), columns.astype(int)), values)
        # Central differences of 1e-7 m of forces that bend over some mm, and their round-off.
        np.testing.assert_allclose(differences, want, atol=1e-5 * np.abs(want).max())
        assert (np.abs(want[:3, :3]).max() > 1.0, np.abs(want[3:, 3:]).max() > 1.0) == (True, True)
        assert not want[:3, 3:].any()


def test_work_arrays_hold_every_line() -> None:
    """Compiled code looks at no bounds: what lay beyond would be other memory."""
    ends, anchors = np.array([[0, 0], [4, 3], [9, 9]]), np.zeros((9, 2))  # lines of 3 and 6 coordinates
    stations, body = batches.work(ends, anchors)
    assert stations.shape == (6, 9, 2)
    assert body.shape == (batches.BLOCK + 6 + 2 * batches.KEPT, 3 * TERMS)


def test_a_state_taken_back_leaves_no_trace() -> None:
    load = plate_load(floor=Floor(-0.02, 1e5))
    pose, velocity = pushed(load, 500)
    before, force = load.history, load.force(pose, velocity, np.zeros(3))
    with load.accepted(1.0, pose - [0.1, 0.02, 0.0], velocity):
        assert len(load.history.time) == len(before.time) + 1
        assert load.history.floor_work[-1] != 0.0
    np.testing.assert_array_equal(load.history.work, before.work)
    np.testing.assert_array_equal(load.force(pose, velocity, np.zeros(3)), force)
    assert load.last.time[-1] == load.time == before.time[-1]


def test_tangent_is_the_derivative_of_the_force() -> None:
    load = plate_load()
    pose, velocity = pushed(load, 1000, 0.3, 0.02)
    pose += [1e-6, 6e-6, 1e-5]  # unloaded by more than half of what yields: at the half the law has a kink
    differences = np.zeros((3, 3))
    for i, j, value in load.tangent(pose, velocity, 1.0, 0.0):
        differences[int(i), int(j)] += value
    for j in range(3):
        step = 1e-7 * np.eye(3)[j]
        ends = [load.force(pose + s * step, velocity, np.zeros(3)) for s in (-1, 1)]
        # Over 0.1 um the depth of the edge in the sand changes by 1e-5 of itself; the kernel's own steps are of 10 nm.
        np.testing.assert_allclose(
            differences[:, j], (ends[1] - ends[0]) / 2e-7, rtol=2e-3, atol=1e-3 * np.abs(differences).max()
        )


def test_unusable_bodies_are_refused() -> None:
    load = plate_load()
    with pytest.raises(SceneError, match="nothing acts on spheres"):
        load.add(ball(Body("ball", [0, 1, 2]), [0.0, 0.0], 0.01, 0.1))
    with pytest.raises(SceneError, match="4 coordinates"):
        outline(Body("box", [0, 1, 2, 3]), [[0, 0], [1, 0], [0, 1]], 0.1)
    load.start(np.zeros(3))
    with pytest.raises(SceneError, match="attached already"):
        load.add(polyline(Body("late", [0, 1, 2]), PLATE, width=SIZE))
