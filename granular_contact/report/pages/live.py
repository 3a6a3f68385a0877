"""Data for the scripts of a page, of one run or of several on a common time axis: table, panels, motion, files."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, replace
from typing import Any

import numpy as np

from granular_contact.report import OVERLAY, SERIES
from granular_contact.report.histories import BASES, Curve, Group, groups_of
from granular_contact.report.overlay import keys, panels
from granular_contact.report.pages.folder import Bed, Folder
from granular_contact.report.pages.rendering import packed
from granular_contact.report.pages.stage import stage
from granular_contact.report.units import Array, label, split
from granular_contact.results.motion import Motion, plain

MOST_NUMBERS = 4_000_000  # greatest size of the table in a page; of a longer one every second row, or every third, ...
_OF_STAGE = ("width", "height", "left", "top", "arrow", "longest")
_TERM = "_force_x_N"


def nothing_live() -> dict[str, Any]:
    """Values for the template of a page without motion and histories."""
    return {"in_space": False, "stage": None, "groups": [], "thinned": 0, "overlaid": [], "data": {}}


def live(folder: Folder, summary: dict[str, Any]) -> dict[str, Any]:
    """Data of a run for scripts, and values for the template: stage and groups of panels; empty without a table."""
    if not folder.has(SERIES):
        return nothing_live()
    columns = folder.numbers(SERIES)
    rows = len(columns["time_s"])
    terms = [name.removesuffix(_TERM) for name in columns if name.endswith(_TERM)]
    groups = groups_of(list(columns), terms, columns.__getitem__) if rows > 1 else []
    played = folder.played() if rows > 1 else None
    moments = _moments(summary, columns) if rows else {}
    shown = _stage(*played, columns, moments) if played is not None and not played[0].in_space else None
    page = _page(columns, groups, played, shown)
    more = {"name": summary.get("name") or folder.path.name, "columns": _columns(list(columns)), "moments": moments}
    return page | {"data": page["data"] | more}


def live_overlay(
    names: Sequence[str], columns: Mapping[str, Array], played: tuple[Motion, Bed] | None, reference: str = ""
) -> dict[str, Any]:
    """`live` for several runs, in a table of `report.overlay`; reference: name of the reference run."""
    if len(columns.get("time_s", ())) < 2:
        return nothing_live()
    prefixes = keys(names)
    shown = None
    if played is not None and not played[0].in_space:
        at = max(0, int(np.searchsorted(played[0].time, _first_end(prefixes, columns))) - 1)
        shown = stage(*played, at, np.zeros((0, 2))) | {"shown": at, "of": ""}
    page = _page(*_subtracted(columns, panels(names, columns, reference)), played, shown)
    runs = [{"key": key, "name": name} for key, name in zip(prefixes, names, strict=True)]
    every = dict.fromkeys(name.partition(".")[2] for name in columns if name != "time_s")
    more = {"runs": runs, "columns": _columns(list(every)), "table_name": OVERLAY}
    return page | {"overlaid": runs, "data": page["data"] | more}


def _subtracted(columns: Mapping[str, Array], groups: list[Group]) -> tuple[Mapping[str, Array], list[Group]]:
    """Add differences of runs to the table as columns: differences of the page's seven-digit numbers would be rough."""
    more: dict[str, Array] = {}

    def single(curve: Curve) -> Curve:
        if not any(factor < 0.0 and len(curve.terms) > 1 for _, factor in curve.terms):
            return curve
        key, _, name = curve.terms[0][0].partition(".")
        more[f"{key}.difference_of_{name}"] = curve.values(columns.__getitem__)
        return Curve(curve.label, ((f"{key}.difference_of_{name}", 1.0),))

    drawn = [
        replace(group, panels=tuple(replace(p, curves=tuple(map(single, p.curves))) for p in group.panels))
        for group in groups
    ]
    return {**columns, **more}, drawn


def _columns(names: Sequence[str]) -> list[tuple[str, str]]:
    """Names and labels of all columns with a unit, for the choice of another column."""
    return [(name, label(name)) for name in names if name != "time_s" and split(name)[1] in BASES]


def _first_end(prefixes: Sequence[str], columns: Mapping[str, Array]) -> float:
    """Time (s) at which the first of several runs ends."""
    columns_of_runs = [next((v for n, v in columns.items() if n.startswith(f"{key}.")), None) for key in prefixes]
    time = columns["time_s"]
    ends = [float(time[np.isfinite(values)][-1]) for values in columns_of_runs if values is not None]
    return min(ends, default=time[-1])


def live_curves(columns: Mapping[str, Array], groups: list[Group], table_name: str) -> dict[str, Any]:
    """`live` for a table of curves over time without a motion."""
    page = _page(columns, groups, None, None)
    return page | {"data": page["data"] | {"columns": [], "table_name": table_name}}


def _page(
    columns: Mapping[str, Array], groups: list[Group], played: tuple[Motion, Bed] | None, shown: dict[str, Any] | None
) -> dict[str, Any]:
    """Data for scripts and values for templates of all pages with histories; shown: stage of a motion in the plane."""
    table = np.column_stack(list(columns.values()))
    every = max(1, -(-table.size // MOST_NUMBERS))
    data: dict[str, Any] = {
        "table": _packed(list(columns), table[::every]),
        "groups": [asdict(group) for group in groups],
        "moments": {},
    }
    if shown is not None:
        data["stage"] = {key: shown[key] for key in _OF_STAGE}
    if played is not None:
        data["motion"] = plain(played[0] if shown is None else shown["motion"])
    space = played is not None and played[0].in_space
    kept = {"stage": shown, "in_space": space, "groups": groups, "thinned": every if every > 1 else 0}
    return nothing_live() | kept | {"data": data}


def _packed(names: list[str], table: Array) -> dict[str, Any]:
    """Pack the table for scripts: time in double precision, all other columns in single precision (seven digits)."""
    time = names.index("time_s") if "time_s" in names else 0
    with np.errstate(over="ignore"):
        values = np.ascontiguousarray(np.delete(table, time, axis=1).T, "<f4")
    return {
        "names": [name for i, name in enumerate(names) if i != time],
        "rows": len(table),
        "time": packed(np.ascontiguousarray(table[:, time], "<f8").tobytes()),
        # Bytes of the same significance are stored together, which compresses better.
        "values": packed(values.reshape(-1, 1).view(np.uint8).T.tobytes()),
    }


def _moments(summary: dict[str, Any], columns: dict[str, Array]) -> dict[str, float]:
    """Instants (s) that the player offers, by name."""
    time, moments = columns["time_s"], dict[str, float]()
    touch, stop = summary.get("touch_time_s"), summary.get("stopping_time_s")
    if touch is not None and touch > time[0] + 0.01 * np.ptp(time):
        moments["touch"] = float(touch)
    if "depth_m" in columns:
        moments["deepest"] = float(time[int(np.argmax(columns["depth_m"]))])
    if touch is not None and stop is not None:
        moments["stop"] = float(touch + stop)
    return moments


def _stage(motion: Motion, bed: Bed, columns: dict[str, Array], moments: dict[str, float]) -> dict[str, Any]:
    """Stage of the player, with the path of the first body, or of the tip."""
    bodies = [n.removesuffix("_vx_m_s") for n in columns if n.endswith("_vx_m_s")]
    of = bodies[0] if bodies else "tip"
    has = f"{of}_x_m" in columns and f"{of}_y_m" in columns
    path = np.column_stack([columns[f"{of}_x_m"], columns[f"{of}_y_m"]]) if has else np.zeros((0, 2))
    shown = int(np.argmin(np.abs(motion.time - moments.get("deepest", motion.time[-1]))))
    return {**stage(motion, bed, shown, path), "shown": shown, "of": of}
