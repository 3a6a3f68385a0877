"""The record of the studies: what each one found, when, where and at which commit; the page is written from it.

`claims.json` holds one `Made` for each study and form (full or quick). In README.md each study has a section; what
stands there between two marks, and the third column of the table at the top, is written here. All else on the page is
by hand.
"""

from __future__ import annotations

import json
import math
import re
import subprocess
from dataclasses import dataclass
from pathlib import Path

from validation.study import Claim

HERE = Path(__file__).parent
PAGE, RECORD = HERE / "README.md", HERE / "claims.json"
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


def not_held(made: Made | None) -> str:
    """Cell of the table at the top of the page: the claims that did not hold."""
    if made is None or not made.claims:
        return "no claims recorded"
    lost = [claim.name.partition(".")[2] for claim in made.claims if not claim.held]
    return f"{len(lost)} of {len(made.claims)}: {'; '.join(lost)}" if lost else f"none of {len(made.claims)}"


def claim_lines(made: Made) -> str:
    """Claims of a study as the page shows them, those that did not hold first."""
    return "\n".join(str(claim) for claim in sorted(made.claims, key=lambda claim: claim.held))


def on_page(page: str, name: str, made: Made, text: str) -> str:
    """The page with tables and claims of a study in its section, and its row at the top; all else unchanged."""
    claims = f"\n\n```\n{claim_lines(made)}\n```" if made.claims else ""
    block = f"{BEGIN}\n\n{made.where()}\n\n{text.strip()}{claims}\n\n{END}"
    begin, end = _section(page, name)
    section = page[begin:end]
    if BEGIN in section:
        before, _, rest = section.partition(BEGIN)
        section = before + block + rest.partition(END)[2]
    else:
        section = f"{section.rstrip()}\n\n{block}\n\n"
    return _with_row(page[:begin] + section + page[end:], name, not_held(made))


def differences(page: str, record: Record) -> list[str]:
    """What the page says of the studies otherwise than the record; numbers are compared by value."""
    found = []
    for name, forms in record.items():
        made = forms.get("full")
        cells = _row(page, name).split(" | ")
        if not _same(cells[2], not_held(made)):
            found.append(f"{name}: the table at the top has {cells[2]!r}, the record {not_held(made)!r}")
        begin, end = _section(page, name)
        block = page[begin:end].partition(BEGIN)[2].partition(END)[0]
        shown = re.findall(r"^(?:Made at|held|NOT HELD) .*$", block, flags=re.M)
        kept = [] if made is None else [made.where(), *filter(None, claim_lines(made).split("\n"))]
        if len(shown) != len(kept):
            found.append(f"{name}: the page has {len(shown)} lines of the record, the record {len(kept)}")
        found += [f"{name}: page: {a}; record: {b}" for a, b in zip(shown, kept, strict=False) if not _same(a, b)]
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


def _section(page: str, name: str) -> tuple[int, int]:
    begin = page.index(f"\n## {name}.py\n") + 1
    end = page.find("\n## ", begin)
    return begin, len(page) if end < 0 else end + 1


def _row(page: str, name: str) -> str:
    return re.search(rf"^\| \[{name}\.py\].*$", page, flags=re.M).group()  # type: ignore[union-attr]


def _with_row(page: str, name: str, cell: str) -> str:
    row = _row(page, name)
    cells = row.split(" | ")
    return page.replace(row, " | ".join([*cells[:2], cell, *cells[3:]]))
