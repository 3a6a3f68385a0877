"""Write results to a folder: summary.json, timeseries.csv and scenario.yaml, completely or not at all; then figures.

drawn       figures are written after the data; one that fails is a warning
units       units of axes, and numbers as text
histories   panels over time, for figures and pages
overlay     several runs on one time axis
figures     figures as PNG, PDF and SVG; films
pages       report as one HTML file
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
except ImportError:  # on Windows, where folders are not locked
    fcntl = None  # type: ignore[assignment]

PROGRAM = "granular-contact"
SUMMARY, SERIES, SCENARIO, FIGURES = "summary.json", "timeseries.csv", "scenario.yaml", "figures"
MOTION = "motion.json"
FORMATS = ("png", "pdf", "svg")  # of figures
ANIMATION, PAGE = "animation", "report.html"  # film without its ending (.gif or .mp4); page, see `report.pages`
COMPARISON, OF_MEDIA, OVERLAY = "compare.csv", "compare-media.csv", "histories.csv"
TABLE, SWEEP, CASES, LAW = "table.csv", "sweep.yaml", "cases", "law.png"
JOURNAL, SENSITIVITY = "journal", "sensitivity.csv"
STATISTICS, CONVERGENCE, BANDS = "statistics.csv", "convergence.csv", "bands.csv"  # of an ensemble, which is a sweep
OPTIMISE, HISTORY, OPTIMUM = "optimise.yaml", "history.csv", "optimise.json"
BEST_CONFIG, BEST = "best.yaml", "best"
FIT, RESIDUALS = "fit.json", "residuals.csv"
# Entries of a results folder, by kind of results.
ENTRIES = {
    "run": (SUMMARY, SERIES, SCENARIO, MOTION, FIGURES),
    "sweep": (TABLE, SWEEP, CASES, JOURNAL, SENSITIVITY, FIGURES, STATISTICS, CONVERGENCE, BANDS),
    "optimise": (OPTIMISE, HISTORY, OPTIMUM, BEST_CONFIG, BEST, JOURNAL, FIGURES),
    "compare": (COMPARISON, SUMMARY, SCENARIO, OVERLAY, MOTION, FIGURES),
    "compare-media": (OF_MEDIA, SCENARIO, OVERLAY, MOTION, FIGURES),
    "media": (LAW,),
    "fit": (FIT, "medium.yaml", *(f"medium_{i}.yaml" for i in range(8)), RESIDUALS, FIGURES),
}
YOUNG = 60.0  # s: unfinished folders of other processes are removed only if they are older


def check_target(directory: Path, kind: str = "run") -> None:
    """Check that `directory` may become a results folder. `write` calls it; call it before a long run as well.

    The folder may be absent, empty, or contain only earlier results of its `kind`, a key of `ENTRIES`; `animation.*`,
    `report.html` and hidden files count as results. So a file that a user put there is never replaced.

    Raises
    ------
    NotADirectoryError
        A file has this name.
    FileExistsError
        The folder contains something else; the message names it.
    """
    if not directory.exists():
        return
    if not directory.is_dir():
        raise NotADirectoryError(f"{directory} is a file; results need a folder: give another name")
    entries = sorted(path.name for path in directory.iterdir())
    results = (*ENTRIES[kind], PAGE)
    foreign = [name for name in entries if name not in results and not name.startswith((".", f"{ANIMATION}."))]
    if foreign:
        message = f"{directory} contains {foreign[0]!r}, which no {kind} wrote: give another folder, or move this file"
        raise FileExistsError(message)


def kind_of(directory: Path) -> str | None:
    """Kind of results (a key of `ENTRIES`) in a folder, recognised by files of this kind alone; None if unclear."""
    counts = Counter(name for names in ENTRIES.values() for name in names)
    kinds = [
        kind
        for kind, names in ENTRIES.items()
        if any(counts[name] == 1 and (directory / name).exists() for name in names)
    ]
    return kinds[0] if len(kinds) == 1 else None


def write(
    results: Results,
    directory: Path,
    figures: bool = True,
    film: str | None = None,
    formats: Sequence[str] = ("png",),
) -> None:
    """Write the results of a run to a folder; results of an earlier run in the folder are replaced.

    The folder is written beside the target under a hidden name and then exchanged for the old one, so that a full disk
    or Ctrl-C leaves the old folder unchanged. Figures are drawn after that; one that fails is a `FigureWarning`.

    Parameters
    ----------
    results : Results
        The results.
    directory : Path
        The folder.
    figures : bool, optional
        Whether figures are drawn.
    film : {"gif", "mp4"}, optional
        Format of a film of results with frames; none is made by default.
    formats : sequence of str, optional
        Formats of the figures (`FORMATS`), in addition to the PNG that pages show.

    Raises
    ------
    OSError
        The folder cannot be written, or `check_target` refuses it.
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
    """Provide an empty hidden folder, which replaces `directory` when the block ends without an exception.

    kind: see `check_target`, which is called first.
    """
    target = directory.resolve()  # a symbolic link stays; its target is replaced
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
    """Lock a folder within the block; yields False if another process holds the lock, None if locks are not supported.

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
        except OSError as error:  # another process holds it, or the file system has no locks
            locked = False if isinstance(error, BlockingIOError) else None
        yield locked
    finally:
        os.close(handle)


def _clear_left(target: Path, kind: str) -> None:
    """Remove unfinished folders beside `target`, left by killed processes.

    A folder is removed only if it has such a name, is older than `YOUNG`, contains only results and is not locked.
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
    """Text of summary.json: the summary, followed by the descriptions of all columns of the time series."""
    content = dict(results.summary)
    if "warnings" not in content:
        content = {"warnings": list(results.warnings), **content}
    content["columns"] = {column.name: column.description for column in results.columns}
    return json_text(content)


def motion_text(motion: Motion, results: Results) -> str:
    """Text of motion.json: the motion, and surface, layers and floor of the bed."""
    surface = results.surface
    bed = {
        "surface_m": surface.tolist() if isinstance(surface, np.ndarray) else surface,
        "layers_m": list(results.layers),
        "floor_m": results.floor,
    }
    return json.dumps(_plain({**plain(motion), "bed": bed}), ensure_ascii=False) + "\n"


def json_text(content: dict[str, Any]) -> str:
    """Format `content` as strict JSON with line breaks."""
    return json.dumps(_plain(content), indent=2, allow_nan=False, ensure_ascii=False) + "\n"


def _plain(value: Any) -> Any:
    """Convert `value` to JSON types, with None for NaN and infinities, which JSON does not have."""
    if isinstance(value, dict):
        return {key: _plain(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(entry) for entry in value]
    if isinstance(value, np.generic):
        return _plain(value.item())
    return None if isinstance(value, float) and not math.isfinite(value) else value


class _Dumper(yaml.SafeDumper):
    """YAML in block style, with lists of scalars on one line and without anchors."""

    def ignore_aliases(self, data: Any) -> bool:  # noqa: ARG002
        return True


def _represent_list(dumper: yaml.SafeDumper, data: list[Any]) -> yaml.Node:
    """Write a list of scalars as `[a, b]`, any other list with one entry per line."""
    flat = not any(isinstance(entry, dict | list) for entry in data)
    return dumper.represent_sequence("tag:yaml.org,2002:seq", data, flow_style=flat)


_Dumper.add_representer(list, _represent_list)


def scenario_text(results: Results) -> str:
    """Text of scenario.yaml: the resolved scenario below a line with its origin."""
    versions = results.summary.get("versions") or {}
    return origin(f"run {SCENARIO}", versions.get(PROGRAM, __version__)) + yaml_text(results.scenario)


def origin(command: str, version: str = __version__) -> str:
    """First line of a file that can be run again: the version that wrote it, and the command."""
    return f"# Written by {PROGRAM} {version}; to run it again: {PROGRAM} {command}\n"


def yaml_text(content: dict[str, Any]) -> str:
    """Format `content`, of plain YAML types, as YAML."""
    return yaml.dump(content, Dumper=_Dumper, sort_keys=False, allow_unicode=True, width=120)


def write_table(path: Path, head: Sequence[str], rows: Iterable[Sequence[Any]]) -> None:
    """Write a CSV file; None is an empty cell, a float the shortest text that reads back as the same number."""
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(head)
        writer.writerows(rows)


def swap(making: Path, target: Path) -> None:
    """Replace `target` by the finished folder `making`; afterwards `making` is absent, or the old folder."""
    if not target.exists():
        making.rename(target)
    elif not _exchange(making, target):
        _replace(making, target)


def _exchange(first: Path, second: Path) -> bool:
    """Exchange two folders atomically, in one system call; return False if the system does not support it."""
    if not sys.platform.startswith("linux"):
        return False
    rename = getattr(ctypes.CDLL(None), "renameat2", None)  # glibc 2.28
    at_cwd, exchange = -100, 2  # AT_FDCWD, RENAME_EXCHANGE
    return rename is not None and rename(at_cwd, os.fsencode(first), at_cwd, os.fsencode(second), exchange) == 0


def _replace(making: Path, target: Path) -> None:
    """Replace a folder by two renames; in between the old folder has a hidden name. It is restored on failure."""
    old = making.with_name(f"{making.name}.old")
    try:
        target.rename(old)
        making.rename(target)
    except BaseException:
        if old.exists() and not target.exists():
            old.rename(target)
        raise
    shutil.rmtree(old, ignore_errors=True)
