"""What users ask of results that the parts above do: folders by `report`, figures by `report.figures`."""

from __future__ import annotations

import base64
import importlib
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from html import escape
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, get_args

import numpy as np
from numpy.typing import NDArray

from granular_contact.errors import ConfigError, MissingPackageError, ResultsError, SceneError
from granular_contact.results import Column, Results, Status, StatusCode
from granular_contact.results.motion import frames_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from granular_contact.report.pages.folder import Folder

_TERM = re.compile(r"(.+)_force_x_N")
_SHOWN = (
    *("stopping_time_s", "angle_at_stop_deg", "max_depth_m", "max_deflection_m"),
    *("forward_speed_m_s", "forward_speed_second_half_m_s", "cost_of_transport"),
)


def dataframe(results: Results) -> Any:
    """The table as a DataFrame."""
    try:
        pandas: Any = importlib.import_module("pandas")
    except ImportError:
        raise MissingPackageError("to_dataframe() needs pandas: pip install pandas") from None
    frame = pandas.DataFrame(results.table.copy(), columns=results.names)
    frame.attrs = {column.name: column.description for column in results.columns}
    return frame


def plot(results: Results, names: Sequence[str]) -> Figure:
    """Columns over time."""
    from granular_contact.report.figures import style
    from granular_contact.report.figures.over_time import chosen

    with style():
        return chosen(results, names)


def figures(results: Results) -> dict[str, Figure]:
    """All figures of a run."""
    from granular_contact.report import figures as drawn

    with drawn.style():
        return drawn.figures(results)


@dataclass(frozen=True)
class Film(PathLike[str]):
    """A film in a file; a notebook plays it."""

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
    """Write the pictures of a run as a film."""
    if file.suffix not in (".gif", ".mp4"):
        raise ResultsError(f"{file}: got the ending {file.suffix!r}; allowed are .gif and .mp4")
    if not results.frames and results.motion is None:
        raise ResultsError(f"{results.name} has no pictures: the run had most_frames=0")
    from granular_contact.report.figures.film import write

    write(results, file)
    return Film(file)


def save(results: Results, directory: Path, with_figures: bool) -> Path:
    """Write a results folder."""
    from granular_contact import report

    report.write(results, directory, figures=with_figures)
    return directory


# ---- a folder read back ----


def opened(directory: Path) -> Results:
    """The results of a run in a folder."""
    from granular_contact.report import SCENARIO, SERIES, SUMMARY, kind_of
    from granular_contact.report.pages.folder import Folder

    if not directory.is_dir():
        raise ResultsError(f"{directory} is {'a file' if directory.exists() else 'not there'}; a folder is needed")
    kind, folder = kind_of(directory), Folder(directory, "run")
    if kind not in (None, "run"):
        raise ResultsError(f"{directory} holds results of a {kind}, and not of one run")
    summary = folder.read(SUMMARY)
    columns = tuple(_columns(summary.pop("columns", None), directory / SUMMARY))
    table = _table(folder, SERIES, columns)
    status = _status(summary, directory / SUMMARY)
    scenario, bed = _scenario(folder, SCENARIO)
    terms = tuple(found[1] for column in columns if (found := _TERM.fullmatch(column.name)))
    warnings = tuple(map(str, summary.get("warnings") or ()))
    return Results(
        name=str(summary.get("name")),
        status=status,
        columns=columns,
        table=table,
        summary=summary,
        scenario=scenario,
        snapshots=(),
        warnings=warnings,
        terms=terms,
        **_pictures(folder),
        **bed,
    )


def _pictures(folder: Folder) -> dict[str, Any]:
    """Frames or motion, as far as the folder holds some."""
    found = folder.motion()
    if found is None:
        return {}
    return {"motion": found} if found.in_space else {"frames": frames_of(found)}


def _columns(saved: object, file: Path) -> Iterator[Column]:
    if not isinstance(saved, dict) or not saved:
        raise ResultsError(f"{file}: has no columns, as this program writes them")
    yield from (Column(str(name), str(words)) for name, words in saved.items())


def _status(summary: dict[str, Any], file: Path) -> Status:
    code: Any = summary.get("status")
    message = summary.get("message")
    if code not in get_args(StatusCode) or not isinstance(message, str):
        raise ResultsError(f"{file}: got the status {code!r}; allowed is one of {', '.join(get_args(StatusCode))}")
    return Status(code, message)


def _table(folder: Folder, name: str, columns: Sequence[Column]) -> NDArray[np.float64]:
    _need(folder, name)
    found = folder.numbers(name)
    if list(found) != [column.name for column in columns]:
        raise ResultsError(f"{folder.path / name}: has other columns than summary.json says")
    return np.column_stack(list(found.values()))


def _need(folder: Folder, name: str) -> None:
    if not folder.has(name):
        raise ResultsError(f"{folder.path} holds no {name}: it is not a complete run")


def _scenario(folder: Folder, name: str) -> tuple[dict[str, Any], dict[str, Any]]:
    """The scenario as plain data, and what its bed looks like."""
    from granular_contact.config import load, scenario_to_dict
    from granular_contact.results.observation import bed_of
    from granular_contact.scene.build import build

    _need(folder, name)
    try:
        loaded = load(folder.path / name)
        return scenario_to_dict(loaded.scenario), bed_of(build(loaded))
    except (ConfigError, SceneError) as error:
        more = f" (and {len(error.faults) - 1} more)" if len(error.faults) > 1 else ""
        raise ResultsError(f"{error.faults[0]}{more}") from None


# ---- in a notebook ----


def notebook(results: Results) -> str:
    """Results as a piece of HTML: how the run ended, key numbers, warnings, and the columns to unfold."""
    from granular_contact.report.units import label, quantity

    known = [
        (label(key), quantity(key, results.summary[key])) for key in _SHOWN if results.summary.get(key) is not None
    ]
    numbers = "".join(f"<tr><td>{escape(words)}</td><td>{escape(value)}</td></tr>" for words, value in known)
    warnings = "".join(f"<p>warning: {escape(words)}</p>" for words in results.warnings)
    columns = _rows((f"<code>{escape(one.name)}</code>", escape(one.description)) for one in results.columns)
    count = f"{len(results.table)} rows, {len(results.columns)} columns"
    return (
        f"<p><b>{escape(results.name)}</b>: {escape(results.status.message)}</p>{warnings}"
        f"<table>{numbers}</table><details><summary>{count}</summary><table>{columns}</table></details>"
    )


def _rows(pairs: Iterable[tuple[str, str]]) -> str:
    return "".join(f"<tr><td>{left}</td><td>{right}</td></tr>" for left, right in pairs)
