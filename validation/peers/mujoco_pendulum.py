"""The pendulum in MuJoCo: the flexible link is a chain of rigid segments, joined by hinges with springs.

The hinges are at the midpoints of n equal elements of length h = LENGTH / n, each with stiffness EI / h. The first half
element belongs to the root body; the last half element is the free end. Each hinge has the compliance of the element
around it, so that the chain converges to the clamped beam with h^2. Joint angles are the coordinates. The model has no
geoms, contacts or constraints, and all optional parts of MuJoCo are switched off.

The sand is one numba function of (qpos, qvel): planar kinematics, strip forces, generalised forces by a backward sweep.
It finds its arrays through a table of addresses, so that it has one argument and can also be a native callback.
"""

from __future__ import annotations

import math
import time

import mujoco
import numpy as np
from numba import carray, cfunc, njit, types
from numba.extending import intrinsic

from . import (
    ANGLE,
    AREA,
    BAR,
    BENDING_STIFFNESS,
    CLAMP_CENTRE,
    CLAMP_MASS,
    DENSITY,
    DISC_MASS,
    GRAVITY,
    LENGTH,
    NO_SURFACE,
    RATE,
    ROOT,
    ROOT_INERTIA,
    SAND,
    SURFACE,
    Path,
    follow,
    sand_on_strip,
    segment_inertia,
)

DISABLED = """constraint equality frictionloss limit contact clampctrl warmstart filterparent actuation sensor midphase
    nativeccd island autoreset"""

# Rows of the address table: counters first, then addresses of arrays.
CALLS, STAGES, SPANS, OVERWRITE, Q, V, A, OUT, LENGTHS, PARAMETERS, ANCHORS, NODES, FORCES, TIPS = range(14)
_TABLE = np.zeros(14, dtype=np.int64)
_TABLE_ADDRESS = _TABLE.ctypes.data


@intrinsic
def _pointer(typingctx, address):  # noqa: ARG001, numba prescribes the signature
    """Address (int64) as a pointer."""

    def generate(context, builder, signature, args):
        return builder.inttoptr(args[0], context.get_value_type(signature.return_type))

    return types.voidptr(address), generate


@njit
def _array(address, shape):
    """Array of float64 at an address."""
    return carray(_pointer(address), shape, np.float64)


@njit
def sand_on_chain(table):
    """Add the generalised sand forces (N m) of the chain's present state, and record the tip once a step.

    Velocities are qvel + lead qacc, where lead is zero, or half a step for a leapfrog with qvel at half steps.
    """
    n = table[SPANS]
    first = table[CALLS] % table[STAGES] == 0
    q, v, a = _array(table[Q], n), _array(table[V], n), _array(table[A], n)
    out, lengths = _array(table[OUT], n), _array(table[LENGTHS], n)
    lead, surface = _array(table[PARAMETERS], 2)
    anchors, forces = _array(table[ANCHORS], (n + 1, 2)), _array(table[FORCES], (3, 2, 2))
    nodes = _array(table[NODES], (n + 1, 4))  # x, y, v_x, v_y
    angle, rate = q[0], v[0] + lead * a[0]
    nodes[0, 0], nodes[0, 1] = ROOT * math.cos(angle), -ROOT * math.sin(angle)
    nodes[0, 2], nodes[0, 3] = rate * nodes[0, 1], -rate * nodes[0, 0]
    for k in range(n):
        if k > 0:
            angle += q[k]
            rate += v[k] + lead * a[k]
        cx, cy = lengths[k] * math.cos(angle), -lengths[k] * math.sin(angle)
        nodes[k + 1, 0], nodes[k + 1, 1] = nodes[k, 0] + cx, nodes[k, 1] + cy
        nodes[k + 1, 2], nodes[k + 1, 3] = nodes[k, 2] + rate * cy, nodes[k, 3] - rate * cx
    if first:
        follow(nodes, anchors, surface, SAND)
    fx = fy = moment = 0.0  # resultant of all forces beyond node k, moment clockwise about it
    for k in range(n - 1, -1, -1):
        if sand_on_strip(
            nodes[k, :2], nodes[k + 1, :2], nodes[k, 2:], nodes[k + 1, 2:],
            anchors[k], anchors[k + 1], surface, BAR, SAND, forces,
        ):  # fmt: skip
            fx += forces[0, 1, 0] + forces[1, 1, 0] + forces[2, 1, 0]
            fy += forces[0, 1, 1] + forces[1, 1, 1] + forces[2, 1, 1]
        moment += (nodes[k + 1, 1] - nodes[k, 1]) * fx - (nodes[k + 1, 0] - nodes[k, 0]) * fy
        fx += forces[0, 0, 0] + forces[1, 0, 0] + forces[2, 0, 0]
        fy += forces[0, 0, 1] + forces[1, 0, 1] + forces[2, 0, 1]
        if k == 0:
            moment += nodes[0, 1] * fx - nodes[0, 0] * fy
        out[k] = moment + (0.0 if table[OVERWRITE] else out[k])
    if first:
        tips = _array(table[TIPS], (table[CALLS] // table[STAGES] + 1, 2))
        tips[-1, 0], tips[-1, 1] = nodes[n, 0], nodes[n, 1]
    table[CALLS] += 1


@cfunc(types.void(types.voidptr, types.voidptr))
def _native(model, data):  # noqa: ARG001, MuJoCo prescribes the signature
    """Callback mjcb_passive without Python; the address of the table is a constant of this process."""
    sand_on_chain(carray(_pointer(_TABLE_ADDRESS), 14, np.int64))


def _from_python(model, data):  # noqa: ARG001, MuJoCo prescribes the signature
    """Callback mjcb_passive through Python."""
    sand_on_chain(_TABLE)


def model_xml(segments: int, step: float, integrator: str, rotary: bool = True) -> str:
    """MJCF of the pendulum with `segments` elements (0: rigid link) and a time step (s).

    rotary: include the rotary inertia of the section.
    """
    lengths = span_lengths(segments)
    mass = DENSITY * AREA * lengths
    centre = ROOT + 0.5 * lengths[0]
    root_mass = DISC_MASS + CLAMP_MASS + mass[0]
    root_centre = (CLAMP_MASS * CLAMP_CENTRE + mass[0] * centre) / root_mass
    pivot_inertia = ROOT_INERTIA + mass[0] * centre**2 + segment_inertia(lengths[0], rotary)
    k = BENDING_STIFFNESS * segments / LENGTH
    body = '<body pos="{:.17g} 0 0"><inertial pos="{:.17g} 0 0" mass="{:.17g}" diaginertia="{:.17g} {:.17g} {:.17g}"/>'
    hinge = '<joint type="hinge" axis="0 0 -1" stiffness="{:.17g}"/>'
    inertia = pivot_inertia - root_mass * root_centre**2
    bodies = body.format(0.0, root_centre, root_mass, inertia, inertia, inertia) + hinge.format(0.0)
    start = ROOT
    for before, length, m in zip(lengths[:-1], lengths[1:], mass[1:], strict=True):
        inertia = segment_inertia(length, rotary)
        bodies += body.format(start + before, 0.5 * length, m, inertia, inertia, inertia) + hinge.format(k)
        start = 0.0
    flags = " ".join(f'{name}="disable"' for name in DISABLED.split())
    option = f'timestep="{step!r}" gravity="0 {-GRAVITY} 0" integrator="{integrator}"'
    return f"""<mujoco><option {option}><flag {flags}/></option>
        <worldbody>{bodies}{"</body>" * len(lengths)}</worldbody></mujoco>"""


def span_lengths(segments: int) -> np.ndarray:
    """Lengths (m) of the rigid spans of the link: a single one, or half an element, whole elements, half an element."""
    if segments == 0:
        return np.array([LENGTH])
    h = LENGTH / segments
    return np.array([0.5 * h] + [h] * (segments - 1) + [0.5 * h])


def run(
    segments: int,
    step: float,
    end_time: float = 0.04,
    integrator: str = "Euler",
    callback: str = "step",
    leapfrog: bool = False,
    sand: bool = True,
    rotary: bool = True,
) -> Path:
    """Tip path of the pendulum from touch to `end_time` (s) with a chain of `segments` hinges.

    callback: with "step" Python calls the sand once a step (qfrc_applied, constant over the stages of RK4), with
    "stage" MuJoCo calls Python at every evaluation (mjcb_passive), with "native" MuJoCo calls compiled code without
    Python. leapfrog: interpret Euler's velocities as those at half steps, so start half a step earlier, and pass qvel +
    step/2 qacc to the sand. rotary: include the rotary inertia of the section. The step (s) is adjusted to divide
    end_time; beyond the stability limit MuJoCo warns and the path is NaN. Only one run at a time: callbacks and the
    table of addresses are global.
    """
    if callback not in CALLBACKS:
        raise ValueError(f"callback {callback!r}: use one of {sorted(CALLBACKS)}")
    if leapfrog and integrator == "RK4":
        raise ValueError("leapfrog: RK4 has its velocities at whole steps; use a single-step integrator")
    steps = math.ceil(end_time / step - 1e-9)
    step = end_time / steps
    model = mujoco.MjModel.from_xml_string(model_xml(segments, step, integrator, rotary))
    data = mujoco.MjData(model)
    lengths = span_lengths(segments)
    n = len(lengths)
    stations = ROOT + np.concatenate([[0.0], np.cumsum(lengths)])
    arrays = {
        Q: data.qpos,
        V: data.qvel,
        A: data.qacc,
        OUT: data.qfrc_applied if callback == "step" else data.qfrc_passive,
        LENGTHS: lengths,
        PARAMETERS: np.array([0.5 * step if leapfrog else 0.0, SURFACE if sand else NO_SURFACE]),
        ANCHORS: np.column_stack((stations * math.cos(ANGLE), -stations * math.sin(ANGLE))),
        NODES: np.zeros((n + 1, 4)),
        FORCES: np.zeros((3, 2, 2)),
        TIPS: np.zeros((steps + 1, 2)),
    }
    for row, array in arrays.items():
        _TABLE[row] = array.ctypes.data
    _TABLE[CALLS], _TABLE[SPANS], _TABLE[OVERWRITE] = 0, n, callback == "step"
    _TABLE[STAGES] = 4 if integrator == "RK4" and callback != "step" else 1
    data.qpos[0], data.qvel[0] = ANGLE, RATE
    mujoco.mj_forward(model, data)
    if leapfrog:
        data.qvel[:] -= 0.5 * step * data.qacc
    mujoco.set_mjcb_passive(CALLBACKS[callback])
    try:
        begin = time.perf_counter()
        if callback == "step":
            for _ in range(steps):
                sand_on_chain(_TABLE)
                mujoco.mj_step(model, data)
        else:
            mujoco.mj_step(model, data, steps)
        seconds = time.perf_counter() - begin
    finally:
        mujoco.set_mjcb_passive(None)
    sand_on_chain(_TABLE)
    return Path(step * np.arange(steps + 1), arrays[TIPS], seconds)


CALLBACKS = {"step": None, "stage": _from_python, "native": _native.ctypes}
sand_on_chain.compile("void(int64[::1])")
