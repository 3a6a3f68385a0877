"""The record of the studies: what each one found, when, where and at which commit; their pages are written from it.

`claims.json` holds one `Made` for each study and form (full or quick). Each study has a page in docs/studies: its
title, question, answer and explanation are by hand; tables, figures and claims stand between two marks, and are written
here. So is what stands between the marks of README.md, the index of all pages.
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
FIGURES = "../../validation/figures/"  # as pages name the folder; studies write `figures/`
BEGIN, END = "<!-- written by granular-contact validate --record -->", "<!-- end -->"
_NUMBER = re.compile(r"[-+]?\d+\.?\d*(?:e[-+]?\d+)?")


@dataclass(frozen=True)
class Made:
    """What a study gave in one form.

    commit: of the checkout, with "+" if files were changed; None where it is not known; machine: one line with
    versions; seconds: of the whole study by the clock, None where nobody measured it; taken_over: from the page as it
    stood when this record was begun: `commit` is then the last that changed the numbers on the page, and the run is as
    old or older.
    """

    commit: str | None
    day: str
    machine: str
    seconds: float | None
    claims: tuple[Claim, ...]
    taken_over: bool = False

    def when(self) -> str:
        """Commit and day in words."""
        return f"made at commit {self.commit}{' or before' if self.taken_over else ''}, {self.day}"

    def where(self) -> str:
        """One line for the page."""
        took = "" if self.seconds is None else f", {self.seconds:.0f} s"
        return f"M{self.when()[1:]}{took}; {self.machine}".rstrip("; ")


Record = dict[str, dict[str, Made]]  # study: form: what it gave


def read() -> Record:
    """Record of all studies."""
    raw = json.loads(RECORD.read_text(encoding="utf-8"))
    return {
        name: {
            form: Made(**{**made, "claims": tuple(_claim(*one) for one in made["claims"].items())})
            for form, made in forms.items()
        }
        for name, forms in raw.items()
    }


def save(record: Record) -> None:
    """Write the record."""
    raw = {
        name: {
            form: {**vars(made), "claims": {one.name: f"{_said(one)}: {one.detail}" for one in made.claims}}
            for form, made in forms.items()
        }
        for name, forms in record.items()
    }
    RECORD.write_text(json.dumps(raw, indent=1) + "\n", encoding="utf-8")


def _said(claim: Claim) -> str:
    return "held" if claim.held else "NOT HELD"


def _claim(name: str, said: str) -> Claim:
    held, _, detail = said.partition(": ")
    return Claim(name, held == "held", detail)


def page_of(name: str) -> Path:
    """Page of a study."""
    return PAGES / f"{name}.md"


def claim_lines(made: Made) -> list[str]:
    """Claims of a study as its page shows them, those that did not hold first."""
    claims = sorted(made.claims, key=lambda claim: claim.held)
    return [f"- {'held' if one.held else '**NOT HELD**'}: {one.name.partition('.')[2]}: {one.detail}" for one in claims]


def between_marks(page: str, block: str) -> str:
    """The page with other text between its marks; all else unchanged."""
    before, begin, rest = page.partition(BEGIN)
    _, end, after = rest.partition(END)
    if not begin or not end:
        raise ValueError(f"a page without {BEGIN!r} and {END!r}")
    return f"{before}{BEGIN}\n\n{block}\n\n{END}{after}"


def on_page(page: str, made: Made, text: str) -> str:
    """The page of a study with its tables, figures and claims."""
    claims = ["## Claims", "\n".join(claim_lines(made))] if made.claims else []
    shown = text.strip().replace("](figures/", f"]({FIGURES}")
    return between_marks(page, "\n\n".join([*claims, "## Tables", made.where(), shown]))


def said_on(page: str, what: str) -> str:
    """The paragraph of a page that begins with `**Question.**`, `**Answer.**` or `**What did not hold.**`, or ""."""
    found = re.search(rf"^\*\*{what}\.\*\* (.+?)\n\n", page, flags=re.M | re.S)
    return " ".join(found[1].split()) if found else ""


def index(pages: Mapping[str, str], record: Record) -> str:
    """What stands between the marks of the index: what did not hold, then all studies, in the order of the pages."""
    failed, rows = [], []
    for name, page in pages.items():
        link = f"[{name}](../docs/studies/{name}.md)"
        made = record.get(name, {}).get("full")
        claims = made.claims if made is not None else ()
        lost = sum(not claim.held for claim in claims)
        if words := said_on(page, "What did not hold"):
            failed.append(f"- {link}{f' ({lost} of {len(claims)} claims)' if lost else ''}: {words}")
        held = f"{len(claims) - lost} of {len(claims)}" if claims else "-"
        rows.append(f"| {link} | {said_on(page, 'Question')} | {said_on(page, 'Answer')} | {held} |")
    head = "| study | question | answer | claims that held |\n| --- | --- | --- | --- |"
    return "\n".join(["## What did not hold", "", *failed, "", "## All studies", "", head, *rows])


def differences(pages: Mapping[str, str], written: str, record: Record) -> list[str]:
    """What the pages, or the index as it is written, say otherwise than the record; numbers are compared by value."""
    found = []
    for name, page in pages.items():
        made = record.get(name, {}).get("full")
        block = page.partition(BEGIN)[2].partition(END)[0]
        shown = re.findall(r"^(?:Made at|- held:|- \*\*NOT HELD\*\*:) .*$", block, flags=re.M)
        kept = [] if made is None else [*claim_lines(made), made.where()]
        if len(shown) != len(kept):
            found.append(f"{name}: the page has {len(shown)} lines of the record, the record {len(kept)}")
        found += [f"{name}: page: {a}; record: {b}" for a, b in zip(shown, kept, strict=False) if not _same(a, b)]
        if made is not None and not all(one.held for one in made.claims) and not said_on(page, "What did not hold"):
            found.append(f"{name}: claims did not hold, and the page has no paragraph '**What did not hold.**'")
    shown, kept = (
        text.strip().split("\n") for text in (written.partition(BEGIN)[2].partition(END)[0], index(pages, record))
    )
    if len(shown) != len(kept):
        found.append(f"the index has {len(shown)} lines, of {len(kept)}")
    found += [f"index: {a}; pages: {b}" for a, b in zip(shown, kept, strict=False) if not _same(a, b)]
    return found


def commits_since(made: Made) -> str:
    """How many commits changed the package since a record was made."""
    line = ["git", "rev-list", "--count", f"{(made.commit or '').rstrip('+')}..HEAD", "--", "granular_contact"]
    done = subprocess.run(line, cwd=HERE.parent, capture_output=True, text=True, check=False)
    return done.stdout.strip() or "an unknown number of"


def commit_here() -> str | None:
    """Commit of this checkout, with "+" if the package or the studies were changed since; None without git."""
    code = ["granular_contact", "validation/*.py", "configs", "models"]
    lines = ["git", "rev-parse", "--short=9", "HEAD"], ["git", "status", "--porcelain", "--", *code]
    done = [subprocess.run(one, cwd=HERE.parent, capture_output=True, text=True, check=False) for one in lines]
    return f"{done[0].stdout.strip()}{'+' if done[1].stdout.strip() else ''}" or None


def _same(a: str, b: str) -> bool:
    """Whether two lines have the same words, and numbers of the same value."""
    numbers = zip(_NUMBER.findall(a), _NUMBER.findall(b), strict=False)
    return _NUMBER.sub("0", a) == _NUMBER.sub("0", b) and all(
        math.isclose(float(x), float(y), rel_tol=1e-6) for x, y in numbers
    )
