"""Mass properties of shapes, merged into rigid bodies; flexible links with their stiffnesses."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from granular_contact.config import schema
from granular_contact.scene.layout import ZERO, Frame, Layout, point
from granular_contact.scene.types import Cylinder, Disc, FlexibleLink, RigidBody, Tether, Vector


@dataclass(frozen=True)
class _Lump:
    """Mass (kg), centre (2,) m in the body's frame and inertia about it (kg m2) of one shape."""

    mass: float
    center: Vector
    inertia: float


def _shapes(name: str, body: schema.Body) -> Iterator[tuple[Cylinder | Disc, _Lump]]:
    """Shapes of a rigid body in its own frame with their mass properties."""
    if isinstance(body, schema.Link):
        yield _bar(name, ZERO, np.array([body.length_m, 0.0]), body.diameter_m, body.density_kg_m3)
        return
    for shape in body.shapes:
        if isinstance(shape, schema.DiscShape):
            mass = body.density_kg_m3 * math.pi / 4 * shape.diameter_m**2 * shape.thickness_m
            center = point(shape.center_m)
            yield Disc(name, center, shape.diameter_m), _Lump(mass, center, mass * shape.diameter_m**2 / 8)
        else:
            yield _bar(name, point(shape.start_m), point(shape.end_m), shape.diameter_m, body.density_kg_m3)


def _bar(name: str, start: Vector, end: Vector, diameter: float, density: float) -> tuple[Cylinder, _Lump]:
    length = float(np.linalg.norm(end - start))
    mass = density * math.pi / 4 * diameter**2 * length
    lump = _Lump(mass, (start + end) / 2, mass * (length**2 / 12 + diameter**2 / 16))
    return Cylinder(name, start, end, diameter), lump


def rigid_body(layout: Layout, group: list[str]) -> RigidBody:
    """Merge a group of welded bodies about their common centre of mass."""
    frames = layout.frames
    shapes = [(frames[n], shape, lump) for n in group for shape, lump in _shapes(n, layout.model.all_bodies[n])]
    mass = sum(lump.mass for _, _, lump in shapes)
    center: Vector = sum((lump.mass * frame.world(lump.center) for frame, _, lump in shapes), ZERO) / mass
    inertia = sum(
        lump.inertia + lump.mass * float(np.sum((frame.world(lump.center) - center) ** 2)) for frame, _, lump in shapes
    )
    own = Frame(center, frames[group[0]].angle)
    cylinders, discs = [], []
    for frame, shape, _ in shapes:
        if isinstance(shape, Disc):
            discs.append(replace(shape, center=own.local(frame.world(shape.center))))
        else:
            start, end = own.local(frame.world(shape.start)), own.local(frame.world(shape.end))
            cylinders.append(replace(shape, start=start, end=end, free=layout.is_free(shape.part, shape.end)))
    root = layout.tethers[group[0]]
    tether = Tether(own.local(frames[group[0]].world(root.point)), root.length)
    return RigidBody(
        "+".join(group), mass, inertia, tuple(cylinders), tuple(discs), layout.motion(group[0], own), tether
    )


def flexible_links(layout: Layout) -> Iterator[FlexibleLink]:
    """Links that bend, with stiffnesses of a round section of one modulus where they are not given."""
    for name, spec in layout.model.all_bodies.items():
        if not isinstance(spec, schema.Link) or spec.flexible is None:
            continue
        flexible = spec.flexible
        area = math.pi / 4 * spec.diameter_m**2
        second_moment = math.pi / 64 * spec.diameter_m**4
        bending = flexible.bending_stiffness_N_m2
        if bending is None:
            assert flexible.youngs_modulus_Pa is not None  # the schema takes exactly one of the two
            bending = flexible.youngs_modulus_Pa * second_moment
        axial = flexible.axial_stiffness_N
        yield FlexibleLink(
            name=name,
            length=spec.length_m,
            diameter=spec.diameter_m,
            mass_per_length=spec.density_kg_m3 * area,
            bending_stiffness=bending,
            axial_stiffness=bending * area / second_moment if axial is None else axial,
            bending_damping=flexible.bending_damping_N_m2_s,
            axial_damping=flexible.axial_damping_N_s,
            elements=flexible.elements,
            motion=layout.motion(name, layout.frames[name]),
            tether=layout.tethers[name],
            free=layout.is_free(name, np.array([spec.length_m, 0.0])),
        )
