"""Exudyn's settings for a scene: generalised-alpha, modified Newton, and tolerances that round-off permits.

The constants are in `mechanics.kernels.numerics`.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import exudyn as exu
import numpy as np

from granular_contact.engines.exudyn.step_control import StepControl
from granular_contact.laws.static_friction import Elastoplastic
from granular_contact.mechanics.kernels.numerics import (
    CLOSER,
    CONTRACTION,
    MOST_ITERATIONS,
    NOISE_SPECTRAL_RADIUS,
    SHORTEST,
)
from granular_contact.mechanics.scheme import spectral_radius, tolerance, tolerance_by_accuracy
from granular_contact.mechanics.stepping import usual_step
from granular_contact.scene.parts import FlexibleLink
from granular_contact.scene.types import Scene

EPSILON = float(np.finfo(float).eps)
NEVER = 2**30
# Tolerance of the residual of a step in space over `sand_noise`, so that round-off of the sand's forces stays below it.
# Without this bound an arc thrown 80 m or more from the origin took 8 to 40 times the steps; with a factor of 45 it
# took no more steps at 800 m [measured].
NOISE_FACTOR = 50.0


def force_noise(scene: Scene, link: FlexibleLink) -> float:
    """Round-off (N) of the elastic forces of a link: a lower bound of the residual of any Newton iteration.

    Positions of size L have the round-off eps L. In an element of length l that is a strain of eps L / l and a
    curvature of 4 eps L / l^2 (the slopes of cubics), whose moment acts on the nodes with the arm l. Errors of n
    elements add up as sqrt(n). Residuals of 4 to 128 elements, with EI from 1e-6 to 1e6 times that of the source, stop
    within a factor of two of this estimate.
    """
    element_length = link.length / link.elements
    stiffness = link.axial_stiffness + 4.0 * link.bending_stiffness / element_length**2
    return EPSILON * scene.length * stiffness / element_length * math.sqrt(link.elements)


def sand_noise(scene: Scene) -> float:
    """Relative round-off of the sand's forces.

    Positions at a distance L from the origin have the round-off eps L; static friction builds up over the yield
    displacement, some 10 um.
    """
    distance = max(float(np.linalg.norm(body.motion.position)) for body in scene.bodies)
    return EPSILON * distance / scene.static.yield_displacement if isinstance(scene.static, Elastoplastic) else 0.0


def unresolved(scene: Scene) -> bool:
    """Whether round-off of a link's elastic forces exceeds the tolerance of a step: the link is practically rigid."""
    return _noise(scene) > tolerance(scene) * scene.force_scale


def _noise(scene: Scene) -> float:
    """Residual (N) that round-off of the elastic forces of links may leave."""
    return 4.0 * max((force_noise(scene, link) for link in scene.links), default=0.0)


def settings(scene: Scene) -> Any:
    """Exudyn's `SimulationSettings` for a scene."""
    simulation, solver = exu.SimulationSettings(), scene.solver
    time = simulation.timeIntegration
    time.endTime = solver.end_time_s
    time.numberOfSteps = max(1, math.ceil(solver.end_time_s / solver.step_s - 1e-9))
    time.minimumStepSize = SHORTEST * usual_step(scene)
    time.verboseMode = 0
    radius = solver.spectral_radius
    time.generalizedAlpha.spectralRadius = _spectral_radius(scene) if radius is None else radius
    _set_newton(time.newton, scene)
    simulation.solution.file.write = False
    simulation.linearSolver.solverType = exu.LinearSolverType.EigenSparse
    return simulation


def _spectral_radius(scene: Scene) -> float:
    """Spectral radius of generalised-alpha if the config gives none."""
    if unresolved(scene) and _elastic_forces_below_round_off(scene):
        return NOISE_SPECTRAL_RADIUS
    return spectral_radius(scene)


def _set_newton(newton: Any, scene: Scene) -> None:
    """Set the modified Newton method and its convergence criterion.

    The engine compares the residual with that at the start of the step and with an absolute force (N); it compares the
    residual of constraints (m, or without unit) with the same number. If the tolerance is below the round-off of
    elastic forces, changes of the coordinates end the iteration: they must be below the displacement that the allowed
    residual gives to a free mass in a step, or below the round-off of the coordinates.
    """
    solver = scene.solver
    newton.useModifiedNewton = True
    newton.modifiedNewtonContractivity, newton.maxIterations = CONTRACTION, MOST_ITERATIONS
    newton.absoluteTolerance = _allowed(scene)
    newton.relativeTolerance = min(1e-8, 1e-3 * tolerance(scene))  # over the residual at the start of the step
    if unresolved(scene):
        newton.residualMode = 1
        newton.absoluteTolerance *= solver.step_s**2 / scene.mass
        newton.absoluteTolerance = max(newton.absoluteTolerance, _coordinate_noise(scene))
        newton.relativeTolerance = 1e-12
        newton.modifiedNewtonJacUpdatePerStep = True
        newton.useModifiedNewton = not _elastic_forces_below_round_off(scene)


def _allowed(scene: Scene) -> float:
    """Tolerance (N) of the residual of a step."""
    if scene.in_space:
        return max(CLOSER * tolerance(scene), NOISE_FACTOR * sand_noise(scene)) * scene.force_scale
    if unresolved(scene):
        return tolerance(scene) * scene.force_scale
    # The tolerance of fixed steps is an upper bound, as residuals of steps add up. With an accuracy of 3e-3 and a
    # fiftieth of it as tolerance, the energy of a four-bar leg was out of balance by 1.9e-3; with 1e-5 by 3e-4.
    return max(min(tolerance(scene), tolerance_by_accuracy(scene)) * scene.force_scale, _noise(scene))


def allowed_in_space(scene: Scene) -> Callable[[float], float]:
    """Tolerance (N) of the residual in space by the length of the step (s).

    It grows in inverse proportion to the step, up to the tolerance of the scene, so that residuals change speeds by as
    much in short steps as in long ones. The part of the residual that round-off of positions causes grows as steps
    shrink. With a constant tolerance a failed step would be halved again and again, to steps that cannot be solved.
    """
    lower, upper, usual = _allowed(scene), tolerance(scene) * scene.force_scale, usual_step(scene)
    return lambda step: max(lower, min(upper, lower * usual / step))


def control_steps(simulation: Any, control: StepControl) -> None:
    """Leave the choice of steps to a step control; the engine still halves a step whose iteration fails."""
    time = simulation.timeIntegration
    time.numberOfSteps = max(1, math.ceil(time.endTime / control.longest - 1e-9))
    if control.sets_steps:
        time.adaptiveStepRecoverySteps = NEVER
    time.discontinuous.ignoreMaxIterations = False


def _coordinate_noise(scene: Scene) -> float:
    """Round-off of the coordinates of links: positions (m) and slopes, which are differences over an element."""
    lengths = [(link, link.length / link.elements) for link in scene.links]
    return max(
        4.0 * EPSILON * (scene.length + scene.length / element_length) * math.sqrt(2.0 * link.elements)
        for link, element_length in lengths
    )


def _elastic_forces_below_round_off(scene: Scene) -> bool:
    """Whether round-off of elastic forces exceeds 1e-3 of the scene's forces; accelerations are then mere noise."""
    return _noise(scene) > 1e-3 * scene.force_scale
