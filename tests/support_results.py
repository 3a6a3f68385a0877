"""Synthetic Results: a pendulum stopped by sand, integrated here in a few lines, so that figures have real shapes."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from granular_contact.results import Column, Outline, Results, Snapshot, Status

Array = NDArray[np.float64]

INERTIA, GRAVITY_MOMENT = 1.4955e-3, 0.08593  # kg m2, N m
RIGID, LENGTH, DIAMETER = 0.024765, 0.23876, 0.00635  # m
REACH = RIGID + LENGTH
DENSITY, DRAG, HORIZONTAL, VERTICAL, EXPONENT, G = 2500.0, 6.5, 8.0, 22.0, 1.1, 9.81
TERMS = ("drag", "horizontal_static", "vertical_static")


@dataclass(frozen=True)
class Case:
    angle_deg: float = 45.0
    rate: float = 6.47  # rad/s at touch
    medium: bool = True
    flexible: bool = False
    before: float = 0.0  # s of flight before touch
    after: float = 0.004  # s of rest after the stop
    stopped: bool = True
    rows: int = 1500
    speed: float = 1.0  # slower time axis: 0.01 makes 30 ms into 3 s


def forces(angle: float, rate: float, surface: float) -> Array:
    """(3 terms, fx fy moment) of the resultant law at the middle of the immersed segment."""
    depth = surface + REACH * np.sin(angle)
    if depth <= 0:
        return np.zeros((3, 3))
    immersed = depth / np.sin(angle)
    arm = REACH - immersed / 2
    point = arm * np.array([np.cos(angle), -np.sin(angle)])
    velocity = arm * rate * np.array([-np.sin(angle), -np.cos(angle)])
    sign = np.tanh(velocity / 2e-3)
    volume = np.pi * DIAMETER**2 / 4 * immersed
    drag = -DRAG * DENSITY * DIAMETER * immersed * np.linalg.norm(velocity) * velocity
    static_h = -sign[0] * HORIZONTAL * G * DENSITY * depth**2 * DIAMETER
    static_v = -sign[1] * VERTICAL * (depth / DIAMETER) ** EXPONENT * G * DENSITY * volume
    force = np.array([drag, [static_h, 0.0], [0.0, static_v]])
    moment = point[0] * force[:, 1] - point[1] * force[:, 0]
    return np.column_stack([force, moment])


@cache
def motion(case: Case) -> tuple[Array, Array, Array, Array, float | None]:
    """Time from the start, angle, rate, forces (rows, 9) and stopping time; semi-implicit steps of 10 us."""
    step = 1e-5
    angle0 = np.radians(case.angle_deg)
    surface = -REACH * np.sin(angle0) if case.medium else -1.0
    angle, rate, rows, stop, held = angle0 - case.rate * case.before, case.rate, [], None, np.zeros((3, 3))
    for i in range(20000):
        force = forces(angle, rate, surface)
        if stop is not None:  # at rest the static terms just carry the weight
            rate, force = 0.0, held * GRAVITY_MOMENT * np.cos(angle) / held[:, 2].sum()
        rows.append([i * step, angle, rate, *force.ravel()])
        rate += step * (GRAVITY_MOMENT * np.cos(angle) - force[:, 2].sum()) / INERTIA
        angle += step * rate
        if stop is None and rate <= 1e-2 and case.medium:
            stop, held = i * step - case.before, force * [[0], [1], [1]]
        if (stop is not None and i * step > case.before + stop + case.after) or i * step > 0.1:
            break
    data = np.array(rows)
    return data[:, 0] / case.speed, data[:, 1], data[:, 2], data[:, 3:], stop


def ringing(time: Array, case: Case) -> tuple[Array, Array]:
    """Deflection of the tip (m) and what it adds to the rate of the hub: a first mode struck at touch."""
    since = np.maximum(time - case.before / case.speed, 0.0)
    omega = 2 * np.pi * 480.0 * case.speed
    envelope = 2.2e-5 * np.exp(-since * 60 * case.speed)
    deflection = -envelope * (1 - np.cos(omega * since)) - 4e-6 * (since > 0) * np.exp(-since * 30 * case.speed)
    return deflection, 0.9 * envelope / REACH * omega / case.speed * np.sin(omega * since)


def table(case: Case) -> tuple[dict[str, Array], float | None]:
    time, angle, rate, force, stop = motion(replace(case, rows=0, flexible=False))  # which change none of it
    fine = np.linspace(time[0], time[-1], case.rows) if case.rows > 1 else time[:1]
    angle, rate = np.interp(fine, time, angle), np.interp(fine, time, rate)
    force = np.array([np.interp(fine, time, column) for column in force.T])
    deflection, extra = ringing(fine, case)
    hub = rate + (extra if case.flexible else 0.0)
    data = {"time_s": fine, "pivot_angle_deg": np.degrees(angle), "pivot_rate_rad_s": hub, "mean_rate_rad_s": rate}
    data |= {"tip_x_m": REACH * np.cos(angle), "tip_y_m": -REACH * np.sin(angle)}
    if case.flexible:
        data["deflection_m"] = deflection
    kinetic, gravity = INERTIA * rate**2 / 2, -GRAVITY_MOMENT * np.sin(angle)
    elastic = 3 * 15.1642 / LENGTH**3 * deflection**2 / 2 if case.flexible else np.zeros_like(fine)
    lost = kinetic[0] + gravity[0] - kinetic - gravity - elastic
    if case.medium:
        data["depth_m"] = REACH * (np.sin(angle) - np.sin(np.radians(case.angle_deg)))
        for i, term in enumerate(TERMS):
            for j, unit in enumerate(("force_x_N", "force_y_N", "moment_Nm")):
                data[f"{term}_{unit}"] = force[3 * i + j]
    data |= {"kinetic_J": kinetic, "gravity_J": gravity}
    if case.flexible:
        data["elastic_J"] = elastic
    if case.medium:
        data["granular_work_J"] = -lost * (0.98 if case.flexible else 1.0)
    data["damping_work_J"] = -lost * (0.02 if case.flexible else 0.0)
    data["energy_imbalance_J"] = 3e-8 * np.sin(fine / max(fine[-1], 1e-9) * 9) * fine / max(fine[-1], 1e-9)
    return data, stop


def outlines(angle: float, deflection: float) -> tuple[Outline, ...]:
    """The paper's three parts: the pivot's disc, the stub and the link (17 points, bent as a clamped beam is)."""
    along, across = np.array([np.cos(angle), -np.sin(angle)]), np.array([-np.sin(angle), -np.cos(angle)])
    share = np.linspace(0, 1, 17)[:, None]
    bend = deflection * share**2 * (3 - share) / 2
    link = (RIGID + LENGTH * share) * along + bend * across
    return (
        Outline("RB1", np.zeros((1, 2)), 0.01905),
        Outline("RB2", np.array([0.009525 * along, RIGID * along]), 0.01524),
        Outline("link", link, DIAMETER),
    )


def make(case: Case | None = None, **changes: Any) -> Results:
    """Results of `case`, or of `Case(**changes)`."""
    case = case or Case(**changes)
    data, stop = table(case)
    rows, touch = len(data["time_s"]), case.before / case.speed
    bend = data.get("deflection_m", np.zeros(rows))
    instants = {"touch": int(np.searchsorted(data["time_s"], touch)), "end": rows - 1}
    if case.medium:
        instants["deepest"] = int(np.argmax(data["depth_m"]))
    instants = {label: min(row, rows - 1) for label, row in instants.items()}
    shots = [
        Snapshot(label, float(data["time_s"][row]), outlines(np.radians(data["pivot_angle_deg"][row]), bend[row]))
        for label, row in sorted(instants.items(), key=lambda item: item[1])
    ]
    stopping = stop / case.speed if stop is not None and case.stopped else None
    at_stop = None if stopping is None else float(np.interp(touch + stopping, data["time_s"], data["pivot_angle_deg"]))
    return Results(
        name="pendulum",
        status=Status("rest" if case.stopped else "failed", "came to rest" if case.stopped else "the solver gave up"),
        columns=tuple(Column(name, f"what {name} is") for name in data),
        table=np.column_stack(list(data.values())),
        summary=summary(data, stopping, at_stop, touch),
        scenario={
            "model": "pendulum",
            "gravity_m_s2": [0.0, -9.81],
            "surface": {"height_m": -0.186, "seen_from": "pivot"},
            "solver": {"step_s": 1e-5, "tolerance": 1e-8, "maximum_steps": 100000},
            "bodies": [{"name": "RB1", "length_m": 0.019812}, {"name": "RB2", "length_m": 0.01524}],
        },
        snapshots=tuple(shots),
        surface=-REACH * np.sin(np.radians(case.angle_deg)) if case.medium else None,
        terms=TERMS if case.medium else (),
        warnings=("a warning",),
    )


def summary(data: dict[str, Array], stopping: float | None, at_stop: float | None, touch: float) -> dict[str, Any]:
    energy = {"initial_J": float(data["kinetic_J"][0]), "imbalance_relative": 3.1e-6, "granular_work_J": float("nan")}
    return {
        "status": "rest",
        "message": "came to rest",
        "stopping_time_s": stopping,
        "stopping_time_measure": "from touch until the mean rate is zero",
        "touch_time_s": touch,
        "angle_at_stop_deg": at_stop,
        "max_depth_m": float(np.max(data["depth_m"])) if "depth_m" in data else None,
        "max_deflection_m": float(np.max(np.abs(data["deflection_m"]))) if "deflection_m" in data else None,
        "max_deflection_time_s": (
            float(data["time_s"][np.argmax(np.abs(data["deflection_m"]))]) if "deflection_m" in data else None
        ),
        "energy": energy,
        "cost": {"solve_s": 0.2, "steps": len(data["time_s"]), "newton_iterations": 2, "load_calls": 3},
        "versions": {"granular-contact": "0.1.0", "numpy": "2.0"},
        "warnings": ["a warning"],
    }
