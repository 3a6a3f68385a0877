"""Arrays of a tree in space, by the names of `tree_arrays`, with the widths and records of space.

space_nodes     (n,) records of SPACE_NODE, see `space_tree`
pose            (n, 7) centre of mass (m) and Euler parameters; pose_rates (n, 7) their rates
twist           (n, 6) velocity of the centre of mass (m/s) and angular velocity (rad/s), along the axes of the
acceleration    world; accelerations likewise
turned          (n, 9) axes of the node, row by row; home (n, 4): orientation that a ball joint's chart begins at
home
arm             (n, 3), along (n, 6), bias (n, 6): e + d, S and b of `space_tree`
force           (n, 6) on the nodes (N) and moment about the centre of mass (N m)
of_sand         (n, 7) generalised forces of the medium, see `space_bodies`; blocks (n, 49): their tangents
blocks
coupled         (n, 3) c of ball joints, of their three nodes three rows
body, joint     (n, 36) and (n, 30), see `space_tree`
shapes          (m, n) Phi^T of `space_modes`, and the inverse (m, m) of its matrix; lacked (m,): Phi^T R; of trees
inverse         with links in modes alone
lacked
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

WIDTHS = {
    **dict.fromkeys(("s", "rates", "s2", "lagged", "s_before", "rates_before", "s2_before", "lagged_before"), 0),
    **dict.fromkeys(("pose", "pose_rates", "of_sand"), 7),
    **dict.fromkeys(("twist", "acceleration", "along", "bias", "force", "passed", "moved"), 6),
    **dict.fromkeys(("effort", "stiffness", "rest", "change"), 0),
    **{"turned": 9, "home": 4, "arm": 3, "body": 36, "joint": 30, "blocks": 49, "coupled": 3},
}


def room(nodes: int) -> dict[str, NDArray[Any]]:
    """As of `tree_arrays`."""
    return {name: np.zeros((nodes, width) if width else nodes) for name, width in WIDTHS.items()}
