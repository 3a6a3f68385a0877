"""Planar tree of rigid bodies on hinges and sliders, one coordinate a joint; every call costs a constant a joint.

Node i is a body, or a massless frame between two joints of a body that flies free. Its joint carries it on a node
before it in order, or on the ground. Coordinates s_i are those of results: of a hinge the angle (rad, clockwise) from
parent to child, of a slider the way (m) along its axis. With r_i the centre of mass, c_i the joint's point on the node,
e_i = c_i - r_p, d_i = r_i - c_i, u_i a slider's axis, and x' = (-x_y, x_x) a vector turned by a right angle, the
acceleration A = (r'', alpha) of a node is that of its parent p, carried over, and that of its joint:

    A_i = X_i A_p + b_i + S_i s_i''

    X_i A_p = (r_p'' + alpha_p (e_i + d_i)', alpha_p)
    b_i = (-omega_p^2 e_i - omega_i^2 d_i, 0),    S_i = (-d_i', -1)                       hinge
    b_i = (-omega_p^2 (e_i + d_i) + 2 omega_p s_i' u_i', 0),    S_i = (u_i, 0)            slider

A node with all that hangs on it takes the force I A + p from its joint, where I = diag(m, m, J) and p = -f for the node
alone, f the force and moment on it. Along its coordinate the joint gives tau = S . (I A + p), so that with U = I S and
D = S . U

    s'' = (tau - S . p - U . (X A_p + b)) / D,

and to its parent a child adds X^T (I - U U^T / D) X to I and X^T (p + (I - U U^T / D) b + U (tau - S . p) / D) to p.
A coordinate that is prescribed has s'', and its child adds X^T I X and X^T (p + I (b + S s'')); its tau follows. (The
articulated-body algorithm and its hybrid form, Featherstone 2008, in the plane.)
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from granular_contact.kernels.compiled import part
from granular_contact.kernels.records import fields

HINGE, SLIDER = 0, 1

# parent: index of the node it hangs on, -1 for the ground; kind: of its joint; on_parent (2,) m: the joint's point in
# the parent's frame, seen from its centre of mass (in the world, on the ground), of a slider at s = 0; point (2,) m:
# the same in the node's own frame; axis (2,): of a slider, in the parent's frame; turn (rad): angle of the node in its
# parent's frame at s = 0; prescribed: whether a signal says s; acts: whether something acts along it; mass kg; inertia
# kg m2 about the centre of mass; radius m: of the farthest point from the centre of mass.
NODE = np.dtype(
    [
        *fields("i8", "parent", "kind", "prescribed", "acts"),
        *((name, "f8", (2,)) for name in ("on_parent", "point", "axis")),
        *fields("f8", "turn", "mass", "inertia", "radius"),
    ]
)

# Of a row of `Motion.whole`: I, of which the lower triangle is that of the upper, and p.
XX, XY, XT, YY, YT, TT, PX, PY, PT = range(9)


class Motion(NamedTuple):
    """Room for the motion of all nodes.

    pose (n, 3): centre of mass x, y (m) and angle; twist (n, 3): their rates; acceleration (n, 3) likewise; turned
    (n, 2): cosine and sine of the angle; arm (n, 4): e and d above (m); along (n, 3): S; bias (n, 2): b; force (n, 3):
    on the nodes, x, y (N) and moment about the centre of mass (N m); effort (n,): tau (N m, N), found of coordinates
    that are prescribed and given of all others; whole (n, 9): see above; joint (n, 5): U, 1 / D and S . p.
    """

    pose: Any
    twist: Any
    acceleration: Any
    turned: Any
    arm: Any
    along: Any
    bias: Any
    force: Any
    effort: Any
    whole: Any
    joint: Any


def motion(nodes: int) -> Motion:
    """Room for so many nodes."""
    widths = (3, 3, 3, 2, 4, 3, 2, 3, 0, 9, 5)
    return Motion(*(np.zeros((nodes, width) if width else nodes) for width in widths))


@part
def place(s, rates, nodes, motion):
    """Fill pose, twist, arm, along and bias."""
    pose, twist, arm, along, bias = motion.pose, motion.twist, motion.arm, motion.along, motion.bias
    for i in range(nodes.shape[0]):
        node = nodes[i]
        p, slides = node.parent, node.kind == SLIDER
        x, y, phi, vx, vy, omega, c, n = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0
        if p >= 0:
            x, y, phi = pose[p, 0], pose[p, 1], pose[p, 2]
            vx, vy, omega = twist[p, 0], twist[p, 1], twist[p, 2]
            c, n = motion.turned[p, 0], motion.turned[p, 1]
        px, py = node.on_parent[0], node.on_parent[1]
        ex, ey, ux, uy = c * px - n * py, n * px + c * py, 0.0, 0.0
        angle, rate, speed = phi + node.turn, omega, 0.0
        if slides:
            ux, uy = c * node.axis[0] - n * node.axis[1], n * node.axis[0] + c * node.axis[1]
            ex, ey, speed = ex + s[i] * ux, ey + s[i] * uy, rates[i]
        else:
            angle, rate = angle - s[i], rate - rates[i]
        c, n = math.cos(angle), math.sin(angle)
        motion.turned[i, 0], motion.turned[i, 1] = c, n
        dx, dy = n * node.point[1] - c * node.point[0], -(n * node.point[0] + c * node.point[1])
        pose[i, 0], pose[i, 1], pose[i, 2] = x + ex + dx, y + ey + dy, angle
        twist[i, 0] = vx - omega * ey - rate * dy + speed * ux
        twist[i, 1] = vy + omega * ex + rate * dx + speed * uy
        twist[i, 2] = rate
        arm[i, 0], arm[i, 1], arm[i, 2], arm[i, 3] = ex, ey, dx, dy
        along[i, 0], along[i, 1], along[i, 2] = dy, -dx, -1.0
        if slides:
            along[i, 0], along[i, 1], along[i, 2] = ux, uy, 0.0
        bias[i, 0] = -omega * omega * ex - rate * rate * dx - 2.0 * omega * speed * uy
        bias[i, 1] = -omega * omega * ey - rate * rate * dy + 2.0 * omega * speed * ux


@part
def times(whole, i, x, y, t):
    """I (x, y, t) of node i."""
    xx, xy, xt, yy, yt, tt = whole[i, XX], whole[i, XY], whole[i, XT], whole[i, YY], whole[i, YT], whole[i, TT]
    return xx * x + xy * y + xt * t, xy * x + yy * y + yt * t, xt * x + yt * y + tt * t


@part
def hang(i, nodes, motion, prescribed):
    """Find U, 1 / D and S . p of node i, whose children have been added, and add it to its parent.

    prescribed: s'' where it is.
    """
    whole, joint, along, node = motion.whole, motion.joint, motion.along, nodes[i]
    sx, sy, st = along[i, 0], along[i, 1], along[i, 2]
    ux, uy, ut = times(whole, i, sx, sy, st)
    d, own = sx * ux + sy * uy + st * ut, sx * whole[i, PX] + sy * whole[i, PY] + st * whole[i, PT]
    inverse = 1.0 / d
    joint[i, 0], joint[i, 1], joint[i, 2], joint[i, 3], joint[i, 4] = ux, uy, ut, inverse, own
    p = node.parent
    if p < 0:
        return
    bx, by = motion.bias[i, 0], motion.bias[i, 1]
    xx, xy, xt, yy, yt, tt = whole[i, XX], whole[i, XY], whole[i, XT], whole[i, YY], whole[i, YT], whole[i, TT]
    if node.prescribed:
        push = prescribed
    else:
        vx, vy, vt = ux * inverse, uy * inverse, ut * inverse
        xx, xy, xt = xx - ux * vx, xy - ux * vy, xt - ux * vt
        yy, yt, tt = yy - uy * vy, yt - uy * vt, tt - ut * vt
        push = (motion.effort[i] - own) * inverse
    fx = whole[i, PX] + xx * bx + xy * by + ux * push
    fy = whole[i, PY] + xy * bx + yy * by + uy * push
    ft = whole[i, PT] + xt * bx + yt * by + ut * push
    # X = [1 l'; 0 1] with l the arm from the parent's centre of mass.
    tx, ty = -(motion.arm[i, 1] + motion.arm[i, 3]), motion.arm[i, 0] + motion.arm[i, 2]
    mx, my = xx * tx + xy * ty + xt, xy * tx + yy * ty + yt
    whole[p, XX] += xx
    whole[p, XY] += xy
    whole[p, YY] += yy
    whole[p, XT] += mx
    whole[p, YT] += my
    whole[p, TT] += tx * mx + ty * my + xt * tx + yt * ty + tt
    whole[p, PX] += fx
    whole[p, PY] += fy
    whole[p, PT] += tx * fx + ty * fy + ft


@part
def accelerate(nodes, motion, s2):
    """Fill s2 (n,) with the accelerations of coordinates that are not prescribed; of those that are it has them.

    Reads the forces and efforts; fills the accelerations of the nodes, and the efforts of what is prescribed.
    """
    whole, joint, force, arm, A = motion.whole, motion.joint, motion.force, motion.arm, motion.acceleration
    count = nodes.shape[0]
    for i in range(count):
        m = nodes[i].mass
        whole[i, XX], whole[i, XY], whole[i, XT] = m, 0.0, 0.0
        whole[i, YY], whole[i, YT], whole[i, TT] = m, 0.0, nodes[i].inertia
        whole[i, PX], whole[i, PY], whole[i, PT] = -force[i, 0], -force[i, 1], -force[i, 2]
    for i in range(count - 1, -1, -1):
        hang(i, nodes, motion, s2[i])
    for i in range(count):
        p, ax, ay, alpha = nodes[i].parent, motion.bias[i, 0], motion.bias[i, 1], 0.0
        if p >= 0:
            alpha = A[p, 2]
            ax += A[p, 0] - alpha * (arm[i, 1] + arm[i, 3])
            ay += A[p, 1] + alpha * (arm[i, 0] + arm[i, 2])
        carried = joint[i, 0] * ax + joint[i, 1] * ay + joint[i, 2] * alpha
        if nodes[i].prescribed:
            motion.effort[i] = s2[i] / joint[i, 3] + joint[i, 4] + carried
        else:
            s2[i] = (motion.effort[i] - joint[i, 4] - carried) * joint[i, 3]
        A[i, 0] = ax + motion.along[i, 0] * s2[i]
        A[i, 1] = ay + motion.along[i, 1] * s2[i]
        A[i, 2] = alpha + motion.along[i, 2] * s2[i]
