"""Status at the end of a solve, with a sentence that says what to change."""

from __future__ import annotations

from granular_contact.laws.static_friction import Elastoplastic, Smooth
from granular_contact.mechanics.scheme import tolerance
from granular_contact.results import Status
from granular_contact.results.stopping import ended
from granular_contact.scene.types import Scene

# A hundred times stiffer or slower than the default bristles, steeper than the default smooth sign: the likely cause of
# a failure.
STIFF, SLOW = 1e-7, 0.1  # yield displacement (m), damping time (s) of bristles
STEEP = 1e-5  # reference speed (m/s) of the smooth sign


def steep(scene: Scene) -> float | None:
    """Reference speed (m/s) of a smooth sign that is so steep that steps get very short; None if it is not so steep."""
    static = scene.static
    if scene.media and isinstance(static, Smooth) and static.reference_speed <= STEEP:
        return static.reference_speed
    return None


def late(scene: Scene, t: float) -> Status:
    """Status of a run that reached its limit of wall time at a time (s), with a remedy where the cause is known."""
    status = ended("time_limit", t, scene.solver)
    return Status(status.code, f"{status.message}; {_remedy(scene)}") if steep(scene) is not None else status


def diverged(scene: Scene, t: float) -> Status:
    """Status of a motion that diverged at a time (s)."""
    return Status("failed", f"the motion diverged at {t:.6g} s; {_remedy(scene)}")


def crowded(scene: Scene, t: float, steps: int, step: float) -> Status:
    """Status of a solve that used up its steps: their number, the time (s) reached, the length (s) of the last one."""
    return Status("failed", f"{steps} steps were needed to {t:.6g} s, the last of {step:.2g} s; {_remedy(scene)}")


def unsolved(scene: Scene, t: float, step: float, problem: str = "") -> Status:
    """Status of a solve in which even the shortest step (s) from a time (s) failed."""
    reason = problem or "Newton's method did not converge"
    # The tolerance of the engine in space is so small that the round-off of forces far above the weight may exceed it.
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
