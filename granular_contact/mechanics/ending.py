"""Status of a solve, with a sentence that says what to change."""

from __future__ import annotations

from granular_contact.laws.static_friction import Elastoplastic, Smooth
from granular_contact.mechanics.scheme import tolerance
from granular_contact.results import Status
from granular_contact.results.stopping import ended
from granular_contact.scene.types import Scene

STIFF, SLOW = 1e-7, 0.1  # m, s: bristles a hundred times stiffer or slower than the default ones are what fails
STEEP = 1e-5  # m/s: as is a smooth sign a hundred times steeper than the default one


def steep(scene: Scene) -> float | None:
    """Reference speed (m/s) of a smooth sign that is so steep that steps get very short; None of any other."""
    static = scene.static
    if scene.media and isinstance(static, Smooth) and static.reference_speed <= STEEP:
        return static.reference_speed
    return None


def late(scene: Scene, t: float) -> Status:
    """Status of a run that its wall time ended at a time (s), with what to change where that is known."""
    status = ended("time_limit", t, scene.solver)
    return Status(status.code, f"{status.message}; {_remedy(scene)}") if steep(scene) is not None else status


def diverged(scene: Scene, t: float) -> Status:
    """Status of a motion that ran away by a time (s)."""
    return Status("failed", f"the motion diverged at {t:.6g} s; {_remedy(scene)}")


def crowded(scene: Scene, t: float, steps: int, step: float) -> Status:
    """Status of a solve that did not get on: it took so many steps to a time (s), the last one of `step` (s)."""
    return Status("failed", f"{steps} steps were needed to {t:.6g} s, the last of {step:.2g} s; {_remedy(scene)}")


def unsolved(scene: Scene, t: float, step: float, problem: str = "") -> Status:
    """Status of a solve that no step (s) leads on from a time (s), however short."""
    reason = problem or "Newton's method did not converge"
    # In space the engine asks for so little that forces far above the weight may leave more by their round-off.
    by_engine = scene.in_space and scene.method is None
    coarser = f" or a larger solver.tolerance (now {tolerance(scene):g})" if by_engine else ""
    return Status("failed", f"{reason} at {t:.6g} s, with the step reduced to {step:.2g} s; {_remedy(scene)}{coarser}")


def _remedy(scene: Scene) -> str:
    solver, static = scene.solver, scene.static
    if scene.media and isinstance(static, Elastoplastic):
        if static.yield_displacement < STIFF:
            return f"take a larger load.friction.yield_displacement_m (now {static.yield_displacement:g})"
        if static.damping_time > SLOW:
            return f"take a smaller load.friction.damping_time_s (now {static.damping_time:g})"
    if (speed := steep(scene)) is not None:
        return f"take a larger load.friction.reference_speed_m_s (now {speed:g}), or type: elastoplastic"
    links = " or, for a very soft or very stiff link, more elements" if scene.links else ""
    what = "solver.step_s" if solver.accuracy is None else "solver.accuracy"
    return f"take a smaller {what} (now {solver.step_s if solver.accuracy is None else solver.accuracy:g}){links}"
