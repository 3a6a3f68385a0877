"""Runs the blocks of a page as a reader would, one after another, in one folder and one process.

`yaml title="FILE"` is written to the file; `python` is executed, all of a page in one namespace; lines of `sh` that
call granular-contact are run by its entry, without figures unless they are asked for; `text` is what the block before
it printed: each of its lines stands there, in this order, with the same words, and numbers that agree to their digits.
`<!-- not run: why -->` before a block leaves it out, `<!-- exit code N -->` says how a command ends.
"""

from __future__ import annotations

import contextlib
import io
import re
import shlex
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[2]
BLOCK = re.compile(
    r"(?:<!-- (?P<note>[^\n]*?) -->\n)?```(?P<kind>\w+)(?: title=\"(?P<title>[^\"]+)\")?\n(?P<code>.*?)```", re.S
)
NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")


@dataclass
class Page:
    """A page that was run: what it printed, and the names that its Python left."""

    printed: str = ""
    names: dict[str, Any] = field(default_factory=lambda: {"__name__": "page"})
    blocks: int = 0


def blocks(path: Path) -> list[re.Match[str]]:
    """The blocks of a page, in order."""
    return list(BLOCK.finditer(path.read_text(encoding="utf-8")))


def run(path: Path, only: str = "") -> Page:
    """Run the blocks of a page, or those after the heading `only`, in the working folder."""
    page, last, text = Page(), "", path.read_text(encoding="utf-8")
    for block in BLOCK.finditer(text, text.index(only)):
        note = block["note"] or ""
        if note.startswith("not run: "):
            continue
        if block["kind"] == "text":
            assert_told(block["code"], last)
            continue
        last = _run(block, page, note)
        page.printed += last
        page.blocks += 1
    return page


def _run(block: re.Match[str], page: Page, note: str) -> str:
    if block["title"]:
        Path(block["title"]).write_text(block["code"], encoding="utf-8")
    out = io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(out):
        if block["kind"] == "python":
            exec(compile(block["code"], "block", "exec", dont_inherit=True), page.names)
        elif block["kind"] == "sh":
            exit_code = re.fullmatch(r"exit code (\d)", note)
            _commands(block["code"], int(exit_code[1]) if exit_code else 0, out)
    return out.getvalue()


def _commands(code: str, ends: int, out: io.StringIO) -> None:
    from granular_contact.cli import main

    for line in code.replace("\\\n", " ").splitlines():
        arguments = shlex.split(line, comments=True)
        if not arguments:
            continue
        assert arguments[0] == "granular-contact", f"{line}: is not run here; say so in a comment above the block"
        if arguments[1] == "run" and "--animate" not in arguments:
            arguments.append("--no-plots")
        assert main(arguments[1:]) == ends, f"{line}\n{out.getvalue()}"


def assert_told(expected: str, printed: str) -> None:
    """Each line of a block stands in what was printed, in order: the same words, numbers to their digits."""
    lines = iter(printed.splitlines())
    for line in expected.rstrip("\n").splitlines():
        assert any(_same(line, other) for other in lines), f"{line!r} is not in what was printed:\n{printed}"


def _same(line: str, other: str) -> bool:
    if " ".join(NUMBER.sub("#", line).split()) != " ".join(NUMBER.sub("#", other).split()):
        return False
    return all(_agree(*pair) for pair in zip(NUMBER.findall(line), NUMBER.findall(other), strict=True))


def _agree(shown: str, printed: str) -> bool:
    """Whether two numbers agree to a unit and a half of the last digit that is shown, or to 0.2 %."""
    digits = len(shown.partition("e")[0].partition(".")[2])
    size = 10.0**-digits * 10.0 ** float(shown.partition("e")[2] or 0)
    return abs(float(shown) - float(printed)) <= max(1.5 * size * ("." in shown), 2e-3 * abs(float(shown)))


def forget(tag: str) -> None:
    """Take a law out again that a page added, for tests that come after it in this process."""
    from granular_contact.config import allowed
    from granular_contact.config.schema import Bed, BedLayer, Scenario
    from granular_contact.laws.catalogue import LAWS

    del LAWS[tag]
    for part in (BedLayer, Bed, Scenario, *Scenario.__subclasses__()):
        part.model_rebuild(force=True)
    allowed.clear_cache()
