"""Law that is a table of measured stresses on an element, by its depth, its angle and its direction of motion.

The angles are those of resistive force theory in the plane (see `rft`): beta is the angle of the element to the
horizontal, positive where the leading face looks down, and gamma the angle of its motion below the horizontal. Motion
to the left is motion to the right, mirrored. stress_x (Pa) acts against the horizontal motion, stress_z (Pa) upward.
All three arguments are interpolated linearly. The stress is 0 at the surface, and below the deepest row it grows in
proportion to the depth [ours]. Where an element moves straight up or down, both mirror images count by half; the same
holds for both ends of beta [ours]. Between rows that resist, an interpolated stress might still drive an element. There
its component along the motion is dropped, as in `rft3d`.

In YAML, `{law: table, file: my_sand.csv}` reads a file beside the config. It has the columns depth_m, beta_deg,
gamma_deg, stress_x_Pa and stress_z_Pa, and a row for each depth, beta and gamma, in any order.
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

UPRIGHT = 0.02  # horizontal component of the motion below which its mirror images are averaged
MOST_DRIVING = 1e-9  # greatest driving stress, divided by the greatest stress, that counts as round-off
MEASURED_STRESS = not_known("friction, cohesion and inertia stand together in a measured stress")
Numbers = Annotated[tuple[float, ...], Listed, Field(min_length=1)]
Angles = Annotated[tuple[float, ...], Listed, Field(min_length=2)]


class StressTable(Law):
    """Stress by depth, beta and gamma, interpolated in a table.

    Parameters
    ----------
    depth : sequence of float
        Depths of the rows (m), increasing.
    beta : sequence of float
        Angles of the element (deg), from -90 to 90, increasing.
    gamma : sequence of float
        Angles of its motion below the horizontal (deg), from -90 to 90, increasing.
    stress_x : sequence of float
        Stress against the horizontal motion (Pa), by depth, then beta, then gamma.
    stress_z : sequence of float
        Stress upward (Pa), in the same order.
    """

    law: Literal["table"]
    depth: Annotated[Numbers, SHAPE] = Field(alias="depth_m")
    beta: Annotated[Angles, SHAPE] = Field(alias="beta_deg")
    gamma: Annotated[Angles, SHAPE] = Field(alias="gamma_deg")
    stress_x: Annotated[Numbers, MEASURED_STRESS] = Field(alias="stress_x_Pa")
    stress_z: Annotated[Numbers, MEASURED_STRESS] = Field(alias="stress_z_Pa")

    equation = "stress = table(depth, beta, gamma)"
    terms = ("static",)
    takes = frozenset({"round", "flat", "outline"})
    constants = ("data", "depths", "betas", "gammas")  # address of the numbers, and how many there are of each

    def _faults(self) -> Faults:
        """Faults of the axes, of the number of stresses, and of the first row whose stress would drive an element."""
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
        for (z, b, g), x, vertical in zip(rows, self.stress_x, self.stress_z, strict=True):
            if driving_stress(g, x, vertical) > MOST_DRIVING * scale:
                yield (), driving_fault(z, b, g, driving_stress(g, x, vertical))
                return

    def numbers(self, gravity: float) -> dict[str, float]:
        """Address and sizes of the table; see `Law.numbers`.

        Gravity does not matter, as the stresses belong to a place.
        """
        data = _table_data((self.depth, self.beta, self.gamma, self.stress_x, self.stress_z))
        sizes = len(self.depth) + (self.depth[0] > 0.0), len(self.beta), len(self.gamma)
        return {"data": float(data.ctypes.data), **dict(zip(("depths", "betas", "gammas"), sizes, strict=True))}

    @staticmethod
    def traction(z, t, u, width, side, j, m):
        """Stress of the table, (2,) Pa, as the first term, in the plane; arguments as in `laws.law`."""
        return stress(z, t, u, m), (0.0, 0.0)

    @staticmethod
    def facet_traction(z, n, u, side, j, m):
        """Stress of the table, (3,) Pa, as the first term, in space; arguments as in `laws.law`.

        It acts on slices along the motion, as in `sand.kernels.slices`. Near a vertical motion it turns to slices along
        the normal.
        """
        (nx, ny, nz), (ux, uy, uz) = n, u
        level, ahead = math.sqrt(nx * nx + ny * ny), math.sqrt(ux * ux + uy * uy)
        share = 1.0 if ahead >= UPRIGHT * level else ahead / (UPRIGHT * level)
        sx, sy, sz = 0.0, 0.0, 0.0
        if share > 0.0:  # slices along the motion
            rx, ry = (ux / ahead, uy / ahead) if ahead > 0.0 else (1.0, 0.0)
            sx, sy, sz = slice_stress(z, (nx * rx + ny * ry, nz), (ahead, uz), (rx, ry), share, m)
        if share < 1.0:  # slices along the normal
            rx, ry = nx / level, ny / level
            ur = ux * rx + uy * ry
            inverse = 1.0 / math.sqrt(ur * ur + uz * uz)
            x, y, vertical = slice_stress(z, (level, nz), (inverse * ur, inverse * uz), (rx, ry), 1.0 - share, m)
            sx, sy, sz = sx + x, sy + y, sz + vertical
        return (sx, sy, sz), (0.0, 0.0, 0.0)


def slice_stress(z, n, u, r, share, m):
    """Weighted stress on a slice of an element.

    Parameters
    ----------
    z : float
        Depth (m), above 0.
    n : tuple of float
        Components of the normal of the element along r and z.
    u : tuple of float
        Components of the direction of motion along r and z, a unit vector.
    r : tuple of float
        Horizontal direction (2,) of the slice, a unit vector.
    share : float
        Weight.
    m : record
        Constants of the law.

    Returns
    -------
    tuple of float
        Stress (3,) Pa per area of the element, times the weight.
    """
    w = math.sqrt(n[0] * n[0] + n[1] * n[1])
    if w == 0.0:
        return 0.0, 0.0, 0.0
    sr, sz = stress(z, (-n[1] / w, n[0] / w), u, m)
    return share * w * sr * r[0], share * w * sr * r[1], share * w * sz


def stress(z, t, u, m):
    """Stress on an element in the plane, without a component that drives it.

    Parameters
    ----------
    z : float
        Depth (m), above 0.
    t, u : tuple of float
        Unit tangent and unit direction of motion (2,), y up.
    m : record
        Constants of the law.

    Returns
    -------
    tuple of float
        Stress (2,) Pa.
    """
    (tx, ty), (ux, uy) = t, u
    share = min(1.0, max(0.0, 0.5 + 0.5 * ux / UPRIGHT))
    sx, sy = 0.0, 0.0
    if share > 0.0:
        x, y = interpolated_stress(z, (tx, ty), (max(0.0, ux), uy), m)
        sx, sy = share * x, share * y
    if share < 1.0:
        x, y = interpolated_stress(z, (-tx, ty), (max(0.0, -ux), uy), m)
        sx, sy = sx - (1.0 - share) * x, sy + (1.0 - share) * y
    along = max(0.0, sx * ux + sy * uy)
    return sx - along * ux, sy - along * uy


def interpolated_stress(z, t, u, m):
    """Interpolated stress on an element that does not move to the left.

    Parameters
    ----------
    z : float
        Depth (m), above 0.
    t : tuple of float
        Unit tangent (2,), of either sense.
    u : tuple of float
        Direction of motion (2,), with x of 0 or more.
    m : record
        Constants of the law.

    Returns
    -------
    tuple of float
        Stress (2,) Pa, x to the right and y up.
    """
    (tx, ty), (ux, uy) = t, u
    nz, nb, ng = int(m.depths), int(m.betas), int(m.gammas)
    axes, size = nz + nb + ng, nz * nb * ng
    data = kernels.tables.numbers_at(m.data, axes + 2 * size)
    if tx < 0.0 or (tx == 0.0 and ty < 0.0):
        tx, ty = -tx, -ty
    iz, c = kernels.tables.interval(data, 0, nz, z)
    ib, b = kernels.tables.interval(data, nz, nb, math.atan2(ty, tx))
    ig, g = kernels.tables.interval(data, nz + nb, ng, math.atan2(-uy, ux))
    extrapolation = max(1.0, z / data[nz - 1])
    sx, sy = 0.0, 0.0
    for k in range(8):
        dz, db, dg = k // 4, (k // 2) % 2, k % 2
        weight = (c if dz else 1.0 - c) * (b if db else 1.0 - b) * (g if dg else 1.0 - g) * extrapolation
        index = axes + ((iz + dz) * nb + ib + db) * ng + ig + dg
        sx -= weight * data[index]
        sy += weight * data[index + size]
    return sx, sy


@lru_cache(maxsize=32)
def _table_data(table: tuple[tuple[float, ...], ...]) -> NDArray[np.float64]:
    """Axes (m, rad) and stresses (Pa) in the array that the kernels read. It is kept, as records hold its address."""
    import numpy as np

    depth, beta, gamma = (np.array(column, dtype=float) for column in table[:3])
    x, z = (np.array(column, dtype=float).reshape(len(depth), len(beta), len(gamma)) for column in table[3:])
    for column in (x, z):  # the ends of beta are the same element
        column[:, [0, -1]] = 0.5 * (column[:, :1] + column[:, -1:])
    if depth[0] > 0.0:
        depth = np.concatenate([[0.0], depth])
        x, z = (np.concatenate([np.zeros((1, *column.shape[1:])), column]) for column in (x, z))
    data = np.concatenate([depth, np.radians(beta), np.radians(gamma), x.ravel(), z.ravel()])
    _KEPT.append(data)  # a record may hold its address for longer than the cache keeps it
    return data


_KEPT: list[Any] = []


def driving_stress(gamma: float, x: float, z: float) -> float:
    """Component of a stress of the table along the motion.

    Parameters
    ----------
    gamma : float
        Angle of the motion below the horizontal (deg).
    x, z : float
        stress_x and stress_z (Pa).

    Returns
    -------
    float
        Pa, positive where the stress drives the element.
    """
    g = math.radians(gamma)
    return -x * math.cos(g) - z * math.sin(g)


def driving_fault(depth: float, beta: float, gamma: float, stress: float) -> str:
    """Fault of a row whose stress would drive an element.

    Parameters
    ----------
    depth : float
        Depth (m).
    beta, gamma : float
        Angles (deg).
    stress : float
        Component of the stress along the motion (Pa).

    Returns
    -------
    str
        A sentence.
    """
    where = f"an element at beta {beta:g} deg that moves at gamma {gamma:g} deg, {depth:g} m deep"
    return f"pushes {where}, along its motion with {stress:.3g} Pa; allowed are stresses that resist it"


def axis_faults(depth: tuple[float, ...], beta: tuple[float, ...], gamma: tuple[float, ...]) -> list[LocalFault]:
    """Faults of the axes of a table.

    Parameters
    ----------
    depth : tuple of float
        Depths (m).
    beta, gamma : tuple of float
        Angles (deg).

    Returns
    -------
    list of LocalFault
        Keys with sentences; empty if the axes are right.
    """
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
