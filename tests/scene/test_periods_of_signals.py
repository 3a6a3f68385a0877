"""Shortest periods of signals, and steps that resolve them: poorly resolved signals are reported or refused."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from support_models import one_body

from granular_contact import Results, load, simulate
from granular_contact.errors import SceneError
from granular_contact.scene.signal_tables import shortest_period
from granular_contact.scene.signals import Buehler, Constant, Ramp, Sine, piecewise

LENGTH, DIAMETER, DENSITY, END = 0.1, 0.006, 2700.0, 0.01
MASS = DENSITY * np.pi / 4.0 * DIAMETER**2 * LENGTH
INERTIA = MASS * (LENGTH**2 / 3.0 + DIAMETER**2 / 16.0)  # kg m2, about the hinge
IMPULSE = 1e-4  # N m s, of a pulse


def rod(signal: Any, **solver: Any) -> dict[str, Any]:
    """A rod on a hinge that a torque turns, without gravity and sand."""
    body = {"type": "link", "length_m": LENGTH, "diameter_m": DIAMETER, "density_kg_m3": DENSITY}
    joint = {"type": "hinge", "parent": "ground", "child": "b"}
    return {
        "model": {"name": "rod", "bodies": {"b": body}, "joints": {"j": joint}},
        "gravity_m_s2": 0,
        "drives": {"j": {"type": "torque", "torque_Nm": signal}},
        "solver": {"end_time_s": END, "rest_time_s": None, **solver},
        "output": {"figures": False},
    }


def rod_in_space(signal: Any, **solver: Any) -> dict[str, Any]:
    config = rod(signal, **solver)
    moments = {"xx": INERTIA, "yy": INERTIA, "zz": INERTIA}
    body = {"type": "rigid", "mass_kg": MASS, "inertia_kg_m2": moments, "shapes": []}
    return config | {"model": one_body("b", body, "j", "hinge", axis=[0, 0, 1])}


def sine(frequency: float) -> dict[str, Any]:
    return {"type": "sine", "amplitude": 1.0, "frequency_Hz": frequency}


def pulses(width: float, count: int = 2) -> dict[str, Any]:
    """Triangles of the impulse IMPULSE, between the first instants that steps of 1 ms end at."""
    times, values = [0.0], [0.0]
    for i in range(count):
        middle = (2.0 * i + 1.5) * 1e-3
        times += [middle - width, middle, middle + width]
        values += [0.0, IMPULSE / width, 0.0]
    return {"type": "table", "time_s": times, "values": values, "interpolation": "linear"}


def turned(results: Results) -> float:
    return math.radians(results["j_angle_deg"][-1])


def test_shortest_period_of_every_signal() -> None:
    assert shortest_period(Sine(2.0, 2.0 * np.pi * 50.0, 0.3, 1.0), 1.0) == pytest.approx(0.02)
    assert shortest_period(Sine(0.0, 2.0 * np.pi * 50.0, 0.3, 1.0), 1.0) == math.inf
    assert shortest_period(Constant(3.0), 1.0) == shortest_period(Ramp(0.0, 1.0, 0.0, 1e-6), 1.0) == math.inf
    assert shortest_period(Buehler(2.0, 1.0, 0.0, 0.7, 0.0, 0.1), 1.0) == pytest.approx(0.3)  # 2 swings of 0.15 s
    assert shortest_period(Buehler(2.0, 1.0, 0.0, 0.7, 0.0, 0.01), 1.0) == pytest.approx(0.08)  # 16 blends of 5 ms


@pytest.mark.parametrize("cubic", [True, False])
def test_shortest_period_of_tables(cubic: bool) -> None:
    """A sampled sine has the period of the sine, with noise too; a pulse alone four times its half width."""
    times = np.linspace(0.0, 1.0, 401)
    wave = np.cos(2.0 * np.pi * 10.0 * times)
    noise = 0.03 * (-1.0) ** np.arange(401)
    for values in (wave, wave + noise):
        assert shortest_period(piecewise(times, values, cubic), 1.0) == pytest.approx(0.1, rel=0.15)
    pulse = piecewise(np.array([0.0, 0.5, 0.501, 0.503, 0.504, 1.0]), np.array([0.0, 0.0, 1.0, 1.0, 0.0, 0.0]), cubic)
    assert shortest_period(pulse, 1.0) == pytest.approx(0.012)
    assert shortest_period(pulse, 0.5) == math.inf  # after the end
    assert shortest_period(piecewise(np.array([0.0, 1e-6]), np.array([0.0, 1.0]), cubic), 1.0) == math.inf


UNSEEN = {"sine": sine(1000), "two steps a period": sine(500), "pulses": pulses(2e-4)}


@pytest.mark.parametrize("made", [rod, rod_in_space])
@pytest.mark.parametrize("case", UNSEEN)
def test_drives_that_fixed_steps_cannot_resolve_are_refused(made: Any, case: str) -> None:
    with pytest.raises(SceneError, match=r"drives\.j\.torque_Nm: goes to and fro within .* solver\.accuracy"):
        simulate(made(UNSEEN[case], step_s=1e-3))


def test_poorly_sampled_drives_warn_and_well_sampled_drives_do_not() -> None:
    message = "the drive of j goes to and fro within"
    assert any(message in warning for warning in simulate(rod(sine(200), step_s=1e-3)).warnings)
    assert not any(message in warning for warning in simulate(rod(sine(50), step_s=1e-3)).warnings)


@pytest.mark.slow
@pytest.mark.parametrize(("method", "step"), [("minimal", None), ("engine", 5e-3), ("in space", None)])
def test_chosen_steps_resolve_every_pulse_of_a_drive(method: str, step: float | None) -> None:
    """Angle of a torque A sin(w t) from rest: A / (I w) (t - sin(w t) / w); of pulses: their impulses over I, each from
    its middle on.

    Passed by they leave nothing. Steps by the trapezoidal rule leave an impulse wrong by the accuracy asked for, 1e-3;
    where steps change in length, as in the first half period, by some of it more.
    """
    made, more = (rod_in_space, {}) if method == "in space" else (rod, {"method": method})
    solver: dict[str, Any] = {"accuracy": 1e-3} | ({} if step is None else {"step_s": step})
    rate = 2.0 * np.pi * 5000.0
    exact = (END - np.sin(rate * END) / rate) / (INERTIA * rate)
    assert turned(simulate(made(sine(5000), **solver) | more)) == pytest.approx(exact, rel=6e-3)
    exact = IMPULSE / INERTIA * sum(END - middle for middle in (1.5e-3, 3.5e-3))
    assert turned(simulate(made(pulses(1e-5), **solver) | more)) == pytest.approx(exact, rel=6e-3)


def test_a_csv_is_seen_as_the_table_in_it(tmp_path: Any) -> None:
    table = pulses(2e-4)
    rows = "\n".join(f"{t},{value}" for t, value in zip(table["time_s"], table["values"], strict=True))
    (tmp_path / "pulses.csv").write_text(f"time_s,torque\n{rows}\n", encoding="utf-8")
    file = {"type": "csv", "file": str(tmp_path / "pulses.csv"), "column": "torque", "interpolation": "linear"}
    with pytest.raises(SceneError, match="goes to and fro"):
        simulate(load(rod(file, step_s=1e-3)))
