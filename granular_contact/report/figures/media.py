"""Histories of one run in several media in common panels."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from granular_contact.report.figures.panels import saved_figure
from granular_contact.report.figures.style import DOUBLE, LINES, PALETTE
from granular_contact.report.units import Array, unit_for
from granular_contact.results import Results
from granular_contact.results.series import resultant

Runs = list[tuple[str, Results]]


def draw_media(runs: Runs, file: Path) -> None:
    """Draw runs (medium and results) into a PNG: depth or distance, force of the medium, energy that it took."""
    with saved_figure(file, 150.0, DOUBLE) as figure:
        panels = figure.subplots(3, 1, sharex=True)
        time = unit_for(_end(runs), "s")
        paths = [_path(one) for _, one in runs]
        length = unit_for(np.concatenate(paths), "m")
        walks = bool(_body(runs[0][1]))
        drawn = {
            f"{'distance' if walks else 'depth'} ({length.name})": [path * length.factor for path in paths],
            "force of the medium (N)": [np.linalg.norm(resultant(one, one.terms), axis=0) for _, one in runs],
            "energy taken (J)": [-one["granular_work_J"] for _, one in runs],
        }
        for axes, (label, curves) in zip(panels, drawn.items(), strict=True):
            axes.set_ylabel(label)
            for i, ((name, one), values) in enumerate(zip(runs, curves, strict=True)):
                look = {"color": PALETTE[i % len(PALETTE)], "linestyle": LINES[i % len(LINES)], "label": name}
                axes.plot(one["time_s"] * time.factor, values, **look)
        if not walks:
            panels[0].invert_yaxis()
        panels[0].legend()
        panels[2].set_xlabel(f"time ({time.name})")
        panels[2].set_xlim(0.0, _end(runs) * time.factor)


def _body(one: Results) -> str:
    """What travels: the first body of a run whose summary has a distance; empty for what does not."""
    if one.summary.get("distance_m") is None:
        return ""
    return next((name.removesuffix("_vx_m_s") for name in one.names if name.endswith("_vx_m_s")), "")


def _path(one: Results) -> Array:
    """Distance of what travels, of all else its depth (rows,) m."""
    body = _body(one)
    return one[f"{body}_x_m"] - one[f"{body}_x_m"][0] if body else one["depth_m"]


def _end(runs: Runs) -> float:
    """Time (s) until which there is something to see."""
    ends = []
    for _, one in runs:
        touch, stopping = one.summary["touch_time_s"], one.summary["stopping_time_s"]
        ends.append(one["time_s"][-1] if touch is None or stopping is None else touch + 1.3 * stopping)
    return float(max(ends))
