"""Sections of links in space, their stiffness, and the elements of links that bend."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from granular_contact.config.schema import space as schema
from granular_contact.scene.space.types import Vector


@dataclass(frozen=True)
class Section:
    """Section of a link (m): round with a diameter, or rectangular with its width along y and its thickness along z."""

    diameter: float | None
    width: float
    thickness: float

    @property
    def area(self) -> float:
        """Area (m2)."""
        return self.width * self.thickness if self.diameter is None else math.pi / 4.0 * self.diameter**2

    @property
    def second_moments(self) -> Vector:
        """Second moments (2,) m4 about y and z."""
        w, t = self.width, self.thickness
        if self.diameter is not None:
            return np.full(2, math.pi / 64.0 * self.diameter**4)
        return np.array([w * t**3, t * w**3]) / 12.0

    @property
    def torsion_constant(self) -> float:
        """Torsion constant J (m4) of Saint-Venant, for a rectangle by the series of its warping function."""
        if self.diameter is not None:
            return math.pi / 32.0 * self.diameter**4
        a, b = max(self.width, self.thickness), min(self.width, self.thickness)
        odd = np.arange(1, 101, 2)
        series = float(np.sum(np.tanh(0.5 * np.pi * odd * a / b) / odd**5))
        return a * b**3 / 3.0 * (1.0 - 192.0 / np.pi**5 * b / a * series)


def section(link: schema.SpatialLink) -> Section:
    """Section of a link."""
    if link.diameter_m is not None:
        return Section(link.diameter_m, link.diameter_m, link.diameter_m)
    assert link.width_m is not None  # the schema requires a diameter, or width and thickness
    assert link.thickness_m is not None
    return Section(None, link.width_m, link.thickness_m)


def stiffness(link: schema.SpatialLink) -> Vector:
    """G J, E I_y and E I_z (3,) N m2 of a link that bends."""
    flexible, cross_section = link.flexible, section(link)
    assert flexible is not None
    moments = cross_section.second_moments
    bending = moments * (flexible.youngs_modulus_Pa or 0.0)
    if flexible.bending_stiffness_N_m2 is not None:
        bending = np.full(2, flexible.bending_stiffness_N_m2)
    torsion = flexible.torsion_stiffness_N_m2
    if torsion is None:
        torsion = bending[0] / moments[0] / (2.0 * (1.0 + flexible.poissons_ratio)) * cross_section.torsion_constant
    return np.array([torsion, *bending])


@dataclass(frozen=True)
class Element:
    """Rigid piece of a link from start to end (m) along it, in the frame of the link.

    share: its length relative to the length of an element of the link: 0.5 at the ends of the link, else 1.
    """

    link: schema.SpatialLink
    start: float
    end: float
    share: float = 1.0

    @property
    def density_kg_m3(self) -> float:
        """Density (kg/m3) of the link."""
        return self.link.density_kg_m3

    @property
    def ends(self) -> tuple[bool, bool]:
        """Whether the element contains the root of the link, and whether it contains the tip."""
        return self.start == 0.0, self.end == self.link.length_m
