"""Tree of rigid bodies in space on hinges, sliders and ball joints: kinematics and inverse dynamics.

Each call costs a constant per coordinate. The equations are those of `tree`, with vectors of three numbers. A node has
one coordinate s. A joint with several degrees of freedom thus consists of several nodes: the last one is the body, the
others are massless frames. A ball joint has three nodes, all at the centre of mass of its body. A body that flies free
has three sliders along the axes of the world, and then those three nodes.

Symbols: r_i is the centre of mass, c_i the point of the joint, e_i = c_i - r_p, d_i = r_i - c_i, u_i the axis of a
hinge or slider, w the angular velocity. The acceleration A = (r'', w') of a node is

    A_i = X_i A_p + b_i + S_i s_i'',    X_i A_p = (r_p'' + w_p' x (e_i + d_i), w_p')
    S_i = (u_i x d_i, u_i)    hinge,    S_i = (u_i, 0)    slider
    b_i = (w_p x (w_p x e_i) + w_i x (w_i x d_i) + g_i x d_i + 2 w_p x s_i' u_i of a slider, g_i)

with g_i = w_p x s_i' u_i for a hinge. All vectors are along the axes of the world and refer to centres of mass, so that
X is a translation. The three coordinates of a ball joint are a rotation vector u, with R_i = R_p exp(u) H_i: a chart
(see `space_rotations`) about the orientation H at the start of the step. `recentre` moves the chart after each step, so
that there u = 0 and u' is the relative angular velocity. The axes of the joint are the columns of R_p J(u), and the
part of its angular acceleration without u'' is g = R_p J' u' + w_p x R_p J u'.

Joints transmit P_i = (m r'' - F, I w' + w x I w - M) + sum of X_c^T P_c. Their residuals, and the elimination of
Newton's matrix (`space_elimination`), are those of `tree`.
"""

from __future__ import annotations

import math

from granular_contact.jit.compiled import part
from granular_contact.mechanics.kernels.space_rotations import (
    ALONG_WORLD,
    UNTURNED,
    as_quaternion,
    exponential,
    jacobian_coefficients,
    jacobian_rate_times,
    jacobian_times,
    matrix_of,
    product,
    quaternion,
    rates_of,
)
from granular_contact.sand.kernels.vectors import (
    at,
    cross,
    fill,
    plus,
    put,
    times,
    turned,
    turned_back,
    unit,
    vector,
    xyz,
)

HINGE, SLIDER, BALL = 0, 1, 2
LAST = 2  # index, among the three nodes of a ball joint, of the one with the body
NONE = (0.0, 0.0, 0.0)


@part
def axes_of(w, i):
    """Rotation matrix (9,) of node i, row by row."""
    R = w.turned
    return R[i, 0], R[i, 1], R[i, 2], R[i, 3], R[i, 4], R[i, 5], R[i, 6], R[i, 7], R[i, 8]


@part
def momentum(w, i, R, a):
    """The inertia of node i about its centre of mass times a vector a (3,); R: rotation matrix of the node."""
    J = w.space_nodes[i].inertia
    inertia = J[0], J[1], J[2], J[3], J[4], J[5], J[6], J[7], J[8]
    return turned(R, turned(inertia, turned_back(R, a)))


@part
def centripetal(w, arm):
    """Centripetal acceleration w x (w x arm)."""
    return cross(w, cross(w, arm))


@part
def place(w):
    """Forward kinematics: fill pose, twist, arm, along and bias from coordinates and rates."""
    for i in range(w.s.shape[0]):
        _place(i, w)


@part
def _place(i, w):
    """Forward kinematics of one node; the last node of a ball joint also sets the axes of the two before."""
    node, twists, p = w.space_nodes[i], w.twist, w.space_nodes[i].parent
    x_p, v_p, w_p, u, speed = NONE, NONE, NONE, NONE, NONE
    q_p, R_p = UNTURNED, ALONG_WORLD
    if p >= 0:
        x_p, q_p, R_p = at(w.pose, p, 0), quaternion(w.pose, p, 3), axes_of(w, p)
        v_p, w_p = at(twists, p, 0), at(twists, p, 3)
    e, spin, drift, q = turned(R_p, xyz(node.on_parent)), w_p, NONE, q_p
    if node.kind == SLIDER:
        u, q = turned(R_p, xyz(node.axis)), product(q_p, as_quaternion(node.before))
        e, speed = plus(e, times(w.s[i], u)), times(w.rates[i], u)
    elif node.kind == HINGE:
        u = turned(R_p, xyz(node.axis))
        relative, half = times(w.rates[i], u), 0.5 * w.s[i]
        q = product(product(q_p, as_quaternion(node.before)), (math.cos(half), 0.0, 0.0, math.sin(half)))
        q = product(q, as_quaternion(node.after))
        spin, drift = plus(w_p, relative), cross(w_p, relative)
    elif node.which == LAST:
        spin, drift, q = _ball_kinematics(i, q_p, R_p, w_p, w)
    d = times(-1.0, turned(matrix_of(q), xyz(node.point)))
    v = plus(plus(plus(v_p, cross(w_p, e)), cross(spin, d)), speed)
    b = plus(plus(centripetal(w_p, e), centripetal(spin, d)), plus(cross(drift, d), times(2.0, cross(w_p, speed))))
    put(b, w.bias, i, 0)
    put(drift, w.bias, i, 3)
    _write(i, plus(x_p, plus(e, d)), q, v, spin, w)
    _write_arm(i, u, plus(e, d), d, w)


@part
def _write(i, x, q, v, spin, w):
    """Write the pose of a node with its rates, its rotation matrix and its twist."""
    poses, rates, axes, twists = w.pose, w.pose_rates, w.turned, w.twist
    R, dq = matrix_of(q), rates_of(q, spin)
    put(x, poses, i, 0)
    put(v, rates, i, 0)
    put(v, twists, i, 0)
    put(spin, twists, i, 3)
    for k in range(4):
        poses[i, 3 + k], rates[i, 3 + k] = q[k], dq[k]
    for k in range(9):
        axes[i, k] = R[k]


@part
def _write_arm(i, u, total_arm, d, w):
    """Write the arm e + d of a node and its S; all nodes of a ball joint are at the centre of mass of its body."""
    node, along, arm = w.space_nodes[i], w.along, w.arm
    put(total_arm, arm, i, 0)
    if node.kind == SLIDER:
        put(u, along, i, 0)
        put(NONE, along, i, 3)
    elif node.kind == HINGE:
        put(cross(u, d), along, i, 0)
        put(u, along, i, 3)
    elif node.which == LAST:
        first = i - LAST
        put(plus(at(arm, first, 0), d), arm, first, 0)
        put(NONE, arm, i, 0)
        for k in range(3):
            put(cross(at(along, first + k, 3), d), along, first + k, 0)


@part
def _ball_kinematics(i, q_p, R_p, w_p, w):
    """Angular velocity, angular acceleration without u'' and orientation of the body on a ball joint; fills axes."""
    s, rates, along, first = w.s, w.rates, w.along, i - LAST
    u, rate = vector(s, first), vector(rates, first)
    coefficients = jacobian_coefficients(u)
    for k in range(3):
        axis = turned(R_p, jacobian_times(u, unit(k), coefficients))
        put(axis, along, first + k, 3)
    relative = turned(R_p, jacobian_times(u, rate, coefficients))
    drift = plus(turned(R_p, jacobian_rate_times(u, rate, coefficients)), cross(w_p, relative))
    return plus(w_p, relative), drift, product(q_p, product(exponential(u), quaternion(w.home, i, 0)))


@part
def recentre(w):
    """Restart the charts of ball joints at their present orientations, but for charts that stay at home."""
    nodes, home, s, rates, s2, lagged = w.space_nodes, w.home, w.s, w.rates, w.s2, w.lagged
    for i in range(nodes.shape[0]):
        if nodes[i].kind != BALL or nodes[i].which != LAST or nodes[i].stays:
            continue
        first = i - LAST
        u, rate = vector(s, first), vector(rates, first)
        coefficients = jacobian_coefficients(u)
        drift = jacobian_rate_times(u, rate, coefficients)
        fill(plus(jacobian_times(u, vector(s2, first), coefficients), drift), s2, first)
        fill(plus(jacobian_times(u, vector(lagged, first), coefficients), drift), lagged, first)
        fill(jacobian_times(u, rate, coefficients), rates, first)
        fill(NONE, s, first)
        q = product(exponential(u), quaternion(home, i, 0))
        size = math.sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3])
        for k in range(4):
            home[i, k] = q[k] / size


@part
def node_accelerations(w):
    """Fill the accelerations A of the nodes from the accelerations s'' of the coordinates."""
    s2, A, along, bias = w.s2, w.acceleration, w.along, w.bias
    for i in range(s2.shape[0]):
        for k in range(6):
            A[i, k] = bias[i, k] + along[i, k] * s2[i]
    outward(A, w)


@part
def outward(A, w):
    """Outward pass: add X A_p, the acceleration that the parent imposes, to the rows (6,) of A."""
    nodes, arm = w.space_nodes, w.arm
    for i in range(nodes.shape[0]):
        p = nodes[i].parent
        if p >= 0:
            alpha = at(A, p, 3)
            x, y, z = cross(alpha, at(arm, i, 0))
            A[i, 0] += A[p, 0] + x
            A[i, 1] += A[p, 1] + y
            A[i, 2] += A[p, 2] + z
            for k in range(3):
                A[i, 3 + k] += alpha[k]


@part
def residuals(w):
    """Fill the residuals R, by inverse dynamics from the accelerations of the nodes and the forces on them."""
    nodes, A, P, force = w.space_nodes, w.acceleration, w.passed, w.force
    effort, residual, twist = w.effort, w.residual, w.twist
    for i in range(nodes.shape[0]):
        for k in range(6):
            P[i, k] = -force[i, k]
        m = nodes[i].mass
        if m > 0.0:
            R, spin = axes_of(w, i), at(twist, i, 3)
            x = plus(momentum(w, i, R, at(A, i, 3)), cross(spin, momentum(w, i, R, spin)))
            for k in range(3):
                P[i, k] += m * A[i, k]
                P[i, 3 + k] += x[k]
    inward(P, residual, w)
    for i in range(nodes.shape[0]):
        residual[i] -= effort[i]


@part
def inward(P, efforts, w):
    """Inward pass: transmit the forces in the rows (6,) of P to the ground; fill efforts (n,) with S . P."""
    nodes, arm, along = w.space_nodes, w.arm, w.along
    for i in range(nodes.shape[0] - 1, -1, -1):
        efforts[i] = 0.0
        for k in range(6):
            efforts[i] += along[i, k] * P[i, k]
        if nodes[i].parent >= 0:
            pass_on(P, i, at(arm, i, 0), nodes[i].parent)


@part
def pass_on(P, i, arm, p):
    """Add the force and moment in row i of P to those of the parent p, about the centre of mass of the parent."""
    x = cross(arm, at(P, i, 0))
    for k in range(3):
        P[p, k] += P[i, k]
        P[p, 3 + k] += P[i, 3 + k] + x[k]
