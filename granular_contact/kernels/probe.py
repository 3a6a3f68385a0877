"""Forces of a law on one run in a given motion, outside any simulation: for figures, studies and tests."""

from __future__ import annotations

from numba import njit

from granular_contact.kernels.law import forces


@njit(cache=True)
def probe(P, V, anchors, run, profile, medium, F, totals):
    """`law.forces` for records (1,) of run and medium."""
    forces(P, V, anchors, run[0], profile, medium[0], F, totals)
