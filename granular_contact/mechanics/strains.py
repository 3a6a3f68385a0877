"""Strains and stresses on the skin of links that bend, from their motion.

In bending and stretch the strain at the skin is |eps| + c |kappa|, with c the distance of the skin from the axis; of a
rectangular section in space c |kappa| is c_y |kappa_z| + c_z |kappa_y|. Torsion adds a shear stress
tau = G r kappa_x, with r the radius, or of a rectangle its smaller side: right for a thin strip, a third too large for
a square. The stress is that of von Mises, sqrt((E eps)^2 + 3 tau^2), as if both were greatest at the same place.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from granular_contact.results import series
from granular_contact.scene.types import Vector


@dataclass(frozen=True)
class Strains:
    """Of a link over the instants (n,): places (k,) m along it, the root first, strain and stress (Pa) there (n, k).

    yield_stress (Pa): None where it is not looked at.
    """

    places: Vector
    strain: Vector
    stress: Vector
    yield_stress: float | None

    def columns(self, name: str) -> series.Series:
        """Strain at the root and the greatest along the link."""
        return {
            f"{name}_root_strain": (f"strain at the skin of {name} at its root", self.strain[:, 0]),
            f"{name}_strain": (f"greatest strain at the skin along {name}", self.strain.max(axis=1)),
        }

    def numbers(self, time: Vector) -> dict[str, float | None]:
        """Greatest strain and stress, where (m from the root) and when (s) this is, and those at the root."""
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
    """For the summary: what of each link that bends is greatest."""
    return {"links": {name: one.numbers(time) for name, one in strains.items()}} if strains else {}


def yielding(strains: dict[str, Strains], time: Vector) -> list[str]:
    """Sentences on links whose stress passes that at which their material yields."""
    found = []
    for name, one in strains.items():
        most = one.numbers(time)
        stress, limit = most["stress_Pa"], one.yield_stress
        if limit is not None and stress is not None and stress > limit:
            place = f"{most['place_m']:.3g} m from its root" if most["place_m"] else "at its root"
            where = f"{place} at {most['time_s']:.3g} s"
            words = f"the stress of {name} comes to {stress:.3g} Pa, {where}, above its yield_stress_Pa, {limit:.3g}"
            found.append(f"{words}: it would stay bent, which is not computed")
    return found
