"""Exudyn's settings for a scene: steps, integrator, and tolerances that round-off leaves room for."""

from __future__ import annotations

import math
from typing import Any

import exudyn as exu
import numpy as np

from granular_contact.engines.exudyn.predictor import Patience
from granular_contact.engines.exudyn.step_control import StepControl
from granular_contact.mechanics.scheme import moving_joints, prescribed, spectral_radius, stops
from granular_contact.mechanics.stepping import SHORT, SHORTEST, usual_step
from granular_contact.scene.parts import FlexibleLink
from granular_contact.scene.types import Scene

EPSILON = float(np.finfo(float).eps)
OF_UNRESOLVED = 0.0  # spectral radius
# What it may leave there of the tolerance asked for: at short steps, and at the most with longer ones. Above the
# accuracy OF_COARSE the first grows as the accuracy, the second as its square; in space neither does.
CLOSER, LOOSEST, OF_COARSE = 1e-3, 0.1, 1e-2
# In space joints have constraints of positions and directions, and what Newton's method leaves in them over a step is a
# speed: of 1 nm over 20 ns 0.05 m/s. A long step leaves it to the short one after it, so the tolerance is one for all.
SHORTEST_IN_SPACE = 1e-2
# What Newton's method leaves in joints at fixed steps is a rate that swings from step to step: a controller answers it.
CONTROLLED = 1e-2
NEVER = 2**30
# At fixed steps: steps after which one that was halved is tried whole again, as what a step fails at is mostly over in
# the next one.
RECOVERY = 1
RECOVERY_OF_REFUSED = 3  # the same of steps that are refused by their error, where nobody can set longer ones
# A link that bends on one hinge, at fixed steps: what a step of SHORT leaves of the motion is a hundred times more than
# what Newton's method leaves with a tolerance EASED times the one asked for, which takes half of the iterations. With
# shorter steps both shrink alike. On a body that flies free it acts as a force that is much the same from step to step,
# and puts it a thousandth of its way off.
EASED = 100.0
# Links that bend, on each other, in sand: what stops them takes out what an iteration leaves. The error of the steps is
# the same to three digits with a tolerance so many times the one asked for.
EASED_IN_SAND = 30.0
# Rigid links on each other, in sand: the tolerance is so many times the one asked for once so many residuals of a step
# were above it. A step needs more where bristles begin to yield or to hold, and soon after the sand has taken out what
# it left. Errors of chains of 2 to 16 links at steps of 0.1 to 0.4 ms, rms of eight speeds, change by -4 to 2 %, in one
# of 24 cases by 6 %, where factors of 16 and of 256 change it by -1 and 2 %. With a tolerance of ten times from the
# first iteration on that of 4 links that strike would be twice as large.
LATER_IN_SAND, UNEASED = 100.0, 3
# In space: iterations with the least tolerance, the factor by which it grows with each one after these, and how many
# times the least a residual is that leads nowhere.
IN_SPACE, NEAR = (4, 4.0), 4.0
# Of the scale of forces: nothing is eased beyond it, or who asks for less than by default gets far less.
MOST_EASED = 1e-3
# Systems up to so many unknowns are solved by full matrices: a Jacobian then takes half of the time, and an iteration
# as much.
FULL = 60
# Of Newton's method where steps are chosen: what an iteration has to leave of the residual at most, or its Jacobian is
# renewed, of links that bend and of rigid bodies alone; most iterations.
GAIN, OF_RIGID, MOST_ITERATIONS, MOST_IN_SPACE = 0.25, 0.6, 14, 40
NO_SHARE = 1e-30  # of a residual: the engine asks for more than 0
# At fixed steps whose iterations are led on by those before: what a change may be of the way before, of links that
# bend, and of those that sand stops, whose Jacobian takes as long as eight iterations; most iterations. Where all links
# of a chain stop at once a step takes 30, and more if it is halved after 25.
OF_LED, OF_STOPPED, MOST_LED = 0.7, 1.2, 60


def force_noise(scene: Scene, link: FlexibleLink) -> float:
    """Round-off (N) of the elastic forces of a link: a lower bound of the residual of any Newton iteration.

    Positions of size L are known to eps L; over an element of length l that is a strain of eps L / l and a curvature of
    4 eps L / l^2 (the slopes of cubics), whose moment acts on the nodes with the arm l. n elements add up as sqrt(n).
    Residuals of 4 to 128 elements, EI from 1e-6 to 1e6 times the source's, stop within a factor of two of this.
    """
    piece = link.length / link.elements
    stiffness = link.axial_stiffness + 4.0 * link.bending_stiffness / piece**2
    return EPSILON * scene.length * stiffness / piece * math.sqrt(link.elements)


def unresolved(scene: Scene) -> bool:
    """Whether round-off of a link's elastic forces exceeds the tolerance of a step: it is practically rigid."""
    return _noise(scene) > scene.solver.tolerance * scene.force_scale


def _noise(scene: Scene) -> float:
    return 4.0 * max((force_noise(scene, link) for link in scene.links), default=0.0)


def settings(scene: Scene) -> Any:
    """Exudyn's settings for a scene."""
    s, solver = exu.SimulationSettings(), scene.solver
    t = s.timeIntegration
    t.endTime = solver.end_time_s
    t.numberOfSteps = max(1, math.ceil(solver.end_time_s / solver.step_s - 1e-9))
    t.minimumStepSize = (SHORTEST_IN_SPACE if scene.in_space else SHORTEST) * usual_step(scene)
    t.verboseMode = 0
    if solver.accuracy is None and not scene.in_space:
        t.adaptiveStepRecoverySteps = RECOVERY
    radius = solver.spectral_radius
    t.generalizedAlpha.spectralRadius = _spectral_radius(scene) if radius is None else radius
    _set_newton(t.newton, scene)
    s.solution.file.write = False
    full = not scene.in_space and _unknowns(scene) <= FULL
    s.linearSolver.solverType = exu.LinearSolverType.EigenDense if full else exu.LinearSolverType.EigenSparse
    return s


def _spectral_radius(scene: Scene) -> float:
    """Of generalised-alpha, unless the config names one."""
    if unresolved(scene) and _elastic_forces_below_round_off(scene):
        return OF_UNRESOLVED
    return spectral_radius(scene)


def _set_newton(newton: Any, scene: Scene) -> None:
    """Set when Newton's method ends.

    Exudyn measures a residual against an earlier one of its step or against an absolute force. Where that force is
    below the noise of the elastic forces, the iteration ends when changes of the coordinates are small: those by which
    the same residual would move a free mass in a step, or their own round-off.
    """
    solver = scene.solver
    newton.useModifiedNewton = True
    newton.absoluteTolerance = _force_tolerance(scene)
    newton.relativeTolerance = min(1e-8, 1e-3 * solver.tolerance)  # of an earlier residual of the step
    if unresolved(scene):
        newton.residualMode = 1
        newton.absoluteTolerance *= solver.step_s**2 / scene.mass
        newton.absoluteTolerance = max(newton.absoluteTolerance, _coordinate_noise(scene))
        newton.relativeTolerance = 1e-12
        newton.modifiedNewtonJacUpdatePerStep = True
        newton.useModifiedNewton = not _elastic_forces_below_round_off(scene)


def _force_tolerance(scene: Scene) -> float:
    """Residual (N) at which Newton's method ends."""
    solver, several = scene.solver, moving_joints(scene) > 1
    asked = solver.tolerance * scene.force_scale
    # In space the constraint of the Euler parameters, a number without unit, shares the tolerance too.
    if scene.in_space or (solver.accuracy is not None and (several or prescribed(scene))):
        return max(CLOSER * _coarser(scene) * asked, _noise(scene))
    if several and any(drive.kind == "control" for drive in scene.drives):
        return max(CONTROLLED * asked, _noise(scene))
    if not scene.links and solver.accuracy is None:
        return asked * max(1.0, solver.step_s / SHORT)
    eased = EASED if _swings(scene) else EASED_IN_SAND if stops(scene) else 1.0
    if not unresolved(scene):
        return max(asked, min(asked * eased * min(1.0, solver.step_s / SHORT) ** 2, MOST_EASED * scene.force_scale))
    return asked


def _unknowns(scene: Scene) -> int:
    """Coordinates of a scene in the plane, and about as many constraints as it has."""
    links = sum(4 * (link.elements + 1) for link in scene.links)
    return 3 * len(scene.rigid) + links + sum(3 if joint.kind == "weld" else 2 for joint in scene.joints)


def _coarser(scene: Scene) -> float:
    """How much coarser than OF_COARSE the accuracy of a scene in the plane is; 1 of all others."""
    return 1.0 if scene.in_space else max(1.0, (scene.solver.accuracy or 0.0) / OF_COARSE)


def _swings(scene: Scene) -> bool:
    """Whether all that moves is links that bend on one hinge on the ground, at fixed steps, with no drive."""
    return bool(scene.links) and scene.pendulum is not None and scene.solver.accuracy is None and not scene.drives


def tolerances(scene: Scene, simulation: Any) -> tuple[float, float, float] | None:
    """Tolerances of `predictor.Predictor`: where steps are chosen and joints ask for less; None elsewhere."""
    newton, whole = simulation.timeIntegration.newton, scene.solver.tolerance * scene.force_scale
    least = newton.absoluteTolerance
    greatest = LOOSEST * _coarser(scene) ** 2 * whole
    if scene.in_space or scene.solver.accuracy is None or newton.residualMode != 0 or least >= greatest:
        return None
    return least, greatest, min(scene.solver.step_s, SHORT)  # a first step longer than usual makes it no closer


def patience(scene: Scene, simulation: Any) -> Patience | None:
    """How the absolute tolerance of Newton's method grows within a step, see `predictor.Predictor`."""
    least, whole = simulation.timeIntegration.newton.absoluteTolerance, scene.solver.tolerance * scene.force_scale
    if scene.in_space:
        return Patience(least, LOOSEST * whole, *IN_SPACE, round_off=NEAR * least)
    if stops(scene) and not scene.links:
        greatest = max(least, min(LATER_IN_SAND * least, MOST_EASED * scene.force_scale))
        return Patience(least, greatest, UNEASED, LATER_IN_SAND)
    return None


def led_on(scene: Scene, simulation: Any) -> float:
    """What a change of an iteration may be of the one before at most; the engine's own rule is switched off."""
    newton = simulation.timeIntegration.newton
    gain = newton.modifiedNewtonContractivity
    if scene.links and scene.solver.accuracy is None:
        gain = OF_STOPPED if stops(scene) else OF_LED
    newton.modifiedNewtonContractivity, newton.maxModifiedNewtonIterations = math.inf, NEVER
    if scene.solver.accuracy is None:
        newton.maxIterations = MOST_LED
    if newton.residualMode == 0:
        newton.relativeTolerance = NO_SHARE  # of an earlier residual, which iterations may have been led astray to
    return float(gain)


def control_steps(simulation: Any, control: StepControl) -> None:
    """Leave the choice of steps to a step control; the engine still halves them where its iteration fails."""
    t = simulation.timeIntegration
    t.numberOfSteps = max(1, math.ceil(t.endTime / control.longest - 1e-9))
    t.adaptiveStepRecoverySteps = NEVER if control.sets else RECOVERY_OF_REFUSED
    # Steps are long enough for a new Jacobian to pay as soon as an iteration gains less than a factor of four; of rigid
    # bodies, whose iterations are led on by those before (`predictor`), it pays later. Where feet in sand change
    # between leading and trailing the iteration may go round in a circle: it seldom ends one later.
    # In space a robot that stands has facets by the hundred at the edge of yielding: it ends, but takes its time.
    scene = control.system.scene
    t.newton.modifiedNewtonContractivity = GAIN if scene.links else OF_RIGID
    t.newton.maxIterations = MOST_IN_SPACE if scene.in_space else MOST_ITERATIONS
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
