"""Mass, centre and inertia of shapes in space at a density of 1, each in its own frame; several as one."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from granular_contact.geometry import mesh, rotations
from granular_contact.scene.space.section import Element, Section
from granular_contact.scene.space.types import Vector


@dataclass(frozen=True)
class Mass:
    """Mass (kg), centre (3,) m, inertia about it (3, 3) kg m2; of a shape alone at a density of 1, so its volume."""

    mass: float
    center: Vector
    inertia: Vector

    def placed(self, position: Vector, rotation: Vector) -> Mass:
        """The same in a frame in which the present one lies at a position (3,) m, turned by (3, 3)."""
        center: Vector = position + rotation @ self.center
        return Mass(self.mass, center, rotation @ self.inertia @ rotation.T)

    def of_density(self, density: float) -> Mass:
        """That of a shape with a density (kg/m3)."""
        return Mass(density * self.mass, self.center, density * self.inertia)


def of_surface(corners: Vector) -> Mass:
    """Of the body that triangles (n, 3, 3) m enclose, from the tetrahedra that they form with their middle."""
    origin = corners.reshape(-1, 3).mean(axis=0)
    a, b, c = np.moveaxis(corners - origin, 1, 0)
    volumes = np.einsum("ij,ij->i", a, np.cross(b, c)) / 6.0
    total = float(volumes.sum())
    center = volumes @ (a + b + c) / (4.0 * total)
    whole = a + b + c
    second = sum(np.einsum("i,ij,ik->jk", volumes, p, p) for p in (a, b, c, whole)) / (20.0 * total)
    return solid(total, origin + center, second - np.outer(center, center))


def of_sheet(sheet: Any, thickness: float) -> Mass:
    """Of a sheet, from the mean of its triangles."""
    corners = sheet.vertices[sheet.faces]
    areas = np.linalg.norm(mesh.areas(corners), axis=1)
    total = float(areas.sum())
    center = areas @ corners.mean(axis=1) / total
    arms = corners - center
    whole = arms.sum(axis=1)
    second = np.einsum("i,inj,ink->jk", areas, arms, arms) + np.einsum("i,ij,ik->jk", areas, whole, whole)
    return solid(total * thickness, center, second / (12.0 * total) + np.eye(3) * thickness**2 / 36.0)


def of_cylinder(d: float, length: float) -> Mass:
    """Of a cylinder around the z axis, from its diameter and length (m)."""
    second = np.diag([d * d / 16.0, d * d / 16.0, length * length / 12.0])
    return solid(math.pi / 4.0 * d * d * length, np.zeros(3), second)


def of_capsule(d: float, length: float) -> Mass:
    """Of a capsule around the z axis, from its diameter and the length between its centres (m)."""
    tube, ends = math.pi / 4.0 * d * d * length, math.pi / 6.0 * d**3
    r = 0.5 * d
    across = (tube * r * r / 4.0 + ends * r * r / 5.0) / (tube + ends)
    along = tube * length**2 / 12.0 + ends * (0.25 * length**2 + 0.375 * r * length + r * r / 5.0)
    return solid(tube + ends, np.zeros(3), np.diag([across, across, along / (tube + ends)]))


def of_arc(spec: Any) -> Mass:
    """Of an arc of half angle h the centre of mass is R sin(h) / h from that of the circle, on the bisector."""
    start, end = math.radians(spec.from_deg), math.radians(spec.to_deg)
    half, middle, R, t = 0.5 * abs(end - start), 0.5 * (start + end), spec.radius_m, spec.thickness_m
    off, cut = R * math.sin(half) / half, math.sin(2.0 * half) / (4.0 * half)
    u, v = (np.array([math.cos(a), 0.0, -math.sin(a)]) for a in (middle, middle + 0.5 * math.pi))
    second = (R * R * (0.5 + cut) - off**2) * np.outer(u, u) + R * R * (0.5 - cut) * np.outer(v, v)
    second += t * t / 24.0 * (np.outer(u, u) + np.outer(v, v)) + np.diag([0.0, spec.width_m**2 / 12.0, 0.0])
    return solid(2.0 * half * R * t * spec.width_m, off * u, second)


def of_line(line: Any) -> Mass:
    """Of a bar, a row of cylinders."""
    pieces = []
    for a, b in pairwise(line.line):
        one = of_cylinder(line.diameter, float(np.linalg.norm(b - a)))
        pieces.append(one.placed(0.5 * (a + b), rotations.to_axis(b - a)))
    return merged(pieces)


def solid(volume: float, center: Vector, second: Vector) -> Mass:
    """Of a shape with a volume (m3), from the mean of r r^T about its centre (3, 3) m2."""
    return Mass(volume, center, volume * (np.trace(second) * np.eye(3) - second))


def merged(pieces: Iterable[Mass]) -> Mass:
    """Several masses as one, about their common centre."""
    parts = list(pieces)
    mass = sum(part.mass for part in parts)
    center: Vector = sum((part.mass * part.center for part in parts), np.zeros(3)) / mass
    inertia = np.zeros((3, 3))
    for part in parts:
        arm = part.center - center
        inertia += part.inertia + part.mass * (float(arm @ arm) * np.eye(3) - np.outer(arm, arm))
    return Mass(mass, center, inertia)


def of_bar(own: Section, element: Element) -> Mass:
    """Of an element of a link along the x axis, or of all of the link."""
    length, middle = element.end - element.start, np.array([0.5 * (element.start + element.end), 0.0, 0.0])
    about_y, about_z = own.second_moments / own.area
    return solid(own.area * length, middle, np.diag([length**2 / 12.0, about_z, about_y]))
