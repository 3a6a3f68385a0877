"""Step sizes of a run: from the config, or by a default rule if the config gives none.

The rule rests on `validation/default_steps.py`, which compares run times at equal error for the shipped configs. One
body in the plane on a hinge or a slider without a drive strikes, slows down and stops within some hundred steps of 0.2
ms; error control of the steps costs more than it saves. A free body falls, strikes, topples over and slides on; the
step that it needs changes more, and depends on the angle of the impact. All other scenes take 2 to 10 times as long
with steps of 0.2 ms as with error control, with errors far below those that are asked of a path. Longer fixed steps can
be still faster where a motion is smooth; they have to be found by trial.
"""

from __future__ import annotations

from granular_contact.config.schema import Scenario, Solver
from granular_contact.config.schema.scenario import MOST_STEPS

STEP = 2e-4  # s
ACCURACY = 1e-3  # 1e-2 is enough for most paths, but the error of the work of a drive then exceeds its warning limit


class Steps(Solver):
    """`solver` of a config with step sizes filled in; why: what they are and where they come from, for messages.

    named: the accuracy that the config gives, None for the default.
    """

    step_s: float = STEP
    why: str = ""
    named: float | None = None


def steps(scenario: Scenario) -> Steps:
    """Solver settings of a scenario with its step sizes."""
    solver = scenario.solver
    accuracy, why = _chosen(scenario)
    step = min(max(STEP, 2.0 * solver.end_time_s / MOST_STEPS), solver.end_time_s)
    step = step if solver.step_s is None else solver.step_s
    if accuracy is not None:
        sizes = f"chosen by their error, with an accuracy of {accuracy:g}"
    else:
        sizes = f"of at most {1e3 * step:g} ms" if scenario.is_modal else f"of {1e3 * step:g} ms"
    given = {key: getattr(solver, key) for key in Solver.model_fields}
    return Steps(**given | {"step_s": step, "accuracy": accuracy, "why": f"{sizes}: {why}", "named": solver.accuracy})


def _chosen(scenario: Scenario) -> tuple[float | None, str]:
    """Accuracy of the error control of steps, None for fixed steps; and the reason."""
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
    """Whether only one body moves (or several welded ones), in the plane, on a hinge or a slider."""
    moving = [joint.type for joint in scenario.model.all_joints.values() if joint.type != "weld"]
    return type(scenario) is Scenario and len(moving) == 1 and moving[0] != "free"
