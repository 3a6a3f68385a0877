"""What the scripts of a run's page get: the table, the panels to draw, the motion to play, files to save."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

import numpy as np

from granular_contact.report import MOTION, SCENARIO, SERIES, SUMMARY
from granular_contact.report.histories import Group, groups, others
from granular_contact.report.pages.folder import Bed, Folder
from granular_contact.report.pages.script import packed
from granular_contact.report.pages.stage import stage
from granular_contact.report.units import Array
from granular_contact.results.motion import Motion, plain

MOST_NUMBERS = 4_000_000  # of the table, in a page; of a longer one every second row, or third, and so on
_OF_STAGE = ("width", "height", "scale", "left", "top", "arrow", "longest")
_TERM = "_force_x_N"


def live(folder: Folder, summary: dict[str, Any]) -> dict[str, Any]:
    """Data for scripts, and what templates need of it: stage and groups of panels; empty without a table."""
    if not folder.has(SERIES):
        return {"data": {}, "in_space": False, "stage": None, "groups": [], "thinned": 0}
    names, table = folder.numbers(SERIES)
    every = max(1, -(-table.size // MOST_NUMBERS))
    columns = dict(zip(names, table.T, strict=True))
    found = _groups(names, columns) if len(table) > 1 else []
    played = folder.played() if len(table) > 1 else None
    moments = _moments(summary, columns) if len(table) else {}
    data: dict[str, Any] = {
        "name": summary.get("name") or folder.path.name,
        "table": _packed(names, table[::every]),
        "columns": others(names),
        "groups": [_told(group) for group in found],
        "moments": moments,
        "files": {name: folder.text(name) for name in (SUMMARY, SCENARIO, MOTION) if folder.has(name)},
    }
    shown: dict[str, Any] | None = None
    if played is not None and not played[0].in_space:
        shown = _stage(*played, columns, moments)
        data["stage"] = {key: shown[key] for key in _OF_STAGE}
    if played is not None:
        data["motion"] = plain(played[0])
    told = {"stage": shown, "groups": found, "thinned": every if every > 1 else 0}
    return {"data": data, "in_space": played is not None and played[0].in_space, **told}


def _groups(names: list[str], columns: dict[str, Array]) -> list[Group]:
    terms = [n.removesuffix(_TERM) for n in names if n.endswith(_TERM)]
    return groups(names, terms, columns.__getitem__)


def _told(group: Group) -> dict[str, Any]:
    """A group as JSON."""
    return {
        "name": group.name,
        "panels": [
            {
                "title": panel.title,
                "unit": panel.unit.name,
                "factor": panel.unit.factor,
                "along": panel.along,
                "curves": [asdict(curve) for curve in panel.curves],
            }
            for panel in group.panels
        ],
    }


def _packed(names: list[str], table: Array) -> dict[str, Any]:
    """The table for scripts: time as it is, all else to seven digits."""
    time = names.index("time_s") if "time_s" in names else 0
    with np.errstate(over="ignore"):
        values = np.ascontiguousarray(np.delete(table, time, axis=1).T, "<f4")
    return {
        "names": [name for i, name in enumerate(names) if i != time],
        "rows": len(table),
        "time": packed(np.ascontiguousarray(table[:, time], "<f8").tobytes()),
        # bytes of the same weight beside each other, which packs better
        "values": packed(values.reshape(-1, 1).view(np.uint8).T.tobytes()),
    }


def _moments(summary: dict[str, Any], columns: dict[str, Array]) -> dict[str, float]:
    """Instants (s) to go to, by their names."""
    time, found = columns["time_s"], dict[str, float]()
    touch, stop = summary.get("touch_time_s"), summary.get("stopping_time_s")
    if touch is not None and touch > time[0] + 0.01 * np.ptp(time):
        found["touch"] = float(touch)
    if "depth_m" in columns:
        found["deepest"] = float(time[int(np.argmax(columns["depth_m"]))])
    if touch is not None and stop is not None:
        found["stop"] = float(touch + stop)
    return found


def _stage(motion: Motion, bed: Bed, columns: dict[str, Array], moments: dict[str, float]) -> dict[str, Any]:
    """The stage of the player, with the path of the first body, or of the tip."""
    bodies = [n.removesuffix("_vx_m_s") for n in columns if n.endswith("_vx_m_s")]
    of = bodies[0] if bodies else "tip"
    has = f"{of}_x_m" in columns and f"{of}_y_m" in columns
    path = np.column_stack([columns[f"{of}_x_m"], columns[f"{of}_y_m"]]) if has else np.zeros((0, 2))
    shown = int(np.argmin(np.abs(motion.time - moments.get("deepest", motion.time[-1]))))
    return {**stage(motion, bed, shown, path), "shown": shown, "of": of}
