"""Granular load of a scene in space: its media and surface, and the elements of its parts."""

from __future__ import annotations

import numpy as np

from granular_contact.errors import scene_error
from granular_contact.sand.contact_lines import Body
from granular_contact.sand.space.load import SpatialLoad
from granular_contact.scene.space.types import Part, SpatialScene

# Facets grow with this power of the number of bodies of a mechanism in sand: the sum of the forces grows with that
# number, the sum of their independent errors with its root, and an error grows with the square of the facet size.
COUNT_POWER = 0.25


def load_from_scene(scene: SpatialScene) -> SpatialLoad:
    """Load of a scene that has a bed, still without elements.

    Parameters
    ----------
    scene : SpatialScene
        The scene.

    Raises
    ------
    SceneError
        A medium has an option that is for the plane only, or lacks a number that is needed in space.
    """
    bed = scene.bed
    assert bed is not None
    try:
        return SpatialLoad(
            bed.layers,
            bed.origin,
            slope=np.array([*bed.rise, 0.0]),
            gravity=scene.gravity,
            static=scene.static,
            end_cap=scene.load.end_cap,
            floor=bed.floor,
            heights=bed.heights,
            watch=bool(bed.walls),
        )
    except ValueError as error:
        raise scene_error("medium", str(error)) from None


def add_part(load: SpatialLoad, body: Body, part: Part, scene: SpatialScene, mass: float, share: float = 1.0) -> None:
    """Add a part of a body to a load.

    Parameters
    ----------
    load : SpatialLoad
        The load. It is changed.
    body : Body
        The body.
    part : Part
        The part.
    scene : SpatialScene
        The scene.
    mass : float
        Mass of the body (kg).
    share : float
        Factor of the size of its facets.

    Raises
    ------
    SceneError
        See `SpatialLoad.add_shape`.
    """
    share *= scene.facet_shares.get(body.name, 1.0)
    if part.facet_size is None:
        share *= scene.in_sand[scene.mechanisms[body.name]] ** COUNT_POWER
    load.add_shape(
        body,
        part.shape,
        part.position,
        part.rotation,
        facet_size=part.facet_size,
        accuracy=scene.solver.named,
        share=share,
        mass=mass,
    )
