"""A law in plain Python -> functions that kernels call in space; as `joining`, loaded for models in space alone.

A law of surfaces needs only its planar `stress`, see `slices`. Instead it may have `facet_stress` or `facet_traction`
for any direction, `facet_inertia` as a second term beside a stress, or `facet_force` for all terms. Laws of bars have
`bar_force` and, for free end faces, `bar_cap`; laws of balls have `space_ball_force`.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from granular_contact.jit.chosen import provide
from granular_contact.sand.kernels import bars, facet_blocks, facet_paths, facets, slices, space_balls, space_law
from granular_contact.sand.kernels.facet_parts import between
from granular_contact.sand.kernels.facet_slopes import facet_slopes
from granular_contact.sand.kernels.ground import tangent_plane
from granular_contact.sand.kernels.joining import PARTS, let_call_others, record_type
from granular_contact.sand.kernels.space_bodies import body_forces
from granular_contact.sand.kernels.space_coordinates import by_six
from granular_contact.sand.kernels.space_friction import component_return_mapping, vector_return_mapping
from granular_contact.sand.kernels.space_tangents import by_differences, by_elements

# Kinds of elements, each with the kernels of its clusters (forces, end of a step).
KINDS: dict[str, tuple[Any, Any]] = {
    "surface": (facets.facet_forces, facets.follow_facets),
    "bar": (bars.bar_forces, bars.follow_stations),
    "ball": (space_balls.space_ball_forces, space_balls.follow_ball),
}
METHODS = {"bar": {"bar_force": "bar", "bar_cap": "cap"}, "ball": {"space_ball_force": "ball"}, "surface": {}}

NEEDED = {
    "surface": ("stress", "facet_stress", "facet_traction", "facet_force"),
    "bar": ("bar_force",),
    "ball": ("space_ball_force",),
}


def kinds_of(law: type) -> set[str]:
    """Kinds of elements in space on which a law acts: surface, bar, ball."""
    return {kind for kind, names in NEEDED.items() if any(hasattr(law, name) for name in names)}


def owner_of(law: type) -> type:
    """First class, of a law and its base classes, that defines functions or constants for kernels (`PARTS`)."""
    return next(base for base in law.__mro__ if PARTS & vars(base).keys())


def space_record(
    owner: Any,
    own: NDArray[np.void],
    kind: str,
    layer: tuple[float, float] | None = None,
    *,
    paths: bool = False,
    heights: bool = False,
    bodies: bool = False,
    six: bool = False,
) -> NDArray[np.void]:
    """Record (1,) of `space_law.SPACE_LAW` for a law and a kind of elements.

    own: the law's record (1,); layer: depths (m) of top and bottom of the medium, None if it fills the bed; paths:
    whether paths of facets are counted; heights: whether the bed has a map of heights; bodies: whether elements are on
    bodies that `space_bodies` moves by their coordinates; six: whether some bodies have six coordinates.
    """
    forces, follow = KINDS[kind]
    functions = {"forces": forces, "follow": follow, **_functions(owner, kind)}
    if paths:
        functions |= {"note": facet_paths.note, "count": facet_paths.count, "begin": facet_paths.begin}
    if heights:
        functions["heights"] = tangent_plane
    if bodies and kind == "surface":
        functions |= {"body": body_forces, "tangent": by_elements, "slopes": facet_slopes}
    elif bodies:
        functions |= {"body": body_forces, "tangent": by_differences}
    if six:
        functions["six"] = by_six
    if layer is not None and kind == "surface":
        functions["layer"] = between
    medium = space_law.record_of(own, functions)
    if layer is not None:
        medium["layered"], medium["top"], medium["bottom"] = 1, *layer
    return medium


@cache
def _functions(owner: Any, kind: str) -> dict[str, Any]:
    """Functions of a law for elements of a kind, by their names in the record."""
    dtype = record_type(owner)
    functions: dict[str, Any] = {"anchor": component_return_mapping if owner.by_component else vector_return_mapping}
    if kind == "surface":
        functions["gather"], functions["facets"] = facets.gather, _traction_function(owner, dtype)
        if not hasattr(owner, "facet_force"):
            functions["lead"] = facet_blocks.lead
    for method, name in METHODS[kind].items():
        if hasattr(owner, method):
            functions[name] = getattr(owner, method)
            let_call_others(functions[name])
    return functions


def _traction_function(owner: Any, dtype: np.dtype) -> Any:
    """Function that fills in the tractions of a block, by the functions that a law has."""
    if hasattr(owner, "facet_force"):
        let_call_others(owner.facet_force)
        provide(facet_blocks.force, dtype, owner.facet_force)
        return facet_blocks.own_facets
    if hasattr(owner, "facet_traction"):
        let_call_others(owner.facet_traction)
        provide(facet_blocks.traction, dtype, owner.facet_traction)
        return facet_blocks.traction_facets
    stress = getattr(owner, "facet_stress", slices.slice_stress)
    let_call_others(stress, inline=True)
    provide(facet_blocks.stress, dtype, stress, inline=True)
    if not hasattr(owner, "facet_inertia"):
        return facet_blocks.static_facets
    let_call_others(owner.facet_inertia)
    provide(facet_blocks.inertia, dtype, owner.facet_inertia)
    return facet_blocks.inertial_facets
