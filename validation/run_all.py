"""List of all studies with their arguments, and the runner behind `granular-contact validate`.

    granular-contact validate [--quick] [--only NAME ...] [--record]
    granular-contact validate --list

The exit code is 1 if a claim that held in the record (validation/claims.json) does not hold in this run, or if a study
ends in an error. Claims of the source paper that we can't confirm never held in the record: they are kept and shown as
not held, and do not change the exit code. With --record the results of this run replace the record, and they are
written into the study's page in docs/studies and into the index, README.md.
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
    """A study in the list.

    forms: command-line arguments of the study's script by form ("full", "quick"). The script prints its tables and
    exits with 0 if its bounds are kept. None: the study's module has a function `study(quick)` instead.
    by_hand: reason why `validate` can't run the study; empty if it can.
    """

    name: str
    forms: Mapping[str, Sequence[str]] | None = None
    by_hand: str = ""

    def has(self, form: str) -> bool:
        """Whether the study has this form."""
        return self.forms is None or form in self.forms

    def run(self, form: str) -> tuple[Outcome, str]:
        """Run the study; return its outcome and one line on the machine and the versions of packages."""
        if self.forms is None:
            outcome: Outcome = importlib.import_module(f"validation.{self.name}").study(form == "quick")
            return outcome, machine("exudyn", "numba")
        command = [sys.executable, str(HERE / f"{self.name}.py"), *self.forms[form]]
        done = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=False)
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


def lost(current: Sequence[Claim], before: Sequence[Claim]) -> list[str]:
    """Names of the claims that held before and that now do not hold or were not made."""
    held = {claim.name for claim in current if claim.held}
    return [claim.name for claim in before if claim.held and claim.name not in held]


def table() -> str:
    """Overview of all studies: run time of both forms, age of the record, and the claims that do not hold."""
    results, lines = record.read(), []
    for entry in STUDIES:
        forms = results.get(entry.name, {})
        durations = [f"{form} {_seconds(forms.get(form))}" for form in ("quick", "full") if entry.has(form)]
        lines.append(f"{entry.name}: {', '.join(durations)}{'; by hand: ' if entry.by_hand else ''}{entry.by_hand}")
        if (latest := forms.get("full")) is not None:
            lines.append(f"    {latest.when()}, {record.commits_since(latest)} commits of the package ago")
            lines.append(f"    did not hold: {_not_held(latest)}")
    return "\n".join(lines)


def _not_held(result: record.Made) -> str:
    failed = [claim.name.partition(".")[2] for claim in result.claims if not claim.held]
    if not result.claims:
        return "no claims recorded"
    return f"{len(failed)} of {len(result.claims)}: {'; '.join(failed)}" if failed else f"none of {len(result.claims)}"


def _seconds(result: record.Made | None) -> str:
    return "not measured" if result is None or result.seconds is None else f"{result.seconds:.0f} s"


def run(entry: Entry, form: str, write: bool) -> tuple[record.Made, list[str]]:
    """Run a study and print its claims; with `write`, record them. Return the result and the names of lost claims."""
    began = time.perf_counter()
    outcome, where = entry.run(form)
    seconds = round(time.perf_counter() - began, 1)
    where += f"; load average {os.getloadavg()[0]:.0f}"  # run times are longer on a busy machine
    day = f"{datetime.now(timezone.utc):%Y-%m-%d}"
    result = record.Made(record.commit_here(), day, where, seconds, outcome.claims)
    print(f"{entry.name} ({seconds:.0f} s)\n  " + "\n  ".join(map(str, result.claims)), flush=True)
    results = record.read()
    before = results.setdefault(entry.name, {}).get(form)
    if write:
        results[entry.name][form] = result
        record.save(results)
        if form == "full":
            _write_pages(entry.name, result, outcome.text)
    return result, lost(result.claims, before.claims if before is not None else ())


def pages() -> dict[str, str]:
    """Text of the page of each study, by name, in the order of the list."""
    return {entry.name: record.page_of(entry.name).read_text(encoding="utf-8") for entry in STUDIES}


def _write_pages(name: str, result: record.Made, text: str) -> None:
    """Write the results of a study into its page, and write the index anew."""
    path = record.page_of(name)
    path.write_text(record.on_page(path.read_text(encoding="utf-8"), result, text), encoding="utf-8")
    written = record.between_marks(record.INDEX.read_text(encoding="utf-8"), record.index(pages(), record.read()))
    record.INDEX.write_text(written, encoding="utf-8")


def main(quick: bool = False, write: bool = False, only: Sequence[str] = ()) -> int:
    """Run all studies or those in `only`; return 0 if no claim was lost and no study ended in an error, else 1."""
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
            result, missing = run(entry, form, write)
        except Exception:  # an error of one study must not stop the others
            traceback.print_exc()
            failed.append(entry.name)
            continue
        claims += result.claims
        gone += missing
    for name in gone:
        print(f"LOST      {name}")
    for name in failed:
        print(f"FAILED    {name}: it ended in an error")
    print(f"{sum(claim.held for claim in claims)} of {len(claims)} claims held, {len(gone)} that held before are lost")
    return 1 if gone or failed else 0
