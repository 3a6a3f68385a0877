"""Methods of `Results` that need rooms above this one: folders (`report`) and figures (`report.figures`)."""

from __future__ import annotations

import base64
import importlib
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from html import escape
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, get_args

import numpy as np

from granular_contact.errors import ConfigError, MissingPackageError, ResultsError, SceneError
from granular_contact.results import Column, Results, Status, StatusCode
from granular_contact.results.motion import frames_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure


_TERM = re.compile(r"(.+)_force_x_N")
_SHOWN = (
    *("stopping_time_s", "angle_at_stop_deg", "max_depth_m", "max_deflection_m"),
    *("forward_speed_m_s", "forward_speed_second_half_m_s", "cost_of_transport"),
)


def dataframe(results: Results) -> Any:
    """`Results.to_dataframe`."""
    try:
        pandas: Any = importlib.import_module("pandas")
    except ImportError:
        raise MissingPackageError("to_dataframe() needs pandas: pip install pandas") from None
    frame = pandas.DataFrame(results.table.copy(), columns=results.names)
    frame.attrs = {column.name: column.description for column in results.columns}
    return frame


def plot(results: Results, names: Sequence[str]) -> Figure:
    """`Results.plot`."""
    from granular_contact.report.figures import style
    from granular_contact.report.figures.over_time import chosen

    with style():
        return chosen(results, names)


def figures(results: Results) -> dict[str, Figure]:
    """`Results.figures`."""
    from granular_contact.report import figures as drawn

    with drawn.style():
        return drawn.figures(results)


@dataclass(frozen=True)
class Film(PathLike[str]):
    """Path of a film; a notebook plays it."""

    path: Path

    def __repr__(self) -> str:
        return f"<film {self.path}>"

    def __fspath__(self) -> str:
        return str(self.path)

    def _repr_html_(self) -> str:
        data = base64.b64encode(self.path.read_bytes()).decode()
        if self.path.suffix == ".mp4":
            return f'<video controls loop src="data:video/mp4;base64,{data}"></video>'
        return f'<img alt="{escape(self.path.name)}" src="data:image/gif;base64,{data}">'


def animation(results: Results, file: Path) -> Film:
    """`Results.animation`."""
    if file.suffix not in (".gif", ".mp4"):
        raise ResultsError(f"{file}: got the ending {file.suffix!r}; allowed are .gif and .mp4")
    if not results.frames and results.motion is None:
        raise ResultsError(f"{results.name} has no pictures, because the run was made with most_frames=0")
    from granular_contact.report.figures.film import write

    write(results, file)
    return Film(file)


def save(results: Results, directory: Path, with_figures: bool) -> Path:
    """`Results.save`."""
    from granular_contact import report

    report.write(results, directory, figures=with_figures)
    return directory


# ---- reading a folder ----


def opened(directory: Path) -> Results:
    """`Results.open`."""
    from granular_contact.report import SCENARIO, SERIES, SUMMARY, kind_of
    from granular_contact.report.pages.folder import Folder

    if not directory.is_dir():
        fault = "is a file" if directory.exists() else "does not exist"
        raise ResultsError(f"{directory} {fault}; the folder of a run is needed")
    kind, folder = kind_of(directory), Folder(directory, "run")
    if kind not in (None, "run"):
        raise ResultsError(f"{directory} contains results of a {kind}; the folder of a single run is needed")
    summary = folder.read(SUMMARY)
    columns = tuple(Column(str(name), str(text)) for name, text in (summary.pop("columns", None) or {}).items())
    if not columns:
        raise ResultsError(f"{directory / SUMMARY}: has no columns, as a summary of a run must have")
    table, status = folder.numbers(SERIES), _status(summary, directory / SUMMARY)
    if list(table) != [column.name for column in columns]:
        raise ResultsError(f"{directory / SERIES}: has other columns than those listed in {SUMMARY}")
    scenario, bed = _scenario(folder.file(SCENARIO))
    motion = folder.motion()
    return Results(
        name=str(summary.get("name")),
        status=status,
        columns=columns,
        table=np.column_stack(list(table.values())),
        summary=summary,
        scenario=scenario,
        snapshots=(),
        warnings=tuple(map(str, summary.get("warnings") or ())),
        terms=tuple(match[1] for column in columns if (match := _TERM.fullmatch(column.name))),
        frames=() if motion is None else frames_of(motion),
        motion=motion if motion is not None and motion.in_space else None,
        **bed,
    )


def _status(summary: dict[str, Any], file: Path) -> Status:
    code: Any = summary.get("status")
    message = summary.get("message")
    if code not in get_args(StatusCode) or not isinstance(message, str):
        raise ResultsError(f"{file}: got the status {code!r}; allowed is one of {', '.join(get_args(StatusCode))}")
    return Status(code, message)


def _scenario(file: Path) -> tuple[dict[str, Any], dict[str, Any]]:
    """Read a scenario file: the scenario as plain YAML types, and the fields of `Results` that describe its bed."""
    from granular_contact.config import load, scenario_to_dict
    from granular_contact.results.observation import bed_of
    from granular_contact.scene.build import build

    try:
        loaded = load(file)
        return scenario_to_dict(loaded.scenario), bed_of(build(loaded))
    except (ConfigError, SceneError) as error:
        more = f" (and {len(error.faults) - 1} more)" if len(error.faults) > 1 else ""
        raise ResultsError(f"{error.faults[0]}{more}") from None


# ---- in a notebook ----


def notebook(results: Results) -> str:
    """Results as HTML for a notebook: status, key numbers, warnings, and the list of columns, folded."""
    from granular_contact.report.units import label, quantity

    rows = [(label(key), quantity(key, results.summary[key])) for key in _SHOWN if results.summary.get(key) is not None]
    numbers = "".join(f"<tr><td>{escape(name)}</td><td>{escape(value)}</td></tr>" for name, value in rows)
    warnings = "".join(f"<p>warning: {escape(warning)}</p>" for warning in results.warnings)
    columns = _rows((f"<code>{escape(column.name)}</code>", escape(column.description)) for column in results.columns)
    count = f"{len(results.table)} rows, {len(results.columns)} columns"
    return (
        f"<p><b>{escape(results.name)}</b>: {escape(results.status.message)}</p>{warnings}"
        f"<table>{numbers}</table><details><summary>{count}</summary><table>{columns}</table></details>"
    )


def _rows(pairs: Iterable[tuple[str, str]]) -> str:
    return "".join(f"<tr><td>{left}</td><td>{right}</td></tr>" for left, right in pairs)
