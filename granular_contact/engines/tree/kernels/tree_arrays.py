"""Arrays of a tree of rigid bodies and of its march, of a view `w` of TREE: `w.pose` (`jit.layout`).

Of n nodes, with the widths of the plane; those of space, and what is there alone, follow.

    nodes           (n,) records of NODE, see `tree`
    prescribed      (n,) whether a signal says s
    acts            (n,) whether something acts along s
    laws, state     (n,) records of JOINT and STATE, of what acts along each coordinate, see `joint_loads`
    gravity         (1,) m/s2
    sand, triplets  as in `planar_sand`, with the coordinates of `pose` as those of the system; room for its tangent
    signals         (n,) which signal a joint's drive follows, -1 of none
    knots, pieces   see `signal_tables`; wanted (signals,): records of SIGNAL, at present
    wanted
    s, rates        (n,) coordinates and their rates, accelerations, and those that the scheme moves by (`tree_newton`);
    s2, lagged      then the same at the start of the step
    pose, twist     (n, 3) centre of mass x, y (m) and angle; their rates; accelerations likewise
    acceleration
    pose_rates      (n, 3) rates of what `pose` has, which in the plane are the twist
    lever           (3 n,) factors from twists to speeds of points (m/s): 1, or the radius; none of what has no mass
    turned          (n, 2) cosine and sine of the angle
    arm             (n, 2) (e + d)' of `tree` (m); along (n, 3): S; bias (n, 2): b
    along, bias
    force           (n, 3) on the nodes, x, y (N) and moment about the centre of mass (N m)
    effort          (n,) tau (N m, N), without what drives of prescribed motions do
    passed          (n, 3) P, or p
    body            (n, 9) B, row by row; stiffness (n,): c
    stiffness
    factors         (n,) records of FACTORS
    rest, change    (n,) R, and the change of s''; moved (n, 3): that of accelerations of nodes
    moved
    newton          (1,) record of NEWTON; iterations: addresses as of `iterations`
    iterations
    changes         addresses as of `step_error`
    scheme          (1,) records of SCHEME (`tree_newton`), CHOICE (`step_choice`) and CONTROL (`tree_march`)
    choice
    control
    bends, followed, arms   see `step_choice`
    clock, counts   (1,) records of CLOCK and COUNTS
    blank           (columns,) a row of the medium's doings before anything is added to it
    states, table   (rows, numbers) and (rows, columns), of which the first counts.steps + 1 are filled
    calls           (1,) record of CALL

In space:

    space_nodes     (n,) records of SPACE_NODE, see `space_tree`
    pose            (n, 7) centre of mass (m) and Euler parameters; pose_rates (n, 7) their rates
    pose_rates
    twist           (n, 6) velocity of the centre of mass (m/s) and angular velocity (rad/s), along the axes of the
    acceleration    world; accelerations likewise
    turned          (n, 9) axes of the node, row by row; home (n, 4): orientation that a ball joint's chart begins at
    home
    arm             (n, 3), along (n, 6), bias (n, 6): e + d, S and b of `space_tree`
    force           (n, 6) on the nodes (N) and moment about the centre of mass (N m)
    of_sand         (n, 7) generalised forces of the medium, see `space_bodies`; blocks (n, 49): their tangents
    blocks
    coupled         (n, 3) c of ball joints, of their three nodes three rows
    body            (n, 36) B, row by row; space_factors (n,): records of SPACE_FACTORS
    space_factors
    shapes          (m, n) Phi^T of `space_modes`, and the inverse (m, m) of its matrix; lacked (m,): Phi^T R; of trees
    inverse         with links in modes alone
    lacked
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from granular_contact.jit.layout import Layout
from granular_contact.jit.records import fields, record_dtype
from granular_contact.mechanics.kernels.joint_loads import JOINT, STATE
from granular_contact.mechanics.kernels.signal_tables import SIGNAL
from granular_contact.mechanics.kernels.step_choice import CHOICE

# parent: index of the node it hangs on, -1 for the ground; kind: of its joint; on_parent (2,) m: the joint's point in
# the parent's frame, seen from its centre of mass (in the world, on the ground), of a slider at s = 0; point (2,) m:
# the same in the node's own frame; axis (2,): of a slider, in the parent's frame; turn (rad): angle of the node in its
# parent's frame at s = 0; mass kg; inertia kg m2 about the centre of mass; radius m: of the farthest point from the
# centre of mass.
NODE = record_dtype(
    [
        *fields("i8", "parent", "kind"),
        *((name, "f8", (2,)) for name in ("on_parent", "point", "axis")),
        *fields("f8", "turn", "mass", "inertia", "radius"),
    ]
)
# In space. parent, mass, radius, on_parent (3,), point (3,): as of NODE; kind of the joint; which of the three
# nodes of a ball joint; axis (3,): of a hinge or slider, in the parent's frame; before, after (4,): quaternions from
# the parent's frame to the joint's, and from there at s = 0 to the node's; inertia (9,): about the centre of mass,
# along the node's axes, row by row. Of a ball joint's last node: acts, what acts in it, before P and after C P^T, bends
# and damps (3,) the diagonals of K and D, see `space_ball_joints`; stays: whether its chart begins at home throughout.
SPACE_NODE = record_dtype(
    [
        *fields("i8", "parent", "kind", "which", "acts", "stays"),
        *((name, "f8", (3,)) for name in ("on_parent", "point", "axis", "bends", "damps")),
        *((name, "f8", (4,)) for name in ("before", "after")),
        ("inertia", "f8", (9,)),
        *fields("f8", "mass", "radius"),
    ]
)
# Factors of Newton's matrix as `tree` eliminates it. u, w, s (3,): U, W and S of the node's coordinate; inverse: 1 / D;
# arm (2,) m: e + d, turned.
FACTORS = record_dtype(
    [*((name, "f8", (3,)) for name in ("u", "w", "s")), *fields("f8", "inverse"), ("arm", "f8", (2,))]
)
# In space. u, w, s (6,): as of FACTORS; inverse (9,): 1 / D as its first number, or, in the record of the first node of
# a ball joint, the inverse of D (3, 3), row by row; arm (3,) m: e + d.
SPACE_FACTORS = record_dtype(
    [*((name, "f8", (6,)) for name in ("u", "w", "s")), ("inverse", "f8", (9,)), ("arm", "f8", (3,))]
)
# alpha_m ... gamma, of the scheme; fixed: whether steps are.
SCHEME = record_dtype([*fields("f8", "alpha_m", "alpha_f", "beta", "gamma"), ("fixed", "i8")])
# Times and speeds in SI units. tolerance (m/s2), share, slow (m/s): of accelerations, and of speeds but not of slower
# ones, at which iterations end; away (m/s): speed from which on a motion has run away; most: steps.
CONTROL = record_dtype(
    [*fields("f8", "end", "rest_speed", "rest_time", "tolerance", "share", "slow", "away"), ("most", "i8")]
)
# now: time reached (s); step, tried: lengths (s) of the step to come and of the last one tried; resting_since: time (s)
# since which everything rests, infinite where something moves; speed, fastest: greatest speed (m/s) at the start of the
# step, and of the run so far; origin, whole: time (s) from which fixed steps are counted, and how many there were.
CLOCK = record_dtype(fields("f8", "now", "step", "resting_since", "tried", "speed", "fastest", "origin", "whole"))
# Steps that were accepted, refused for their error, and fixed ones that had to be shortened.
COUNTS = record_dtype(fields("i8", "steps", "refused", "shortened"))
# matrix_of_v: the of_v (s, see `tree_newton`) that the matrix in use was made with, 0 where a new one is asked for;
# iterations, matrices: counts of both so far.
NEWTON = record_dtype([*fields("f8", "matrix_of_v"), *fields("i8", "iterations", "matrices")])
# Addresses, see `tree_calls`.
CALL = record_dtype(
    fields(
        "i8",
        *("force", "tangent", "accept", "update_active", "soonest", "begin", "accelerate", "iterate", "end", "attempt"),
        *("push", "stiffen"),
    )
)

_ROW, _ROWS, _WHOLE = (float, 1), (float, 2), (np.int64, 1)
TREE = Layout(
    "tree",
    nodes=(NODE, 1),
    space_nodes=(SPACE_NODE, 1),
    factors=(FACTORS, 1),
    space_factors=(SPACE_FACTORS, 1),
    laws=(JOINT, 1),
    state=(STATE, 1),
    wanted=(SIGNAL, 1),
    pieces=(float, 3),
    sand=(np.int64, 2),
    scheme=(SCHEME, 1),
    choice=(CHOICE, 1),
    control=(CONTROL, 1),
    clock=(CLOCK, 1),
    counts=(COUNTS, 1),
    newton=(NEWTON, 1),
    calls=(CALL, 1),
    **dict.fromkeys(("gravity", "knots", "blank", "bends", "arms", "lever", "lacked"), _ROW),
    **dict.fromkeys(("s", "rates", "s2", "lagged"), _ROW),
    **dict.fromkeys(("s_before", "rates_before", "s2_before", "lagged_before"), _ROW),
    **dict.fromkeys(("effort", "stiffness", "rest", "change"), _ROW),
    **dict.fromkeys(("triplets", "states", "table", "shapes", "inverse"), _ROWS),
    **dict.fromkeys(("pose", "pose_rates", "twist", "acceleration", "turned", "home", "arm", "along", "bias"), _ROWS),
    **dict.fromkeys(("force", "of_sand", "blocks", "coupled", "passed", "body", "moved"), _ROWS),
    **dict.fromkeys(("signals", "prescribed", "acts", "followed"), _WHOLE),
    **dict.fromkeys(("iterations", "changes"), _WHOLE),
)
view = TREE.view

_SCALARS = (
    *("s", "rates", "s2", "lagged", "s_before", "rates_before", "s2_before", "lagged_before"),
    *("effort", "stiffness", "rest", "change"),
)
_WIDTHS = {
    **dict.fromkeys(("pose", "twist", "acceleration", "along", "force", "passed", "moved"), 3),
    **{"turned": 2, "arm": 2, "bias": 2, "body": 9},
}
_WIDTHS_IN_SPACE = {
    **dict.fromkeys(("pose", "pose_rates", "of_sand"), 7),
    **dict.fromkeys(("twist", "acceleration", "along", "bias", "force", "passed", "moved"), 6),
    **{"turned": 9, "home": 4, "arm": 3, "body": 36, "blocks": 49, "coupled": 3},
}


def room(nodes: int, *, in_space: bool = False) -> dict[str, NDArray[Any]]:
    """Arrays that say nothing yet: the motion of so many nodes, and what is worked out from it."""
    widths = _WIDTHS_IN_SPACE if in_space else _WIDTHS
    made = {name: np.zeros(nodes) for name in _SCALARS}
    made |= {name: np.zeros((nodes, width)) for name, width in widths.items()}
    if in_space:
        return made | {"factors": np.zeros(nodes, SPACE_FACTORS)}
    return made | {"factors": np.zeros(nodes, FACTORS), "pose_rates": made["twist"]}


def addresses(arrays: Mapping[str, NDArray[Any]]) -> NDArray[np.int64]:
    """`TREE.addresses` of a tree in the plane or in space, which have records of their own for nodes and factors."""
    names = {"nodes": "space_nodes", "factors": "space_factors"} if arrays["nodes"].dtype == SPACE_NODE else {}
    return TREE.addresses({names.get(name, name): array for name, array in arrays.items()})
