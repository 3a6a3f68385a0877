"""What kernels take for a medium: its law, and how it acts on lines of a kind."""

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
    """`law.forces` in the form that the line asks for."""
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
    """Record (1,) of `law.LAW` for a law's own record (1,), with what its lines ask for.

    lines: their records, None of any; paths: whether path lengths of stations are counted; bodies: whether lines are on
    bodies, by whose coordinates `lines` moves them; spatial: whether on some of `spatial`, too.

    Raises
    ------
    TypeError
        The law has no force in the plane; further as of `law.record_of`.
    """

    def asked(field: str) -> bool:
        return lines is None or bool(np.any(lines[field] > 0))

    if not {"ball_force", "strip_force"} & LAWS[own.dtype].keys():
        raise TypeError(f"the law {OWN_LAWS[own.dtype].__name__} has no force in the plane, such as a stress")
    if "ball_force" in LAWS[own.dtype]:
        found = {"forces": ball_forces}
    else:
        found = {"forces": line_forces if asked("resultant") else distributed_forces}
        if paths:
            found["count_shear"] = count_shear
        if asked("scatter"):
            found["scattered"] = scattered
        if asked("behind"):
            found["lowering"] = lowering
    if paths:
        found["count_path"] = count_path
    if bodies:
        found |= {"line_force": force, "line_accept": accept}
        if spatial:
            found |= {"spatial_stations": spatial_stations, "spatial_scatter": spatial_scatter}
    return record_of(own, found)
