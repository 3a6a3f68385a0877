"""Scene in space -> granular load: its media and surface, and what of its parts they meet."""

from __future__ import annotations

import numpy as np

from granular_contact.errors import scene_error
from granular_contact.sand.contact_lines import Body
from granular_contact.sand.space.load import SpatialLoad
from granular_contact.scene.space.types import Part, SpatialScene

# Power of the number of a mechanism's bodies in sand by which its facets are larger: the sum of forces grows with it,
# that of their errors, which are independent, with its root, and an error goes with the square of facets.
TOGETHER = 0.25


def load_from_scene(scene: SpatialScene) -> SpatialLoad:
    """The load of a scene with a bed, without anything on it yet.

    Raises
    ------
    SceneError
        A medium has what is for the plane alone.
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
    """Let the media act on a part of a body of a mass (kg); share: of the size of its facets, which is taken."""
    share *= scene.facet_shares.get(body.name, 1.0)
    if part.facet_size is None:
        share *= scene.in_sand[scene.mechanisms[body.name]] ** TOGETHER
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
