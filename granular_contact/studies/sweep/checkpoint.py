"""The work folder of a sweep, `DIR.part` beside its target DIR: finished cases are kept there until all are done.

    DIR.part/sweep.yaml     the sweep; a folder of another one is refused
    DIR.part/journal/       rows as they were finished, and what began them
    DIR.part/cases/         results of cases, with --plots

When the table is written the folder is renamed to DIR, in one step. Nothing of a sweep is in DIR before.
"""

from __future__ import annotations

import json
import os
import shutil
from collections.abc import Iterator, Set
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from granular_contact import report
from granular_contact.config import Sweep
from granular_contact.config.differences import MISSING, differences
from granular_contact.config.tree import dotted
from granular_contact.errors import GranularContactError
from granular_contact.report import CASES, JOURNAL, SWEEP, TABLE
from granular_contact.results.summary import versions
from granular_contact.studies.sweep import table
from granular_contact.studies.sweep.journal import Journal

try:
    import fcntl
except ImportError:  # not everywhere
    fcntl = None  # type: ignore[assignment]

_BEGUN = "begun.json"


class FolderRefused(GranularContactError):
    """The folder belongs to another sweep; the message is one line."""


@dataclass(frozen=True)
class Checkpoint:
    """A work folder that is open. done: cases that had a row when it was opened; cases: folder for their results."""

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
        for path in (self.folder / SWEEP, self.folder / TABLE):
            _sync(path)
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


def is_finished(sweep: Sweep, target: Path, cases: bool) -> bool:
    """Whether `target` holds this sweep already, with results of its cases if these are asked for.

    Raises
    ------
    FolderRefused
        It holds another sweep.
    OSError
        It is no folder of a sweep.
    """
    report.check_target(target, "sweep")
    visible = [path for path in target.iterdir() if not path.name.startswith(".")] if target.exists() else []
    if not visible:
        return False
    _same(sweep, target, "give another --out, or remove it")
    if cases and not (target / CASES).is_dir():
        raise FolderRefused(f"{target} holds this sweep without --plots: --restart runs it again")
    _remove(target / JOURNAL)  # the end may have been cut short
    return True


@contextmanager
def open_checkpoint(sweep: Sweep, target: Path, cases: bool = False, restart: bool = False) -> Iterator[Checkpoint]:
    """The work folder of a sweep, new or of an earlier try, locked against other processes.

    cases: whether each case gets a results folder. restart: throw away what there is.

    Raises
    ------
    FolderRefused
        It holds another sweep, or one begun with other versions or options; or another process is at work on it.
    OSError
        The disk refuses, or something else is in the way.
    """
    folder = work_folder(target)
    report.check_target(folder, "sweep")
    begun: dict[str, Any] = {"versions": versions(), "plots": cases}
    fresh = not (folder / JOURNAL / _BEGUN).exists()
    if fresh or restart:
        (folder / JOURNAL).mkdir(parents=True, exist_ok=True)
    with _locked(folder):
        if fresh or restart:
            _clear(folder)
            (folder / SWEEP).write_text(table.sweep_text(sweep), encoding="utf-8")
            _write_whole(folder / JOURNAL / _BEGUN, json.dumps(begun) + "\n")
        else:
            _same(sweep, folder, "--restart throws it away")
            _same_start(folder, begun)
        (folder / TABLE).unlink(missing_ok=True)
        journal = Journal(folder / JOURNAL)
        done = frozenset(journal.done())
        place = folder / CASES if cases else None
        if place is not None:
            _keep_only(place, {sweep.cases[i].name for i in done})
        yield Checkpoint(folder, target.resolve(), journal, done, place)


@contextmanager
def _locked(folder: Path) -> Iterator[None]:
    """Lock `folder` for this process; the system releases the lock when the process dies."""
    if fcntl is None:
        yield
        return
    with (folder / JOURNAL / ".lock").open("w") as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise FolderRefused(f"{folder}: another process is at work on this sweep") from None
        yield


def _same(sweep: Sweep, folder: Path, remedy: str) -> None:
    """Raise unless `folder` holds this very sweep."""
    path, here = folder / SWEEP, table.sweep_text(sweep)
    if not path.exists():
        raise FolderRefused(f"{folder} does not tell which sweep it is of, as it has no {SWEEP}: {remedy}")
    there = path.read_text(encoding="utf-8")
    if here != there:
        raise FolderRefused(f"{folder} is of another sweep ({_difference(there, here)}): {remedy}")


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


def _difference(there: str, here: str) -> str:
    """The first key that differs, with both values."""
    loader: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
    try:
        found = differences(yaml.load(here, loader), yaml.load(there, loader))
    except yaml.YAMLError:
        return f"its {SWEEP} can't be read"
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
    text = json.dumps(value, ensure_ascii=False, default=str)
    return text if len(text) <= 40 else text[:37] + "..."


def _clear(folder: Path) -> None:
    """Remove the rest of an earlier sweep, but not the lock."""
    for path in (*folder.iterdir(), *(folder / JOURNAL).iterdir()):
        if path.name not in (JOURNAL, ".lock"):
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


def _write_whole(path: Path, text: str) -> None:
    """Write a file completely or not at all."""
    making = path.with_suffix(".new")
    making.write_text(text, encoding="utf-8")
    _sync(making)
    making.replace(path)


def _sync(path: Path) -> None:
    with path.open("rb") as file:
        os.fsync(file.fileno())
