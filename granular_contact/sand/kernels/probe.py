"""Forces of a law on one line in a given motion, outside any simulation: for figures, studies and tests."""

from __future__ import annotations

from typing import Any

from granular_contact.jit.compiled import kernel
from granular_contact.sand.kernels.forces import medium_record
from granular_contact.sand.kernels.law import forces


def probe(P: Any, V: Any, anchors: Any, line: Any, profile: Any, own: Any, F: Any, totals: Any) -> None:
    """`law.forces` for records (1,) of a line and of the law."""
    _probe(P, V, anchors, line, profile, medium_record(own), F, totals)


@kernel
def _probe(P, V, anchors, line, profile, medium, F, totals):
    forces(P, V, anchors, line[0], profile, medium[0], F, totals)
