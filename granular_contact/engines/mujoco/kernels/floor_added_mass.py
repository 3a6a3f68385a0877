"""`added_mass` of bodies that touch a floor in space, whose contact has no bristle.

Its force follows from the depth and the velocity where the step ends. How it changes with the velocity there is found
from a second evaluation, of a body that came down faster by TRIAL and so got deeper; it acts along the vertical alone.
Arguments as of `space_added_mass`.
"""

from __future__ import annotations

from granular_contact.engines.mujoco.kernels.added_mass import add_inertia
from granular_contact.engines.mujoco.kernels.facets_added_mass import add_turned
from granular_contact.engines.mujoco.kernels.held_bodies import advance
from granular_contact.engines.mujoco.kernels.space_added_mass import begin_or_follow, middle, view
from granular_contact.jit.compiled import kernel, part
from granular_contact.jit.memory import clear, copy, room2
from granular_contact.jit.memory import rows as some_of
from granular_contact.sand.kernels import space_law as law
from granular_contact.sand.kernels.law import TERMS
from granular_contact.sand.kernels.space_clusters import reach_below

TRIAL = 1e-6  # m/s


@kernel(nogil=True)
def act(addresses, rows):
    """As `space_added_mass.act`; ground (4,): the floor."""
    w = view(addresses)
    begin_or_follow(w, True)
    resist(w, rows)


@part
def resist(w, rows):
    """As `space_added_mass.resist`."""
    W, ahead, lower, inertia = room2(TERMS, 6), room2(6, 3), room2(6, 3), room2(6, 6)
    step, clusters, ground, medium = w.bed[0].step, w.clusters, w.ground, w.medium[0]
    for b in range(w.bodies.shape[0]):
        at, near_floor, some = w.held[w.of_bed[b]], False, False
        for c in range(w.bodies[b].first, w.bodies[b].last):
            if not w.active[c]:
                continue
            if not near_floor:
                advance(at.pose, at.then, step, ahead)
                copy(lower, ahead)
                lower[3, 2] -= step * TRIAL
                lower[4, 2] -= TRIAL
                clear(inertia)
                near_floor = True
            one = clusters[c]
            if reach_below(one, ahead, ground, medium) <= 0.0:
                continue
            s, e = one.first, one.last
            for i in range(s, e - rows + 1):
                E, A = some_of(w.elements, i, rows), some_of(w.anchors, i, rows)
                clear(W)
                law.forces(medium, (E, A, w.inner[c], lower, ground, W))
                slope = W[0, 2]
                if slope == 0.0:
                    continue
                clear(W)
                law.forces(medium, (E, A, w.inner[c], ahead, ground, W))
                for k in range(6):
                    at.wrench[k] += W[0, k]
                weigh(step * (slope - W[0, 2]) / TRIAL, E, at.pose, inertia)
                some = True
        if some:
            add_turned(inertia, at.pose, w.bed[0].turn, at.arm, at.added)


@part
def weigh(mass, E, pose, inertia):
    """Add a mass (kg) that is felt along the vertical to the inertia of a body, at the middle of an element's rows.

    Frame of the body, upper triangle, as of `facets_added_mass`.
    """
    x, y, z = middle(E)
    add_inertia(mass, pose[2, 0], pose[2, 1], pose[2, 2], x, y, z, inertia)
