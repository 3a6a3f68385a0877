"""Results -> a folder of summary.json, timeseries.csv, scenario.yaml, written completely or not at all; then figures.

drawn       a picture that fails is told, and costs nothing else
units       numbers for readers
histories   panels over time, for figures and pages
overlay     several runs on one clock
figures     PNG, PDF and SVG
pages       one HTML file
"""

from __future__ import annotations

import csv
import ctypes
import glob
import json
import math
import os
import re
import secrets
import shutil
import sys
import time
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from granular_contact import __version__
from granular_contact.report.drawn import drawn, saved_before
from granular_contact.results import Results
from granular_contact.results.motion import Motion, motion_of, plain

try:
    import fcntl
except ImportError:  # on Windows, where nothing is locked
    fcntl = None  # type: ignore[assignment]

PROGRAM = "granular-contact"
SUMMARY, SERIES, SCENARIO, FIGURES = "summary.json", "timeseries.csv", "scenario.yaml", "figures"
MOTION = "motion.json"
FORMATS = ("png", "pdf", "svg")  # of figures
ANIMATION, PAGE = "animation", "report.html"  # .gif or .mp4; of any kind of results, see `report.pages`
COMPARISON, OF_MEDIA, OVERLAY = "compare.csv", "compare-media.csv", "histories.csv"
TABLE, SWEEP, CASES, LAW = "table.csv", "sweep.yaml", "cases", "law.png"
JOURNAL, SENSITIVITY = "journal", "sensitivity.csv"
STATISTICS, CONVERGENCE, BANDS = "statistics.csv", "convergence.csv", "bands.csv"  # of an ensemble, which is a sweep
OPTIMISE, HISTORY, OPTIMUM = "optimise.yaml", "history.csv", "optimise.json"
BEST_CONFIG, BEST = "best.yaml", "best"
FIT, RESIDUALS = "fit.json", "residuals.csv"
# What a results folder holds, by what wrote it.
ENTRIES = {
    "run": (SUMMARY, SERIES, SCENARIO, MOTION, FIGURES),
    "sweep": (TABLE, SWEEP, CASES, JOURNAL, SENSITIVITY, FIGURES, STATISTICS, CONVERGENCE, BANDS),
    "optimise": (OPTIMISE, HISTORY, OPTIMUM, BEST_CONFIG, BEST, JOURNAL, FIGURES),
    "compare": (COMPARISON, SUMMARY, SCENARIO, OVERLAY, MOTION, FIGURES),
    "compare-media": (OF_MEDIA, SCENARIO, OVERLAY, MOTION, FIGURES),
    "media": (LAW,),
    "fit": (FIT, "medium.yaml", *(f"medium_{i}.yaml" for i in range(8)), RESIDUALS, FIGURES),
}
YOUNG = 60.0  # s: age up to which nobody's folder is cleared away


def check_target(directory: Path, kind: str = "run") -> None:
    """Raise unless `directory` may become a results folder; to be called before a long run, and called by `write`.

    It may if it is absent, empty, or holds nothing but earlier results of its `kind`, a key of `ENTRIES` (files named
    `animation.*` or `report.html` count as such, so do hidden files): nothing that a user put there is ever replaced.

    Raises
    ------
    NotADirectoryError
        A file of that name is in the way.
    FileExistsError
        The folder holds something else; the message names it.
    """
    if not directory.exists():
        return
    if not directory.is_dir():
        raise NotADirectoryError(f"{directory} is a file; results need a folder: give another name")
    entries = sorted(path.name for path in directory.iterdir())
    own = (*ENTRIES[kind], PAGE)
    foreign = [name for name in entries if name not in own and not name.startswith((".", f"{ANIMATION}."))]
    if foreign:
        message = f"{directory} holds {foreign[0]!r}, which no {kind} wrote: give another folder or move it"
        raise FileExistsError(message)


def kind_of(directory: Path) -> str | None:
    """The kind of results (a key of `ENTRIES`) that a folder holds, by the files that only one kind has; else None."""
    counts = Counter(name for names in ENTRIES.values() for name in names)
    found = [k for k, names in ENTRIES.items() if any(counts[n] == 1 and (directory / n).exists() for n in names)]
    return found[0] if len(found) == 1 else None


def write(
    results: Results,
    directory: Path,
    figures: bool = True,
    film: str | None = None,
    formats: Sequence[str] = ("png",),
) -> None:
    """Write `results` to `directory`, in place of an earlier run's results there.

    film: `gif` or `mp4`, for the frames of results that have some; None for no animation. formats: of figures, beside
    the PNG that pages show (`FORMATS`).

    The folder is made beside its place under a hidden name and then exchanged for the old one, so that a full disk or
    Ctrl-C leaves the old folder as it was. Pictures come after that: one that can't be drawn is a `FigureWarning`.

    Raises
    ------
    OSError
        The disk refuses, or `check_target` does.
    """
    with whole_folder(directory) as making:
        (making / SUMMARY).write_text(_summary(results), encoding="utf-8")
        (making / SCENARIO).write_text(scenario_text(results), encoding="utf-8")
        write_table(making / SERIES, results.names, map(np.ndarray.tolist, results.table))
        if (motion := motion_of(results)) is not None:
            (making / MOTION).write_text(motion_text(motion, results), encoding="utf-8")
    with saved_before(directory):
        if figures:
            from granular_contact.report.figures import draw

            draw(results, directory / FIGURES, formats)
        if film is not None:
            from granular_contact.report.figures.film import write as animate

            with drawn(directory / f"{ANIMATION}.{film}") as picture:
                animate(results, picture)


@contextmanager
def whole_folder(directory: Path, kind: str = "run") -> Iterator[Path]:
    """Give an empty hidden folder beside `directory`, which replaces it when the block ends without an exception.

    kind: as for `check_target`, which is called first.
    """
    target = directory.resolve()  # of a symbolic link, what it points to is replaced
    check_target(target, kind)
    target.parent.mkdir(parents=True, exist_ok=True)
    _clear_left(target, kind)
    making = target.with_name(f".{target.name}.{secrets.token_hex(4)}")
    try:
        making.mkdir()
        with held(making):
            yield making
            swap(making, target)
    finally:  # either the unfinished new folder or, after an exchange, the old one
        shutil.rmtree(making, ignore_errors=True)


@contextmanager
def held(folder: Path) -> Iterator[bool | None]:
    """Lock a folder that a process is writing; False if another has it, None where nothing can be locked.

    The system releases the lock when the process dies.
    """
    if fcntl is None:
        yield None
        return
    handle = os.open(folder, os.O_RDONLY)
    locked: bool | None = True
    try:
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:  # another has it; or a file system without locks
            locked = False if isinstance(error, BlockingIOError) else None
        yield locked
    finally:
        os.close(handle)


def _clear_left(target: Path, kind: str) -> None:
    """Remove unfinished folders beside `target` of processes that were killed while they wrote there.

    Only folders with such a name, older than a minute, with nothing but results in them and not locked.
    """
    if fcntl is None:
        return
    name = re.compile(rf"\.{re.escape(target.name)}\.[a-z0-9_]{{8}}")
    for path in target.parent.glob(f".{glob.escape(target.name)}.*"):
        with suppress(OSError):
            if not name.fullmatch(path.name) or path.is_symlink() or time.time() - path.stat().st_mtime < YOUNG:
                continue
            check_target(path, kind)
            with held(path) as free:
                if free:
                    shutil.rmtree(path, ignore_errors=True)


def _summary(results: Results) -> str:
    """Text of summary.json: the summary as it is, then what every column of the time series means."""
    content = dict(results.summary)
    if "warnings" not in content:
        content = {"warnings": list(results.warnings), **content}
    content["columns"] = {column.name: column.description for column in results.columns}
    return json_text(content)


def motion_text(motion: Motion, results: Results) -> str:
    """Text of motion.json: how it moved, and what its bed looks like."""
    surface = results.surface
    bed = {
        "surface_m": surface.tolist() if isinstance(surface, np.ndarray) else surface,
        "layers_m": list(results.layers),
        "floor_m": results.floor,
    }
    return json.dumps(_plain({**plain(motion), "bed": bed}), ensure_ascii=False) + "\n"


def json_text(content: dict[str, Any]) -> str:
    """`content` as strict JSON, to be read."""
    return json.dumps(_plain(content), indent=2, allow_nan=False, ensure_ascii=False) + "\n"


def _plain(value: Any) -> Any:
    """`value` in JSON types, with None for NaN and infinities, which JSON does not have."""
    if isinstance(value, dict):
        return {key: _plain(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(entry) for entry in value]
    if isinstance(value, np.generic):
        return _plain(value.item())
    return None if isinstance(value, float) and not math.isfinite(value) else value


class _Dumper(yaml.SafeDumper):
    """Block style with plain lists of scalars on one line, and no anchors: written to be read."""

    def ignore_aliases(self, data: Any) -> bool:  # noqa: ARG002
        return True


def _represent_list(dumper: yaml.SafeDumper, data: list[Any]) -> yaml.Node:
    """A list of scalars as `[a, b]`, any other one entry per line."""
    flat = not any(isinstance(entry, dict | list) for entry in data)
    return dumper.represent_sequence("tag:yaml.org,2002:seq", data, flow_style=flat)


_Dumper.add_representer(list, _represent_list)


def scenario_text(results: Results) -> str:
    """Text of scenario.yaml: the resolved scenario below a line with its origin."""
    versions = results.summary.get("versions") or {}
    return origin(f"run {SCENARIO}", versions.get(PROGRAM, __version__)) + yaml_text(results.scenario)


def origin(command: str, version: str = __version__) -> str:
    """First line of a file that the program reads again: which version wrote it, and the command."""
    return f"# Written by {PROGRAM} {version}; to run it again: {PROGRAM} {command}\n"


def yaml_text(content: dict[str, Any]) -> str:
    """`content`, of plain YAML types, as text to be read."""
    return yaml.dump(content, Dumper=_Dumper, sort_keys=False, allow_unicode=True, width=120)


def write_table(path: Path, head: Sequence[str], rows: Iterable[Sequence[Any]]) -> None:
    """A CSV file; None is an empty cell, a float the shortest text that reads back as the same one."""
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(head)
        writer.writerows(rows)


def swap(making: Path, target: Path) -> None:
    """Put the finished folder `making` in the place of `target`; afterwards `making` is absent or the old folder."""
    if not target.exists():
        making.rename(target)
    elif not _exchange(making, target):
        _replace(making, target)


def _exchange(one: Path, other: Path) -> bool:
    """Exchange two folders in one system call, with no instant between; False where the system can't."""
    if not sys.platform.startswith("linux"):
        return False
    rename = getattr(ctypes.CDLL(None), "renameat2", None)  # glibc 2.28
    here, exchange = -100, 2  # AT_FDCWD, RENAME_EXCHANGE
    return rename is not None and rename(here, os.fsencode(one), here, os.fsencode(other), exchange) == 0


def _replace(making: Path, target: Path) -> None:
    """The same in two renames: between them the old folder has a hidden name; it is restored on failure."""
    old = making.with_name(f"{making.name}.old")
    try:
        target.rename(old)
        making.rename(target)
    except BaseException:
        if old.exists() and not target.exists():
            old.rename(target)
        raise
    shutil.rmtree(old, ignore_errors=True)
