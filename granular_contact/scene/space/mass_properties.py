"""Mass properties of shapes in space at a density of 1, each in its own frame, and of several shapes together."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from granular_contact.geometry import mesh, rotations
from granular_contact.geometry.rotations import vector_products
from granular_contact.scene.space.section import Element, Section
from granular_contact.scene.space.types import Vector


@dataclass(frozen=True)
class Mass:
    """Mass (kg), centre of mass (3,) m, inertia (3, 3) kg m2 about it; of a shape at a density of 1."""

    mass: float
    center: Vector
    inertia: Vector

    def placed(self, position: Vector, rotation: Vector) -> Mass:
        """The same in another frame, in which the present frame has a position (3,) m and a rotation (3, 3)."""
        center: Vector = position + rotation @ self.center
        return Mass(self.mass, center, rotation @ self.inertia @ rotation.T)

    def of_density(self, density: float) -> Mass:
        """Mass properties of the shape with a density (kg/m3)."""
        return Mass(density * self.mass, self.center, density * self.inertia)


def of_surface(corners: Vector) -> Mass:
    """Mass properties of the solid enclosed by triangles (n, 3, 3) m, from tetrahedra between these and one point."""
    origin = corners.reshape(-1, 3).mean(axis=0)
    a, b, c = np.moveaxis(corners - origin, 1, 0)
    volumes = np.einsum("ij,ij->i", a, vector_products(b, c)) / 6.0
    total = float(volumes.sum())
    corner_sum = a + b + c
    center = volumes @ corner_sum / (4.0 * total)
    second = sum(np.einsum("i,ij,ik->jk", volumes, p, p) for p in (a, b, c, corner_sum)) / (20.0 * total)
    return solid(total, origin + center, second - np.outer(center, center))


def of_sheet(sheet: Any, thickness: float) -> Mass:
    """Mass properties of a thin sheet of triangles with a thickness (m)."""
    corners = sheet.vertices[sheet.faces]
    areas = np.linalg.norm(mesh.areas(corners), axis=1)
    total = float(areas.sum())
    center = areas @ corners.mean(axis=1) / total
    arms = corners - center
    arm_sum = arms.sum(axis=1)
    second = np.einsum("i,inj,ink->jk", areas, arms, arms) + np.einsum("i,ij,ik->jk", areas, arm_sum, arm_sum)
    return solid(total * thickness, center, second / (12.0 * total) + np.eye(3) * thickness**2 / 36.0)


def of_cylinder(d: float, length: float) -> Mass:
    """Mass properties of a cylinder around the z axis with a diameter d and a length (m)."""
    second = np.diag([d * d / 16.0, d * d / 16.0, length * length / 12.0])
    return solid(math.pi / 4.0 * d * d * length, np.zeros(3), second)


def of_capsule(d: float, length: float) -> Mass:
    """Mass properties of a capsule around the z axis with a diameter d and a length between its two centres (m)."""
    cylinder, ends = math.pi / 4.0 * d * d * length, math.pi / 6.0 * d**3  # volumes
    r = 0.5 * d
    across = (cylinder * r * r / 4.0 + ends * r * r / 5.0) / (cylinder + ends)
    along = cylinder * length**2 / 12.0 + ends * (0.25 * length**2 + 0.375 * r * length + r * r / 5.0)
    return solid(cylinder + ends, np.zeros(3), np.diag([across, across, along / (cylinder + ends)]))


def of_arc(spec: Any) -> Mass:
    """Mass properties of a sheet along an arc of half angle h and radius R.

    Its centre of mass is R sin(h) / h away from the centre of the circle, on the bisector u.
    """
    start, end = math.radians(spec.from_deg), math.radians(spec.to_deg)
    half, middle, R, t = 0.5 * abs(end - start), 0.5 * (start + end), spec.radius_m, spec.thickness_m
    offset, excess = R * math.sin(half) / half, math.sin(2.0 * half) / (4.0 * half)  # excess: of mean cos^2 over 1/2
    u, v = (np.array([math.cos(a), 0.0, -math.sin(a)]) for a in (middle, middle + 0.5 * math.pi))
    second = (R * R * (0.5 + excess) - offset**2) * np.outer(u, u) + R * R * (0.5 - excess) * np.outer(v, v)
    second += t * t / 24.0 * (np.outer(u, u) + np.outer(v, v)) + np.diag([0.0, spec.width_m**2 / 12.0, 0.0])
    return solid(2.0 * half * R * t * spec.width_m, offset * u, second)


def of_line(line: Any) -> Mass:
    """Mass properties of a bar, as a row of cylinders between the points of its line."""
    pieces = []
    for a, b in pairwise(line.line):
        cylinder = of_cylinder(line.diameter, float(np.linalg.norm(b - a)))
        pieces.append(cylinder.placed(0.5 * (a + b), rotations.to_axis(b - a)))
    return merged(pieces)


def solid(volume: float, center: Vector, second: Vector) -> Mass:
    """Mass properties of a shape with a volume (m3), from second (3, 3) m2: the mean of r r^T about its centre."""
    return Mass(volume, center, volume * (np.trace(second) * np.eye(3) - second))


def merged(pieces: Iterable[Mass]) -> Mass:
    """Mass properties of several masses together, about their common centre of mass."""
    parts = list(pieces)
    mass = sum(part.mass for part in parts)
    center: Vector = sum((part.mass * part.center for part in parts), np.zeros(3)) / mass
    inertia = np.zeros((3, 3))
    for part in parts:
        arm = part.center - center
        inertia += part.inertia + part.mass * (float(arm @ arm) * np.eye(3) - np.outer(arm, arm))
    return Mass(mass, center, inertia)


def of_element(section: Section, element: Element) -> Mass:
    """Mass properties of an element of a link along the x axis, or of a whole link, with a section."""
    length, middle = element.end - element.start, np.array([0.5 * (element.start + element.end), 0.0, 0.0])
    about_y, about_z = section.second_moments / section.area
    return solid(section.area * length, middle, np.diag([length**2 / 12.0, about_z, about_y]))
