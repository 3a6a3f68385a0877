"""Record of a medium for kernels: its law, and its forces on lines of a kind."""

from __future__ import annotations

import numpy as np

from granular_contact.jit.compiled import part
from granular_contact.sand.kernels.balls import ball_forces
from granular_contact.sand.kernels.law import LAWS, OWN_LAWS, record_of
from granular_contact.sand.kernels.lines import accept, force
from granular_contact.sand.kernels.path_length import count_path, count_shear
from granular_contact.sand.kernels.scatter import scattered
from granular_contact.sand.kernels.spatial import spatial_scatter, spatial_stations
from granular_contact.sand.kernels.strips import distributed_forces, resultant_forces
from granular_contact.sand.kernels.wheels import lowering


@part
def line_forces(P, V, anchors, line, profile, medium, F, totals):
    """`law.forces` of strips, in the form that the line has."""
    if line.resultant:
        resultant_forces(P, V, anchors, line, profile, medium, F, totals)
    else:
        distributed_forces(P, V, anchors, line, profile, medium, F, totals)


def medium_record(
    own: np.ndarray,
    lines: np.ndarray | None = None,
    paths: bool = True,
    bodies: bool = True,
    spatial: bool = True,
) -> np.ndarray:
    """Record (1,) of `law.LAW` for a law's own record (1,), with the functions that its lines need.

    lines: their records, None for any lines; paths: whether path lengths of stations are counted; bodies: whether lines
    are on bodies, with whose coordinates `lines` moves them; spatial: whether some of these bodies are of `spatial`.

    Raises
    ------
    TypeError
        The law has no force in the plane; or see `law.record_of`.
    """

    def any_has(field: str) -> bool:
        return lines is None or bool(np.any(lines[field] > 0))

    if not {"ball_force", "strip_force"} & LAWS[own.dtype].keys():
        raise TypeError(f"the law {OWN_LAWS[own.dtype].__name__} has no force in the plane, such as a stress")
    if "ball_force" in LAWS[own.dtype]:
        functions = {"forces": ball_forces}
    else:
        functions = {"forces": line_forces if any_has("resultant") else distributed_forces}
        if paths:
            functions["count_shear"] = count_shear
        if any_has("scatter"):
            functions["scattered"] = scattered
        if any_has("behind"):
            functions["lowering"] = lowering
    if paths:
        functions["count_path"] = count_path
    if bodies:
        functions |= {"line_force": force, "line_accept": accept}
        if spatial:
            functions |= {"spatial_stations": spatial_stations, "spatial_scatter": spatial_scatter}
    return record_of(own, functions)
