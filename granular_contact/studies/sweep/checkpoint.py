"""Work folder of an unfinished sweep or search, `DIR.part` beside its target DIR.

    DIR.part/sweep.yaml     the sweep (or optimise.yaml, the search); a folder with another one is refused
    DIR.part/journal/       rows of the finished cases; versions and options with which the sweep was begun
    DIR.part/cases/         results of cases, with --plots

When the table is complete the folder is renamed to DIR in one step. Until then DIR contains nothing of the sweep.
"""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable, Iterator, Set
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import yaml

from granular_contact import report
from granular_contact.config.differences import MISSING, differences
from granular_contact.config.tree import dotted
from granular_contact.errors import GranularContactError, short
from granular_contact.report import CASES, JOURNAL
from granular_contact.results.summary import versions
from granular_contact.studies.sweep.journal import Journal
from granular_contact.values.files import sync, write_whole

_BEGUN = "begun.json"


class FolderRefused(GranularContactError):
    """The folder belongs to another sweep, or another process uses it; the message is one line."""


@dataclass(frozen=True)
class Contents:
    """Contents of a work folder.

    kind: of results; file, text: name and text of the file that defines the sweep or search; table: name of the table.
    case_name: function from the index of a case to its name. noun, runs: names of the sweep and its runs in messages.
    packages: versions of further packages on which the rows depend.
    """

    kind: str
    file: str
    text: str
    table: str
    case_name: Callable[[int], str]
    noun: str
    runs: str
    packages: dict[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Checkpoint:
    """An open work folder. done: cases that had a row when it was opened; cases: folder for the results of cases."""

    work: Contents
    folder: Path
    target: Path
    journal: Journal
    done: frozenset[int]
    cases: Path | None

    def finish(self) -> None:
        """Move the complete folder to the target.

        Raises
        ------
        OSError
            The folder cannot be moved; it stays as it is.
        """
        for path in (self.folder / self.work.file, self.folder / self.work.table):
            sync(path)
        report.swap(self.folder, self.target)
        _remove(self.folder)  # `swap` left the replaced earlier results of the same sweep there
        _remove(self.target / JOURNAL)

    def discard(self) -> None:
        """Remove the work folder."""
        _remove(self.folder)


def work_folder(target: Path) -> Path:
    """Return the work folder of a target; symbolic links are resolved first."""
    target = target.resolve()
    return target.with_name(f"{target.name}.part")


def is_finished(work: Contents, target: Path, cases: bool = False) -> bool:
    """Return whether `target` already contains this finished sweep or search; cases: with the results of its cases.

    Raises
    ------
    FolderRefused
        It contains another sweep, or lacks the results of the cases.
    OSError
        It is not the folder of a sweep.
    """
    report.check_target(target, work.kind)
    visible = [path for path in target.iterdir() if not path.name.startswith(".")] if target.exists() else []
    if not visible:
        return False
    _check_same(work, target, "give another --out, or remove the folder")
    if cases and not (target / CASES).is_dir():
        raise FolderRefused(f"{target} contains this {work.noun} without --plots; --restart runs it again")
    _remove(target / JOURNAL)  # a kill in `Checkpoint.finish` can leave it behind
    return True


@contextmanager
def open_checkpoint(work: Contents, target: Path, cases: bool = False, restart: bool = False) -> Iterator[Checkpoint]:
    """Create or reopen the work folder of a sweep, locked against other processes within the block.

    cases: whether each case gets a results folder. restart: discard an unfinished sweep in the folder.

    Raises
    ------
    FolderRefused
        It contains another sweep, or one begun with other versions or options; or another process works on it.
    OSError
        The folder cannot be written, or something else has its name.
    """
    folder = work_folder(target)
    report.check_target(folder, work.kind)
    begun: dict[str, Any] = {"versions": versions() | work.packages, "plots": cases}
    fresh = not (folder / JOURNAL / _BEGUN).exists()
    if fresh or restart:
        (folder / JOURNAL).mkdir(parents=True, exist_ok=True)
    with report.held(folder / JOURNAL) as free:
        if free is False:
            raise FolderRefused(f"{folder}: another process is working on this {work.noun}")
        if fresh or restart:
            _clear(folder)
            (folder / work.file).write_text(work.text, encoding="utf-8")
            write_whole(folder / JOURNAL / _BEGUN, json.dumps(begun) + "\n")
        else:
            _check_same(work, folder, "--restart discards it and starts again")
            _check_same_start(folder, begun)
        (folder / work.table).unlink(missing_ok=True)
        journal = Journal(folder / JOURNAL)
        done = frozenset(journal.done())
        cases_folder = folder / CASES if cases else None
        if cases_folder is not None:
            _keep_only(cases_folder, {work.case_name(i) for i in done})
        yield Checkpoint(work, folder, target.resolve(), journal, done, cases_folder)


def _check_same(work: Contents, folder: Path, remedy: str) -> None:
    """Raise FolderRefused unless `folder` contains exactly this sweep or search."""
    path, noun = folder / work.file, work.noun
    if not path.exists():
        raise FolderRefused(f"{folder} has no {work.file}, so its {noun} is unknown; {remedy}")
    stored = path.read_text(encoding="utf-8")
    if work.text != stored:
        difference = _difference(stored, work.text, work.file)
        raise FolderRefused(f"{folder} contains another {noun} ({difference}); {remedy}")


def _check_same_start(folder: Path, begun: dict[str, Any]) -> None:
    """Raise FolderRefused unless the folder was begun with the same versions and options."""
    stored = json.loads((folder / JOURNAL / _BEGUN).read_text(encoding="utf-8"))
    for name, version in begun["versions"].items():
        if stored["versions"].get(name) != version:
            fault = f"was begun with {name} {stored['versions'].get(name)}, but this process has {version}"
            raise FolderRefused(f"{folder} {fault}; --restart discards it and starts again")
    if stored["plots"] != begun["plots"]:
        option = f"{'with' if stored['plots'] else 'without'} --plots"
        raise FolderRefused(f"{folder} was begun {option}; continue {option}, or start again with --restart")


_ABOUT = (".standing", ".provenance")


def _difference(stored: str, requested: str, file: str) -> str:
    """Describe the first key that differs between the stored and the requested file, with both values."""
    loader: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
    try:
        changes = differences(yaml.load(requested, loader), yaml.load(stored, loader))
    except yaml.YAMLError:
        return f"its {file} can't be read"
    # Standing and provenance of a medium change with its numbers; the numbers are reported first.
    first = min(changes, key=lambda change: dotted(change[0]).endswith(_ABOUT), default=None)
    if first is not None:
        path, new, old = first
        if new is MISSING:
            return f"{dotted(path)} is in that folder alone"
        if old is MISSING:
            return f"{dotted(path)} is not in that folder"
        return f"{dotted(path)} is {_short(old)} there, but {_short(new)} is requested"
    lines = zip(stored.splitlines(), requested.splitlines(), strict=False)
    return next((f"its file says {a.lstrip('# ')!r}" for a, b in lines if a != b), "its text differs")


def _short(value: Any) -> str:
    return short(json.dumps(value, ensure_ascii=False, default=str), 40)


def _clear(folder: Path) -> None:
    """Remove the files of an earlier sweep, except for the journal's folder, which is locked."""
    for path in (*folder.iterdir(), *(folder / JOURNAL).iterdir()):
        if path.name != JOURNAL:
            _remove(path)


def _keep_only(folder: Path, names: Set[str]) -> None:
    """Remove all entries but the named ones: results of cases without a row, which may be incomplete."""
    for path in folder.iterdir() if folder.exists() else ():
        if path.name not in names:
            _remove(path)


def _remove(path: Path) -> None:
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path, ignore_errors=True)
    else:
        with suppress(OSError):
            path.unlink()
