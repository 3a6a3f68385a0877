"""Rigid bodies from the merged mass properties of their shapes; flexible links with their stiffnesses."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from granular_contact.config import schema
from granular_contact.scene.layout import ZERO, Layout, point
from granular_contact.scene.parts import FlexibleLink, RigidBody, Shape
from granular_contact.scene.shapes import Mass, bar, build_shape, merged, section


def _parts(name: str, body: schema.Body, strips: int) -> list[tuple[Shape, Mass]]:
    """Shapes of a body in its own frame, each with its mass properties at a density of 1."""
    if isinstance(body, schema.Link):
        return [bar(name, ZERO, np.array([body.length_m, 0.0]), section(body))]
    return [build_shape(name, shape, strips) for shape in body.shapes]


def _mass(body: schema.Body, volumes: list[Mass]) -> Mass:
    """Mass properties of a body: those of the config, or of its shapes with its density.

    volumes: mass properties of the shapes at a density of 1.
    """
    if isinstance(body, schema.Rigid) and body.density_kg_m3 is None:
        assert body.mass_kg is not None  # the schema requires a density, or mass and inertia
        assert body.inertia_kg_m2 is not None
        center = ZERO if body.center_of_mass_m is None else point(body.center_of_mass_m)
        return Mass(body.mass_kg, center, body.inertia_kg_m2)
    density = body.density_kg_m3
    assert density is not None
    return merged(volume.of_density(density) for volume in volumes)


def mass_of(name: str, body: schema.Body) -> float:
    """Mass (kg) of a body."""
    parts = [] if not isinstance(body, schema.Link) and body.density_kg_m3 is None else _parts(name, body, 1)
    return _mass(body, [volume for _, volume in parts]).mass


def rigid_body(layout: Layout, group: list[str], strips: int) -> RigidBody:
    """Merge a group of welded bodies about their common centre of mass; strips: least number of chords of curves."""
    pose, bodies = layout.pose, layout.model.all_bodies
    parts = {name: _parts(name, bodies[name], strips) for name in group}
    masses = {name: _mass(bodies[name], [volume for _, volume in parts[name]]) for name in group}
    total = merged(replace(mass, center=pose[name].world(mass.center)) for name, mass in masses.items())
    first = pose[group[0]]
    motion = replace(first, position=total.center, velocity=first.speed_at(total.center))
    shapes = []
    for name in group:
        density = bodies[name].density_kg_m3
        for shape, volume in parts[name]:
            points = motion.local(pose[name].world(shape.points))
            mass = masses[name].mass if density is None else density * volume.mass
            wheel = shape.wheel
            if wheel is not None:
                wheel = replace(wheel, axle=motion.local(pose[name].world(wheel.axle)))
            free = layout.is_free(name, shape.points[-1])
            shapes.append(replace(shape, points=points, free=free, mass=mass, wheel=wheel))
    bound = layout.workspace_bounds[group[0]]
    workspace = replace(bound, point=motion.local(first.world(bound.point)))
    return RigidBody("+".join(group), total.mass, total.inertia, tuple(shapes), motion, workspace)


def flexible_links(layout: Layout) -> Iterator[FlexibleLink]:
    """Links that bend; stiffnesses that the config does not give are those of a homogeneous section."""
    for name, spec in layout.model.all_bodies.items():
        if not isinstance(spec, schema.Link) or spec.flexible is None:
            continue
        flexible = spec.flexible
        cut = section(spec)
        area, second_moment = cut.area, cut.area * cut.gyration_squared
        bending = flexible.bending_stiffness_N_m2
        if bending is None:
            assert flexible.youngs_modulus_Pa is not None  # the schema requires exactly one of the two
            bending = flexible.youngs_modulus_Pa * second_moment
        axial = flexible.axial_stiffness_N
        yield FlexibleLink(
            name=name,
            length=spec.length_m,
            kind=cut.kind,
            width=cut.width,
            thickness=cut.thickness,
            mass_per_length=spec.density_kg_m3 * area,
            bending_stiffness=bending,
            axial_stiffness=bending * area / second_moment if axial is None else axial,
            bending_damping=flexible.bending_damping_N_m2_s,
            axial_damping=flexible.axial_damping_N_s,
            elements=flexible.elements,
            motion=layout.pose[name],
            workspace=layout.workspace_bounds[name],
            free=layout.is_free(name, np.array([spec.length_m, 0.0])),
            modulus=bending / second_moment,
            yield_stress=flexible.yield_stress_Pa,
        )
