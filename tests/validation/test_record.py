"""The record of the studies: complete, in line with pages and index, and differences are detected."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

from granular_contact.cli import main
from validation import record, run_all
from validation.record import Made
from validation.study import Claim, Outcome

HERE = Path(run_all.__file__).parent
NAMES = [entry.name for entry in run_all.STUDIES]
MADE = Made(
    "1a2b3c4", "2026-11-25", "2 cores", 12.0, (Claim("one.a: b", True, "1.50 mm"), Claim("one.c", False, "2 of 3"))
)
MARKS = f"{record.BEGIN}\n\nnothing yet\n\n{record.END}\n"
SMALL = (
    f"# One\n\n**Question.** Why\nso?\n\n**Answer.** So.\n\n**What did not hold.** The third.\n\nBy hand.\n\n{MARKS}"
)


def both(page: str, made: Made = MADE) -> tuple[dict[str, str], str, dict[str, dict[str, Made]]]:
    """A page, its index and its record, as `record.differences` takes them."""
    pages, kept = {"one": page}, {"one": {"full": made}}
    return pages, record.between_marks(f"# Studies\n\n{MARKS}", record.index(pages, kept)), kept


def test_every_script_that_makes_claims_is_in_the_list() -> None:
    shared = {"study", "record", "run_all"}  # what all studies share
    scripts = [path for path in HERE.glob("*.py") if path.stem not in shared]
    making = {path.stem for path in scripts if "Claim(" in path.read_text(encoding="utf-8")}
    assert len(making) > 20
    assert making <= {entry.name for entry in run_all.STUDIES if entry.forms is None}


@pytest.mark.parametrize("entry", run_all.STUDIES, ids=NAMES)
def test_each_entry_of_the_list_agrees_with_its_script(entry: run_all.Entry) -> None:
    source = (HERE / f"{entry.name}.py").read_text(encoding="utf-8")
    functions = {item.name for item in ast.parse(source).body if isinstance(item, ast.FunctionDef)}
    assert ("study" in functions) == (entry.forms is None)
    for arguments in (entry.forms or {}).values():
        assert all(f'"{item}"' in source for item in arguments if item.startswith("--"))
    if entry.forms is not None and '"--quick"' in source:
        assert entry.has("quick")


def test_pages_list_and_record_have_the_same_studies() -> None:
    assert sorted(path.stem for path in record.PAGES.glob("*.md")) == sorted(NAMES)
    assert sorted(record.read()) == sorted(NAMES)


@pytest.mark.parametrize("name", NAMES)
def test_a_page_asks_and_answers(name: str) -> None:
    page = run_all.pages()[name]
    assert page.startswith("# ")
    assert record.said_on(page, "Question").endswith("?")
    assert 5 < len(record.said_on(page, "Answer")) < 400  # one line of the index


def test_the_pages_and_the_index_say_what_the_record_says() -> None:
    written = record.INDEX.read_text(encoding="utf-8")
    assert record.differences(run_all.pages(), written, record.read()) == []


@pytest.mark.parametrize(
    ("before", "after", "detected"),
    [
        ("- held: a: b: 1.50 mm", "- held: a: b: 1.5 mm", False),
        ("- held: a: b: 1.50 mm", "- held: a: b: 1.51 mm", True),
        ("- **NOT HELD**: c: 2 of 3", "- held: c: 2 of 3", True),
        ("- **NOT HELD**: c: 2 of 3\n", "", True),
        ("**What did not hold.** The third.\n\n", "", True),
        ("at commit 1a2b3c4", "at commit 1a2b3c5", True),
        ("12 s; 2 cores", "13 s; 2 cores", True),
    ],
)
def test_a_page_with_other_values_than_the_record_is_detected(before: str, after: str, detected: bool) -> None:
    page = record.on_page(SMALL, MADE, "| a |\n| --- |\n| 3 |")
    assert before in page
    assert bool(record.differences(*both(page.replace(before, after)))) == detected


@pytest.mark.parametrize(
    ("before", "after", "detected"),
    [
        ("(1 of 2 claims): The third.", "(1.0 of 2 claims): The third.", False),
        ("(1 of 2 claims): The third.", "(0 of 2 claims): The third.", True),
        ("| Why so? | So. | 1 of 2 |", "| Why so? | Not so. | 1 of 2 |", True),
        ("| Why so? | So. | 1 of 2 |", "| Why so? | So. | 2 of 2 |", True),
    ],
)
def test_an_index_with_other_values_than_the_record_is_detected(before: str, after: str, detected: bool) -> None:
    pages, index, kept = both(record.on_page(SMALL, MADE, "| a |"))
    assert before in index
    assert bool(record.differences(pages, index.replace(before, after), kept)) == detected


def test_a_study_writes_between_the_marks_of_its_page_and_nothing_else() -> None:
    page = record.on_page(SMALL, MADE, "| a |\n\n![b](figures/b.png)")
    assert page.partition(record.BEGIN)[0] == SMALL.partition(record.BEGIN)[0]
    assert record.on_page(page, MADE, "| b |") == record.on_page(SMALL, MADE, "| b |")
    assert page.index("**NOT HELD**: c") < page.index("held: a: b")
    assert "![b](../../validation/figures/b.png)" in page
    with pytest.raises(ValueError, match="a page without"):
        record.on_page("# One\n", MADE, "| a |")


def test_a_record_is_read_as_it_was_saved(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(record, "RECORD", tmp_path / "claims.json")
    made = {"one": {"full": MADE, "quick": Made(None, "2026-11-24", "", None, (), taken_over=True)}}
    record.save(made)
    assert record.read() == made


def test_validate_runs_records_and_reports_lost_claims(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A study that comes out otherwise the second time, in a list of two of which the other ends in an error."""
    index, kept = tmp_path / "README.md", tmp_path / "claims.json"
    index.write_text(MARKS, encoding="utf-8")
    page, other = (tmp_path / f"{name}.md" for name in ("one", "two"))
    for path in (page, other):
        path.write_text(SMALL, encoding="utf-8")
    kept.write_text("{}", encoding="utf-8")
    held = [True]

    def made(entry: run_all.Entry, form: str) -> tuple[Outcome, str]:
        assert form == "full"
        if entry.name == "two":
            raise ValueError("no such number")
        return Outcome("| 1 |", (Claim("one.holds", held[0], "1"),)), "2 cores"

    monkeypatch.setattr(run_all.Entry, "run", made)
    monkeypatch.setattr(run_all, "STUDIES", (run_all.Entry("one"), run_all.Entry("two")))
    monkeypatch.setattr(record, "PAGES", tmp_path)
    monkeypatch.setattr(record, "INDEX", index)
    monkeypatch.setattr(record, "RECORD", kept)
    assert main(["validate", "--only", "one", "--record"]) == 0
    assert "- held: holds: 1" in page.read_text(encoding="utf-8")
    assert "| So. | 1 of 1 |" in index.read_text(encoding="utf-8")
    held[0] = False
    assert main(["validate", "--only", "one"]) == 1
    assert "LOST      one.holds" in capsys.readouterr().out
    assert record.differences(run_all.pages(), index.read_text(encoding="utf-8"), record.read()) == []
    assert main(["validate", "--record"]) == 1
    assert "FAILED    two" in capsys.readouterr().out
    assert "- **NOT HELD**: holds: 1" in page.read_text(encoding="utf-8")
    assert main(["validate", "--only", "three"]) == 2


def test_a_script_that_prints_tables_is_judged_by_its_exit_code(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    (tmp_path / "cost.py").write_text("import sys\nprint('2 cores\\n\\n| 1 |\\n\\n3 s of 2 s')\nsys.exit(1)\n")
    (tmp_path / "none.py").write_text("")
    monkeypatch.setattr(run_all, "HERE", tmp_path)
    outcome, where = run_all.Entry("cost", {"full": ()}).run("full")
    assert where == "2 cores"
    assert outcome.text == "| 1 |\n\n3 s of 2 s\n"
    assert outcome.claims == (Claim("cost.keeps its bounds", False, "3 s of 2 s"),)
    with pytest.raises(RuntimeError, match=r"none.py printed no tables"):
        run_all.Entry("none", {"full": ()}).run("full")


def test_every_figure_is_on_a_page() -> None:
    pages = [HERE.parent / "README.md", *(HERE.parent / "docs").rglob("*.md"), *HERE.parent.glob("*/README.md")]
    text = "".join(path.read_text(encoding="utf-8") for path in pages)
    assert [path.name for path in sorted((HERE / "figures").iterdir()) if path.name not in text] == []
