"""Checks of an Exudyn that returns copies or evaluates objects in another order: it is detected and warned of once."""

from __future__ import annotations

from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

import exudyn as exu
import numpy as np
import pytest
from exudyn import itemInterface as items
from support_models import chain
from support_runs import scenario_of, scene_of

from granular_contact import GranularBed, Simulation, preset
from granular_contact.engines.exudyn import engine_checks
from granular_contact.engines.exudyn.build import build
from granular_contact.engines.exudyn.engine_checks import (
    CONSTRAINT,
    FORCE,
    RESIDUAL,
    TRIGGER,
    Abilities,
    abilities,
    in_order,
    trial_abilities,
)
from granular_contact.engines.exudyn.solve import solve
from granular_contact.engines.exudyn.tangent import Tangent
from granular_contact.errors import SolveError
from granular_contact.mechanics.system import Trajectory
from granular_contact.run import run

CHAIN = chain(
    4,
    0.05,
    "medium: play_sand",
    "initial: {impact_angle_deg: 40, impact_speed_rad_s: 5}",
    "solver: {step_s: 2e-4, end_time_s: 0.04, rest_time_s: null}",
    "method: engine",
)
PATCH = pytest.MonkeyPatch


@pytest.fixture(autouse=True)
def _tried_anew(monkeypatch: PATCH) -> Iterator[None]:
    """Clear the cached result of the trial of the engine before and after each test."""
    trial_abilities.cache_clear()
    yield
    monkeypatch.undo()
    trial_abilities.cache_clear()


def copies_of_controls(monkeypatch: PATCH) -> None:
    """Make the solver return copies of the settings that it reads while it runs."""
    fields = {
        "it": ("currentStepSize", "maxStepSize", "minStepSize", "endTime", "currentTime", *("newtonStepsCount",)),
        "conv": ("jacobianUpdateRequested", "residual"),
        "newton": ("absoluteTolerance", "maxIterations"),
    }
    fields["it"] += "newtonJacobiCount", "rejectedModifiedNewtonSteps"

    for handle, names in fields.items():
        original = getattr(exu.MainSolverImplicitSecondOrder, handle)

        def copy(solver: Any, original: Any = original, names: tuple[str, ...] = names) -> Any:
            handed = original.fget(solver)
            return SimpleNamespace(**{name: getattr(handed, name) for name in names})

        monkeypatch.setattr(exu.MainSolverImplicitSecondOrder, handle, property(copy))


def copies_of_vectors(monkeypatch: PATCH) -> None:
    """Make the system return copies of its vectors, whatever the arguments."""
    for getter in engine_checks.GETTERS:
        original = getattr(exu.SystemData, getter)

        def copy(
            data: Any, configuration: Any = exu.ConfigurationType.Current, *, original: Any = original, **_: bool
        ) -> Any:
            return original(data, configuration, copy=True)

        monkeypatch.setattr(exu.SystemData, getter, copy)


def other_order(_: PATCH) -> None:
    """Try an engine that evaluates objects in another order than that in which they were added."""
    original, kept = exu.MainSystem.AddObject, []

    def swapped(mbs: Any, item: Any) -> Any:
        if isinstance(item, items.ObjectGenericODE2) and not kept:
            return kept.append(item)
        added = original(mbs, item)
        if isinstance(item, items.ObjectGenericODE2):
            original(mbs, kept.pop())
        return added

    with pytest.MonkeyPatch.context() as during:
        during.setattr(exu.MainSystem, "AddObject", swapped)
        assert not abilities().order  # and is not tried again


CASES = {
    "controls": (copies_of_controls, "copies of solver.it, .conv and .newton"),
    "views": (copies_of_vectors, "copies of its vectors of state"),
    "order": (other_order, "the order in which they were added"),
}


def spoil(case: str, monkeypatch: PATCH) -> None:
    """Make the engine lack the ability of this case."""
    trial_abilities.cache_clear()
    CASES[case][0](monkeypatch)


each = pytest.mark.parametrize("case", CASES)


def simulated(*changes: str) -> Trajectory:
    return solve(build(scene_of(CHAIN, *changes)))


def ends(first: Trajectory, second: Trajectory) -> float:
    """Greatest difference (m, rad) of coordinates at the end."""
    return float(np.abs(first.q[-1] - second.q[-1]).max())


def test_installed_engine_has_all_abilities() -> None:
    assert abilities() == Abilities()
    assert simulated().notices == ()


@each
def test_missing_abilities_of_the_engine_are_detected_and_warned_once(case: str, monkeypatch: PATCH) -> None:
    spoil(case, monkeypatch)
    missing = [name for name in ("controls", "views", "order") if not getattr(abilities(), name)]
    assert missing == [case]
    warnings = [warning for warning in run(scene_of(CHAIN)).warnings if CASES[case][1] in warning]
    assert len(warnings) == 1
    assert "Exudyn 1." in warnings[0]


@each
def test_the_motion_is_the_same_within_the_error_of_its_steps(case: str, monkeypatch: PATCH) -> None:
    usual, finer = simulated(), simulated("solver.step_s=1e-4")
    spoil(case, monkeypatch)
    other = simulated()
    assert len(other.time) == len(usual.time)
    # What halving the steps changes is most of their error; half of that is left for other ends of iterations.
    assert ends(other, usual) < 0.5 * ends(finer, usual)


@pytest.mark.slow
@each
def test_chosen_steps_keep_their_accuracy(case: str, monkeypatch: PATCH) -> None:
    """Where none can be set, they are refused by the same estimate."""
    accuracy, true = 3e-3, simulated("solver.step_s=1e-5")
    spoil(case, monkeypatch)
    trajectory = simulated(f"solver.accuracy={accuracy}")
    assert trajectory.notices
    path = float(np.abs(np.diff(true.q, axis=0)).sum(axis=0).max())
    assert ends(trajectory, true) < accuracy * path
    assert 1.0 < len(trajectory.time) < 0.5 * len(simulated().time)


def test_a_bed_of_the_users_own_system_reads_the_present_state(monkeypatch: PATCH) -> None:
    """A falling ball is stopped alike; whoever attaches the bed is warned."""

    def fall() -> float:
        container = exu.SystemContainer()
        mbs = container.AddSystem()
        node = mbs.AddNode(items.NodeRigidBody2D(referenceCoordinates=[0, 0.03, 0], initialVelocities=[0.0, -1.0, 0]))
        body = mbs.AddObject(items.ObjectRigidBody2D(mass=0.1, inertia=1e-4, nodeNumber=node))
        bed = GranularBed(mbs, preset("play_sand"), 0.0)
        bed.add_rigid(body, (-0.05, 0.0), (0.05, 0.0), 0.01)
        bed.attach()
        mbs.Assemble()
        settings = exu.SimulationSettings()
        settings.timeIntegration.endTime, settings.timeIntegration.numberOfSteps = 0.06, 300
        settings.timeIntegration.verboseMode, settings.solution.file.write = 0, False
        mbs.SolveDynamic(settings)
        assert bed.work < 0.0
        return float(mbs.systemData.GetODE2Coordinates()[1])

    usual = fall()
    spoil("views", monkeypatch)
    with pytest.warns(UserWarning, match="copies of its vectors") as caught:
        depth = fall()
    assert len(caught) == 1
    assert caught[0].filename == __file__
    # The same steps and iterations from the same start: but for round-off, of 0.1 m, the same.
    assert depth == pytest.approx(usual, abs=1e-12)


def test_a_run_that_can_not_be_stepped_is_refused(monkeypatch: PATCH) -> None:
    copies_of_controls(monkeypatch)
    with pytest.raises(SolveError, match=r"can't be stepped with Exudyn 1\..*`simulate` it"):
        Simulation(scenario_of(CHAIN))


def test_vectorised_copies_are_stepped_and_restored(monkeypatch: PATCH) -> None:
    copies_of_vectors(monkeypatch)
    assert _after_a_detour() == 0.0


def test_jacobian_is_computed_again_if_the_engine_ignores_its_place(monkeypatch: PATCH) -> None:
    """The engine ignores where it is led: told, and the same within what Newton's method leaves."""
    monkeypatch.setattr("granular_contact.engines.exudyn.tangent._starting_at", lambda _: lambda *_: None)
    warnings: list[str] = []
    changed = _after_a_detour(warnings)
    assert any("did not go back to the Jacobian" in warning for warning in warnings)
    # A residual of 1e-5 of the forces (solver.tolerance) each step, which sand takes out.
    assert 0.0 < changed < 1e-5 * 0.2


def test_accelerations_that_are_not_those_of_the_state_are_reported(monkeypatch: PATCH) -> None:
    monkeypatch.setattr(exu.MainSolverImplicitSecondOrder, "InitializeSolverInitialConditions", lambda *_: True)
    warnings: list[str] = []
    _after_a_detour(warnings)
    assert any("accelerations of a saved state" in warning for warning in warnings)


def _after_a_detour(warnings: list[str] | None = None) -> float:
    """Greatest difference in the table (m) of tips between a run, and the same gone on with from a restored state."""
    simulation = Simulation(scenario_of(CHAIN))
    simulation.step({}, 0.02)
    kept = simulation.state()
    simulation.step({}, 0.02)
    first = simulation.results()
    simulation.restore(kept)
    simulation.step({}, 0.02)
    second = simulation.results()
    if warnings is not None:
        warnings += second.warnings
    place = [column.name for column in first.columns].index("tip_x_m")
    return float(np.abs(first.table - second.table)[:, place : place + 2].max())


def test_a_prescribed_motion_needs_constraints_after_forces() -> None:
    able = Abilities(constraints_last=False)
    assert "prescribed motion" in str(engine_checks.refusal(able, pauses=False, turns=True))
    assert engine_checks.refusal(able, pauses=True, turns=False) is None


@pytest.mark.parametrize(
    ("asked", "fine"),
    [
        ([RESIDUAL, TRIGGER, FORCE, CONSTRAINT, RESIDUAL, TRIGGER, TRIGGER, FORCE, CONSTRAINT], True),
        ([RESIDUAL, TRIGGER, FORCE, CONSTRAINT, RESIDUAL, FORCE, TRIGGER, CONSTRAINT], False),
        ([RESIDUAL, TRIGGER, CONSTRAINT], False),
        ([], False),
    ],
)
def test_the_order_of_evaluation_is_checked_in_every_residual(asked: list[str], fine: bool) -> None:
    assert in_order(asked, TRIGGER, FORCE) == fine


def test_engine_goes_back_to_the_state_of_its_jacobian() -> None:
    """The usual way back: the engine computes the Jacobian where it did."""
    answers: list[bool] = []
    recompute = Tangent.recompute

    def watched(tangent: Tangent, place: Any) -> bool:
        answers.append(recompute(tangent, place))
        return answers[-1]

    with pytest.MonkeyPatch.context() as during:
        during.setattr(Tangent, "recompute", watched)
        warnings: list[str] = []
        assert _after_a_detour(warnings) == 0.0
    assert answers == [True]
    assert not any("did not go back" in warning for warning in warnings)
