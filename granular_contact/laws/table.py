"""A law that is a table: stress on an element by its depth, its angle and its direction of motion, as it was measured.

The angles are those of resistive force theory in the plane (see `rft`): beta of the element to the horizontal, positive
where what leads looks down, and gamma of its motion below it; motion to the left is that to the right, mirrored.
stress_x is against the horizontal motion and stress_z upward (Pa). Between the rows all three are interpolated
linearly, from nothing at the surface; below the deepest row the stress grows in proportion to the depth [ours]. Where
the element moves straight up or down, both mirror images count, half and half, as do both ends of beta [ours]. Between
rows that resist a stress might still drive an element: the part of it along the motion is dropped there, as in `rft3d`.

In YAML `{law: table, file: my_sand.csv}` reads the columns depth_m, beta_deg, gamma_deg, stress_x_Pa and stress_z_Pa of
a file beside the config: a row for each depth, beta and gamma, in any order.
"""

from __future__ import annotations

import math
from functools import lru_cache
from itertools import pairwise
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import Field

from granular_contact.laws.gravity import SHAPE, not_known
from granular_contact.laws.law import Law
from granular_contact.sand import kernels
from granular_contact.values.strict import Faults, Listed, LocalFault

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

UPRIGHT = 0.02  # of the horizontal part of the motion, over which its mirror images go over into each other
MOST_DRIVING = 1e-9  # of the greatest stress: round-off
OF_PLACE = not_known("friction, cohesion and inertia stand together in a measured stress")
Numbers = Annotated[tuple[float, ...], Listed, Field(min_length=1)]
Angles = Annotated[tuple[float, ...], Listed, Field(min_length=2)]


class StressTable(Law):
    """Stress by depth, beta and gamma, as a table has it.

    Parameters
    ----------
    depth : sequence of float
        Depths (m) of the rows, rising.
    beta : sequence of float
        Angles of the element (deg), from -90 to 90, rising.
    gamma : sequence of float
        Angles of its motion below the horizontal (deg), from -90 to 90, rising.
    stress_x : sequence of float
        Against the horizontal motion (Pa), by depth, then beta, then gamma.
    stress_z : sequence of float
        Upward (Pa), in the same order.
    """

    law: Literal["table"]
    depth: Annotated[Numbers, SHAPE] = Field(alias="depth_m")
    beta: Annotated[Angles, SHAPE] = Field(alias="beta_deg")
    gamma: Annotated[Angles, SHAPE] = Field(alias="gamma_deg")
    stress_x: Annotated[Numbers, OF_PLACE] = Field(alias="stress_x_Pa")
    stress_z: Annotated[Numbers, OF_PLACE] = Field(alias="stress_z_Pa")

    equation = "stress = table(depth, beta, gamma)"
    terms = ("static",)
    takes = frozenset({"round", "flat", "outline"})
    constants = ("data", "depths", "betas", "gammas")  # address of the numbers, and how many there are of each

    def _faults(self) -> Faults:
        yield from super()._faults()
        faults = [*axis_faults(self.depth, self.beta, self.gamma)]
        count = len(self.depth) * len(self.beta) * len(self.gamma)
        faults += [
            ((key,), f"got {len(values)} stresses for {count} rows of depth, beta and gamma")
            for key, values in (("stress_x_Pa", self.stress_x), ("stress_z_Pa", self.stress_z))
            if len(values) != count
        ]
        yield from faults
        if faults:
            return
        scale = max(map(abs, (*self.stress_x, *self.stress_z)))
        rows = [(z, b, g) for z in self.depth for b in self.beta for g in self.gamma]
        for (z, b, g), x, up in zip(rows, self.stress_x, self.stress_z, strict=True):
            if power(g, x, up) > MOST_DRIVING * scale:
                yield (), driving(z, b, g, power(g, x, up))
                return

    def numbers(self, gravity: float) -> dict[str, float]:
        """As `Law.numbers`; gravity does not matter, the stresses are those of a place."""
        held = _held((self.depth, self.beta, self.gamma, self.stress_x, self.stress_z))
        sizes = len(self.depth) + (self.depth[0] > 0.0), len(self.beta), len(self.gamma)
        return {"data": float(held.ctypes.data), **dict(zip(("depths", "betas", "gammas"), sizes, strict=True))}

    @staticmethod
    def traction(z, t, u, width, side, j, m):
        """Stress of the table; as `sand.kernels.plates.traction`."""
        return stress(z, t, u, m), (0.0, 0.0)

    @staticmethod
    def facet_traction(z, n, u, side, j, m):
        """Stress on the slices along the motion, as in `kernels.slices`; see `sand.kernels.facet_blocks.traction`."""
        (nx, ny, nz), (ux, uy, uz) = n, u
        level, ahead = math.sqrt(nx * nx + ny * ny), math.sqrt(ux * ux + uy * uy)
        share = 1.0 if ahead >= UPRIGHT * level else ahead / (UPRIGHT * level)
        sx, sy, sz = 0.0, 0.0, 0.0
        if share > 0.0:  # of the plane of the motion
            rx, ry = (ux / ahead, uy / ahead) if ahead > 0.0 else (1.0, 0.0)
            sx, sy, sz = slice_stress(z, (nx * rx + ny * ry, nz), (ahead, uz), (rx, ry), share, m)
        if share < 1.0:  # of that of the normal
            rx, ry = nx / level, ny / level
            ur = ux * rx + uy * ry
            one = 1.0 / math.sqrt(ur * ur + uz * uz)
            x, y, up = slice_stress(z, (level, nz), (one * ur, one * uz), (rx, ry), 1.0 - share, m)
            sx, sy, sz = sx + x, sy + y, sz + up
        return (sx, sy, sz), (0.0, 0.0, 0.0)


def slice_stress(z, n, u, r, share, m):
    """Share of the stress (3,) Pa on a slice along the horizontal direction r; its normal n and motion u along r, z."""
    w = math.sqrt(n[0] * n[0] + n[1] * n[1])
    if w == 0.0:
        return 0.0, 0.0, 0.0
    sr, up = stress(z, (-n[1] / w, n[0] / w), u, m)
    return share * w * sr * r[0], share * w * sr * r[1], share * w * up


def stress(z, t, u, m):
    """Stress (2,) Pa at a depth z > 0 (m) on an element along t that moves in the direction u, without what drives."""
    (tx, ty), (ux, uy) = t, u
    share = min(1.0, max(0.0, 0.5 + 0.5 * ux / UPRIGHT))
    sx, sy = 0.0, 0.0
    if share > 0.0:
        x, y = looked_up(z, (tx, ty), (max(0.0, ux), uy), m)
        sx, sy = share * x, share * y
    if share < 1.0:
        x, y = looked_up(z, (-tx, ty), (max(0.0, -ux), uy), m)
        sx, sy = sx - (1.0 - share) * x, sy + (1.0 - share) * y
    along = max(0.0, sx * ux + sy * uy)
    return sx - along * ux, sy - along * uy


def looked_up(z, t, u, m):
    """Stress (2,) Pa for a motion that is not to the left, x to the right."""
    (tx, ty), (ux, uy) = t, u
    nz, nb, ng = int(m.depths), int(m.betas), int(m.gammas)
    axes, size = nz + nb + ng, nz * nb * ng
    data = kernels.tables.numbers_at(m.data, axes + 2 * size)
    if tx < 0.0 or (tx == 0.0 and ty < 0.0):
        tx, ty = -tx, -ty
    iz, c = kernels.tables.interval(data, 0, nz, z)
    ib, b = kernels.tables.interval(data, nz, nb, math.atan2(ty, tx))
    ig, g = kernels.tables.interval(data, nz + nb, ng, math.atan2(-uy, ux))
    deeper = max(1.0, z / data[nz - 1])
    sx, sy = 0.0, 0.0
    for k in range(8):
        dz, db, dg = k // 4, (k // 2) % 2, k % 2
        weight = (c if dz else 1.0 - c) * (b if db else 1.0 - b) * (g if dg else 1.0 - g) * deeper
        at = axes + ((iz + dz) * nb + ib + db) * ng + ig + dg
        sx -= weight * data[at]
        sy += weight * data[at + size]
    return sx, sy


@lru_cache(maxsize=32)
def _held(table: tuple[tuple[float, ...], ...]) -> NDArray[np.float64]:
    """Axes (m, rad) and stresses as the kernels read them; kept, as they know its address."""
    import numpy as np

    depth, beta, gamma = (np.array(one, dtype=float) for one in table[:3])
    x, z = (np.array(one, dtype=float).reshape(len(depth), len(beta), len(gamma)) for one in table[3:])
    for one in (x, z):  # the ends of beta are the same element
        one[:, [0, -1]] = 0.5 * (one[:, :1] + one[:, -1:])
    if depth[0] > 0.0:
        depth = np.concatenate([[0.0], depth])
        x, z = (np.concatenate([np.zeros((1, *one.shape[1:])), one]) for one in (x, z))
    held = np.concatenate([depth, np.radians(beta), np.radians(gamma), x.ravel(), z.ravel()])
    _ALIVE.append(held)  # also when the cache has dropped it: a record may still have its address
    return held


_ALIVE: list[Any] = []


def power(gamma: float, x: float, z: float) -> float:
    """Stress (Pa) along a motion at gamma (deg) below the horizontal, of stress_x and stress_z."""
    g = math.radians(gamma)
    return -x * math.cos(g) - z * math.sin(g)


def driving(depth: float, beta: float, gamma: float, stress: float) -> str:
    """That a row would drive a body."""
    where = f"an element at beta {beta:g} deg that moves at gamma {gamma:g} deg, {depth:g} m deep"
    return f"pushes {where}, along its motion with {stress:.3g} Pa; allowed are stresses that resist it"


def axis_faults(depth: tuple[float, ...], beta: tuple[float, ...], gamma: tuple[float, ...]) -> list[LocalFault]:
    """Faults of the depths and angles of a table, each in rising order."""
    faults: list[LocalFault] = []
    for key, values in (("depth_m", depth), ("beta_deg", beta), ("gamma_deg", gamma)):
        if any(b <= a for a, b in pairwise(values)):
            faults.append(((key,), "does not rise; allowed are values that do"))
    if depth[0] < 0.0 or depth[-1] <= 0.0:
        faults.append(
            (("depth_m",), f"got {depth[0]:g} to {depth[-1]:g}; allowed are depths from 0 on, below the surface")
        )
    for key, values in (("beta_deg", beta), ("gamma_deg", gamma)):
        if (values[0], values[-1]) != (-90.0, 90.0):
            faults.append(((key,), f"goes from {values[0]:g} to {values[-1]:g}; allowed is from -90 to 90"))
    return faults
