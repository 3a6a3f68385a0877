"""Record of the studies' results with date, machine and commit, and the pages that are written from it.

`claims.json` holds one `Made` for each study and form (full or quick). Each study has a page in docs/studies. Its
title, question, answer and explanation are written by hand; its tables, figures and claims are written by this module,
between two marks. README.md, the index of all pages, is written in the same way between its own marks.
"""

from __future__ import annotations

import json
import math
import re
import subprocess
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from validation.study import Claim

HERE = Path(__file__).parent
PAGES, INDEX, RECORD = HERE.parent / "docs" / "studies", HERE / "README.md", HERE / "claims.json"
FIGURES = "../../validation/figures/"  # path from a page to the figures; studies write `figures/`
BEGIN, END = "<!-- written by granular-contact validate --record -->", "<!-- end -->"
_NUMBER = re.compile(r"[-+]?\d+\.?\d*(?:e[-+]?\d+)?")


@dataclass(frozen=True)
class Made:
    """Recorded results of a study in one form.

    commit: commit of the checkout, with "+" if files were changed; None if unknown. machine: one line on the machine
    and the versions of packages. seconds: wall-clock time of the whole study; None if it was not measured.
    taken_over: the numbers come from a page that is older than this record. `commit` is then the last one that changed
    the numbers on the page; the run itself is of that commit or an earlier one.
    """

    commit: str | None
    day: str
    machine: str
    seconds: float | None
    claims: tuple[Claim, ...]
    taken_over: bool = False

    def when(self) -> str:
        """Commit and day of the results, as text."""
        return f"made at commit {self.commit}{' or before' if self.taken_over else ''}, {self.day}"

    def where(self) -> str:
        """Line of the page with commit, day, run time and machine."""
        took = "" if self.seconds is None else f", {self.seconds:.0f} s"
        return f"M{self.when()[1:]}{took}; {self.machine}".rstrip("; ")


Record = dict[str, dict[str, Made]]  # results by study and form


def read() -> Record:
    """Read the record of all studies from `claims.json`."""
    raw = json.loads(RECORD.read_text(encoding="utf-8"))
    return {
        name: {
            form: Made(**{**made, "claims": tuple(_claim(*item) for item in made["claims"].items())})
            for form, made in forms.items()
        }
        for name, forms in raw.items()
    }


def save(record: Record) -> None:
    """Write the record to `claims.json`."""
    raw = {
        name: {
            form: {**vars(made), "claims": {claim.name: f"{_status(claim)}: {claim.detail}" for claim in made.claims}}
            for form, made in forms.items()
        }
        for name, forms in record.items()
    }
    RECORD.write_text(json.dumps(raw, indent=1) + "\n", encoding="utf-8")


def _status(claim: Claim) -> str:
    return "held" if claim.held else "NOT HELD"


def _claim(name: str, entry: str) -> Claim:
    status, _, detail = entry.partition(": ")
    return Claim(name, status == "held", detail)


def page_of(name: str) -> Path:
    """Path of a study's page."""
    return PAGES / f"{name}.md"


def claim_lines(made: Made) -> list[str]:
    """Lines of a study's page that list its claims, claims that did not hold first."""
    claims = sorted(made.claims, key=lambda claim: claim.held)
    return [
        f"- {'held' if claim.held else '**NOT HELD**'}: {claim.name.partition('.')[2]}: {claim.detail}"
        for claim in claims
    ]


def between_marks(page: str, block: str) -> str:
    """Return the page with `block` as the text between its marks; the rest is unchanged."""
    before, begin, rest = page.partition(BEGIN)
    _, end, after = rest.partition(END)
    if not begin or not end:
        raise ValueError(f"a page without {BEGIN!r} and {END!r}")
    return f"{before}{BEGIN}\n\n{block}\n\n{END}{after}"


def on_page(page: str, made: Made, text: str) -> str:
    """Return the page of a study with these claims, tables and figures between its marks."""
    claims = ["## Claims", "\n".join(claim_lines(made))] if made.claims else []
    shown = text.strip().replace("](figures/", f"]({FIGURES}")
    return between_marks(page, "\n\n".join([*claims, "## Tables", made.where(), shown]))


def said_on(page: str, heading: str) -> str:
    """Paragraph of a page under `Question`, `Answer` or `What did not hold`; "" if the page has no such paragraph."""
    match = re.search(rf"^\*\*{heading}\.\*\* (.+?)\n\n", page, flags=re.M | re.S)
    return " ".join(match[1].split()) if match else ""


def index(pages: Mapping[str, str], record: Record) -> str:
    """Text between the marks of the index: first what did not hold, then a table of all studies, in order of pages."""
    failed, rows = [], []
    for name, page in pages.items():
        link = f"[{name}](../docs/studies/{name}.md)"
        made = record.get(name, {}).get("full")
        claims = made.claims if made is not None else ()
        lost = sum(not claim.held for claim in claims)
        if paragraph := said_on(page, "What did not hold"):
            failed.append(f"- {link}{f' ({lost} of {len(claims)} claims)' if lost else ''}: {paragraph}")
        held = f"{len(claims) - lost} of {len(claims)}" if claims else "-"
        rows.append(f"| {link} | {said_on(page, 'Question')} | {said_on(page, 'Answer')} | {held} |")
    head = "| study | question | answer | claims that held |\n| --- | --- | --- | --- |"
    return "\n".join(["## What did not hold", "", *failed, "", "## All studies", "", head, *rows])


def differences(pages: Mapping[str, str], written: str, record: Record) -> list[str]:
    """Lines of the pages, and of the index `written`, that differ from the record; numbers are compared by value."""
    faults = []
    for name, page in pages.items():
        made = record.get(name, {}).get("full")
        block = page.partition(BEGIN)[2].partition(END)[0]
        lines = re.findall(r"^(?:Made at|- held:|- \*\*NOT HELD\*\*:) .*$", block, flags=re.M)
        expected = [] if made is None else [*claim_lines(made), made.where()]
        if len(lines) != len(expected):
            faults.append(f"{name}: the page has {len(lines)} lines of the record, the record {len(expected)}")
        faults += [f"{name}: page: {a}; record: {b}" for a, b in zip(lines, expected, strict=False) if not _same(a, b)]
        if made is not None and not all(claim.held for claim in made.claims) and not said_on(page, "What did not hold"):
            faults.append(f"{name}: claims did not hold, and the page has no paragraph '**What did not hold.**'")
    lines, expected = (
        text.strip().split("\n") for text in (written.partition(BEGIN)[2].partition(END)[0], index(pages, record))
    )
    if len(lines) != len(expected):
        faults.append(f"the index has {len(lines)} lines, of {len(expected)}")
    faults += [f"index: {a}; pages: {b}" for a, b in zip(lines, expected, strict=False) if not _same(a, b)]
    return faults


def commits_since(made: Made) -> str:
    """Number of commits that changed the package since these results were recorded."""
    command = ["git", "rev-list", "--count", f"{(made.commit or '').rstrip('+')}..HEAD", "--", "granular_contact"]
    done = subprocess.run(command, cwd=HERE.parent, capture_output=True, text=True, check=False)
    return done.stdout.strip() or "an unknown number of"


def commit_here() -> str | None:
    """Commit of this checkout, with "+" if the package or the studies have uncommitted changes; None without git."""
    code = ["granular_contact", "validation/*.py", "configs", "models"]
    commands = ["git", "rev-parse", "--short=9", "HEAD"], ["git", "status", "--porcelain", "--", *code]
    done = [
        subprocess.run(command, cwd=HERE.parent, capture_output=True, text=True, check=False) for command in commands
    ]
    return f"{done[0].stdout.strip()}{'+' if done[1].stdout.strip() else ''}" or None


def _same(a: str, b: str) -> bool:
    """Whether two lines have the same text, and the same numbers to a relative 1e-6."""
    numbers = zip(_NUMBER.findall(a), _NUMBER.findall(b), strict=False)
    return _NUMBER.sub("0", a) == _NUMBER.sub("0", b) and all(
        math.isclose(float(x), float(y), rel_tol=1e-6) for x, y in numbers
    )
