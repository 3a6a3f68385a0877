"""Forces and added inertia of bodies that touch a floor in space; its contact has no bristles.

The force depends on depth and velocity at the predicted end of the step. Its derivative by the velocity is found from a
second evaluation: of a body that moves down faster by TRIAL and is deeper accordingly. The force is vertical. Arguments
are those of `space_added_mass`.
"""

from __future__ import annotations

from granular_contact.engines.mujoco.kernels.added_mass import add_inertia
from granular_contact.engines.mujoco.kernels.facets_added_mass import add_rotated_inertia
from granular_contact.engines.mujoco.kernels.held_bodies import advance
from granular_contact.engines.mujoco.kernels.space_added_mass import begin_or_follow, mean_position, view
from granular_contact.jit.compiled import kernel, part
from granular_contact.jit.memory import clear, copy, room2
from granular_contact.jit.memory import rows as row_slice
from granular_contact.sand.kernels import space_law as law
from granular_contact.sand.kernels.law import TERMS
from granular_contact.sand.kernels.space_clusters import reach_below

TRIAL = 1e-6  # change of the velocity for the derivative (m/s)


@kernel(nogil=True)
def act(addresses, rows):
    """As `space_added_mass.act`; ground (4,): surface of the floor."""
    w = view(addresses)
    begin_or_follow(w, True)
    resist(w, rows)


@part
def resist(w, rows):
    """As `space_added_mass.resist`."""
    W, end_pose, lower_pose, inertia = room2(TERMS, 6), room2(6, 3), room2(6, 3), room2(6, 6)
    step, clusters, ground, medium = w.bed[0].step, w.clusters, w.ground, w.medium[0]
    for b in range(w.bodies.shape[0]):
        held, is_near, touches = w.held[w.held_places[b]], False, False
        for c in range(w.bodies[b].first, w.bodies[b].last):
            if not w.active[c]:
                continue
            if not is_near:
                advance(held.pose, held.predicted_pose, step, end_pose)
                copy(lower_pose, end_pose)
                lower_pose[3, 2] -= step * TRIAL
                lower_pose[4, 2] -= TRIAL
                clear(inertia)
                is_near = True
            cluster = clusters[c]
            if reach_below(cluster, end_pose, ground, medium) <= 0.0:
                continue
            for i in range(cluster.first, cluster.last - rows + 1):
                E, A = row_slice(w.elements, i, rows), row_slice(w.anchors, i, rows)
                clear(W)
                law.forces(medium, (E, A, w.inner_clusters[c], lower_pose, ground, W))
                lower_force = W[0, 2]
                if lower_force == 0.0:
                    continue
                clear(W)
                law.forces(medium, (E, A, w.inner_clusters[c], end_pose, ground, W))
                for k in range(6):
                    held.wrench[k] += W[0, k]
                add_vertical_mass(step * (lower_force - W[0, 2]) / TRIAL, E, held.pose, inertia)
                touches = True
        if touches:
            add_rotated_inertia(inertia, held.pose, w.bed[0].turn, held.arm, held.added_inertia)


@part
def add_vertical_mass(mass, E, pose, inertia):
    """Add a mass (kg) that acts along the vertical, at the mean position of the rows E of an element.

    inertia (6, 6): as in `facets_added_mass.facet_wrench_and_inertia`.
    """
    x, y, z = mean_position(E)
    add_inertia(mass, pose[2, 0], pose[2, 1], pose[2, 2], x, y, z, inertia)
