"""Generalised-alpha and modified Newton in Exudyn: settings of a scene, and what round-off leaves of its tolerances.

Constants: `mechanics.kernels.numerics`.
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
# Residual of a step in space that round-off of the sand's forces leaves, over `sand_noise`: a thrown arc took 8 to 40
# times the steps from 80 m on without, and none more at 800 m with 45 [measured].
LEFT = 50.0


def force_noise(scene: Scene, link: FlexibleLink) -> float:
    """Round-off (N) of the elastic forces of a link: a lower bound of the residual of any Newton iteration.

    Positions of size L are known to eps L; over an element of length l that is a strain of eps L / l and a curvature of
    4 eps L / l^2 (the slopes of cubics), whose moment acts on the nodes with the arm l. n elements add up as sqrt(n).
    Residuals of 4 to 128 elements, EI from 1e-6 to 1e6 times the source's, stop within a factor of two of this.
    """
    piece = link.length / link.elements
    stiffness = link.axial_stiffness + 4.0 * link.bending_stiffness / piece**2
    return EPSILON * scene.length * stiffness / piece * math.sqrt(link.elements)


def sand_noise(scene: Scene) -> float:
    """Round-off of the sand's forces, as a part of them: static friction builds up over a path of some 10 um.

    Positions L from the origin are known to eps L.
    """
    far = max(float(np.linalg.norm(body.motion.position)) for body in scene.bodies)
    return EPSILON * far / scene.static.yield_displacement if isinstance(scene.static, Elastoplastic) else 0.0


def unresolved(scene: Scene) -> bool:
    """Whether round-off of a link's elastic forces exceeds the tolerance of a step: it is practically rigid."""
    return _noise(scene) > tolerance(scene) * scene.force_scale


def _noise(scene: Scene) -> float:
    return 4.0 * max((force_noise(scene, link) for link in scene.links), default=0.0)


def settings(scene: Scene) -> Any:
    """Exudyn's settings for a scene."""
    s, solver = exu.SimulationSettings(), scene.solver
    t = s.timeIntegration
    t.endTime = solver.end_time_s
    t.numberOfSteps = max(1, math.ceil(solver.end_time_s / solver.step_s - 1e-9))
    t.minimumStepSize = SHORTEST * usual_step(scene)
    t.verboseMode = 0
    radius = solver.spectral_radius
    t.generalizedAlpha.spectralRadius = _spectral_radius(scene) if radius is None else radius
    _set_newton(t.newton, scene)
    s.solution.file.write = False
    s.linearSolver.solverType = exu.LinearSolverType.EigenSparse
    return s


def _spectral_radius(scene: Scene) -> float:
    """Of generalised-alpha, unless the config names one."""
    if unresolved(scene) and _elastic_forces_below_round_off(scene):
        return NOISE_SPECTRAL_RADIUS
    return spectral_radius(scene)


def _set_newton(newton: Any, scene: Scene) -> None:
    """Modified Newton, and when it ends.

    The engine measures a residual against the first one of its step or against an absolute force (N), and that of a
    constraint (m, or without unit) against the same number. Where the force is below the noise of the elastic forces,
    the iteration ends when changes of the coordinates are small: those by which the same residual would move a free
    mass in a step, or their own round-off.
    """
    solver = scene.solver
    newton.useModifiedNewton = True
    newton.modifiedNewtonContractivity, newton.maxIterations = CONTRACTION, MOST_ITERATIONS
    newton.absoluteTolerance = _allowed(scene)
    newton.relativeTolerance = min(1e-8, 1e-3 * tolerance(scene))  # of the first residual of the step
    if unresolved(scene):
        newton.residualMode = 1
        newton.absoluteTolerance *= solver.step_s**2 / scene.mass
        newton.absoluteTolerance = max(newton.absoluteTolerance, _coordinate_noise(scene))
        newton.relativeTolerance = 1e-12
        newton.modifiedNewtonJacUpdatePerStep = True
        newton.useModifiedNewton = not _elastic_forces_below_round_off(scene)


def _allowed(scene: Scene) -> float:
    """Residual (N) that a step may leave."""
    if scene.in_space:
        return max(CLOSER * tolerance(scene), LEFT * sand_noise(scene)) * scene.force_scale
    if unresolved(scene):
        return tolerance(scene) * scene.force_scale
    # At most that of fixed steps, as residuals add up: with a fiftieth of an accuracy of 3e-3 the energy of a four-bar
    # leg was out of balance by 1.9e-3 of it, with 1e-5 by 3e-4.
    return max(min(tolerance(scene), tolerance_by_accuracy(scene)) * scene.force_scale, _noise(scene))


def allowed_in_space(scene: Scene) -> Callable[[float], float]:
    """Residual (N) that a step (s) in space may leave: as much more as it is shorter than usual, up to the tolerance.

    So it changes speeds as much. What round-off of positions leaves of it grows as steps shrink: where a step fails it
    would be halved, down to where none can be solved.
    """
    least, most, usual = _allowed(scene), tolerance(scene) * scene.force_scale, usual_step(scene)
    return lambda step: max(least, min(most, least * usual / step))


def control_steps(simulation: Any, control: StepControl) -> None:
    """Leave the choice of steps to a step control; the engine still halves them where its iteration fails."""
    t = simulation.timeIntegration
    t.numberOfSteps = max(1, math.ceil(t.endTime / control.longest - 1e-9))
    if control.sets:
        t.adaptiveStepRecoverySteps = NEVER
    t.discontinuous.ignoreMaxIterations = False


def _coordinate_noise(scene: Scene) -> float:
    """Round-off of a step's coordinates: positions (m) and slopes, which are differences over an element."""
    lengths = [(link, link.length / link.elements) for link in scene.links]
    return max(
        4.0 * EPSILON * (scene.length + scene.length / piece) * math.sqrt(2.0 * link.elements)
        for link, piece in lengths
    )


def _elastic_forces_below_round_off(scene: Scene) -> bool:
    """Whether round-off of elastic forces exceeds 1e-3 of the scene's forces, so that accelerations are noise."""
    return _noise(scene) > 1e-3 * scene.force_scale
