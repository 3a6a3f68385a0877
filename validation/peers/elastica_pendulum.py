"""The pendulum in PyElastica: the flexible link is a Cosserat rod with the true stiffness, the root a rigid body.

The rod has n elements of length h = LENGTH / (n - 1/2). Element 0 is centred on the end of RB2 and rotates with the
root; its node 0 is half an element inside RB2. Bending starts between elements 0 and 1, so that the clamp has the right
position and the rod converges with h^2. With the usual OneEndFixedBC at the first node the rod would lack the
compliance of half an element and converge with h. The root (RB1 and RB2) has one coordinate. A constraint class
integrates its rate from the torque about the pivot: that of its weight, and of the rod's force on node 0 and couple on
element 0, in the order of the time stepper.

Two expert options are off by default. `rotary_scale` multiplies the rotary inertia of the elements and subtracts the
surplus from the root (selective mass scaling: on a thin rod the shear vibration of an element, not the wave speed,
limits the step). `exact_inertia` moves an eighth of a nodal mass inwards from the free end, so that the weight of the
link acts at the right position, and adds the missing inertia of the nodal masses about the pivot to the root; without
it the errors of both are of order h^2.
"""

from __future__ import annotations

import math
import time

import elastica
import numpy as np
from numba import njit

from . import (
    ANGLE,
    AREA,
    BAR,
    CLAMP_CENTRE,
    CLAMP_MASS,
    DENSITY,
    DIAMETER,
    GRAVITY,
    LENGTH,
    NO_SURFACE,
    RATE,
    ROOT,
    ROOT_INERTIA,
    SAND,
    SECOND_MOMENT,
    SURFACE,
    YOUNGS_MODULUS,
    Path,
    follow,
    sand_on_strip,
)

POISSON = 0.3


class Pendulum(elastica.BaseSystemCollection, elastica.Constraints, elastica.Forcing):
    """A rod with a constraint and one force; no damper, no callbacks."""


@njit(cache=True)
def place_root(x, directors, offset):
    """Place node 0 at `offset` (m) from the pivot along the tangent of element 0."""
    x[0, 0], x[1, 0] = offset * directors[2, 0, 0], offset * directors[2, 1, 0]


@njit(cache=True)
def turn_root(x, v, directors, omega, forces, couples, rate, step, inertia):
    """Update the angular velocity of the root in a step, and that of node 0 and element 0.

    rate (1,): about +z, rad/s; inertia: about the pivot, kg m^2; forces (3, n + 1): internal, on the nodes, N; couples
    (3, n): internal, in the material frame with +z as first axis, N m. The root lies along the tangent of element 0.
    """
    torque = x[0, 0] * forces[1, 0] - x[1, 0] * forces[0, 0] + couples[0, 0]
    torque -= CLAMP_MASS * GRAVITY * CLAMP_CENTRE * directors[2, 0, 0]
    rate[0] += step * torque / inertia
    omega[0, 0], omega[1, 0], omega[2, 0] = rate[0], 0.0, 0.0
    v[0, 0], v[1, 0], v[2, 0] = -rate[0] * x[1, 0], rate[0] * x[0, 0], 0.0


class RigidRoot(elastica.ConstraintBase):
    """Hinged root body as a constraint on node 0 and element 0; rate: about +z, rad/s; inertia: kg m^2."""

    def __init__(self, offset: float, rate: float, step: float, inertia: float, **kwargs):
        super().__init__(**kwargs)
        self.offset, self.rate, self.step, self.inertia = offset, np.array([rate]), step, inertia

    def constrain_values(self, system, time):  # noqa: ARG002
        """Keep node 0 on the root."""
        place_root(system.position_collection, system.director_collection, self.offset)

    def constrain_rates(self, system, time):  # noqa: ARG002
        """Update the rate of the root, and with it those of node 0 and element 0."""
        turn_root(
            system.position_collection,
            system.velocity_collection,
            system.director_collection,
            system.omega_collection,
            system.internal_forces,
            system.internal_torques,
            self.rate,
            self.step,
            self.inertia,
        )


@njit
def weight_and_sand(x, v, mass, anchors, surface, m, forces, f):
    """Add weight and sand forces to the nodal forces (3, n + 1) N, once in a step; node 0 belongs to the root."""
    follow(x.T, anchors, surface, m)
    for k in range(1, mass.shape[0]):
        forces[1, k] -= GRAVITY * mass[k]
        if sand_on_strip(
            x[:, k - 1], x[:, k], v[:, k - 1], v[:, k], anchors[k - 1], anchors[k], surface, BAR, m, f
        ):  # fmt: skip
            for end in range(2):
                for term in range(3):
                    forces[0, k - 1 + end] += f[term, end, 0]
                    forces[1, k - 1 + end] += f[term, end, 1]


class WeightAndSand(elastica.NoForces):
    """Weight and sand in one call."""

    def __init__(self, anchors, surface: float):
        super().__init__()
        self.anchors, self.surface, self.work = anchors, surface, np.zeros((3, 2, 2))

    def apply_forces(self, system, time=0.0):  # noqa: ARG002
        """Add the forces of this step."""
        weight_and_sand(
            system.position_collection,
            system.velocity_collection,
            system.mass,
            self.anchors,
            self.surface,
            SAND,
            system.external_forces,
            self.work,
        )


def stable_step(segments: int, rotary_scale: float = 1.0) -> float:
    """Estimate of the largest stable step of PositionVerlet (s): 2 / omega of the fastest vibration of an element."""
    h = LENGTH / (segments - 0.5)
    shear = 27.0 / 28.0 * YOUNGS_MODULUS / (2.0 * (1.0 + POISSON))
    rotation = (shear * AREA + 4.0 * YOUNGS_MODULUS * SECOND_MOMENT / h**2) / (DENSITY * SECOND_MOMENT * rotary_scale)
    return 2.0 / math.sqrt(max(rotation + 4.0 * shear / (DENSITY * h**2), 4.0 * YOUNGS_MODULUS / (DENSITY * h**2)))


def link(segments: int, rotary_scale: float, exact_inertia: bool) -> elastica.CosseratRod:
    """Make the rod at touch, in rigid-body motion."""
    h = LENGTH / (segments - 0.5)
    direction = np.array([math.cos(ANGLE), -math.sin(ANGLE), 0.0])
    rod = elastica.CosseratRod.straight_rod(
        segments,
        start=(ROOT - 0.5 * h) * direction,
        direction=direction,
        normal=np.array([0.0, 0.0, 1.0]),
        base_length=segments * h,
        base_radius=0.5 * DIAMETER,
        density=DENSITY,
        youngs_modulus=YOUNGS_MODULUS,
        shear_modulus=YOUNGS_MODULUS / (2.0 * (1.0 + POISSON)),
    )
    rod.mass_second_moment_of_inertia *= rotary_scale
    rod.inv_mass_second_moment_of_inertia /= rotary_scale
    if exact_inertia:
        rod.mass[-2:] += np.array([0.125, -0.125]) * DENSITY * AREA * h
    x = rod.position_collection
    rod.velocity_collection[0], rod.velocity_collection[1] = RATE * x[1], -RATE * x[0]
    rod.omega_collection[0] = -RATE
    return rod


def missing_inertia(rod: elastica.CosseratRod) -> float:
    """Link's inertia about the pivot minus that of nodes and elements outside the root (kg m^2), of either sign."""
    r = np.hypot(rod.position_collection[0], rod.position_collection[1])
    exact = DENSITY * AREA * ((ROOT + LENGTH) ** 3 - ROOT**3) / 3.0 + DENSITY * SECOND_MOMENT * LENGTH
    half = 0.5 * DENSITY * SECOND_MOMENT * rod.rest_lengths[0]
    return exact - half - (rod.mass[1:] * r[1:] ** 2).sum() - rod.mass_second_moment_of_inertia[0, 0, 1:].sum()


def assemble(
    segments: int, step: float, rotary_scale: float, exact_inertia: bool, surface: float
) -> tuple[Pendulum, elastica.CosseratRod]:
    """Assemble the pendulum at touch for steps of `step` (s); return it and its rod."""
    pendulum, rod = Pendulum(), link(segments, rotary_scale, exact_inertia)
    pendulum.append(rod)
    h = rod.rest_lengths[0]
    inertia = (
        ROOT_INERTIA + 0.5 * DENSITY * SECOND_MOMENT * h
    )  # includes the half of element 0 that belongs to the link
    if exact_inertia:
        inertia += missing_inertia(rod)
    else:
        inertia -= (rotary_scale - 1.0) * DENSITY * SECOND_MOMENT * (LENGTH - 0.5 * h)
    if inertia <= 0.0:
        raise ValueError(f"rotary_scale = {rotary_scale}: the root cannot give up that much inertia, use a smaller one")
    pendulum.constrain(rod).using(RigidRoot, ROOT - 0.5 * h, -RATE, step, inertia)
    anchors = rod.position_collection[:2].T.copy()
    pendulum.add_forcing_to(rod).using(WeightAndSand, anchors, surface)
    pendulum.finalize()
    return pendulum, rod


def run(
    segments: int,
    step: float | None = None,
    end_time: float = 0.04,
    rotary_scale: float = 1.0,
    exact_inertia: bool = False,
    sand: bool = True,
    samples: int = 400,
) -> Path:
    """Tip path of the pendulum from touch to `end_time` (s), at `samples` equal intervals, with `segments` elements.

    step: longest step in s, shortened to divide the sample interval; None takes 0.95 of `stable_step`.
    """
    step = step or 0.95 * stable_step(segments, rotary_scale)
    substeps = math.ceil(end_time / samples / step - 1e-9)
    step = np.float64(end_time / samples / substeps)
    stepper = elastica.PositionVerlet()
    model = (segments, step, rotary_scale, exact_inertia, SURFACE if sand else NO_SURFACE)
    stepper.step(assemble(*model)[0], np.float64(0.0), step)  # compiles functions that are not compiled yet
    pendulum, rod = assemble(*model)
    tips = np.empty((samples + 1, 2))
    tips[0] = rod.position_collection[:2, -1]
    now = np.float64(0.0)
    begin = time.perf_counter()
    for sample in range(samples):
        for _ in range(substeps):
            now = stepper.step(pendulum, now, step)
        tips[sample + 1] = rod.position_collection[:2, -1]
    seconds = time.perf_counter() - begin
    return Path(end_time / samples * np.arange(samples + 1), tips, seconds)
