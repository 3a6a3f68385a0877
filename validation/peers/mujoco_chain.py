"""A chain of rigid links in MuJoCo with joint angles as coordinates; the sand is called once a step.

The model has no geoms, contacts or constraints, and all optional parts of MuJoCo are switched off. As in
`mujoco_pendulum`, the sand is one compiled function that finds its arrays through a table of addresses, so that it has
one argument and can also be a native callback.
"""

from __future__ import annotations

import math
import time

import mujoco
import numpy as np
from numba import carray, cfunc, njit, types

from . import BAR, GRAVITY, SAND, Path, follow, sand_on_strip
from .mujoco_pendulum import DISABLED, _array, _pointer

# Rows of the address table: counters first, then addresses of arrays.
CALLS, STAGES, LINKS, STRIPS, OVERWRITE, Q, V, A, OUT, PARAMETERS, ANCHORS, POINTS, FORCES, LOADS, TIPS = range(15)
_TABLE = np.zeros(15, dtype=np.int64)
_TABLE_ADDRESS = _TABLE.ctypes.data


@njit
def sand_on_links(table):
    """Add the generalised sand forces (N m) of the chain's present state, and record the tip once a step.

    Velocities are qvel + lead qacc, where lead is zero, or half a step for a leapfrog with qvel at half steps.
    """
    n, strips = table[LINKS], table[STRIPS]
    first = table[CALLS] % table[STAGES] == 0
    q, v, a, out = _array(table[Q], n), _array(table[V], n), _array(table[A], n), _array(table[OUT], n)
    lead, surface, length = _array(table[PARAMETERS], 3)
    anchors, forces = _array(table[ANCHORS], (n * strips + 1, 2)), _array(table[FORCES], (3, 2, 2))
    points, loads = _array(table[POINTS], (n * strips + 1, 4)), _array(table[LOADS], (n * strips + 1, 2))
    angle = rate = 0.0
    points[0, :] = 0.0
    loads[:] = 0.0
    j = 0
    for k in range(n):
        angle += q[k]
        rate += v[k] + lead * a[k]
        cx, cy = length / strips * math.cos(angle), -length / strips * math.sin(angle)
        for _ in range(strips):
            points[j + 1, 0], points[j + 1, 1] = points[j, 0] + cx, points[j, 1] + cy
            points[j + 1, 2], points[j + 1, 3] = points[j, 2] + rate * cy, points[j, 3] - rate * cx
            j += 1
    if first:
        follow(points, anchors, surface, SAND)
    for i in range(j):
        if sand_on_strip(
            points[i, :2], points[i + 1, :2], points[i, 2:], points[i + 1, 2:],
            anchors[i], anchors[i + 1], surface, BAR, SAND, forces,
        ):  # fmt: skip
            for end in range(2):
                for xy in range(2):
                    loads[i + end, xy] += forces[0, end, xy] + forces[1, end, xy] + forces[2, end, xy]
    # The share of a strip's force at a hinge acts at the hinge point, so it can be assigned to either link.
    fx = fy = moment = 0.0  # resultant of all forces beyond point j, moment clockwise about it
    for k in range(n - 1, -1, -1):
        for _ in range(strips):
            fx += loads[j, 0]
            fy += loads[j, 1]
            j -= 1
            moment += (points[j + 1, 1] - points[j, 1]) * fx - (points[j + 1, 0] - points[j, 0]) * fy
        out[k] = moment + (0.0 if table[OVERWRITE] else out[k])
    if first:
        tips = _array(table[TIPS], (table[CALLS] // table[STAGES] + 1, 2))
        tips[-1, 0], tips[-1, 1] = points[n * strips, 0], points[n * strips, 1]
    table[CALLS] += 1


@cfunc(types.void(types.voidptr, types.voidptr))
def _native(model, data):  # noqa: ARG001, MuJoCo prescribes the signature
    """Callback mjcb_passive without Python; the address of the table is a constant of this process."""
    sand_on_links(carray(_pointer(_TABLE_ADDRESS), 15, np.int64))


def model_xml(masses: np.ndarray, inertia: float, length: float, step: float, integrator: str) -> str:
    """MJCF of the chain: mass (kg) and transverse inertia (kg m2) of each link, its length (m), time step (s)."""
    body = (
        '<body pos="{:.17g} 0 0"><inertial pos="{:.17g} 0 0" mass="{:.17g}" diaginertia="{:.17g} {:.17g} {:.17g}"/>'
        '<joint type="hinge" axis="0 0 -1"/>'
    )
    bodies = "".join(
        body.format(length if i else 0.0, 0.5 * length, mass, inertia, inertia, inertia)
        for i, mass in enumerate(masses)
    )
    flags = " ".join(f'{name}="disable"' for name in DISABLED.split())
    option = f'timestep="{step!r}" gravity="0 {-GRAVITY} 0" integrator="{integrator}"'
    return f"""<mujoco><option {option}><flag {flags}/></option>
        <worldbody>{bodies}{"</body>" * len(masses)}</worldbody></mujoco>"""


def run(
    links: int,
    strips: int,
    masses: np.ndarray,
    inertia: float,
    length: float,
    surface: float,
    start: tuple[float, float],
    steps: int,
    end_time: float = 0.04,
    integrator: str = "Euler",
    native: bool = False,
    leapfrog: bool = False,
) -> Path:
    """Tip path of a straight chain of `links` links of `length` (m), each with `strips` strips in the sand.

    start: angle below the horizontal (rad) and rate (rad/s) of the first hinge. native: MuJoCo calls compiled code at
    every evaluation; otherwise Python calls it once a step, and the force is constant over the stages of RK4. leapfrog:
    interpret Euler's velocities as those at half steps, so start half a step earlier, and pass qvel + step/2 qacc to
    the sand. Beyond its stability limit MuJoCo warns and the path is NaN. Only one run at a time: callback and table
    are global.
    """
    step = end_time / steps
    model = mujoco.MjModel.from_xml_string(model_xml(masses, inertia, length, step, integrator))
    data = mujoco.MjData(model)
    angle, rate = start
    stations = np.arange(links * strips + 1) * length / strips
    arrays = {
        Q: data.qpos,
        V: data.qvel,
        A: data.qacc,
        OUT: data.qfrc_passive if native else data.qfrc_applied,
        PARAMETERS: np.array([0.5 * step if leapfrog else 0.0, surface, length]),
        ANCHORS: np.column_stack((stations * math.cos(angle), -stations * math.sin(angle))),
        POINTS: np.zeros((links * strips + 1, 4)),
        FORCES: np.zeros((3, 2, 2)),
        LOADS: np.zeros((links * strips + 1, 2)),
        TIPS: np.zeros((steps + 1, 2)),
    }
    for row, array in arrays.items():
        _TABLE[row] = array.ctypes.data
    _TABLE[CALLS], _TABLE[LINKS], _TABLE[STRIPS], _TABLE[OVERWRITE] = 0, links, strips, not native
    _TABLE[STAGES] = 4 if integrator == "RK4" and native else 1
    data.qpos[0], data.qvel[0] = angle, rate
    mujoco.mj_forward(model, data)
    if leapfrog:
        data.qvel[:] -= 0.5 * step * data.qacc
    mujoco.set_mjcb_passive(_native.ctypes if native else None)
    try:
        begin = time.perf_counter()
        if native:
            mujoco.mj_step(model, data, steps)
        else:
            for _ in range(steps):
                sand_on_links(_TABLE)
                mujoco.mj_step(model, data)
        seconds = time.perf_counter() - begin
    finally:
        mujoco.set_mjcb_passive(None)
    sand_on_links(_TABLE)
    return Path(step * np.arange(steps + 1), arrays[TIPS], seconds)


sand_on_links.compile("void(int64[::1])")
