"""Arguments of a law's functions, in their order, and what the functions return.

Meaning of the arguments: `law.strip_force`, `cap_force`, `ball_force`, `drag_anchor`, `plates.stress`, `traction`; in
space `facet_blocks.stress`, `traction`, `inertia` and `force`, and `space_law`. The vectors t, n, u, v, e, c, p and
anchor are tuples of two numbers in the plane, of three in space. Numba is not imported here, as laws are checked when a
config is read.
"""

from __future__ import annotations

IN_PLANE: dict[str, tuple[str, int]] = {  # by name: arguments, number of vectors returned; 0: it adds to f
    "strip_force": ("strip, line, m, f", 0),
    "cap_force": ("c, v, line, m, f", 0),
    "ball_force": ("z, v, e, line, m, f", 0),
    "drag_anchor": ("p, anchor, m", 1),
    "stress": ("t, u, m", 1),
    "traction": ("z, t, u, width, side, j, m", 2),
}
IN_SPACE: dict[str, tuple[str, int]] = {
    "facet_stress": ("n, u, m", 1),
    "facet_traction": ("z, n, u, side, j, m", 2),
    "facet_inertia": ("n, v, side, m", 1),
    "facet_force": ("z, n, v, e, spread, side, j, m", 2),
    "bar_force": ("strip, cluster, m, f", 0),
    "bar_cap": ("c, v, cluster, m, f", 0),
    "space_ball_force": ("z, v, e, cluster, m, f", 0),
}
VECTORS = {"t", "n", "u", "v", "e", "c", "p", "anchor"}  # among the arguments
# Functions of which a law needs one, for bars, plates and outlines, and for balls.
OF_SURFACES = ("stress", "traction", "strip_force", "facet_stress", "facet_traction", "facet_force", "bar_force")
OF_BALLS = ("ball_force", "space_ball_force")


def arguments(name: str) -> list[str]:
    """Arguments of a law's function, in their order."""
    return (IN_PLANE | IN_SPACE)[name][0].split(", ")


def wanted(name: str) -> str:
    """Signature of a law's function as it has to be written, with its result."""
    parameters, count = (IN_PLANE | IN_SPACE)[name]
    vector = f"of {2 if name in IN_PLANE else 3} numbers"
    gives = ("adds to f", f"gives a tuple {vector}", f"gives two tuples {vector}")[count]
    return f"{name}({parameters}), which {gives}"
