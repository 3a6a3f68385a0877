"""Run every study and say what holds; the claims that held before are kept in claims.json.

    granular-contact validate [--quick] [--record]

A claim that held and does not any more makes the exit code 1. A claim of the source paper that we do not find is one
that never held: it is shown as such and stays in. --record makes what was found the new record.
"""

from __future__ import annotations

import importlib
import json
import sys
import time
from pathlib import Path

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parent))

from validation.study import Claim

STUDIES = (
    "paper_cases",
    "single_mode_vs_fe",
    "error_vs_run_time",
    "stability",
    "beam_against_theory",
    "laws",
    "sensitivity",
    "fit_recovery",
    "force_tests",
    "measured",
    "runner",
    "scaling",
    "strips",
    "strip_estimates",
    "settling",
)
RECORD = HERE / "claims.json"


def lost(found: list[Claim], record: dict[str, bool]) -> list[str]:
    """Names of claims that held in the record and do not, or were not made, now."""
    held = {claim.name for claim in found if claim.held}
    return [name for name, before in record.items() if before and name not in held]


def main(quick: bool = False, record: bool = False) -> int:
    """Run all studies; 0 when no claim was lost, else 1."""
    form = "quick" if quick else "full"
    known: dict[str, dict[str, bool]] = json.loads(RECORD.read_text(encoding="utf-8")) if RECORD.exists() else {}
    found: list[Claim] = []
    for name in STUDIES:
        began = time.perf_counter()
        outcome = importlib.import_module(f"validation.{name}").study(quick)
        found += outcome.claims
        print(f"{name} ({time.perf_counter() - began:.0f} s)", flush=True)
        for claim in outcome.claims:
            print(f"  {claim}", flush=True)
    gone = lost(found, known.get(form, {}))
    for name in gone:
        print(f"LOST      {name}")
    print(f"{sum(claim.held for claim in found)} of {len(found)} claims held, {len(gone)} that held before are lost")
    if record:
        known[form] = {claim.name: claim.held for claim in found}
        RECORD.write_text(json.dumps(known, indent=2) + "\n", encoding="utf-8")
    return 1 if gone else 0
