"""Strains and von Mises stresses at the surface of flexible links, from their motion.

In bending and stretching the strain at the surface is |eps| + c |kappa|, with the distance c of the surface from the
axis; for a rectangular section in space c |kappa| is c_y |kappa_z| + c_z |kappa_y|. Torsion adds the shear stress
tau = G r kappa_x; r: radius, or the smaller side of a rectangle, which is right for a thin strip and a third too large
for a square. The stress is sqrt((E eps)^2 + 3 tau^2), as if both were greatest at the same point.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from granular_contact.results import series
from granular_contact.scene.types import Vector


@dataclass(frozen=True)
class Strains:
    """Strain and stress (Pa) of a link, (n, k) each, at n instants and places (k,) m from its root.

    yield_stress (Pa): None where none is given.
    """

    places: Vector
    strain: Vector
    stress: Vector
    yield_stress: float | None

    def columns(self, name: str) -> series.Series:
        """Columns of the strain at the root and the greatest strain along the link."""
        return {
            f"{name}_root_strain": (f"strain at the skin of {name} at its root", self.strain[:, 0]),
            f"{name}_strain": (f"greatest strain at the skin along {name}", self.strain.max(axis=1)),
        }

    def numbers(self, time: Vector) -> dict[str, float | None]:
        """Greatest strain and stress, place (m from the root) and time (s) of the latter, and both at the root."""
        instant, place = np.unravel_index(int(self.stress.argmax()), self.stress.shape)
        return {
            "strain": float(self.strain.max()),
            "stress_Pa": float(self.stress[instant, place]),
            "place_m": float(self.places[place]),
            "time_s": float(time[instant]),
            "root_strain": float(self.strain[:, 0].max()),
            "root_stress_Pa": float(self.stress[:, 0].max()),
            "yield_stress_Pa": self.yield_stress,
        }


def stress_numbers(strains: dict[str, Strains], time: Vector) -> dict[str, Any]:
    """Numbers of the summary: extremes of each flexible link."""
    return {"links": {name: strain.numbers(time) for name, strain in strains.items()}} if strains else {}


def yielding(strains: dict[str, Strains], time: Vector) -> list[str]:
    """Sentences on links whose stress exceeds the yield stress of their material."""
    sentences = []
    for name, strain in strains.items():
        extremes = strain.numbers(time)
        stress, limit = extremes["stress_Pa"], strain.yield_stress
        if limit is not None and stress is not None and stress > limit:
            place = f"{extremes['place_m']:.3g} m from its root" if extremes["place_m"] else "at its root"
            where = f"{place} at {extremes['time_s']:.3g} s"
            text = f"the stress of {name} comes to {stress:.3g} Pa, {where}, above its yield_stress_Pa, {limit:.3g}"
            sentences.append(f"{text}: it would stay bent, which is not computed")
    return sentences
