"""A law of your own for thin bars, a drag c z v d per length: the bar of a sled sinks into the sand."""

from __future__ import annotations

from typing import Literal

import numpy as np
from common import panels, save
from pydantic import Field

from granular_contact import Law, simulate

GAUSS = 1.0 / np.sqrt(3.0)  # of two points, which integrate the force exactly: depth and velocity vary linearly


class Viscous(Law):
    """Drag on a thin bar in proportion to depth and velocity."""

    law: Literal["example_viscous"]
    drag: float = Field(alias="drag_N_s_m4", ge=0)
    equation = "F = -c z d v per length"
    terms = ("drag",)
    takes = frozenset({"round"})
    constants = ("c",)

    def numbers(self, _: float) -> dict[str, float]:
        """Constants of the law at a gravity (m/s2)."""
        return {"c": self.drag}

    @staticmethod
    def strip_force(strip, line, m, f):
        """Add the forces on the ends of a strip, of which the part from a to b is in the medium, to f."""
        a, b, v0, v1 = strip.a, strip.b, strip.v0, strip.v1
        for sign in (-1.0, 1.0):
            s = 0.5 * (a + b) + sign * GAUSS * 0.5 * (b - a)
            z, length = (1.0 - s) * strip.z0 + s * strip.z1, 0.5 * (b - a) * np.hypot(*strip.c)
            for i in range(2):
                force = m.c * line.width * z * length * ((1.0 - s) * v0[i] + s * v1[i])
                f[0, 0, i] -= (1.0 - s) * force
                f[0, 1, i] -= s * force


DRAG, LENGTH, DIAMETER, DENSITY, SPEED = 2e5, 0.2, 0.01, 7800, 0.5  # N s/m4, m, m, kg/m3, m/s
run = {
    "model": {
        "name": "sled",
        "bodies": {"bar": {"type": "link", "length_m": LENGTH, "diameter_m": DIAMETER, "density_kg_m3": DENSITY}},
        "joints": {"rail": {"type": "slider", "parent": "ground", "child": "bar", "axis": [0, 1]}},
    },
    "medium": {"law": "example_viscous", "drag_N_s_m4": DRAG},
    "bed": {"height_m": 0.0},
    "initial": {"joints": {"rail": {"speed_m_s": -SPEED}}},
    "solver": {"end_time_s": 0.3, "accuracy": 1e-3},
}
results = simulate(run, laws=[Viscous])
time, depth, speed = results["time_s"], -results["rail_position_m"], -results["rail_speed_m_s"]
mass = DENSITY * np.pi / 4 * DIAMETER**2 * LENGTH
# The impulse of the drag, c d L (integral of z dz/dt), is c d L z^2 / 2.
expected = np.sqrt(2.0 * mass * (SPEED + 9.81 * time - speed) / (DRAG * DIAMETER * LENGTH))
print(f"{1e3 * depth[-1]:.2f} mm deep after {time[-1]:.1f} s, by the balance of momentum {1e3 * expected[-1]:.2f}")

figure, axes = panels(1)
axes.plot(1e3 * time, 1e3 * depth, label="computed")
axes.plot(1e3 * time, 1e3 * expected, "--", label="balance of momentum")
axes.set(xlabel="time (ms)", ylabel="depth (mm)")
axes.legend()
save(figure)
