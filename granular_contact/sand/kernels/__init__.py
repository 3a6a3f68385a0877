"""Compiled code of the granular load: arrays in, arrays out.

laws in the plane   law, joining, forces         what a law provides, how it is compiled, what a medium asks for
                    signatures, own_law          arguments of its functions; why one from outside can't be compiled
                    strips, bars, plates, balls  a law on a strip, a bar, a surface element, a ball
                    strip, vectors               what a law is told of a strip; vectors as tuples
                    immersion, surface           integrals over what is immersed; height of the surface
                    bar_statics, tables, probe   static terms of bars; laws with many numbers; a law outside a run
friction state      friction, planar_friction, space_friction
                    scatter, path_length, wheels scatter of grains, shear displacement, the surface behind a wheel
any bed             proximity                    what may touch the surface, and when
a bed in the plane  planar_sand, batches, lines  all media; one; one contact line
                    kinematics, spatial          how bodies move stations
a bed in space      space_law, space_joining     as `law` and `joining`
                    space_sand, space_bodies     all media; one, with rigid bodies and all elements on them
                    space_coordinates            rotations of bodies
                    space_clusters               how deep clusters of elements are
                    facet_records, facets, facet_blocks, facet_parts, slices, facet_paths, space_balls
                                                 elements; bars: in `bars`
                    space_tangents, facet_slopes how forces follow the motion
                    ground                       the surface
                    space_watched                `space_sand` with the walls of a container
"""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from typing import Any

_HERE = Path(__file__).parent


def __getattr__(name: str) -> Any:
    """A module of kernels, loaded when first asked for: laws name them, and are read without the compiler."""
    if not (_HERE / f"{name}.py").exists():
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return import_module(f"{__name__}.{name}")
