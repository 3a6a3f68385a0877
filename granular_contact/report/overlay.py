"""Several runs on one clock: their histories side by side, and their motions as one, for pages that compare them.

A column of a run is named `RUN.column`, where RUN is its name without spaces and signs. Positions and angles between
the rows of a run are cubics (as in `results.interpolation`), all else is linear. A run that ends before the others has
no numbers after its end, and stays where it was.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from granular_contact.report import MOTION, OVERLAY, motion_text
from granular_contact.report.histories import ROUND_OFF, Group, Panel, distinct, groups, in_unit
from granular_contact.report.units import Array, greatest, split
from granular_contact.results import Results
from granular_contact.results.frames import MOST, resample
from granular_contact.results.interpolation import at_times, rates
from granular_contact.results.motion import Motion, motion_of

MOST_NUMBERS, MOST_ROWS, LEAST_ROWS = 600_000, 4000, 400  # of a table
MOST_CURVES = 4  # of a panel of one run; of more the first two are compared, and any other can be chosen
_SMOOTH = ("deg", "m")  # units of what is a cubic between rows
_BALANCE = ("granular_work_J", "drive_work_J", "energy_imbalance_J")  # energies that are compared


@dataclass(frozen=True)
class History:
    """A run as it is compared: its columns (rows,) by name, `time_s` among them, and how it moved if that is known."""

    name: str
    columns: Mapping[str, Array]
    motion: Motion | None = None


def history(name: str, results: Results) -> History:
    """What is compared of results."""
    return History(name, {column: results[column] for column in results.names}, motion_of(results))


def keys(names: Iterable[str]) -> list[str]:
    """What columns of runs begin with, one for each name, all of them different."""
    found: list[str] = []
    for name in names:
        key = re.sub(r"\W+", "_", name).strip("_") or "run"
        found.append(key if key not in found else f"{key}_{len(found) + 1}")
    return found


def table(runs: Sequence[History]) -> dict[str, Array]:
    """Columns of all runs on one clock (rows,), by name; without those that are zero throughout."""
    times = np.unique(np.concatenate([run.columns["time_s"] for run in runs]))
    count = sum(len(run.columns) for run in runs)
    most = int(np.clip(MOST_NUMBERS // max(count, 1), LEAST_ROWS, MOST_ROWS))
    time = times if len(times) <= most else np.linspace(times[0], times[-1], most)
    found: dict[str, Array] = {"time_s": time}
    for key, run in zip(keys(one.name for one in runs), runs, strict=True):
        own = run.columns["time_s"]
        for name, values in run.columns.items():
            if name == "time_s" or not greatest(values) > 0.0:
                continue
            smooth = split(name)[1] in _SMOOTH and len(own) > 1
            at = at_times(own, values, rates(own, values), time) if smooth else np.interp(time, own, values)
            found[f"{key}.{name}"] = np.where(time <= own[-1], at, np.nan)
    return found


def motion(runs: Sequence[History]) -> Motion | None:
    """The motions of runs as one, whose parts are called `RUN: part`; None where a run has none, or of another kind."""
    ones = [(run.name, run.motion) for run in runs if run.motion is not None and len(run.motion.time) > 1]
    if len(ones) < len(runs) or len({one.in_space for _, one in ones}) != 1:
        return None
    end = max(float(one.time[-1]) for _, one in ones)
    time = np.linspace(0.0, end, min(MOST, max(len(one.time) for _, one in ones)))
    moved = [(name, _at(one, time)) for name, one in ones]
    bent: dict[int, Array] = {}
    place = 0
    for _, one in moved:
        bent |= {place + i: points for i, points in one.bent.items()}
        place += len(one.parts)
    return replace(
        moved[-1][1],
        parts=tuple(replace(part, name=f"{name}: {part.name}") for name, one in moved for part in one.parts),
        poses=np.concatenate([one.poses for _, one in moved], axis=1),
        bent=bent,
        forces={f"{name}: {body}": force for name, one in moved for body, force in one.forces.items()},
    )


def _at(one: Motion, time: Array) -> Motion:
    """A motion at other times, straight between its pictures, and held beyond its end."""
    poses = one.poses
    if one.in_space:  # of the two quaternions of an attitude the one that is nearer to that before
        same = np.sign(np.sum(poses[1:, :, 3:] * poses[:-1, :, 3:], axis=2))
        sign = np.cumprod(np.concatenate([np.ones((1, poses.shape[1])), np.where(same < 0, -1.0, 1.0)]), axis=0)
        poses = np.concatenate([poses[..., :3], poses[..., 3:] * sign[..., None]], axis=2)
    drawn = resample(one.time, poses, time)
    if one.in_space:
        drawn[..., 3:] /= np.linalg.norm(drawn[..., 3:], axis=2, keepdims=True)
    bent = {i: resample(one.time, points, time) for i, points in one.bent.items()}
    forces = {body: (resample(one.time, at, time), resample(one.time, f, time)) for body, (at, f) in one.forces.items()}
    return replace(one, time=time, poses=drawn, bent=bent, forces=forces)


def write(runs: Sequence[tuple[str, Results]], folder: Path) -> None:
    """Write what is compared of runs (name and results) into their folder: a table, and a motion if all have one."""
    compared = [history(*run) for run in runs]
    columns = table(compared)
    with (folder / OVERLAY).open("w", encoding="utf-8", newline="") as file:
        np.savetxt(file, np.column_stack(list(columns.values())), "%.8g", ",", header=",".join(columns), comments="")
    if (moved := motion(compared)) is not None:
        (folder / MOTION).write_text(motion_text(moved, runs[-1][1]), encoding="utf-8")


# ---- what is drawn of it ----


def panels(names: Sequence[str], columns: Mapping[str, Array], reference: str = "") -> list[Group]:
    """Groups of panels of a `table`, each of one quantity, with a curve for each run, by the names of runs.

    reference: a run from which the others are distinguished, in panels of their own for angles and positions.
    """
    runs = dict(zip(keys(names), names, strict=True))
    found: dict[str, Group] = {}
    quantities: dict[tuple[str, str], dict[str, Panel]] = {}  # of a group, by title, then by run
    for key in runs:
        own = {name.removeprefix(f"{key}."): values for name, values in columns.items() if name.startswith(f"{key}.")}
        own["time_s"] = columns["time_s"]
        terms = [name.removesuffix("_force_x_N") for name in own if name.endswith("_force_x_N")]
        for group in groups(list(own), terms, own.__getitem__):
            found.setdefault(group.name, group)
            for one in _quantities(group, key, runs[key]):
                quantities.setdefault((group.name, one.title), {})[key] = one
    base = next((key for key, name in runs.items() if name == reference), "")
    made = []
    for name, group in found.items():
        mine = [of_runs for (of, _), of_runs in quantities.items() if of == name]
        made.append(replace(group, panels=tuple(p for one in mine for p in _drawn(one, columns, base, reference))))
    return distinct(made, columns.__getitem__, compared=True)


def _quantities(group: Group, key: str, name: str) -> Iterator[Panel]:
    """Panels of one curve of a run. Of forces the sum; of energies what is exchanged; of many joints the first."""
    for panel in group.panels:
        curves = panel.curves
        if group.name == "energy":
            curves = tuple(one for one in curves if one.terms[0][0] in _BALANCE)
        elif curves[0].label == "sum":
            curves = curves[:1]
        elif len(curves) > MOST_CURVES:
            curves = curves[:2]
        single = group.name in ("wheel", "forces", "depth") and len(curves) == 1
        for curve in curves:
            for words in curve.label.split(", "):  # those of curves that are the same
                title = panel.title if single else words if group.name == "energy" else f"{panel.title}: {words}"
                along = f"{key}.{panel.along}" if panel.along else ""
                terms = tuple((f"{key}.{column}", factor) for column, factor in curve.terms)
                drawn = replace(curve, label=name, terms=terms, along=along)
                yield replace(panel, title=title, curves=(drawn,), along=along)


def _drawn(of_runs: Mapping[str, Panel], columns: Mapping[str, Array], base: str, reference: str) -> Iterator[Panel]:
    """A quantity with a curve for each run; and, for a reference, how far the others are from it."""
    column = columns.__getitem__
    one = next(iter(of_runs.values()))
    curves = {key: panel.curves[0] for key, panel in of_runs.items()}
    yield in_unit(replace(one, curves=tuple(curves.values())), column)
    if base not in curves or len(curves) < 2 or one.base not in _SMOOTH or one.along:
        return
    less = tuple((name, -factor) for name, factor in curves[base].terms)
    away = tuple(replace(curve, terms=(*curve.terms, *less)) for key, curve in curves.items() if key != base)
    if max(greatest(curve.values(column)) for curve in away) > ROUND_OFF * greatest(curves[base].values(column)):
        yield in_unit(replace(one, title=f"{one.title}, less {reference}", curves=away), column)
