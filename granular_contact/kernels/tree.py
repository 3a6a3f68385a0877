"""Planar tree of rigid bodies on hinges, in as many coordinates as it has hinges; every call costs a constant a body.

Body i hangs by its hinge on a body before it in order, or on the ground. Coordinates are the angles phi_i of the
bodies' frames in the world (rad, counter-clockwise), rates omega_i. With r_i the centre of mass, c_i the hinge,
d_i = r_i - c_i, l_i = c_i - c_p the arm from the parent's hinge, and x' = (-x_y, x_x) a vector turned by a right angle,

    c_i'' = c_p'' + alpha_p l_i' - omega_p^2 l_i,          r_i'' = c_i'' + alpha_i d_i' - omega_i^2 d_i.

A hinge passes on a force F_i and no moment, so seen from its hinge a body with all that hangs on it is a mass of two by
two: with a = c_i'',

    F_i = M a + G alpha_i + p,          0 = G . a + H alpha_i + g,

where M = m 1, G = m d', H = J + m d^2, p = -m omega^2 d - f, g = -d' . f - n for the body alone (f force and n moment
on it), and each child adds, with I = M - G G^T / H and b = p - G g / H of its own and e = b - omega^2 I l,

    M += I,     G += I l',     H += l' . I l',     p += e,     g += l' . e.

From the leaves inward this gives H and g of all, from the ground outward alpha_i = -(G . a + g) / H. (The
articulated-body algorithm, Featherstone 1983, for hinges in the plane.)
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from granular_contact.kernels.compiled import part
from granular_contact.kernels.records import fields

# parent: index of the body it hangs on, -1 for the ground; on_parent (2,) m: the hinge in the parent's frame, seen from
# its centre of mass (in the world, on the ground); hinge (2,) m: the same in the body's own frame; mass kg; inertia
# kg m2 about the centre of mass; radius m: of the farthest point from the centre of mass.
BODY = np.dtype(
    [("parent", "i8"), ("on_parent", "f8", (2,)), ("hinge", "f8", (2,)), *fields("f8", "mass", "inertia", "radius")]
)

# Of a row of an articulated body: M_xx, M_xy, M_yy, G, H, p, g.
XX, XY, YY, GX, GY, H, PX, PY, G = range(9)


class Motion(NamedTuple):
    """Room for the motion of all bodies.

    pose (n, 3): centre of mass x, y (m) and angle; twist (n, 3): their rates; lever, arm (n, 2): d and l above (m);
    force (n, 3): on the bodies, x, y (N) and moment about the centre of mass (N m); joint (n, 9): see above.
    """

    pose: Any
    twist: Any
    lever: Any
    arm: Any
    force: Any
    joint: Any


def motion(bodies: int) -> Motion:
    """Room for so many bodies."""
    shapes = ((bodies, 3), (bodies, 3), (bodies, 2), (bodies, 2), (bodies, 3), (bodies, 9))
    return Motion(*(np.zeros(shape) for shape in shapes))


@part
def place(angles, rates, bodies, motion):
    """Fill pose, twist, lever and arm."""
    pose, twist, lever, arm = motion.pose, motion.twist, motion.lever, motion.arm
    for i in range(bodies.shape[0]):
        body = bodies[i]
        c, s = math.cos(angles[i]), math.sin(angles[i])
        rate, parent = rates[i], body.parent
        hx, hy, px, py = body.hinge[0], body.hinge[1], body.on_parent[0], body.on_parent[1]
        dx, dy = -(c * hx - s * hy), -(s * hx + c * hy)
        if parent < 0:
            cx, cy, vx, vy = px, py, 0.0, 0.0
            arm[i, 0], arm[i, 1] = 0.0, 0.0
        else:
            # cos and sin of the parent stand in its joint row until `accelerate` needs the room.
            cp, sp = motion.joint[parent, XX], motion.joint[parent, XY]
            ex, ey = cp * px - sp * py, sp * px + cp * py
            cx, cy = pose[parent, 0] + ex, pose[parent, 1] + ey
            vx, vy = twist[parent, 0] - twist[parent, 2] * ey, twist[parent, 1] + twist[parent, 2] * ex
            arm[i, 0], arm[i, 1] = lever[parent, 0] + ex, lever[parent, 1] + ey
        motion.joint[i, XX], motion.joint[i, XY] = c, s
        lever[i, 0], lever[i, 1] = dx, dy
        pose[i, 0], pose[i, 1], pose[i, 2] = cx + dx, cy + dy, angles[i]
        twist[i, 0], twist[i, 1], twist[i, 2] = vx - rate * dy, vy + rate * dx, rate


@part
def accelerate(rates, bodies, motion, alpha):
    """Fill alpha (n,) with the angular accelerations (rad/s2) from the forces on the bodies."""
    joint, lever, arm, force = motion.joint, motion.lever, motion.arm, motion.force
    count = bodies.shape[0]
    for i in range(count):
        m, square = bodies[i].mass, rates[i] * rates[i]
        dx, dy, fx, fy = lever[i, 0], lever[i, 1], force[i, 0], force[i, 1]
        joint[i, XX], joint[i, XY], joint[i, YY] = m, 0.0, m
        joint[i, GX], joint[i, GY] = -m * dy, m * dx
        joint[i, H] = bodies[i].inertia + m * (dx * dx + dy * dy)
        joint[i, PX], joint[i, PY] = -m * square * dx - fx, -m * square * dy - fy
        joint[i, G] = dy * fx - dx * fy - force[i, 2]
    for i in range(count - 1, -1, -1):
        parent = bodies[i].parent
        if parent < 0:
            continue
        h, gx, gy, g = joint[i, H], joint[i, GX], joint[i, GY], joint[i, G]
        xx, xy, yy = joint[i, XX] - gx * gx / h, joint[i, XY] - gx * gy / h, joint[i, YY] - gy * gy / h
        lx, ly, square = arm[i, 0], arm[i, 1], rates[parent] * rates[parent]
        ex = joint[i, PX] - gx * g / h - square * (xx * lx + xy * ly)
        ey = joint[i, PY] - gy * g / h - square * (xy * lx + yy * ly)
        tx, ty = -xx * ly + xy * lx, -xy * ly + yy * lx  # I l'
        joint[parent, XX] += xx
        joint[parent, XY] += xy
        joint[parent, YY] += yy
        joint[parent, GX] += tx
        joint[parent, GY] += ty
        joint[parent, H] += -ly * tx + lx * ty
        joint[parent, PX] += ex
        joint[parent, PY] += ey
        joint[parent, G] += -ly * ex + lx * ey
    for i in range(count):
        parent = bodies[i].parent
        ax, ay = 0.0, 0.0
        if parent >= 0:
            square = rates[parent] * rates[parent]
            ax = joint[parent, PX] - alpha[parent] * arm[i, 1] - square * arm[i, 0]
            ay = joint[parent, PY] + alpha[parent] * arm[i, 0] - square * arm[i, 1]
        alpha[i] = -(joint[i, GX] * ax + joint[i, GY] * ay + joint[i, G]) / joint[i, H]
        joint[i, PX], joint[i, PY] = ax, ay  # what the children hang on
