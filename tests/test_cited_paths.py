"""Every file that code, tests, configs and docs name is there."""

from __future__ import annotations

import re
import subprocess

from support_runs import ROOT

# Code and pages anywhere, other files in a folder of the project.
FOLDERS = ("granular_contact", "tests", "configs", "models", "validation")
OTHER = rf"(?:{'|'.join(FOLDERS)})/[\w./-]*\w\.(?:yaml|css|png|csv|json)"
PATH = re.compile(rf"(?<![\w/.:~}}-])((?:\w[\w.-]*/)+\w+\.(?:py|md)|\w+\.md|{OTHER})\b")
MADE = re.compile(r"^(results|home|tmp)/|^configs/zzz")  # by a run of the one who reads, or by a test
SUFFIXES = {".py", ".md", ".yaml", ".toml", ".css"}


def tracked() -> list[str]:
    listed = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=False)
    return [name for name in listed.stdout.splitlines() if (ROOT / name).suffix in SUFFIXES]


FILES = tracked() or [
    str(path.relative_to(ROOT)) for top in FOLDERS for path in (ROOT / top).rglob("*") if path.suffix in SUFFIXES
]


def cited(text: str) -> set[str]:
    return {path for path in PATH.findall(text) if not MADE.match(path)}


def test_cited_paths_are_found_in_text() -> None:
    text = "see physics.md section 1, tests/fit/test_nothing.py and [those](validation/README.md#a); not results/a.md"
    assert cited(text) == {"physics.md", "tests/fit/test_nothing.py", "validation/README.md"}


def lost(name: str) -> list[str]:
    """What a file names that is not there."""
    path = ROOT / name
    return [
        cited_path
        for cited_path in cited(path.read_text(encoding="utf-8"))
        # (Pages of the site are links among themselves, and tests/docs/test_site.py builds them strictly.)
        if not (name.startswith("docs/") and name != "docs/architecture.md" and cited_path.endswith(".md"))
        if not any(
            (base / cited_path).exists()
            for base in (ROOT, path.parent, *(ROOT / room for room in ("granular_contact", "tests", "docs")))
        )
    ]


def test_files_that_are_named_are_there() -> None:
    assert len(FILES) > 500
    assert {name: names for name in FILES if name != "tests/test_cited_paths.py" and (names := lost(name))} == {}
