"""All studies in one list, what each takes, and how `granular-contact validate` runs them.

    granular-contact validate [--quick] [--only NAME ...] [--record]
    granular-contact validate --list

A claim that held in the record (validation/claims.json) and does not any more makes the exit code 1, and so does a
study that ends in an error. A claim of the source paper that we do not find is one that never held: it is shown as such
and stays in. --record makes what was found the new record and writes it into the study's page in docs/studies and
into the index, README.md.
"""

from __future__ import annotations

import importlib
import os
import subprocess
import sys
import time
import traceback
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime, timezone
from pathlib import Path

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parent))

from validation import record
from validation.study import Claim, Outcome
from validation.tables import machine


@dataclass(frozen=True)
class Entry:
    """A study of the list.

    forms: arguments of a script by form (full or quick): it prints its tables, and its exit code says whether it kept
    its bounds; None: the study is a function `study(quick)`; by_hand: why `validate` can't run it.
    """

    name: str
    forms: Mapping[str, Sequence[str]] | None = None
    by_hand: str = ""

    def has(self, form: str) -> bool:
        """Whether it has this form."""
        return self.forms is None or form in self.forms

    def run(self, form: str) -> tuple[Outcome, str]:
        """What it gives, and on which machine with which versions."""
        if self.forms is None:
            outcome: Outcome = importlib.import_module(f"validation.{self.name}").study(form == "quick")
            return outcome, machine("exudyn", "numba")
        line = [sys.executable, str(HERE / f"{self.name}.py"), *self.forms[form]]
        done = subprocess.run(line, stdout=subprocess.PIPE, text=True, check=False)
        first, _, text = done.stdout.partition("\n\n")
        if not text:
            raise RuntimeError(f"{self.name}.py printed no tables; its exit code is {done.returncode}")
        last = text.strip().splitlines()[-1]
        detail = f"exit code {done.returncode}" if last.startswith("|") else last
        return Outcome(text, (Claim(f"{self.name}.keeps its bounds", done.returncode == 0, detail),)), first


def _script(name: str, full: Sequence[str] = (), quick: Sequence[str] | None = None, by_hand: str = "") -> Entry:
    return Entry(name, {"full": full} if quick is None else {"full": full, "quick": quick}, by_hand)


STUDIES = (
    # Against measurements, sources and theory
    Entry("measured"),
    Entry("braked_wheel"),
    Entry("paper_cases"),
    Entry("laws"),
    Entry("beam_against_theory"),
    Entry("spatial_beam"),
    Entry("oblique_modes"),
    Entry("single_mode_vs_fe"),
    Entry("sensitivity"),
    Entry("fit_recovery"),
    Entry("force_tests"),
    # Accuracy
    Entry("accuracy_promise"),
    Entry("space_trees"),
    Entry("default_steps"),
    Entry("convergence"),
    Entry("error_vs_run_time"),
    Entry("strips"),
    Entry("strip_estimates"),
    Entry("facet_estimates"),
    Entry("space_configs"),
    Entry("settling"),
    _script("standing"),
    # Other tools
    _script("against_peers"),
    Entry("mechanism_fronts"),
    Entry("space_fronts"),
    Entry("facet_fronts"),
    Entry("two_engines"),
    _script("mujoco_cost"),
    _script("mujoco_versions", by_hand="it needs environments with other versions of MuJoCo"),
    _script("menagerie", by_hand="it needs a copy of MuJoCo Menagerie"),
    # Robots
    Entry("runner"),
    Entry("gaits"),
    Entry("runner_policy"),
    Entry("hexapod_policy"),
    Entry("gait_search"),
    # Cost
    Entry("numerics"),
    Entry("mechanism_cost"),
    Entry("minimal_cost"),
    Entry("scaling"),
    Entry("load_cost"),
    _script("law_cost"),
    Entry("space_cost"),
    _script("hexapod"),
    Entry("scatter_cost"),
    Entry("sweep_throughput"),
    Entry("bookkeeping"),
    Entry("control_cost"),
    Entry("gym_speed"),
    _script("robot_loading"),
    Entry("compile_cost"),
    Entry("lean_scenes"),
    # Robustness
    Entry("properties"),
    Entry("properties_in_space"),
    Entry("stability"),
    _script("fuzz", full=("--count", "10000"), quick=()),
    _script("mutants", by_hand="it needs cosmic-ray, and half an hour"),
)


def lost(found: Sequence[Claim], before: Sequence[Claim]) -> list[str]:
    """Names of claims that held before and do not, or were not made, now."""
    held = {claim.name for claim in found if claim.held}
    return [claim.name for claim in before if claim.held and claim.name not in held]


def table() -> str:
    """One line for each study: seconds of both forms, claims, and how old its record is."""
    kept, lines = record.read(), []
    for entry in STUDIES:
        forms = kept.get(entry.name, {})
        took = [f"{form} {_seconds(forms.get(form))}" for form in ("quick", "full") if entry.has(form)]
        lines.append(f"{entry.name}: {', '.join(took)}{'; by hand: ' if entry.by_hand else ''}{entry.by_hand}")
        if (made := forms.get("full")) is not None:
            lines.append(f"    {made.when()}, {record.commits_since(made)} commits of the package ago")
            lines.append(f"    did not hold: {_not_held(made)}")
    return "\n".join(lines)


def _not_held(made: record.Made) -> str:
    lost = [claim.name.partition(".")[2] for claim in made.claims if not claim.held]
    if not made.claims:
        return "no claims recorded"
    return f"{len(lost)} of {len(made.claims)}: {'; '.join(lost)}" if lost else f"none of {len(made.claims)}"


def _seconds(made: record.Made | None) -> str:
    return "not measured" if made is None or made.seconds is None else f"{made.seconds:.0f} s"


def run(entry: Entry, form: str, write: bool) -> tuple[record.Made, list[str]]:
    """Run a study, print its claims, put it on record if asked; what it gave and names of claims that were lost."""
    began = time.perf_counter()
    outcome, where = entry.run(form)
    seconds = round(time.perf_counter() - began, 1)
    where += f"; load average {os.getloadavg()[0]:.0f}"  # of a busy machine times are long
    day = f"{datetime.now(timezone.utc):%Y-%m-%d}"
    made = record.Made(record.commit_here(), day, where, seconds, outcome.claims)
    print(f"{entry.name} ({seconds:.0f} s)\n  " + "\n  ".join(map(str, made.claims)), flush=True)
    kept = record.read()
    before = kept.setdefault(entry.name, {}).get(form)
    if write:
        kept[entry.name][form] = made
        record.save(kept)
        if form == "full":
            _write_pages(entry.name, made, outcome.text)
    return made, lost(made.claims, before.claims if before is not None else ())


def pages() -> dict[str, str]:
    """Pages of all studies of the list, in its order."""
    return {entry.name: record.page_of(entry.name).read_text(encoding="utf-8") for entry in STUDIES}


def _write_pages(name: str, made: record.Made, text: str) -> None:
    """Write what a study gave into its page, and the index."""
    path = record.page_of(name)
    path.write_text(record.on_page(path.read_text(encoding="utf-8"), made, text), encoding="utf-8")
    written = record.between_marks(record.INDEX.read_text(encoding="utf-8"), record.index(pages(), record.read()))
    record.INDEX.write_text(written, encoding="utf-8")


def main(quick: bool = False, write: bool = False, only: Sequence[str] = ()) -> int:
    """Run studies, all or those named; 0 when no claim was lost and none ended in an error, else 1."""
    form = "quick" if quick else "full"
    claims: list[Claim] = []
    gone: list[str] = []
    failed: list[str] = []
    for entry in STUDIES:
        if only and entry.name not in only:
            continue
        if entry.by_hand or not entry.has(form):
            print(f"{entry.name}: not run: {entry.by_hand or 'it has no quick form'}", flush=True)
            continue
        try:
            made, missing = run(entry, form, write)
        except Exception:  # whatever ends one study, the others are run
            traceback.print_exc()
            failed.append(entry.name)
            continue
        claims += made.claims
        gone += missing
    for name in gone:
        print(f"LOST      {name}")
    for name in failed:
        print(f"FAILED    {name}: it ended in an error")
    print(f"{sum(claim.held for claim in claims)} of {len(claims)} claims held, {len(gone)} that held before are lost")
    return 1 if gone or failed else 0
