"""The bristle of `planar_friction` in space: direction of the static resistance, and return of anchors.

Stretch, velocity and direction have three components; the equations are the same as in the plane. A law that opposes
the motion by components has two bristles in space: one in the horizontal plane, by radial return, and one along the
vertical.

A facet has one bristle for all its points, and is loaded where n . q > 0, to a thousandth of |q|. For a body that turns
the bristle has two corrections.

First, each point of a facet has its own velocity, and a bristle that slides on is stretched along the velocity of its
own point: q = e + tau v differs between two points by

    (tau + u_y / (|v| + u_y / T)) (v - v')        across v.

Without the second term a ball that slides slowly and turns would be loaded on trailing facets, the more the larger the
facets are. Second, p - anchor, the path of the step, has the direction of motion in the middle of the step. A bristle
that is dragged much farther than u_y therefore leans towards v: e has the direction of

    (1 - f) e / |e| + f v / |v|,    f = cos(e, v) (1 - u_y / |p - anchor|) |v| / (|v| + FAST u_y / T).

Without u_y / T both corrections would jump where a body comes to rest. The first would also jump where the centroid of
a facet comes to rest while its body turns, as cos(e, v) is arbitrary there: so its part beside the damping time is
multiplied by v^2 / (v^2 + w^2), w = STILL u_y / T.
"""

from __future__ import annotations

import math

from granular_contact.jit.compiled import part
from granular_contact.sand.kernels.friction import SMOOTH, SWITCH, drag_component, sliding
from granular_contact.sand.kernels.planar_friction import radial_return
from granular_contact.sand.kernels.vectors import dot, minus, norm, plus, times

TINY = 1e-300  # prevents division by zero without stretch or at rest
# With 1 a hexapod takes a quarter more iterations at long steps; with 10 a ball that spins in place is 0.9 % off.
FAST = 5.0
# With 0 the force on a slow facet jumps by a third. The error of that ball grows by a tenth with 0.3, not with 0.1.
STILL = 0.1


@part
def drive(e, v, m):
    """Vector q (3,) as in `planar_friction.drive`: p - anchor e (m), velocity v (m/s)."""
    k, tau = factors(e, v, m)
    return plus(times(k, e), times(tau, v))


@part
def factors(e, v, m):
    """As `planar_friction.factors`."""
    if m.friction == SMOOTH:
        return 0.0, 1.0
    h, speed, along = lengths(e, v)
    slides = along / max(TINY, h * speed)
    return m.u_y / h if h > m.u_y else 1.0, m.tau + slides * (sliding(min(h, m.u_y), m) - m.tau)


@part(inline=True)
def lengths(e, v):
    """Lengths of two vectors (3,), and their scalar product, at least 0."""
    return norm(e), norm(v), max(0.0, dot(e, v))


@part(inline=True)
def factors_of_facet(e, v, m):
    """`factors` of the bristle of a facet, and the factor of differences of v within the facet.

    Without a branch, so that compilers vectorise loops over facets.
    """
    h, speed, along = lengths(e, v)
    k = m.u_y / h if h > m.u_y else 1.0
    slides = along / max(TINY, h * speed)  # cosine
    slow = m.u_y / SWITCH
    leans = slides * (1.0 - k) / (speed + FAST * slow)
    f = leans * speed
    k /= math.sqrt(1.0 - 2.0 * f * (1.0 - f) * (1.0 - slides))  # the length of both together
    tau = m.tau + slides * (sliding(min(h, m.u_y), m) - m.tau) + k * h * leans
    k *= 1.0 - f
    differs = tau - m.tau + slides * k * h / (speed + slow) * min(1.0, max(0.0, 2.0 * h / m.u_y - 1.0))
    square, w = speed * speed, STILL * slow
    return k, tau, m.tau + square / (square + w * w) * differs


@part
def mobilised(q, m):
    """Direction u (3,) and mobilised share s in [0, 1] of a vector q as in `drive`, medium record m."""
    h = norm(q)
    if h == 0.0:
        return (0.0, 0.0, 0.0), 0.0
    share = math.tanh(h / m.v_eps) if m.friction == SMOOTH else min(1.0, h / m.u_y)
    return times(1.0 / h, q), share


@part
def vector_return_mapping(p, anchor, m):
    """Anchor after an accepted step that ended at p (3,) m, by radial return in space: on the line to p, within u_y."""
    e = minus(p, anchor)
    h = norm(e)
    if h <= m.u_y:
        return anchor
    return minus(p, times(m.u_y / h, e))


@part
def component_return_mapping(p, anchor, m):
    """Anchor after an accepted step that ended at p (3,) m: radial return in the horizontal plane, z by itself."""
    x, y = radial_return((p[0], p[1]), (anchor[0], anchor[1]), m)
    return x, y, drag_component(p[2], anchor[2], m)
