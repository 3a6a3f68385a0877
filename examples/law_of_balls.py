"""A law of your own for spheres, F = k (z / 1 m)^n: a faster steel ball sinks deeper."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
from common import panels, save
from pydantic import Field

from granular_contact import Law, simulate
from granular_contact.sand import kernels


class Power(Law):
    """Force k (z / 1 m)^n on a sphere, against its motion."""

    law: Literal["example_power"]
    stiffness: float = Field(alias="stiffness_N", ge=0)
    exponent: float = Field(gt=0, le=5)
    equation = "F = k (z / 1 m)^n"
    terms = ("static",)
    takes = frozenset({"ball"})
    constants = ("k", "n")

    def numbers(self, _: float) -> dict[str, float]:
        """Constants of the law at a gravity (m/s2)."""
        return {"k": self.stiffness, "n": self.exponent}

    @staticmethod
    def ball_force(z, v, e, line, m, f):  # noqa: ARG004  # compiled: without types
        """Add the force at a depth z (m) to f."""
        u, share = kernels.planar_friction.mobilised(kernels.planar_friction.drive(e, v, m), m)
        f[0, 0] -= share * m.k * z**m.n * u[0]
        f[0, 1] -= share * m.k * z**m.n * u[1]


def drop(speed: float) -> Any:
    """A ball that meets the surface at a speed (m/s)."""
    shape = {"type": "sphere", "diameter_m": 0.02}
    ball = {"type": "rigid", "density_kg_m3": 7700, "shapes": [shape]}
    fall = {"type": "free", "parent": "ground", "child": "ball"}
    run = {
        "model": {"name": "ball", "bodies": {"ball": ball}, "joints": {"fall": fall}},
        "medium": {"law": "example_power", "stiffness_N": 400, "exponent": 1.6},
        "initial": {"joints": {"fall": {"vy_m_s": -speed}}},
    }
    return simulate(run, laws=[Power])


speeds = np.array([0.25, 0.5, 1.0])
drops = [drop(speed) for speed in speeds]
depths = np.array([one.summary["max_depth_m"] for one in drops])
# At the deepest point the work k z^(n+1) / (n+1) is m v^2 / 2 + m g z.
ball = 7700 * np.pi / 6 * 0.02**3
work, energy = 400 / 2.6 * depths**2.6, ball * (0.5 * speeds**2 + 9.81 * depths)
for speed, depth, ratio in zip(speeds, depths, work / energy, strict=True):
    print(f"{speed:.2f} m/s: {1e3 * depth:.1f} mm deep; work of the law over energy {ratio:.3f}")

figure, axes = panels(1)
for speed, one in zip(speeds, drops, strict=True):
    axes.plot(1e3 * one["time_s"], 1e3 * one["depth_m"], label=f"{speed:g} m/s")
axes.set(xlabel="time (ms)", ylabel="depth (mm)")
axes.legend()
save(figure)
