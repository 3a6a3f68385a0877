"""Result types of a study (its text and claims), and the function that runs a study as a script."""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from validation.tables import machine


@dataclass(frozen=True)
class Claim:
    """A statement that a study has tested, with the number that decides whether it holds.

    name: `study.statement`, the statement in a few words; it stays the same over the revisions, since records are
    compared by it. detail: the number found and the bound it must keep.
    """

    name: str
    held: bool
    detail: str

    def __str__(self) -> str:
        """Claim as one line of text."""
        return f"{'held    ' if self.held else 'NOT HELD'}  {self.name}: {self.detail}"


@dataclass(frozen=True)
class Outcome:
    """Results of a study: its claims, and its text in Markdown (notes, figures, tables with captions above them)."""

    text: str
    claims: tuple[Claim, ...] = field(default=())


Study = Callable[[bool], Outcome]


def script(study: Study, arguments: Sequence[str] | None = None) -> int:
    """Run a study as a script (`--quick` for the quick form), print its outcome; return 0 if all claims hold."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--quick", action="store_true", help="fewer cases, same claims")
    quick = parser.parse_args(arguments).quick
    began = time.perf_counter()
    outcome = study(quick)
    print(f"{machine('exudyn', 'numba')}; {time.perf_counter() - began:.0f} s{', quick form' if quick else ''}\n")
    print(outcome.text)
    print()
    for claim in outcome.claims:
        print(claim)
    return 0 if all(claim.held for claim in outcome.claims) else 1
