"""Coordinates of hinges and sliders as functions of the coordinates of the nodes that they join.

    hinge   s = phi_P - phi_C + offset                  clockwise from parent to child
    slider  s = u . (r_C + arm_C - r_P) - u . arm_P     u: axis, turns with the parent

r: position of a node, phi: its angle, of a cable's node that of its slope; arm: from the node to the joint's point. A
torque or force tau along s is tau ds/dq on the nodes. Arguments that the functions share:

    joint   record with the fields COORDINATE, see `joint_loads.JOINT`
    turns   (2,) angles (rad) of the ends of parent and child found last, by which the turns of a slope are counted
    q, v    coordinates of the parent's node, then of the child's, without reference values, and their rates
"""

from __future__ import annotations

import math

from granular_contact.jit.compiled import part
from granular_contact.jit.memory import clear
from granular_contact.jit.records import fields

HINGE, SLIDER = 0, 1
RIGID, CABLE = 3, 4  # coordinates of a node; the ground has none

# parent, child: how many coordinates their nodes have. axis: of a slider, in the parent's frame; seat (m): where along
# it the joint's point on the parent is. arm (2,) m: from the child's node to the joint's point, in its frame.
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
    """Angle of a node whose coordinates begin at `first`, its rate, and its derivatives by the third and fourth."""
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
def _hinge(joint, turns, q, v, slope):
    n = joint.parent
    one, one_rate, by_x, by_y = _angle(n, joint.parent_reference, q, v, 0, turns[0])
    if n > 0:
        slope[2] = by_x
    if n == CABLE:
        slope[3] = by_y
    two, two_rate, by_x, by_y = _angle(joint.child, joint.child_reference, q, v, n, turns[1])
    slope[n + 2] = -by_x
    if joint.child == CABLE:
        slope[n + 3] = -by_y
    turns[0], turns[1] = one, two
    return one - two + joint.offset, one_rate - two_rate


@part
def _vectors(joint, q):
    """Axis u, vector D from the parent's node to the joint's point on the child, arm of the child (x, y each)."""
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
def _slider(joint, q, v, slope):
    n = joint.parent
    ux, uy, dx, dy, ax, ay = _vectors(joint, q)
    if n > 0:
        slope[0], slope[1], slope[2] = -ux, -uy, ux * dy - uy * dx
    slope[n], slope[n + 1] = ux, uy
    if joint.child == RIGID:
        slope[n + 2] = uy * ax - ux * ay
    rate = 0.0
    for i in range(n + joint.child):
        rate += slope[i] * v[i]
    return ux * dx + uy * dy - joint.seat, rate


@part
def coordinate(joint, turns, q, v, slope):
    """Coordinate and its rate; slope is filled with its gradient. Turns become those found here."""
    clear(slope)
    if joint.kind == HINGE:
        return _hinge(joint, turns, q, v, slope)
    return _slider(joint, q, v, slope)
