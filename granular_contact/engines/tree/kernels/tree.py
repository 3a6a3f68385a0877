"""Planar tree of rigid bodies on hinges and sliders: inverse dynamics and articulated-body elimination.

Each call costs a constant per joint. A node i is a body, or a massless frame between two joints of a body that flies
free. The joint of a node connects it to its parent p, a node with a lower index, or to the ground. The coordinates s_i
are those of results: the angle (rad, clockwise) of a hinge, from parent to child, and the way (m) of a slider.

Symbols: r_i is the centre of mass, c_i the point of the joint, e_i = c_i - r_p, d_i = r_i - c_i, u_i the axis of a
slider, and x' = (-x_y, x_x) the vector x turned by a right angle. The acceleration A = (r'', alpha) of a node follows
from the acceleration of its parent and from its joint:

    A_i = X_i A_p + b_i + S_i s_i''

    X_i A_p = (r_p'' + alpha_p (e_i + d_i)', alpha_p)
    b_i = (-omega_p^2 e_i - omega_i^2 d_i, 0),    S_i = (-d_i', -1)                       hinge
    b_i = (-omega_p^2 (e_i + d_i) + 2 omega_p s_i' u_i', 0),    S_i = (u_i, 0)            slider

With the force and moment f_i on a node, its inertia I_i = diag(m, m, J) and the effort tau_i along its coordinate, the
joint transmits P_i, and the residual of its equation of motion is R_i:

    P_i = I_i A_i - f_i + sum of X_c^T P_c over its children c,    R_i = S_i . P_i - tau_i

A motion has R = 0. An implicit step solves R = 0 for the s'' at its end, where forces depend on s'': if s'' changes by
1, rates change by fv and coordinates by fq. Newton's method solves for the change of s'' that makes R vanish. The
tangents of the forces enter as a matrix B_i of each node, which multiplies the change of A_i, and a number c_i of each
joint, which multiplies the change of s_i'':

    B_i = I_i - fq df_i/dq - fv df_i/dv,    c_i = -fq dtau_i/ds - fv dtau_i/ds'

The change thus obeys the equations of a tree whose bodies have the inertias B. They are solved by the articulated-body
algorithm (Featherstone 2008), from the leaves inward and back outward, without a matrix of the whole tree:

    U = B S,    W = S B,    D = S . U + c,    B_p gets X^T (B - U W / D) X,
    g = (-R - S . p) / D,    p_p gets X^T (p + U g),    change of s'' = g - W . (X dA_p) / D.

B is not symmetric, as the forces of the sand have no potential. Limit: arms, axes and b also turn with the change; the
matrix neglects that, a share of the order of a step times a rate. A prescribed coordinate has 1 / D = 0, and its R is
the effort of its drive.
"""

from __future__ import annotations

import math

from granular_contact.jit.compiled import part
from granular_contact.jit.memory import clear, piece

HINGE, SLIDER = 0, 1


@part
def place(w):
    """Forward kinematics: fill pose, twist, arm, along and bias from coordinates and rates."""
    nodes, s, rates, turned, arm = w.nodes, w.s, w.rates, w.turned, w.arm
    pose, twist, along, bias = w.pose, w.twist, w.along, w.bias
    for i in range(nodes.shape[0]):
        node = nodes[i]
        p, slides = node.parent, node.kind == SLIDER
        x, y, phi, vx, vy, omega, c, n = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0
        if p >= 0:
            x, y, phi = pose[p, 0], pose[p, 1], pose[p, 2]
            vx, vy, omega = twist[p, 0], twist[p, 1], twist[p, 2]
            c, n = turned[p, 0], turned[p, 1]
        px, py = node.on_parent[0], node.on_parent[1]
        ex, ey, ux, uy = c * px - n * py, n * px + c * py, 0.0, 0.0
        angle, rate, speed = phi + node.turn, omega, 0.0
        if slides:
            ux, uy = c * node.axis[0] - n * node.axis[1], n * node.axis[0] + c * node.axis[1]
            ex, ey, speed = ex + s[i] * ux, ey + s[i] * uy, rates[i]
        else:
            angle, rate = angle - s[i], rate - rates[i]
        c, n = math.cos(angle), math.sin(angle)
        turned[i, 0], turned[i, 1] = c, n
        dx, dy = n * node.point[1] - c * node.point[0], -(n * node.point[0] + c * node.point[1])
        pose[i, 0], pose[i, 1], pose[i, 2] = x + ex + dx, y + ey + dy, angle
        twist[i, 0] = vx - omega * ey - rate * dy + speed * ux
        twist[i, 1] = vy + omega * ex + rate * dx + speed * uy
        twist[i, 2] = rate
        arm[i, 0], arm[i, 1] = -(ey + dy), ex + dx
        along[i, 0], along[i, 1], along[i, 2] = dy, -dx, -1.0
        if slides:
            along[i, 0], along[i, 1], along[i, 2] = ux, uy, 0.0
        bias[i, 0] = -omega * omega * ex - rate * rate * dx - 2.0 * omega * speed * uy
        bias[i, 1] = -omega * omega * ey - rate * rate * dy + 2.0 * omega * speed * ux


@part
def node_accelerations(w):
    """Fill the accelerations A of the nodes from the accelerations s'' of the coordinates."""
    nodes, s2, A = w.nodes, w.s2, w.acceleration
    arm, along, bias = w.arm, w.along, w.bias
    for i in range(nodes.shape[0]):
        p, ax, ay, alpha = nodes[i].parent, bias[i, 0], bias[i, 1], 0.0
        if p >= 0:
            alpha = A[p, 2]
            ax += A[p, 0] + arm[i, 0] * alpha
            ay += A[p, 1] + arm[i, 1] * alpha
        A[i, 0] = ax + along[i, 0] * s2[i]
        A[i, 1] = ay + along[i, 1] * s2[i]
        A[i, 2] = alpha + along[i, 2] * s2[i]


@part
def residuals(w):
    """Fill the residuals R, by inverse dynamics from the accelerations of the nodes and the forces on them."""
    nodes, A, P, force = w.nodes, w.acceleration, w.passed, w.force
    arm, along, effort, residual = w.arm, w.along, w.effort, w.residual
    for i in range(nodes.shape[0]):
        P[i, 0] = nodes[i].mass * A[i, 0] - force[i, 0]
        P[i, 1] = nodes[i].mass * A[i, 1] - force[i, 1]
        P[i, 2] = nodes[i].inertia * A[i, 2] - force[i, 2]
    for i in range(nodes.shape[0] - 1, -1, -1):
        effort_needed = along[i, 0] * P[i, 0] + along[i, 1] * P[i, 1] + along[i, 2] * P[i, 2]
        residual[i] = effort_needed - effort[i]
        p = nodes[i].parent
        if p >= 0:
            P[p, 0] += P[i, 0]
            P[p, 1] += P[i, 1]
            P[p, 2] += P[i, 2] + arm[i, 0] * P[i, 0] + arm[i, 1] * P[i, 1]


@part
def inertias(w):
    """Fill B with the inertias I, and c with zeros: the matrix without any forces."""
    nodes, body = w.nodes, w.body
    clear(body)
    clear(w.stiffness)
    for i in range(nodes.shape[0]):
        body[i, 0] = body[i, 4] = nodes[i].mass
        body[i, 8] = nodes[i].inertia


@part
def add_to_parent(b, f, parent):
    """Add X^T (B - U W / D) X of a node to the B of its parent (9,); b: its B (9,), f: record of FACTORS."""
    ux, uy, ut = f.u[0] * f.inverse, f.u[1] * f.inverse, f.u[2] * f.inverse
    wx, wy, wt, tx, ty = f.w[0], f.w[1], f.w[2], f.arm[0], f.arm[1]
    xx, xy, xt = b[0] - ux * wx, b[1] - ux * wy, b[2] - ux * wt
    yx, yy, yt = b[3] - uy * wx, b[4] - uy * wy, b[5] - uy * wt
    zx, zy, zt = b[6] - ut * wx, b[7] - ut * wy, b[8] - ut * wt
    mx, my, mt = xx * tx + xy * ty + xt, yx * tx + yy * ty + yt, zx * tx + zy * ty + zt
    parent[0] += xx
    parent[1] += xy
    parent[2] += mx
    parent[3] += yx
    parent[4] += yy
    parent[5] += my
    parent[6] += tx * xx + ty * yx + zx
    parent[7] += tx * xy + ty * yy + zy
    parent[8] += tx * mx + ty * my + mt


@part
def eliminate(w):
    """Fill `factors` from B and c; B of each node then includes all nodes that it carries."""
    nodes, body, factors, stiffness = w.nodes, w.body, w.factors, w.stiffness
    along, arm, prescribed = w.along, w.arm, w.prescribed
    for i in range(nodes.shape[0] - 1, -1, -1):
        b, f, x, y, t = piece(body, i, 9), factors[i], along[i, 0], along[i, 1], along[i, 2]
        for k in range(3):
            f.u[k] = b[3 * k] * x + b[3 * k + 1] * y + b[3 * k + 2] * t
            f.w[k] = b[k] * x + b[3 + k] * y + b[6 + k] * t
        d = x * f.u[0] + y * f.u[1] + t * f.u[2] + stiffness[i]
        f.inverse = 0.0 if prescribed[i] else 1.0 / d
        f.s[0], f.s[1], f.s[2], f.arm[0], f.arm[1] = x, y, t, arm[i, 0], arm[i, 1]
        if nodes[i].parent >= 0:
            add_to_parent(b, f, piece(body, nodes[i].parent, 9))


@part
def solve(w):
    """Fill the change of s'' that makes R vanish, and the change of the accelerations of nodes that follows.

    The factors are those of the last `eliminate`, which may have been at another state (modified Newton).
    """
    nodes, factors, residual, change = w.nodes, w.factors, w.residual, w.change
    p, A = w.passed, w.node_change
    clear(p)
    for i in range(nodes.shape[0] - 1, -1, -1):
        f, q = factors[i], nodes[i].parent
        g = (-residual[i] - f.s[0] * p[i, 0] - f.s[1] * p[i, 1] - f.s[2] * p[i, 2]) * f.inverse
        change[i] = g
        if q >= 0:
            x, y = p[i, 0] + f.u[0] * g, p[i, 1] + f.u[1] * g
            p[q, 0] += x
            p[q, 1] += y
            p[q, 2] += p[i, 2] + f.u[2] * g + f.arm[0] * x + f.arm[1] * y
    for i in range(nodes.shape[0]):
        f, q, x, y, t = factors[i], nodes[i].parent, 0.0, 0.0, 0.0
        if q >= 0:
            t = A[q, 2]
            x, y = A[q, 0] + f.arm[0] * t, A[q, 1] + f.arm[1] * t
        change[i] -= (f.w[0] * x + f.w[1] * y + f.w[2] * t) * f.inverse
        A[i, 0], A[i, 1], A[i, 2] = x + f.s[0] * change[i], y + f.s[1] * change[i], t + f.s[2] * change[i]
