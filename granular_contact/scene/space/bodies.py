"""Mass properties of shapes in space, merged into rigid bodies."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from granular_contact.config.schema import space as schema
from granular_contact.config.schema.space.shapes import SpatialMesh
from granular_contact.errors import Fault, SceneError, scene_fault
from granular_contact.sand.space.triangles import FACET_SIZE
from granular_contact.scene.space.layout import Pose
from granular_contact.scene.space.shapes import Mass, merged, moved, part_of
from granular_contact.scene.space.types import Part, SpatialRigidBody


@dataclass(frozen=True)
class Made:
    """A body of the config by itself, in its own frame: parts with their mass properties, and mass."""

    parts: list[Part]
    mass: Mass


def bodies_of(
    model: schema.SpatialModel, media: Collection[str], strips: int, faults: list[Fault], notes: list[Fault]
) -> dict[str, Made] | None:
    """All bodies by name; None, with faults, if one can't be made; notes on uncertain forces are appended, too.

    Arguments as of `shapes.part_of`.
    """
    found, before = {}, len(faults)
    for name, body in model.all_bodies.items():
        specs = (body,) if isinstance(body, schema.SpatialLink) else body.shapes
        parts, own = [], []
        for i, spec in enumerate(specs):
            key = f"model.bodies.{name}" + (f".shapes.{i}" if isinstance(body, schema.SpatialRigid) else "")
            place = f"{key}.file" if getattr(spec, "type", "") == "mesh" else key
            try:
                part, properties = part_of(name, spec, media, strips)
            except SceneError as error:
                keys = (f"{key}.facet_size_m" if one.key == FACET_SIZE else place for one in error.faults)
                told = [scene_fault(at, one.message) for at, one in zip(keys, error.faults, strict=True)]
                if _is_drawn_alone(body, spec):
                    notes += [replace(one, message=f"{one.message}; not in the sand, it is not drawn") for one in told]
                else:
                    faults += told
                continue
            parts.append(part)
            notes += [scene_fault(place, words) for words in part.notes]
            own.append(properties)
            if body.density_kg_m3 is not None and not properties.mass > 0.0:
                words = "a sheet without thickness_m has no mass, but its body has a density; give it a thickness"
                faults.append(scene_fault(key, words))
        if len(faults) == before:
            found[name] = _made(body, parts, own)
    return found if len(faults) == before else None


def _is_drawn_alone(body: schema.SpatialBody, spec: Any) -> bool:
    """Whether a mesh gives neither forces nor mass: a run can do without it."""
    return isinstance(spec, SpatialMesh) and not spec.in_sand and body.density_kg_m3 is None


def _made(body: schema.SpatialBody, parts: list[Part], own: list[Mass]) -> Made:
    """A body with its mass, as given or of its shapes; a ball knows its own mass."""
    if isinstance(body, schema.SpatialLink) or body.density_kg_m3 is not None:
        density = body.density_kg_m3
        assert density is not None
        masses = [one.of_density(density) for one in own]
        of_parts = [_with_mass(part, one.mass) for part, one in zip(parts, masses, strict=True)]
        return Made(of_parts, merged(masses))
    assert body.mass_kg is not None  # the schema takes a density, or both
    assert body.inertia_kg_m2 is not None
    j = body.inertia_kg_m2
    inertia = np.array([[j.xx, j.xy, j.xz], [j.xy, j.yy, j.yz], [j.xz, j.yz, j.zz]])
    center = np.array(body.center_of_mass_m or (0.0, 0.0, 0.0), float)
    return Made([_with_mass(part, body.mass_kg) for part in parts], Mass(body.mass_kg, center, inertia))


def _with_mass(part: Part, mass: float) -> Part:
    """A ball with its own mass, for laws that ask for it."""
    return replace(part, shape=replace(part.shape, mass=mass)) if "ball" in part.meets else part


def rigid_body(made: dict[str, Made], group: list[str], placed: Pose) -> SpatialRigidBody:
    """Merge a group of welded bodies; the frame has the axes of the first and its origin at their centre of mass."""
    whole = merged(made[name].mass.placed(placed[name].position, placed[name].rotation) for name in group)
    first = placed[group[0]]
    motion = replace(first, position=whole.center, velocity=first.speed_at(whole.center))
    R = motion.rotation
    parts = []
    for name in group:
        at, turn = motion.local(placed[name].position), R.T @ placed[name].rotation
        parts += [moved(part, at, turn) for part in made[name].parts]
    inertia = R.T @ whole.inertia @ R
    return SpatialRigidBody("+".join(group), whole.mass, 0.5 * (inertia + inertia.T), tuple(parts), motion)
