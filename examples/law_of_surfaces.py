"""A law of your own for surfaces, Winkler's p = k z: a foot let go at the surface sinks to twice its static depth."""

from __future__ import annotations

from typing import Literal

from common import panels, save
from pydantic import Field

from granular_contact import Law, simulate


class Winkler(Law):
    """Pressure k z on a surface, against the part of its motion that is along its normal."""

    law: Literal["example_winkler"]
    stiffness: float = Field(alias="stiffness_N_m3", ge=0)
    equation = "p = k z"
    terms = ("static",)
    takes = frozenset({"round", "flat", "outline"})
    constants = ("k",)

    def numbers(self, _: float) -> dict[str, float]:
        """Constants of the law at a gravity (m/s2)."""
        return {"k": self.stiffness}

    @staticmethod
    def stress(t, u, m):  # compiled: without types
        """Stress per depth (N/m3) on an element along t that moves along u, unit vectors."""
        nx, ny = -t[1], t[0]
        along = nx * u[0] + ny * u[1]
        return -m.k * along * nx, -m.k * along * ny


MASS, STIFFNESS, SIZE = 5.0, 2e5, [0.2, 0.1, 0.04]  # kg, N/m3, m
body = {
    "type": "rigid",
    "mass_kg": MASS,
    "inertia_kg_m2": {"xx": 0.01, "yy": 0.02, "zz": 0.02},
    "shapes": [{"type": "box", "size_m": SIZE}],
}
run = {
    "model": {
        "in_space": True,
        "name": "foot",
        "bodies": {"foot": body},
        "joints": {"fall": {"type": "free", "parent": "ground", "child": "foot"}},
    },
    "medium": {"law": "example_winkler", "stiffness_N_m3": STIFFNESS},
}
results = simulate(run, laws=[Winkler])
deepest = 2 * MASS * 9.81 / (STIFFNESS * SIZE[0] * SIZE[1])
print(f"depth {1e3 * results.summary['max_depth_m']:.1f} mm, 2 m g / (k A) = {1e3 * deepest:.1f} mm")

figure, axes = panels(1)
axes.plot(1e3 * results["time_s"], 1e3 * results["depth_m"])
axes.axhline(1e3 * deepest, color="0.6", linestyle="--")
axes.set(xlabel="time (ms)", ylabel="depth (mm)")
save(figure)
