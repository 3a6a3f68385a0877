"""What kernels take for a medium: its law, and the way in which it acts on lines of a kind."""

from __future__ import annotations

import numpy as np

from granular_contact.kernels.balls import ball_forces
from granular_contact.kernels.compiled import part
from granular_contact.kernels.law import LAWS, record_of
from granular_contact.kernels.lines import force
from granular_contact.kernels.scatter import scattered
from granular_contact.kernels.strips import distributed_forces, resultant_forces
from granular_contact.kernels.ways import count_shear, count_way
from granular_contact.kernels.wheels import lowering


@part
def line_forces(P, V, anchors, line, profile, medium, F, totals):
    """`law.forces` in the form that the line asks for."""
    if line.resultant:
        resultant_forces(P, V, anchors, line, profile, medium, F, totals)
    else:
        distributed_forces(P, V, anchors, line, profile, medium, F, totals)


def medium_record(
    own: np.ndarray, runs: np.ndarray | None = None, ways: bool = True, bodies: bool = True
) -> np.ndarray:
    """Record (1,) of `law.LAW` for a law's own record (1,), with what its lines ask for.

    runs: their records, None of any; ways: whether those of stations are counted; bodies: whether lines are on bodies,
    by whose coordinates `lines` moves them.
    """

    def asked(field: str) -> bool:
        return runs is None or bool(np.any(runs[field] > 0))

    if "ball_force" in LAWS[own.dtype]:
        found = {"forces": ball_forces}
    else:
        found = {"forces": line_forces if asked("resultant") else distributed_forces}
        if ways:
            found["count_shear"] = count_shear
        if asked("scatter"):
            found["scattered"] = scattered
        if asked("behind"):
            found["lowering"] = lowering
    if ways:
        found["count_way"] = count_way
    if bodies:
        found["line_force"] = force
    return record_of(own, found)
