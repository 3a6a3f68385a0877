"""A PID controller in Python presses a rod into the sand, and holds it at 40 degrees."""

from __future__ import annotations

from collections.abc import Mapping

from common import panels, save

from granular_contact import load, simulate

TARGET, RATE = 40.0, 1000.0  # deg, Hz
total = 0.0  # deg s


def pid(_: float, seen: Mapping[str, float]) -> dict[str, float]:
    """Torque of the hinge (N m) from what is measured."""
    global total
    error = TARGET - seen["pivot_angle_deg"]
    total += error / RATE
    return {"pivot_torque_Nm": 0.2 * error + 8 * total - 0.02 * seen["pivot_rate_rad_s"]}


hinge = {"drives": {"pivot": {"type": "external", "torque_Nm": 0, "range": [-2, 2]}}, "solver.end_time_s": 0.5}
results = simulate(load("pendulum_rigid").scenario.replace(hinge), control=pid, control_rate_Hz=RATE)
print(f"angle {results['pivot_angle_deg'][-1]:.2f} deg, held by {results['pivot_torque_Nm'][-1]:.3f} N m")

figure, (left, right) = panels(2)
left.plot(results["time_s"], results["pivot_angle_deg"])
left.axhline(TARGET, color="0.6", linestyle="--")
left.set(xlabel="time (s)", ylabel="angle (deg)")
right.plot(results["time_s"], results["pivot_torque_Nm"])
right.set(xlabel="time (s)", ylabel="torque (N m)")
save(figure)
