"""What every study gives: tables, figures and claims; and how it is run as a script."""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from validation.tables import machine


@dataclass(frozen=True)
class Claim:
    """A statement that a study marks as held or not, with the number it rests on.

    name: stable, `study.statement` in a few words; detail: the number, and what was asked of it.
    """

    name: str
    held: bool
    detail: str

    def __str__(self) -> str:
        """One line for people."""
        return f"{'held    ' if self.held else 'NOT HELD'}  {self.name}: {self.detail}"


@dataclass(frozen=True)
class Outcome:
    """Tables in Markdown (each with its caption before it), notes and claims of a study."""

    text: str
    claims: tuple[Claim, ...] = field(default=())


Study = Callable[[bool], Outcome]


def script(study: Study, arguments: Sequence[str] | None = None) -> int:
    """Run a study as a script (`--quick` for the quick form) and print it; 0 when every claim held, else 1."""
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
