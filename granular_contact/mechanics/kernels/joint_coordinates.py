"""Joint coordinates of hinges and sliders in the plane, as functions of the coordinates of their two nodes.

    hinge   s = phi_P - phi_C + offset                  clockwise from parent to child
    slider  s = u . (r_C + arm_C - r_P) - u . arm_P     u: axis, turns with the parent

r: position of a node; phi: its angle, for the node of a cable the angle of its slope vector; arm: vector from the node
to the joint's point. A torque or force tau along s has the generalised forces tau ds/dq. Arguments that the functions
share:

    joint        record with the fields COORDINATE, see `joint_loads.JOINT`
    last_angles  (2,) angles (rad) of the parent's and the child's end before, by which whole turns of a slope vector
                 are counted; they are updated. Forces give a copy of those at the last accepted state
    q, v         coordinates of the parent's node, then of the child's, without reference values, and their rates
    gradient     (MOST,) ds/dq, which is filled
"""

from __future__ import annotations

import math

from granular_contact.jit.compiled import part
from granular_contact.jit.memory import clear
from granular_contact.jit.records import fields

HINGE, SLIDER = 0, 1
RIGID, CABLE = 3, 4  # number of coordinates of a node; the ground has none

# kind: HINGE or SLIDER; parent, child: numbers of coordinates of their nodes; offset (rad): of a hinge; axis: of a
# slider, in the parent's frame; seat (m): u . arm_P; arm (2,) m: arm_C in the child's frame; references: values that
# the nodes' coordinates are counted from.
COORDINATE = [
    *fields("i8", "kind", "parent", "child"),
    *fields("f8", "offset", "seat"),
    ("axis", "f8", (2,)),
    ("arm", "f8", (2,)),
    ("parent_reference", "f8", (4,)),
    ("child_reference", "f8", (4,)),
]


@part
def _angle(size, reference, q, v, first, last):
    """Angle (rad) of a node whose coordinates begin at `first`, its rate, its derivatives by coordinates 3 and 4.

    last (rad): angle of a slope vector before.
    """
    if size == 0:
        return 0.0, 0.0, 0.0, 0.0
    if size == RIGID:
        return reference[2] + q[first + 2], v[first + 2], 1.0, 0.0
    x, y = reference[2] + q[first + 2], reference[3] + q[first + 3]
    square = x * x + y * y
    phi = math.atan2(y, x)
    phi += 2.0 * math.pi * round((last - phi) / (2.0 * math.pi))
    return phi, (x * v[first + 3] - y * v[first + 2]) / square, -y / square, x / square


@part
def _hinge(joint, last_angles, q, v, gradient):
    """`coordinate` of a hinge (rad)."""
    n = joint.parent
    phi_P, rate_P, by_x, by_y = _angle(n, joint.parent_reference, q, v, 0, last_angles[0])
    if n > 0:
        gradient[2] = by_x
    if n == CABLE:
        gradient[3] = by_y
    phi_C, rate_C, by_x, by_y = _angle(joint.child, joint.child_reference, q, v, n, last_angles[1])
    gradient[n + 2] = -by_x
    if joint.child == CABLE:
        gradient[n + 3] = -by_y
    last_angles[0], last_angles[1] = phi_P, phi_C
    return phi_P - phi_C + joint.offset, rate_P - rate_C


@part
def _vectors(joint, q):
    """Components of the axis u, of r_C + arm_C - r_P (m) and of arm_C (m), in the world frame."""
    n, x, y, c, s = joint.parent, 0.0, 0.0, 1.0, 0.0
    if n > 0:
        x, y = joint.parent_reference[0] + q[0], joint.parent_reference[1] + q[1]
        phi = joint.parent_reference[2] + q[2]
        c, s = math.cos(phi), math.sin(phi)
    ux, uy = c * joint.axis[0] - s * joint.axis[1], s * joint.axis[0] + c * joint.axis[1]
    ax, ay = 0.0, 0.0
    if joint.child == RIGID:
        phi = joint.child_reference[2] + q[n + 2]
        c, s = math.cos(phi), math.sin(phi)
        ax, ay = c * joint.arm[0] - s * joint.arm[1], s * joint.arm[0] + c * joint.arm[1]
    dx, dy = joint.child_reference[0] + q[n] + ax - x, joint.child_reference[1] + q[n + 1] + ay - y
    return ux, uy, dx, dy, ax, ay


@part
def _slider(joint, q, v, gradient):
    """`coordinate` of a slider (m)."""
    n = joint.parent
    ux, uy, dx, dy, ax, ay = _vectors(joint, q)
    if n > 0:
        gradient[0], gradient[1], gradient[2] = -ux, -uy, ux * dy - uy * dx
    gradient[n], gradient[n + 1] = ux, uy
    if joint.child == RIGID:
        gradient[n + 2] = uy * ax - ux * ay
    rate = 0.0
    for i in range(n + joint.child):
        rate += gradient[i] * v[i]
    return ux * dx + uy * dy - joint.seat, rate


@part
def coordinate(joint, last_angles, q, v, gradient):
    """Coordinate s (rad or m) and its rate; fills the gradient and updates last_angles."""
    clear(gradient)
    if joint.kind == HINGE:
        return _hinge(joint, last_angles, q, v, gradient)
    return _slider(joint, q, v, gradient)
