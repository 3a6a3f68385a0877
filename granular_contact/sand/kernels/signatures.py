"""Arguments of a law's functions, in their order, and how many numbers each gives back.

What they mean: `law.strip_force`, `cap_force`, `ball_force`, `drag_anchor`, `plates.stress` and `traction`; in space
`facets.stress`, `traction`, `inertia` and `force`, and `space_law`. Numba is not imported here: laws are checked when a
config is read.
"""

from __future__ import annotations

_MOTION = "v0x, v0y, v1x, v1y, e0x, e0y, e1x, e1y"
_MOTION_IN_SPACE = "v0x, v0y, v0z, v1x, v1y, v1z, e0x, e0y, e0z, e1x, e1y, e1z"

IN_PLANE: dict[str, tuple[str, int]] = {  # by name: arguments, numbers given back; 0: it adds to f
    "strip_force": (f"a, b, z0, z1, cx, cy, {_MOTION}, line, m, f", 0),
    "cap_force": ("cx, cy, vx, vy, line, m, f", 0),
    "ball_force": ("z, vx, vy, ex, ey, line, m, f", 0),
    "drag_anchor": ("px, py, ax, ay, m", 2),
    "stress": ("tx, ty, ux, uy, m", 2),
    "traction": ("z, tx, ty, ux, uy, width, side, j, m", 4),
}
IN_SPACE: dict[str, tuple[str, int]] = {
    "facet_stress": ("nx, ny, nz, ux, uy, uz, m", 3),
    "facet_traction": ("z, nx, ny, nz, ux, uy, uz, side, j, m", 6),
    "facet_inertia": ("nx, ny, nz, vx, vy, vz, side, m", 3),
    "facet_force": ("z, nx, ny, nz, vx, vy, vz, ex, ey, ez, spread, side, j, m", 6),
    "bar_force": (f"a, b, z0, z1, cx, cy, cz, {_MOTION_IN_SPACE}, cluster, m, f", 0),
    "bar_cap": ("cx, cy, cz, vx, vy, vz, cluster, m, f", 0),
    "space_ball_force": ("z, vx, vy, vz, ex, ey, ez, cluster, m, f", 0),
}
# Of these, what a law needs at least for what it takes: bars, plates and outlines, or balls.
OF_SURFACES = ("stress", "traction", "strip_force", "facet_stress", "facet_traction", "facet_force", "bar_force")
OF_BALLS = ("ball_force", "space_ball_force")


def arguments(name: str) -> list[str]:
    """Arguments of a law's function, in their order."""
    return (IN_PLANE | IN_SPACE)[name][0].split(", ")


def wanted(name: str) -> str:
    """A law's function as it has to be written, with what it gives."""
    given, count = (IN_PLANE | IN_SPACE)[name]
    return f"{name}({given}), which {f'gives {count} numbers' if count else 'adds to f'}"
