"""How long the steps of a run are: as its config says, or by a rule for what the config leaves open.

The rule rests on `validation/default_steps.py`, which compares time at equal error on shipped configs. One body in the
plane on a hinge or a slider that nothing drives strikes, slows down and stops within some hundred steps of 0.2 ms: to
choose them costs more than it saves. A body that flies free falls, strikes, topples over and slides on: how short its
steps have to be changes more, and with the angle at which it strikes. All else takes 2 to 10 times as long with steps
of 0.2 ms as with chosen ones, at errors far below those that a path is asked for. Longer fixed steps can be faster
still where a motion is smooth; they are found by trial.
"""

from __future__ import annotations

from granular_contact.config.schema import Scenario, Solver

STEP = 2e-4  # s
ACCURACY = 1e-3  # with 1e-2, enough for most paths, the energy of a drive's work is off by more than is warned of


class Steps(Solver):
    """`solver` of a config with steps that are known; why: a sentence on what they are and where they come from.

    named: the accuracy that the config names, None for the default's.
    """

    step_s: float = STEP
    why: str = ""
    named: float | None = None


def steps(scenario: Scenario) -> Steps:
    """Steps of a scenario."""
    solver = scenario.solver
    accuracy, why = _chosen(scenario)
    step = min(STEP, solver.end_time_s) if solver.step_s is None else solver.step_s
    if accuracy is not None:
        what = f"chosen by their error, with an accuracy of {accuracy:g}"
    else:
        what = f"of at most {1e3 * step:g} ms" if scenario.is_modal else f"of {1e3 * step:g} ms"
    given = {key: getattr(solver, key) for key in Solver.model_fields}
    return Steps(**given | {"step_s": step, "accuracy": accuracy, "why": f"{what}: {why}", "named": solver.accuracy})


def _chosen(scenario: Scenario) -> tuple[float | None, str]:
    """Accuracy by which steps are chosen, None for fixed ones, and the reason."""
    solver = scenario.solver
    if scenario.is_modal:
        return None, "the method chooses them by its rtol"
    if solver.accuracy is not None:
        return solver.accuracy, "the config names it (solver.accuracy)"
    if solver.step_s is not None:
        return None, "the config names them (solver.step_s)"
    if scenario.drives or scenario.wheel is not None:
        return ACCURACY, "drives move the mechanism"
    if not _is_held(scenario):
        return ACCURACY, "several bodies move, or one that flies free or moves in space"
    return None, "one body moves in the plane, held by a joint that nothing drives; fixed steps are then faster"


def _is_held(scenario: Scenario) -> bool:
    """Whether all that moves is one body in the plane, or several that are welded together, on a hinge or a slider."""
    moving = [joint.type for joint in scenario.model.all_joints.values() if joint.type != "weld"]
    return type(scenario) is Scenario and len(moving) == 1 and moving[0] != "free"
