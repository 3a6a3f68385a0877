"""The work folder of many runs, `DIR.part` beside its target DIR: what is finished is kept there until all is.

    DIR.part/sweep.yaml     the sweep (or optimise.yaml, the search); a folder of another one is refused
    DIR.part/journal/       rows as they were finished, and what began them
    DIR.part/cases/         results of cases, with --plots

When the table is written the folder is renamed to DIR, in one step. Nothing of a sweep is in DIR before.
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
    """The folder belongs to another sweep; the message is one line."""


@dataclass(frozen=True)
class Contents:
    """What a work folder is of: a kind of results, the file that says all of it, that file's text, and its table.

    case_name: of a case by its index. noun, runs: what messages call it, and what its runs. packages: versions on which
    the rows depend besides those of all runs.
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
    """A work folder that is open. done: cases that had a row when it was opened; cases: folder for their results."""

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
            The disk refuses; the folder stays as it is.
        """
        for path in (self.folder / self.work.file, self.folder / self.work.table):
            sync(path)
        report.swap(self.folder, self.target)
        _remove(self.folder)  # an earlier result of the same sweep, run again
        _remove(self.target / JOURNAL)

    def discard(self) -> None:
        """Remove the folder."""
        _remove(self.folder)


def work_folder(target: Path) -> Path:
    """The work folder of a target; a symbolic link is followed first."""
    target = target.resolve()
    return target.with_name(f"{target.name}.part")


def is_finished(work: Contents, target: Path, cases: bool = False) -> bool:
    """Whether `target` holds this sweep or search already, with results of its cases if these are asked for.

    Raises
    ------
    FolderRefused
        It holds another sweep.
    OSError
        It is no folder of a sweep.
    """
    report.check_target(target, work.kind)
    visible = [path for path in target.iterdir() if not path.name.startswith(".")] if target.exists() else []
    if not visible:
        return False
    _same(work, target, "give another --out, or remove it")
    if cases and not (target / CASES).is_dir():
        raise FolderRefused(f"{target} holds this {work.noun} without --plots: --restart runs it again")
    _remove(target / JOURNAL)  # the end may have been cut short
    return True


@contextmanager
def open_checkpoint(work: Contents, target: Path, cases: bool = False, restart: bool = False) -> Iterator[Checkpoint]:
    """The work folder of a sweep, made or found again, and kept from other processes meanwhile.

    cases: whether each case gets a results folder. restart: throw away what there is.

    Raises
    ------
    FolderRefused
        It holds another sweep, or one begun with other versions or options; or another process is at work on it.
    OSError
        The disk refuses, or something else is in the way.
    """
    folder = work_folder(target)
    report.check_target(folder, work.kind)
    begun: dict[str, Any] = {"versions": versions() | work.packages, "plots": cases}
    fresh = not (folder / JOURNAL / _BEGUN).exists()
    if fresh or restart:
        (folder / JOURNAL).mkdir(parents=True, exist_ok=True)
    with report.held(folder / JOURNAL) as free:
        if free is False:
            raise FolderRefused(f"{folder}: another process is at work on this {work.noun}")
        if fresh or restart:
            _clear(folder)
            (folder / work.file).write_text(work.text, encoding="utf-8")
            write_whole(folder / JOURNAL / _BEGUN, json.dumps(begun) + "\n")
        else:
            _same(work, folder, "--restart throws it away")
            _same_start(folder, begun)
        (folder / work.table).unlink(missing_ok=True)
        journal = Journal(folder / JOURNAL)
        done = frozenset(journal.done())
        place = folder / CASES if cases else None
        if place is not None:
            _keep_only(place, {work.case_name(i) for i in done})
        yield Checkpoint(work, folder, target.resolve(), journal, done, place)


def _same(work: Contents, folder: Path, remedy: str) -> None:
    """Raise unless `folder` holds this very sweep or search."""
    path, noun = folder / work.file, work.noun
    if not path.exists():
        raise FolderRefused(f"{folder} does not say which {noun} it is of, as it has no {work.file}: {remedy}")
    there = path.read_text(encoding="utf-8")
    if work.text != there:
        raise FolderRefused(f"{folder} is of another {noun} ({_difference(there, work.text, work.file)}): {remedy}")


def _same_start(folder: Path, begun: dict[str, Any]) -> None:
    there = json.loads((folder / JOURNAL / _BEGUN).read_text(encoding="utf-8"))
    for name, version in begun["versions"].items():
        if there["versions"].get(name) != version:
            words = f"was begun with {name} {there['versions'].get(name)}, and here is {version}"
            raise FolderRefused(f"{folder} {words}: --restart throws it away")
    if there["plots"] != begun["plots"]:
        how = "with" if there["plots"] else "without"
        raise FolderRefused(f"{folder} was begun {how} --plots: go on {how} it, or throw it away with --restart")


_ABOUT = (".standing", ".provenance")


def _difference(there: str, here: str, file: str) -> str:
    """The first key that differs, with both values."""
    loader: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
    try:
        found = differences(yaml.load(here, loader), yaml.load(there, loader))
    except yaml.YAMLError:
        return f"its {file} can't be read"
    # What a medium's numbers rest on changes with them, and the numbers say more.
    first = min(found, key=lambda one: dotted(one[0]).endswith(_ABOUT), default=None)
    if first is not None:
        path, mine, other = first
        if MISSING in (mine, other):
            return f"{dotted(path)} is only {'there' if mine is MISSING else 'here'}"
        return f"{dotted(path)} is {_short(other)} there and {_short(mine)} here"
    lines = zip(there.splitlines(), here.splitlines(), strict=False)
    return next((f"{a.lstrip('# ')!r} there" for a, b in lines if a != b), "its text differs")


def _short(value: Any) -> str:
    return short(json.dumps(value, ensure_ascii=False, default=str), 40)


def _clear(folder: Path) -> None:
    """Remove the rest of an earlier sweep, but not the folder that is locked."""
    for path in (*folder.iterdir(), *(folder / JOURNAL).iterdir()):
        if path.name != JOURNAL:
            _remove(path)


def _keep_only(folder: Path, names: Set[str]) -> None:
    """Remove results of cases without a row, which may be incomplete."""
    for path in folder.iterdir() if folder.exists() else ():
        if path.name not in names:
            _remove(path)


def _remove(path: Path) -> None:
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path, ignore_errors=True)
    else:
        with suppress(OSError):
            path.unlink()
