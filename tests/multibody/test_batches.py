"""Many bodies in one bed: computed in one call, active near the sand, with the results of separate beds."""

from __future__ import annotations

from typing import Any

import exudyn as exu
import numpy as np
import pytest
from exudyn import itemInterface as items
from test_bed import DIAMETER, HALF, INERTIA, MASS, SAND, G, settings

from granular_contact.engines.exudyn.bed import GranularBed
from granular_contact.sand.load import GranularLoad

COUNT, SURFACE = 8, -0.03
HEIGHTS = np.linspace(0.0, 0.6, COUNT)  # the first is in the sand after 20 ms, the last never


def rods(beds: int) -> tuple[Any, list[GranularBed], list[np.ndarray]]:
    """COUNT rods falling from different heights, in one bed or in one each; the states of all accepted steps."""
    mbs = exu.SystemContainer().AddSystem()
    made, states = [GranularBed(mbs, SAND, SURFACE) for _ in range(beds)], []
    for i, height in enumerate(HEIGHTS):
        node = mbs.AddNode(
            items.NodeRigidBody2D(referenceCoordinates=[i, height, -0.3], initialVelocities=[0.2, -1.0, 1.0])
        )
        body = mbs.AddObject(items.ObjectRigidBody2D(mass=MASS, inertia=INERTIA, nodeNumber=node, name=f"rod{i}"))
        weight = mbs.AddMarker(items.MarkerBodyMass(bodyNumber=body))
        mbs.AddLoad(items.LoadMassProportional(markerNumber=weight, loadVector=[0, -G, 0]))
        made[i % beds].add_rigid(body, [-HALF, 0.0], [HALF, 0.0], DIAMETER)
    for bed in made:
        bed.attach()
    mbs.Assemble()

    def keep(mbs: Any, t: float) -> bool:
        states.append(np.concatenate([[t], mbs.systemData.GetODE2Coordinates(), mbs.systemData.GetODE2Coordinates_t()]))
        return True

    mbs.SetPostStepUserFunction(keep)
    return mbs, made, states


def solved(beds: int, step: float = 2e-4, end: float = 0.06) -> tuple[list[GranularBed], np.ndarray]:
    mbs, made, states = rods(beds)
    mbs.SolveDynamic(settings(step, end))
    return made, np.array(states)


def test_one_bed_does_what_one_for_each_does() -> None:
    (bed,), together = solved(1)
    each, apart = solved(COUNT)
    # Sums in another order, and a Newton iteration that ends at 1e-8 of its first residual.
    np.testing.assert_allclose(together, apart, atol=1e-9)
    for i, separate in enumerate(each):
        ours, theirs = bed.history.bodies[:, i], separate.history.bodies[:, 0]
        np.testing.assert_allclose(ours, theirs, atol=1e-5 * max(1.0, np.abs(theirs).max()))
    touched = [np.abs(bed.history.bodies[:, i]).max() > 0.0 for i in range(COUNT)]
    assert touched == [True] * sum(touched) + [False] * (COUNT - sum(touched))
    assert 1 <= sum(touched) < COUNT
    assert bed.work == pytest.approx(sum(separate.work for separate in each), rel=1e-6)


def test_one_call_serves_all_bodies() -> None:
    (bed,), _ = solved(1)
    each, _ = solved(COUNT)
    assert bed.load_calls == pytest.approx(each[0].load_calls, rel=0.05)


def test_the_active_set_changes_no_digit(monkeypatch: pytest.MonkeyPatch) -> None:
    """Steps in which a rod falls 2 mm: what gets active when it is there is too late."""
    step = 1e-3
    (_,), with_set = solved(1, step)

    def everything(load: GranularLoad, step: float) -> bool:  # noqa: ARG001
        for batch in load.batches:
            batch.active[:] = True
        load.active = True
        return True

    monkeypatch.setattr(GranularLoad, "update_active", everything)
    (_,), without = solved(1, step)
    np.testing.assert_array_equal(with_set, without)


def test_most_lines_are_inactive_during_free_fall() -> None:
    mbs, (bed,), _ = rods(1)
    mbs.SolveDynamic(settings(2e-4, 2e-3))
    (batch,) = bed.load.batches
    assert batch.active.sum() <= 2


def test_forces_of_a_bed_end_with_its_contact() -> None:
    """A rod thrown up out of the sand: what was sent last must not act on it for ever."""
    mbs = exu.SystemContainer().AddSystem()
    node = mbs.AddNode(items.NodeRigidBody2D(referenceCoordinates=[0, -0.04, 0], initialVelocities=[0.0, 20.0, 0.0]))
    body = mbs.AddObject(items.ObjectRigidBody2D(mass=MASS, inertia=INERTIA, nodeNumber=node))
    bed = GranularBed(mbs, SAND, SURFACE)
    bed.add_rigid(body, [-HALF, 0.0], [HALF, 0.0], DIAMETER)
    bed.attach()
    mbs.Assemble()
    mbs.SolveDynamic(settings(1e-4, 0.1))
    speed, height = mbs.systemData.GetODE2Coordinates_t()[1], mbs.systemData.GetODE2Coordinates()[1]
    assert height > 0.05
    mbs.systemData.SetODE2Coordinates(mbs.systemData.GetODE2Coordinates(), exu.ConfigurationType.Initial)
    mbs.systemData.SetODE2Coordinates_t(mbs.systemData.GetODE2Coordinates_t(), exu.ConfigurationType.Initial)
    mbs.SolveDynamic(settings(1e-4, 0.1))
    assert mbs.systemData.GetODE2Coordinates_t()[1] == speed  # no gravity here
    np.testing.assert_array_equal(bed.force, [0.0, 0.0])
