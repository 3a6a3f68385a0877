"""Schema of the bodies of a mechanism in space. The keys name SI units."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from granular_contact.config.schema.mechanism import Link, Rigid, modulus_faults
from granular_contact.config.schema.space.shapes import SpatialShape
from granular_contact.config.schema.space.turned import Point3
from granular_contact.values.strict import Faults, Listed, NotNegative, Positive, Strict, Tagged, by_type

MOST_ELEMENTS = 256
ROUND_OFF = 1e-6  # relative to the largest principal moment: rounding of numbers in files


class Inertia(Strict):
    """Entries of the inertia tensor (kg m2) about the centre of mass, along the axes of the body's frame.

    The entries off the diagonal are the negative products of inertia, as in the matrix: xy = -integral of x y dm.
    """

    xx: Positive
    """Moment of inertia about x."""
    yy: Positive
    """Moment of inertia about y."""
    zz: Positive
    """Moment of inertia about z."""
    xy: float = 0.0
    """Entry xy of the matrix."""
    xz: float = 0.0
    """Entry xz of the matrix."""
    yz: float = 0.0
    """Entry yz of the matrix."""

    def _faults(self) -> Faults:
        import numpy as np  # here, since reading a schema alone does without numpy

        low, middle, high = moments = np.linalg.eigvalsh(self.tensor).tolist()
        listed = ", ".join(f"{moment:.4g}" for moment in moments)
        if not low > 0.0:
            yield (), f"has the principal moments {listed}; allowed are moments above 0"
        elif low + middle < high * (1.0 - ROUND_OFF):
            message = f"no body has the principal moments {listed}: the greatest is at most the sum of the other two"
            yield (), message

    @property
    def tensor(self) -> list[list[float]]:
        """The inertia matrix, row by row."""
        return [[self.xx, self.xy, self.xz], [self.xy, self.yy, self.yz], [self.xz, self.yz, self.zz]]


class SpatialRigid(Rigid):
    """A rigid body. Its mass follows from its shapes and a density, or is given; then shapes only meet the medium."""

    inertia_kg_m2: Inertia | None = None  # type: ignore[assignment]
    """Inertia tensor about the centre of mass, along the axes of the body's frame; if no density is given."""
    center_of_mass_m: Point3 | None = None  # type: ignore[assignment]
    """Centre of mass, x, y and z in the frame of the body. null: the origin of the frame, or with a density the
    centroid of the shapes."""
    shapes: Annotated[tuple[SpatialShape, ...], Listed] = ()  # type: ignore[assignment]


class SpatialFlexible(Strict):
    """Elasticity of a link: in bending about both axes of its cross-section, in torsion, and optionally in stretch.

    Give Young's modulus, or for a round link the bending stiffness.
    """

    bending_stiffness_N_m2: Positive | None = None
    """Bending stiffness E I of a round cross-section. Give this or youngs_modulus_Pa."""
    youngs_modulus_Pa: Positive | None = None
    """Young's modulus E; the bending stiffness follows from the cross-section."""
    torsion_stiffness_N_m2: Positive | None = None
    """Torsional stiffness G J. null: it follows from Young's modulus and poissons_ratio."""
    poissons_ratio: Annotated[float, Field(gt=-1.0, le=0.5)] = 0.3
    """Poisson's ratio, for the torsional stiffness."""
    axial_stiffness_N: Positive | None = None
    """Axial stiffness E A. null: the link keeps its length. This is a good approximation except for rubber, and for
    links that are held at both ends."""
    elements: Annotated[int, Field(ge=1, le=MOST_ELEMENTS)] = 8
    """Number of elements along the link."""
    bending_damping_N_m2_s: NotNegative = 0.0
    """Internal damping: bending moment per rate of curvature, about both axes."""
    torsion_damping_N_m2_s: NotNegative = 0.0
    """Internal damping: torque per rate of twist."""
    axial_damping_N_s: NotNegative = 0.0
    """Internal damping: axial force per rate of strain; needs axial_stiffness_N."""
    yield_stress_Pa: Positive | None = None
    """Yield stress: a run with a larger stress warns that the material stays bent. null: no check."""

    def _faults(self) -> Faults:
        yield from modulus_faults(self.bending_stiffness_N_m2, self.youngs_modulus_Pa)
        if self.axial_damping_N_s > 0.0 and self.axial_stiffness_N is None:
            yield ("axial_damping_N_s",), "damps a link that keeps its length: give axial_stiffness_N as well"


class SpatialLink(Link):
    """A straight uniform bar along the x axis of its frame, from its root at the origin to its tip at x = length."""

    width_m: Positive | None = None
    """Width of a rectangular cross-section, along y of the link."""
    thickness_m: Positive | None = None
    """Thickness of a rectangular cross-section, along z of the link."""
    flexible: SpatialFlexible | None = None  # type: ignore[assignment]
    facet_size_m: Positive | None = None
    """Longest edge of the facets on which laws of surfaces act. null: chosen by the estimated error of the motion; for
    a flexible link a quarter of an element, or the smaller side of the cross-section if that is larger."""

    def _faults(self) -> Faults:
        yield from super()._faults()
        if self.width_m is not None and self.flexible is not None and self.flexible.bending_stiffness_N_m2 is not None:
            message = "stands beside width_m; a rectangular section has two of them: allowed is youngs_modulus_Pa"
            yield ("flexible", "bending_stiffness_N_m2"), message


BODIES = by_type(SpatialRigid, SpatialLink)
SpatialBody = Annotated[SpatialRigid | SpatialLink, Tagged("type", BODIES)]
