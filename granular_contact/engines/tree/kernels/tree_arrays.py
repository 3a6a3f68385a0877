"""Arrays of a tree and of its march, as kernels find them by name in a view `w` of TREE: `w.pose` (`jit.layout`).

n is the number of nodes. Widths are those of the plane; those of space, and arrays of space alone, follow. The
symbols are those of `tree`.

Given:
    nodes           (n,) records of NODE
    prescribed      (n,) whether a signal prescribes s
    acts            (n,) whether an effort acts along s
    laws, state     (n,) records of JOINT and STATE of each coordinate, see `joint_loads`
    gravity         (1,) m/s2
    sand, triplets  as in `planar_sand`, with `pose` for the coordinates of the system; work array of the tangent
    signals         (n,) signal that the drive of a joint follows, -1 for none
    knots, pieces   tables of signals, see `signal_tables`
    wanted          (signals,) records of SIGNAL: values, rates and accelerations at present
    lever           (3 n,) factors from twists to speeds of points (m/s): 1 or the radius, 0 for massless nodes
    bends, followed, arms   see `step_choice`
    scheme, choice, control (1,) records of SCHEME, of CHOICE (`step_choice`), and of CONTROL
    calls           (1,) record of CALL
    blank           (columns,) row of the history of the medium before anything is added

State:
    s, rates, s2    (n,) coordinates s, their rates s' and accelerations s''
    lagged          (n,) lagged accelerations of the scheme (`tree_newton`)
    s_before ...    the same four at the start of the step
    clock, counts   (1,) records of CLOCK and COUNTS
    newton          (1,) record of NEWTON
    iterations      addresses of the arrays of `iterations`
    changes         addresses of the arrays of `step_error`
    states, table   (rows, numbers) and (rows, columns), see `tree_march`; the first counts.steps + 1 rows are filled

Computed from the state:
    pose, twist     (n, 3) centre of mass x, y (m) and angle (rad), and their rates
    acceleration    (n, 3) A
    pose_rates      (n, 3) rates of `pose`, which in the plane are the twist
    turned          (n, 2) cosine and sine of the angle
    arm             (n, 2) (e + d)' (m)
    along, bias     (n, 3) S and (n, 2) b
    force           (n, 3) forces f on the nodes, x, y (N), and moment about the centre of mass (N m)
    effort          (n,) tau (N m, N), without the effort of drives of prescribed motions
    passed          (n, 3) P of the inverse dynamics, or p of the elimination
    residual        (n,) R
    change          (n,) change of s'' by an iteration
    node_change     (n, 3) change of A by an iteration
    body            (n, 9) B, row by row
    stiffness       (n,) c
    factors         (n,) records of FACTORS

In space:
    space_nodes     (n,) records of SPACE_NODE
    pose            (n, 7) centre of mass (m) and Euler parameters; pose_rates (n, 7): their rates
    twist           (n, 6) velocity of the centre of mass (m/s) and angular velocity (rad/s), along the world's axes
    acceleration    (n, 6) rates of the twist
    lever           (6 n,) as in the plane
    turned          (n, 9) rotation matrix of the node, row by row
    home            (n, 4) orientation H at which the chart of a ball joint begins
    arm             (n, 3) e + d of `space_tree`
    along, bias     (n, 6) S and b of `space_tree`
    force           (n, 6) forces on the nodes (N) and moments about their centres of mass (N m)
    of_sand         (n, 7) generalised forces of the medium, see `space_bodies`; blocks (n, 49): their tangents
    coupled         (n, 3) c of ball joints, in the three rows of their nodes
    body            (n, 36) B, row by row
    space_factors   (n,) records of SPACE_FACTORS
    shapes          (m, n) Phi^T of `space_modes`
    inverse         (m, m) inverse of G
    projected       (m,) Phi^T R; these three only of trees with links in modes
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

# parent: index of the parent node, -1 for the ground; kind: of the joint; on_parent (2,) m: point of the joint in the
# parent's frame, from its centre of mass (on the ground: in the world), for a slider at s = 0; point (2,) m: the same
# in the node's own frame; axis (2,): axis of a slider, in the parent's frame; turn (rad): angle of the node in the
# parent's frame at s = 0; mass (kg); inertia (kg m2) about the centre of mass; radius (m): distance of the farthest
# point from the centre of mass.
NODE = record_dtype(
    [
        *fields("i8", "parent", "kind"),
        *((name, "f8", (2,)) for name in ("on_parent", "point", "axis")),
        *fields("f8", "turn", "mass", "inertia", "radius"),
    ]
)
# In space. parent, kind, mass, radius, on_parent (3,), point (3,): as in NODE; which: index among the three nodes of a
# ball joint; axis (3,): axis of a hinge or slider, in the parent's frame; before, after (4,): quaternions from the
# parent's frame to the joint's, and from there, at s = 0, to the node's; inertia (9,): about the centre of mass, along
# the node's axes, row by row. For the last node of a ball joint: acts: kind of its law, 0 for none; before, after: P
# and C P^T; bends, damps (3,): diagonals of K and D, see `space_ball_joints`; stays: whether its chart stays at home.
SPACE_NODE = record_dtype(
    [
        *fields("i8", "parent", "kind", "which", "acts", "stays"),
        *((name, "f8", (3,)) for name in ("on_parent", "point", "axis", "bends", "damps")),
        *((name, "f8", (4,)) for name in ("before", "after")),
        ("inertia", "f8", (9,)),
        *fields("f8", "mass", "radius"),
    ]
)
# Factors of the elimination of Newton's matrix, see `tree`. u, w, s (3,): U, W and S of the coordinate of the node;
# inverse: 1 / D; arm (2,) m: (e + d)'.
FACTORS = record_dtype(
    [*((name, "f8", (3,)) for name in ("u", "w", "s")), *fields("f8", "inverse"), ("arm", "f8", (2,))]
)
# In space. u, w, s (6,): as in FACTORS; inverse (9,): 1 / D as its first number, or, in the record of the first node of
# a ball joint, the inverse of D (3, 3), row by row; arm (3,) m: e + d.
SPACE_FACTORS = record_dtype(
    [*((name, "f8", (6,)) for name in ("u", "w", "s")), ("inverse", "f8", (9,)), ("arm", "f8", (3,))]
)
# Coefficients of the time scheme (`tree_newton`); fixed: whether the length of steps is fixed.
SCHEME = record_dtype([*fields("f8", "alpha_m", "alpha_f", "beta", "gamma"), ("fixed", "i8")])
# end (s): time to march to; rest_speed (m/s), rest_time (s): the march ends when no speed has been above for that time;
# tolerance (m/s2), share, slow (m/s): of the iterations, see `tree_march.newton_tolerance`; away (m/s): speed at which
# a motion counts as diverged; most: greatest number of steps.
CONTROL = record_dtype(
    [*fields("f8", "end", "rest_speed", "rest_time", "tolerance", "share", "slow", "away"), ("most", "i8")]
)
# now: time reached (s); step, tried: lengths (s) of the step to come and of the last one tried; resting_since: time (s)
# since which everything rests, infinite where something moves; speed, greatest: greatest speed (m/s) at the start of
# the step, and of the run so far; fastest: the latter, but at least the value that step-size control takes; origin,
# whole: time (s) from which fixed steps are counted, and how many there were.
CLOCK = record_dtype(
    fields("f8", "now", "step", "resting_since", "tried", "speed", "greatest", "fastest", "origin", "whole")
)
# Numbers of steps that were accepted, refused for their error, and of fixed steps that had to be shortened.
COUNTS = record_dtype(fields("i8", "steps", "refused", "shortened"))
# matrix_of_v: the of_v (s, see `tree_newton`) that the matrix in use was made with, 0 where a new one is needed;
# iterations, matrices: counts of both so far.
NEWTON = record_dtype([*fields("f8", "matrix_of_v"), *fields("i8", "iterations", "matrices")])
# Addresses of functions, see `tree_calls`.
CALL = record_dtype(
    fields(
        "i8",
        *("force", "tangent", "accept", "update_active", "soonest", "begin", "accelerate", "iterate", "end", "attempt"),
        *("ball_efforts", "ball_stiffness"),
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
    **dict.fromkeys(("gravity", "knots", "blank", "bends", "arms", "lever", "projected"), _ROW),
    **dict.fromkeys(("s", "rates", "s2", "lagged"), _ROW),
    **dict.fromkeys(("s_before", "rates_before", "s2_before", "lagged_before"), _ROW),
    **dict.fromkeys(("effort", "stiffness", "residual", "change"), _ROW),
    **dict.fromkeys(("triplets", "states", "table", "shapes", "inverse"), _ROWS),
    **dict.fromkeys(("pose", "pose_rates", "twist", "acceleration", "turned", "home", "arm", "along", "bias"), _ROWS),
    **dict.fromkeys(("force", "of_sand", "blocks", "coupled", "passed", "body", "node_change"), _ROWS),
    **dict.fromkeys(("signals", "prescribed", "acts", "followed"), _WHOLE),
    **dict.fromkeys(("iterations", "changes"), _WHOLE),
)
view = TREE.view

_SCALARS = (
    *("s", "rates", "s2", "lagged", "s_before", "rates_before", "s2_before", "lagged_before"),
    *("effort", "stiffness", "residual", "change"),
)
_WIDTHS = {
    **dict.fromkeys(("pose", "twist", "acceleration", "along", "force", "passed", "node_change"), 3),
    **{"turned": 2, "arm": 2, "bias": 2, "body": 9},
}
_WIDTHS_IN_SPACE = {
    **dict.fromkeys(("pose", "pose_rates", "of_sand"), 7),
    **dict.fromkeys(("twist", "acceleration", "along", "bias", "force", "passed", "node_change"), 6),
    **{"turned": 9, "home": 4, "arm": 3, "body": 36, "blocks": 49, "coupled": 3},
}


def room(nodes: int, *, in_space: bool = False) -> dict[str, NDArray[Any]]:
    """Return the arrays of a number of nodes: those of the state, and those computed from it; all are zero."""
    widths = _WIDTHS_IN_SPACE if in_space else _WIDTHS
    arrays = {name: np.zeros(nodes) for name in _SCALARS}
    arrays |= {name: np.zeros((nodes, width)) for name, width in widths.items()}
    if in_space:
        return arrays | {"factors": np.zeros(nodes, SPACE_FACTORS)}
    return arrays | {"factors": np.zeros(nodes, FACTORS), "pose_rates": arrays["twist"]}


def addresses(arrays: Mapping[str, NDArray[Any]]) -> NDArray[np.int64]:
    """Return `TREE.addresses` of a tree in the plane or in space; their nodes and factors differ in record type."""
    names = {"nodes": "space_nodes", "factors": "space_factors"} if arrays["nodes"].dtype == SPACE_NODE else {}
    return TREE.addresses({names.get(name, name): array for name, array in arrays.items()})
