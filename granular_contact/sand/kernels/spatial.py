"""Rigid body in space with Euler parameters that moves in the x-y plane: its stations and its generalised forces.

Coordinates (x, y, z, e_0, e_1, e_2, e_3); stations r (n, 3) in the body frame, p = x + A(e) r. A is quadratic in e, so
its derivative J(e) by e is linear, the velocity is V = x' + J(e) e', and dV/de = J(e'). Off the unit sphere A may be
continued in any way: the engine's constraint on e takes the component of a generalised force along e. Compiled only for
beds with such bodies, see `forces`.
"""

from __future__ import annotations

from granular_contact.jit.compiled import part
from granular_contact.jit.memory import room2

SIZE = 7  # coordinates


@part
def jacobian(e0, e1, e2, e3, r, J):
    """Fill J (2, 4) with the derivatives of the x and y components of A(e) r by e; linear in e."""
    J[0, 0] = 2.0 * (e0 * r.x - e3 * r.y + e2 * r.z)
    J[0, 1] = 2.0 * (e1 * r.x + e2 * r.y + e3 * r.z)
    J[0, 2] = 2.0 * (-e2 * r.x + e1 * r.y + e0 * r.z)
    J[0, 3] = 2.0 * (-e3 * r.x - e0 * r.y + e1 * r.z)
    J[1, 0] = 2.0 * (e3 * r.x + e0 * r.y - e1 * r.z)
    J[1, 1] = 2.0 * (e2 * r.x - e1 * r.y - e0 * r.z)
    J[1, 2] = J[0, 1]
    J[1, 3] = J[0, 0]


@part
def spatial_stations(q, v, geometry, P, V):
    """As `kinematics.stations`."""
    J = room2(2, 4)
    for i in range(geometry.shape[0]):
        jacobian(q[3], q[4], q[5], q[6], geometry[i], J)
        for xy in range(2):
            p, w = 0.0, 0.0
            for k in range(4):
                p += 0.5 * J[xy, k] * q[3 + k]  # a quadratic form is half its derivative times its argument
                w += J[xy, k] * v[3 + k]
            P[i, xy] = q[xy] + p
            V[i, xy] = v[xy] + w


@part
def spatial_scatter(q, geometry, F, out):
    """As `kinematics.scatter`."""
    J = room2(2, 4)
    for i in range(F.shape[0]):
        if F[i, 0] == 0.0 and F[i, 1] == 0.0:
            continue
        jacobian(q[3], q[4], q[5], q[6], geometry[i], J)
        out[0] += F[i, 0]
        out[1] += F[i, 1]
        for k in range(4):
            out[3 + k] += J[0, k] * F[i, 0] + J[1, k] * F[i, 1]
