"""The slow obvious modal pendulum: integrals by quadrature over every part, derivatives by differences."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from granular_contact.engines.modal.marching import March
from granular_contact.engines.modal.model import Model, model
from granular_contact.scene.types import Reduced, Scene

Array = NDArray[np.float64]

# The root is bent: RB2 leaves the pivot at an angle, the link sits beside it and turns on by another angle.
CROOKED = """\
model:
  name: crooked
  bodies:
    hub:
      type: rigid
      density_kg_m3: 2700
      shapes:
        - {type: disc, diameter_m: 0.03, thickness_m: 0.02, center_m: [0.01, 0.004], in_sand: false}
        - {type: cylinder, diameter_m: 0.012, end_m: [0.05, 0.02]}
    link:
      type: link
      length_m: 0.3
      diameter_m: 0.006
      density_kg_m3: 7700
      flexible: {bending_stiffness_N_m2: 0.9, bending_damping_N_m2_s: 2e-4}
  joints:
    pivot: {type: hinge, parent: ground, child: hub, child_point_m: [0.002, -0.003]}
    clamp: {type: weld, parent: hub, child: link, parent_point_m: [0.05, 0.02], home_deg: -20}
medium: play_sand
surface_height_m: -0.12
initial: {impact_angle_deg: 15, impact_speed_rad_s: 4}
solver: {end_time_s: 0.2}
"""


def reduce(scene: Scene, modes: int, static: str = "true_sign", rtol: float = 1e-8) -> Model:
    return model(scene, Reduced(modes=modes, static=static, rtol=rtol))


def points(reduced: Model) -> tuple[Array, Array, Array]:
    """Masses (p,), places (p, 2) and mode shapes (p, n) of points that stand for the pendulum: link and root body.

    The root is three points: they have its mass, centre and inertia if they sit at distance k sqrt(3/2) around it.
    """
    xi, weight = np.polynomial.legendre.leggauss(48)
    root = reduced.scene.rigid[0]
    radius = np.sqrt(root.inertia / root.mass)
    ring = radius * np.array([[np.cos(a), np.sin(a)] for a in (0.3, 0.3 + 2 * np.pi / 3, 0.3 + 4 * np.pi / 3)])
    places = reduced.view.of(root, np.zeros(2)) + ring
    masses, shapes = np.full(3, root.mass / 3), np.zeros((3, reduced.method.modes))
    if reduced.link is not None:
        z = 0.5 * reduced.link.length * (1 + xi)
        along = reduced.bars[-1].start + np.column_stack([z, np.zeros_like(z)])
        masses = np.concatenate([masses, 0.5 * weight * reduced.link.mass])
        places = np.concatenate([places, along])
        shapes = np.concatenate([shapes, reduced.shapes(reduced.bars[-1], along)])
    return masses, places, shapes


def velocities(reduced: Model, q: Array) -> Array:
    """Velocities (p, 2, n + 1) of the points for unit rates, from r = place_0 e + x n."""
    _, places, shapes = points(reduced)
    e, n = np.array([np.cos(q[0]), -np.sin(q[0])]), np.array([-np.sin(q[0]), -np.cos(q[0])])
    x = places[:, 1] + shapes @ q[1:]
    turn = places[:, [0]] * n - x[:, None] * e
    return np.concatenate([turn[:, :, None], shapes[:, None, :] * n[:, None]], axis=2)


def mass_matrix(reduced: Model, q: Array) -> Array:
    rates = velocities(reduced, q)
    return np.einsum("p,pci,pcj->ij", points(reduced)[0], rates, rates)


def potential(reduced: Model, q: Array) -> float:
    """Gravity, and bending with the curvature of the modes by quadrature."""
    masses, places, shapes = points(reduced)
    height = -places[:, 0] * np.sin(q[0]) - (places[:, 1] + shapes @ q[1:]) * np.cos(q[0])
    energy = float(reduced.scene.gravity * masses @ height)
    if reduced.link is not None and reduced.bends:
        xi, weight = np.polynomial.legendre.leggauss(64)
        bending = reduced.modes.curvature(0.5 * reduced.link.length * (1 + xi)) @ q[1:]
        energy += 0.25 * reduced.link.length * reduced.link.bending_stiffness * float(weight @ bending**2)
    return energy


def lagrange(reduced: Model, q: Array, v: Array) -> Array:
    """Right-hand side of M q'' = -M' q' + d(T - U)/dq without medium and damping, by central differences."""
    step = 1e-6 * np.eye(len(q))
    dm = np.array([(mass_matrix(reduced, q + s) - mass_matrix(reduced, q - s)) / 2e-6 for s in step])
    du = np.array([(potential(reduced, q + s) - potential(reduced, q - s)) / 2e-6 for s in step])
    return -np.einsum("k,kij,j->i", v, dm, v) + 0.5 * np.einsum("i,kij,j->k", v, dm, v) - du


def march_of(reduced: Model) -> March:
    return March(reduced)
