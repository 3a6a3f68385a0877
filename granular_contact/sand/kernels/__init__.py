"""Compiled code of the granular load: arrays in, arrays out.

laws in the plane   law, joining, forces         functions of a law, their compilation, record of a medium
                    signatures, own_law          arguments of these functions; errors of laws from outside the package
                    strips, bars, plates, balls  a law on a strip, a bar, a surface element, a ball
                    strip, vectors               a strip as laws see it; vectors as tuples
                    immersion, surface           integrals over the immersed part; height of the surface
                    bar_statics, tables, probe   static terms of bars; laws with many numbers; a law outside a run
friction state      friction, planar_friction, space_friction
                    scatter, path_length, wheels scatter of grains, shear displacement, the surface behind a wheel
any bed             proximity                    which lines and bodies may touch the surface, and when
a bed in the plane  planar_sand, batches, lines  all media; one medium; one contact line
                    kinematics, spatial          motion of stations with their bodies
a bed in space      space_law, space_joining     as `law` and `joining`
                    space_sand, space_bodies     all media; one medium, with all elements of rigid bodies
                    space_coordinates            rotations of bodies
                    space_clusters               bounds of depth and speed of clusters of elements
                    facet_records, facets, facet_blocks, facet_parts, slices, facet_paths, space_balls
                                                 elements; bars: in `bars`
                    space_tangents, facet_slopes tangents of the forces
                    ground                       the surface
                    space_watched                `space_sand` with the walls of a container
"""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from typing import Any

_HERE = Path(__file__).parent


def __getattr__(name: str) -> Any:
    """A module of kernels, loaded at its first use: laws name these modules, and are read without the compiler."""
    if not (_HERE / f"{name}.py").exists():
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return import_module(f"{__name__}.{name}")
