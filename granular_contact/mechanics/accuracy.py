"""A posteriori accuracy checks of a finished solve, from its own steps, with remedies.

Each sentence gives a number that was measured on the trajectory. The absence of warnings is no proof: a run whose steps
miss an event entirely has no trace of it in its states. `results.limits` checks the range of the run (depth, speed,
floor), `results.accuracy` its energy balance; the latter selects what is reported.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import pairwise
from typing import Any

import numpy as np

from granular_contact.mechanics.beam_energy import curvatures
from granular_contact.mechanics.kinematics import Kinematics
from granular_contact.mechanics.strip_error import strip_warnings
from granular_contact.results.accuracy import AccuracyWarning, remedy
from granular_contact.results.limits import LEAST_START_DEPTH
from granular_contact.results.summary import least_energy
from granular_contact.scene.drives import WELL_SAMPLED
from granular_contact.scene.signal_tables import bends, shortest_period
from granular_contact.scene.signals import Piecewise
from granular_contact.scene.stiff import LEAST_BOW
from granular_contact.scene.types import Vector

STEP_ERROR = 5e-3  # of the path length
CREEP = 5e-3  # of the path length: motion that is left when a run ends at rest
LEAST_CREEP = 1e-9  # of the rest speed: slower motion is round-off
UNKNOWN = 0.1  # of the energy: with a larger uncertainty of the work the computed motion is another one
FEWEST_STEPS = 8  # steps from the touch to the deepest point
ROUGH_BEAM = 0.05  # of the path length: jumps of curvature times an element's length squared; the error is smaller
ROUGH = 0.5  # rms of second differences over twice that of first ones; at 6 steps a period the two rms are equal
COARSE_BEAM, MOST_ELEMENTS = 0.01, 256  # of a link in space: error over the path, number of elements
FEW_MODES = 0.02  # of a link's greatest deflection: error by the neglected modes
TREMBLE = 1e-3  # of a link's length: smaller vibration does not count
EXCESS = 1.0 / 9.0  # |beta - 1/6| at a spectral radius of 0.9, see `stepping`


def accuracy_warnings(motion: Kinematics) -> Iterator[AccuracyWarning]:
    """Yield sentences on steps, strips, beams and vibration."""
    if len(motion.trajectory.time) < 4:
        return
    yield from _steps(motion)
    yield from _entry(motion)
    yield from _signals(motion)
    yield from _creep(motion)
    yield from strip_warnings(motion)
    for name in motion.system.links:
        yield from _beam(motion, name)
    for name, (error, elements) in motion.element_errors().items():
        yield from _elements(motion, name, error, elements)
    for name, error in motion.mode_errors(FEW_MODES).items():
        yield from _modes(motion, name, error)
    for name, deflections in motion.bends().items():
        yield from (warning for bend in deflections for warning in _vibration(motion, name, bend))


def step_error(time: Vector, speeds: Vector) -> float:
    """Estimated error (m) of positions as in `stepping`; time (n,) s, speeds (n, k) m/s of points."""
    steps = np.diff(time)
    change = np.diff(np.diff(speeds, axis=0) / steps[:, None], axis=0)
    return EXCESS * float(np.sum(steps[1:] ** 2 * np.abs(change).max(axis=1)))


def jump_error(time: Vector, v: Vector, mass: Any, fastest: Vector, loss: Vector | float = 0.0) -> float:
    """Estimated error (m) of positions by jumps of the force, as in `stepping`.

    v (n, m): rates of all coordinates; mass (m, m): mass matrix; fastest (n,) m/s: greatest speed of any point; loss
    (n,) W: power lost in viscous dampers.

    A jump J within a step h changes the mean acceleration from this step to the next by J / 2. So h times the
    unexpected part of this change bounds the error of the velocity. Only its projection on the motion counts, in the
    scalar product of the mass matrix, in which vibration is orthogonal to it. It keeps its sign, as forces that come
    and go leave no error. It decays with the time v / a that the motion lasts, or with the time v^T M v / loss in which
    dampers brake this motion, if that is shorter. The instant of a jump within its step is taken as random: root mean
    square.
    """
    steps = np.diff(time)[:, None]
    mean = np.diff(v, axis=0) / steps
    change = np.diff(mean, axis=0)
    before = np.concatenate([np.zeros((1, v.shape[1])), change[:-1]]) * steps[1:] / steps[:-1]
    jump = steps[1:] * np.where(np.abs(change) < np.abs(change - before), change, change - before)
    momentum = (v @ mass)[2:]
    energy = np.sum(momentum * v[2:], axis=1)
    relative = np.divide(np.sum(momentum * jump, axis=1), energy, out=np.zeros_like(energy), where=energy > 0.0)
    positive = np.maximum(energy, 1e-300)
    by_dampers = np.broadcast_to(loss, len(v))[2:] / positive
    rate = np.maximum(np.sqrt(np.sum((mean @ mass) * mean, axis=1)[1:] / positive), by_dampers)
    kicks, decay = relative * fastest[2:], np.exp(-steps[1:, 0] * rate)
    return displacement(steps[1:, 0], kicks, decay) / math.sqrt(3.0)


def displacement(steps: Vector, kicks: Vector, decay: Vector) -> float:
    """Greatest displacement (m) by changes (n,) m/s of a velocity that decays by a factor (n,) in each step (n,) s."""
    velocity, path, greatest = 0.0, 0.0, 0.0
    for step, kick, factor in zip(steps.tolist(), kicks.tolist(), decay.tolist(), strict=True):
        velocity = velocity * factor + kick
        path += step * velocity
        greatest = max(greatest, abs(path))
    return greatest


def _steps(motion: Kinematics) -> Iterator[AccuracyWarning]:
    """Yield a sentence if steps are too long for the motion, or the work of the medium is uncertain."""
    lever = motion.lever
    time, v, fastest, first = motion.trajectory.time, motion.trajectory.v, motion.speeds, 0
    if motion.trajectory.load is not None:
        # From the first touch on, or a short impact would not show beside a long flight.
        immersed = motion.trajectory.load.depth > 0.0
        first = max(0, int(np.argmax(immersed)) - 1)
        time, v, fastest = time[first:], v[first:], fastest[first:]
    if len(time) < 4:
        return
    unknown = _work_uncertainty(motion)
    if unknown > UNKNOWN:
        said = f"the steps are too long: the work of the medium is known to {unknown:.0%} of the energy only"
        yield AccuracyWarning(f"{said}, and the result is not usable; {remedy(motion.scene)}", math.inf)
        return
    path = max(float(np.sum(np.diff(time) * fastest[1:])), motion.scene.least_path)
    error = step_error(time, (v * lever)[:, lever > 0.0]) / path
    if motion.scene.solver.accuracy is None:  # step-size control has limited every jump already
        loss = _viscous_loss(motion)[first:]
        error = max(error + jump_error(time, v, motion.trajectory.mass, fastest, loss) / path, 0.5 * unknown)
    if error > STEP_ERROR:
        said = f"the steps are too long: the error of the motion is about {error:.1%} of its path, {error * path:.2g} m"
        yield AccuracyWarning(f"{said}; {remedy(motion.scene)}", error)


def _viscous_loss(motion: Kinematics) -> Vector:
    """Power (n,) W lost in the damping of links that bend, and in the dampers of hinges and sliders."""
    loss = np.zeros(len(motion.trajectory.time))
    for _, dissipated in motion.elastic():
        loss += dissipated
    for joint in motion.scene.joints:
        if joint.has_coordinate and joint.law.damping > 0.0:
            loss += joint.law.damping * motion.coordinate(joint)[1] ** 2
    return loss


def _creep(motion: Kinematics) -> Iterator[AccuracyWarning]:
    """Yield a sentence if the run ended at rest while the mechanism still crept."""
    left = _motion_left(motion)
    error = left / max(motion.path_length + left, motion.scene.least_path)
    if error > CREEP:
        said = (
            f"the mechanism still creeps: about {left:.2g} m, {error:.1%} of its motion, are left before the end time"
        )
        slower = f"a smaller solver.rest_speed_m_s (now {motion.scene.solver.rest_speed_m_s:g})"
        yield AccuracyWarning(f"{said}; take {slower}, or solver.rest_time_s: null", error)


def _motion_left(motion: Kinematics) -> float:
    """Greatest displacement (m) of a point that is left before the end time; 0 unless the run ended at rest."""
    trajectory, rest_time, solver = motion.trajectory, motion.scene.rest_time, motion.scene.solver
    if trajectory.status.code != "rest" or rest_time is None:
        return 0.0
    speeds = trajectory.v * motion.lever
    return displacement_left(trajectory.time, speeds, rest_time, solver.rest_speed_m_s, solver.end_time_s)


def displacement_left(time: Vector, speeds: Vector, rest_time: float, rest_speed: float, end_time: float) -> float:
    """Greatest displacement (m) that is left when a run ends because the mechanism has come to rest.

    A run ends once everything has been slower than `rest_speed_m_s` for `rest_time_s`. A heavily damped mechanism can
    be as slow as that long before it reaches its equilibrium. The speeds v_0 and v_1 at both ends of the rest time, t
    apart, show how fast they decay. An exponential decay with the time constant T = t / ln(v_0 / v_1) leaves the
    displacement

        v_1 T (1 - exp(-(end time - now) / T)).

    Limits: a speed that changes its sign within the rest time is a vibration, which leaves no displacement. A speed
    that grows counts as constant.

    time (n,) s; speeds (n, k) m/s of points, with their signs; rest_time s, rest_speed m/s, end_time s of the run.
    """
    first = max(0, int(np.searchsorted(time, time[-1] - rest_time, side="right")) - 1)
    lasted, remaining = float(time[-1] - time[first]), end_time - float(time[-1])
    since = speeds[first:]
    one_way = (since >= 0.0).all(axis=0) | (since <= 0.0).all(axis=0)
    creeps = one_way & (np.abs(since[-1]) > LEAST_CREEP * rest_speed)
    if remaining <= 0.0 or lasted <= 0.0 or not creeps.any():
        return 0.0
    now = np.abs(since[-1, creeps])
    before = np.maximum(now, np.abs(since[0, creeps]))
    rate = np.maximum(np.log(before / now) / lasted, 1e-6 / remaining)  # 1/s; with the least rate the speed is constant
    return float(np.max(now / rate * -np.expm1(-rate * remaining)))


def _work_uncertainty(motion: Kinematics) -> float:
    """Uncertainty of the medium's work by the steps, over the greatest energy; velocities vary with its square root.

    It is the greatest difference between the work on bodies by two quadrature rules of second order, which is small
    where forces and velocities change little in a step. It includes changes of forces in any direction, also across the
    motion, where they change its direction.
    """
    if not motion.scene.media:
        return 0.0
    scale = greatest_energy(motion)
    return float(np.abs(motion.work_beyond).max(initial=0.0)) / scale if scale > 0.0 else 0.0


def greatest_energy(motion: Kinematics) -> float:
    """Greatest kinetic energy (J) of a run or work of its medium, whichever is greater; at least `least_energy`."""
    trajectory = motion.trajectory
    kinetic = 0.5 * np.sum((trajectory.v @ trajectory.mass) * trajectory.v, axis=1)
    work = 0.0 if trajectory.load is None else float(np.abs(trajectory.load.work).max())
    return max(float(kinetic.max()), work, least_energy(motion.scene))


def _entry(motion: Kinematics) -> Iterator[AccuracyWarning]:
    """Yield a sentence if too few steps resolve the first contact."""
    load = motion.trajectory.load
    if load is None:
        return
    below = np.flatnonzero(load.depth > 0.0)
    if len(below) == 0 or below[-1] == below[0] or load.depth.max() <= LEAST_START_DEPTH:  # it only grazes
        return
    first = int(below[0])
    deepest = int(first + np.argmax(load.depth[first:]))
    if deepest - first + 1 < FEWEST_STEPS and (first > 0 or load.depth[0] < LEAST_START_DEPTH):
        said = f"from the touch to the deepest point there are {deepest - first + 1} steps"
        yield AccuracyWarning(f"{said}; {remedy(motion.scene)}")


def _signals(motion: Kinematics) -> Iterator[AccuracyWarning]:
    """Yield sentences if fixed steps are too long for the signals of drives.

    Step-size control ends steps at the bends of tables, and limits them to a share of a period.
    """
    solver, end = motion.scene.solver, motion.trajectory.time[-1]
    if solver.accuracy is not None:
        return
    for drive in motion.scene.drives:
        if isinstance(drive.signal, Piecewise) and drive.kind != "motion":
            continue  # not periodic; its bends are checked below
        steps = shortest_period(drive.signal, float(end)) / solver.step_s
        if steps < WELL_SAMPLED:
            said = f"the drive of {drive.joint} goes to and fro within {steps * solver.step_s:.3g} s, {steps:.1f} steps"
            yield AccuracyWarning(f"{said}, which take away much of it; {remedy(motion.scene)}")
    times = bends(drive.signal for drive in motion.scene.drives if drive.kind != "motion")
    least = min((after - before for before, after in pairwise(times) if before < end), default=math.inf)
    if least < FEWEST_STEPS * solver.step_s:
        said = f"a drive follows a table that bends twice within {least:.3g} s, {least / solver.step_s:.1f} steps"
        yield AccuracyWarning(f"{said}, which can miss its greatest force; {remedy(motion.scene)}")


def _beam(motion: Kinematics, name: str) -> Iterator[AccuracyWarning]:
    """Yield a sentence if the elements of a link are too long for its bending.

    The error of cubic elements shows as jumps of curvature between elements; at a free end the curvature jumps to zero.
    With elements of length l the error of positions is some part of the jump times l^2: a sixteenth to one in 35 beams
    of 1 to 16 elements, EI from 1e-6 to 1 times the source's.
    """
    t, link = motion.trajectory, motion.system.links[name].link
    nodes = np.array(motion.nodes(name))
    elements, length = len(nodes) - 1, link.length / (len(nodes) - 1)
    first, last = curvatures(t.q[:, nodes], length)
    jump = np.abs(first[:, 1:] - last[:, :-1]).sum(axis=1)
    if link.free:
        jump = np.maximum(jump, np.abs(last[:, -1]))
    path = max(motion.path_length, motion.scene.least_path)
    size = float(jump.max()) * length**2
    if size > ROUGH_BEAM * path:
        more = min(elements * int(np.ceil(np.sqrt(size / path / ROUGH_BEAM) + 1.0)), 1024)
        yield AccuracyWarning(
            f"{name} bends too much within its elements: take model.bodies.{name}.flexible.elements: {more} "
            f"(now {elements})"
        )


def _elements(motion: Kinematics, name: str, error: float, elements: int) -> Iterator[AccuracyWarning]:
    """Yield a sentence if a link in space has too few elements; their error has order two in the length.

    The error is compared with the path, or with the deflection of a link that hardly moves.
    """
    bent = max(float(np.abs(values).max()) for values in motion.bends()[name])
    scale = max(motion.path_length, motion.scene.least_path, bent)
    if error > COARSE_BEAM * scale:
        more = min(math.ceil(elements * math.sqrt(error / scale / COARSE_BEAM)), MOST_ELEMENTS)
        said = f"{name} has too few elements: it may be {error:.2g} m off, {error / scale:.1%} of its path"
        yield AccuracyWarning(
            f"{said}; take model.bodies.{name}.flexible.elements: {more} (now {elements})", error / scale
        )


def _modes(motion: Kinematics, name: str, error: float) -> Iterator[AccuracyWarning]:
    """Yield a sentence if a link has too few modes; the error is compared with its greatest deflection."""
    bent = float(np.hypot(*motion.bends()[name]).max())
    if error > FEW_MODES * bent > FEW_MODES * LEAST_BOW * motion.scene.link_length(name):
        path = max(motion.path_length, motion.scene.least_path)
        said = f"{name} has too few modes: its deflection may be {error:.2g} m off, {error / bent:.0%} of the greatest"
        yield AccuracyWarning(f"{said}; take more method.reduced.modes, or method: minimal", error / path)


def _vibration(motion: Kinematics, name: str, bend: Vector) -> Iterator[AccuracyWarning]:
    """Yield a sentence if the deflection (n,) m of a link alternates faster than the steps resolve."""
    first, second = np.diff(bend), np.diff(bend, 2)
    size = float(np.sqrt(np.mean(first**2)))
    if size < TREMBLE * motion.scene.link_length(name):
        return
    rough = float(np.sqrt(np.mean(second**2))) / (2.0 * size)
    if rough > ROUGH:
        yield AccuracyWarning(f"{name} vibrates faster than the steps can show; {remedy(motion.scene)}")
