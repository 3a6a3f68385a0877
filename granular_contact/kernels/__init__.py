"""Compiled code: arrays in, arrays out.

laws in the plane   law, joining, forces         what a law provides, how it is compiled, what a medium asks for
                    signatures, own_law          arguments of its functions; why one from outside can't be compiled
                    strips, bars, plates, balls  a law on a strip, a bar, a surface element, a ball
                    immersion, surface           integrals over what is immersed; height of the surface
                    bar_statics, tables, probe   static terms of bars; laws with many numbers; a law outside a run
friction state      friction, planar_friction, space_friction
                    scatter, path_length, wheels scatter of grains, shear displacement, the surface behind a wheel
a bed in the plane  planar_sand, batches, lines  all media; one; one contact line
                    kinematics, spatial          how bodies move stations
                    departure                    how far a motion departs from one that is known, with other strips
a bed in space      space_law, space_joining     as `law` and `joining`
                    space_bodies                 rigid bodies with all elements on them
                    facets, slices, facet_layers, facet_paths, space_balls    the elements; bars are in `bars`
                    ground, space_reach          the surface; the walls of a container
joints              joint_coordinates, joint_laws, joint_loads, space_joints
the solve           iterations, anderson, line_search    Newton's method
                    step_error, step_choice              choice of steps
implicit forces     added_mass, planar_added_mass, space_added_mass, floor_added_mass, facets_added_mass, held_step
reduced model       modal, modal_motion, modal_load, modal_calls, pendulum, slip, events    its equations
                    runge_kutta, march, modal_looks                                 its steps, and what is found in them
trees               tree_arrays, tree, tree_load         its equations
                    tree_newton, tree_march, tree_calls  its steps
                    signal_tables                        of drives
how it is compiled  compiled, compiling, loaded
                    records, calls, lending, memory    record types; calls by address, arrays at addresses

numba keeps what it compiled beside the sources and takes it again while the file of the called function is unchanged;
it does not see that a function of another file, inlined into it, has changed. So what is older than any kernel or law
is dropped.
"""

from __future__ import annotations

from contextlib import suppress
from importlib import import_module
from pathlib import Path
from typing import Any

_HERE = Path(__file__).parent


def _drop_stale_cache(*folders: Path) -> None:
    newest = max(source.stat().st_mtime for folder in folders for source in folder.glob("*.py"))
    for cached in (file for folder in folders for file in (folder / "__pycache__").glob("*.nb[ic]")):
        with suppress(OSError):  # another process was faster, or the folder is not ours to change
            if cached.stat().st_mtime < newest:
                cached.unlink()


_drop_stale_cache(_HERE, _HERE.parent / "laws")


def __getattr__(name: str) -> Any:
    """A module of kernels, loaded when first asked for: laws name them, and are read without the compiler."""
    if not (_HERE / f"{name}.py").exists():
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return import_module(f"{__name__}.{name}")
