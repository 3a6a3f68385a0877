"""Schema of the bodies of a mechanism in space. SI units, named in the keys."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from granular_contact.config.schema.mechanism import Link, Rigid, modulus_faults
from granular_contact.config.schema.space.shapes import SpatialShape
from granular_contact.config.schema.space.turned import Point3
from granular_contact.values.strict import Faults, Listed, NotNegative, Positive, Strict, Tagged, by_type

MOST_ELEMENTS = 256
ROUND_OFF = 1e-6  # of the greatest moment of inertia: what files round away


class Inertia(Strict):
    """Inertia tensor (kg m2) about the centre of mass, along the axes of the body's frame: entries of its matrix."""

    xx: Positive
    yy: Positive
    zz: Positive
    xy: float = 0.0
    xz: float = 0.0
    yz: float = 0.0

    def _faults(self) -> Faults:
        import numpy as np  # not where only schemas are read

        low, middle, high = moments = np.linalg.eigvalsh(self.tensor).tolist()
        listed = ", ".join(f"{one:.4g}" for one in moments)
        if not low > 0.0:
            yield (), f"has the principal moments {listed}; allowed are moments above 0"
        elif low + middle < high * (1.0 - ROUND_OFF):
            words = f"no body has the principal moments {listed}: the greatest is at most the sum of the other two"
            yield (), words

    @property
    def tensor(self) -> list[list[float]]:
        """The matrix, row by row."""
        return [[self.xx, self.xy, self.xz], [self.xy, self.yy, self.yz], [self.xz, self.yz, self.zz]]


class SpatialRigid(Rigid):
    """A rigid body: shapes with a density, or a given mass and shapes for the medium only."""

    inertia_kg_m2: Inertia | None = None  # type: ignore[assignment]
    """About the centre of mass."""
    center_of_mass_m: Point3 | None = None  # type: ignore[assignment]
    shapes: Annotated[tuple[SpatialShape, ...], Listed] = ()  # type: ignore[assignment]


class SpatialFlexible(Strict):
    """Elasticity of a link, in bending about both axes of its section, in torsion, and along it if that is given.

    Give the bending stiffness, of a round link, or Young's modulus.
    """

    bending_stiffness_N_m2: Positive | None = None
    """E I of a round section; give this or youngs_modulus_Pa."""
    youngs_modulus_Pa: Positive | None = None
    torsion_stiffness_N_m2: Positive | None = None
    """G J; null: of the same material, with poissons_ratio."""
    poissons_ratio: Annotated[float, Field(gt=-1.0, le=0.5)] = 0.3
    axial_stiffness_N: Positive | None = None
    """E A; null: it keeps its length, as all but rubber and what is held at both ends nearly does."""
    elements: Annotated[int, Field(ge=1, le=MOST_ELEMENTS)] = 8
    bending_damping_N_m2_s: NotNegative = 0.0
    """Bending moment per rate of curvature, about both axes."""
    torsion_damping_N_m2_s: NotNegative = 0.0
    """Torque per rate of twist."""
    axial_damping_N_s: NotNegative = 0.0
    """Axial force per rate of strain, with axial_stiffness_N."""
    yield_stress_Pa: Positive | None = None
    """Stress above which the material stays bent: a run that passes it says so. null: not looked at."""

    def _faults(self) -> Faults:
        yield from modulus_faults(self.bending_stiffness_N_m2, self.youngs_modulus_Pa)
        if self.axial_damping_N_s > 0.0 and self.axial_stiffness_N is None:
            yield ("axial_damping_N_s",), "damps a link that keeps its length: give axial_stiffness_N as well"


class SpatialLink(Link):
    """A straight uniform bar along the x axis of its frame, from the root at the origin to the tip."""

    width_m: Positive | None = None
    """Along y."""
    thickness_m: Positive | None = None
    """Along z."""
    flexible: SpatialFlexible | None = None  # type: ignore[assignment]
    facet_size_m: Positive | None = None
    """Greatest edge of its facets, for laws of surfaces; null: by its error, of a link that bends a fourth
    of an element, or its thickness if that is more."""

    def _faults(self) -> Faults:
        yield from super()._faults()
        if self.width_m is not None and self.flexible is not None and self.flexible.bending_stiffness_N_m2 is not None:
            words = "stands beside width_m; a rectangular section has two of them: allowed is youngs_modulus_Pa"
            yield ("flexible", "bending_stiffness_N_m2"), words


BODIES = by_type(SpatialRigid, SpatialLink)
SpatialBody = Annotated[SpatialRigid | SpatialLink, Tagged("type", BODIES)]
