"""What kernels take for a medium: its law, and the way in which it acts on lines of a kind."""

from __future__ import annotations

import numpy as np

from granular_contact.kernels.balls import ball_forces
from granular_contact.kernels.compiled import part
from granular_contact.kernels.law import LAWS, record_of
from granular_contact.kernels.strips import distributed_forces, resultant_forces


@part
def line_forces(P, V, anchors, line, profile, medium, F, totals):
    """`law.forces` in the form that the line asks for."""
    if line.resultant:
        resultant_forces(P, V, anchors, line, profile, medium, F, totals)
    else:
        distributed_forces(P, V, anchors, line, profile, medium, F, totals)


def medium_record(own: np.ndarray, resultant: bool = True) -> np.ndarray:
    """Record (1,) of `law.LAW` for a law's own record (1,); resultant: whether lines may ask for that form."""
    forces = line_forces if resultant else distributed_forces
    return record_of(own, ball_forces if "ball_force" in LAWS[own.dtype] else forces)
