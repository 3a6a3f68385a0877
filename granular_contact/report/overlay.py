"""Several runs on a common time axis: their histories side by side, and their motions as one, for comparisons.

A column of a run is named `RUN.column`, where RUN is the name of the run without spaces and signs. Between the rows of
a run positions and angles are interpolated by cubics (as in `results.interpolation`), all other columns linearly. After
the end of a run its columns are NaN, and its motion stays at the last position.
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

MOST_NUMBERS, MOST_ROWS, LEAST_ROWS = 600_000, 4000, 400  # limits of a table
MOST_CURVES = 4  # of a panel with more curves only the first two are compared; any other column can be chosen
_SMOOTH = ("deg", "m")  # units of columns that are interpolated by cubics
_BALANCE = ("granular_work_J", "drive_work_J", "energy_imbalance_J")  # energies that are compared


@dataclass(frozen=True)
class History:
    """A run to compare: its columns (rows,) by name, with `time_s`, and its motion, None if it was not saved."""

    name: str
    columns: Mapping[str, Array]
    motion: Motion | None = None


def history(name: str, results: Results) -> History:
    """Make the history of results."""
    return History(name, {column: results[column] for column in results.names}, motion_of(results))


def keys(names: Iterable[str]) -> list[str]:
    """Unique prefixes of the columns of runs, one for each name."""
    prefixes: list[str] = []
    for name in names:
        key = re.sub(r"\W+", "_", name).strip("_") or "run"
        prefixes.append(key if key not in prefixes else f"{key}_{len(prefixes) + 1}")
    return prefixes


def table(runs: Sequence[History]) -> dict[str, Array]:
    """Columns (rows,) of all runs on a common time axis, by name; columns that are zero in all runs are left out.

    Velocities along z stay, as they tell that a run is in space.
    """
    times = np.unique(np.concatenate([run.columns["time_s"] for run in runs]))
    count = sum(len(run.columns) for run in runs)
    row_limit = int(np.clip(MOST_NUMBERS // max(count, 1), LEAST_ROWS, MOST_ROWS))
    time = times if len(times) <= row_limit else np.linspace(times[0], times[-1], row_limit)
    columns: dict[str, Array] = {"time_s": time}
    kept = {name for run in runs for name in run.columns if name.endswith("_vz_m_s") or greatest(run.columns[name]) > 0}
    for key, run in zip(keys(run.name for run in runs), runs, strict=True):
        run_time = run.columns["time_s"]
        for name, values in run.columns.items():
            if name == "time_s" or name not in kept:
                continue
            if split(name)[1] in _SMOOTH and len(run_time) > 1:
                sampled = at_times(run_time, values, rates(run_time, values), time)
            else:
                sampled = np.interp(time, run_time, values)
            columns[f"{key}.{name}"] = np.where(time <= run_time[-1], sampled, np.nan)
    return columns


def motion(runs: Sequence[History]) -> Motion | None:
    """The motions of all runs as one, with parts named `RUN: part`.

    None if a run has no motion, or if some runs are in the plane and others in space.
    """
    motions = [(run.name, run.motion) for run in runs if run.motion is not None and len(run.motion.time) > 1]
    if len(motions) < len(runs) or len({motion.in_space for _, motion in motions}) != 1:
        return None
    end = max(float(motion.time[-1]) for _, motion in motions)
    time = np.linspace(0.0, end, min(MOST, max(len(motion.time) for _, motion in motions)))
    resampled = [(name, _at_times(motion, time)) for name, motion in motions]
    bent: dict[int, Array] = {}
    first = 0
    for _, motion in resampled:
        bent |= {first + i: points for i, points in motion.bent.items()}
        first += len(motion.parts)
    return replace(
        resampled[-1][1],
        parts=tuple(replace(part, name=f"{name}: {part.name}") for name, motion in resampled for part in motion.parts),
        poses=np.concatenate([motion.poses for _, motion in resampled], axis=1),
        bent=bent,
        forces={f"{name}: {body}": force for name, motion in resampled for body, force in motion.forces.items()},
    )


def _at_times(motion: Motion, time: Array) -> Motion:
    """Interpolate a motion linearly at other times (k,) s; after its end it is constant."""
    poses = motion.poses
    if motion.in_space:  # q and -q are the same attitude: take the one nearer to its predecessor
        cosine = np.sum(poses[1:, :, 3:] * poses[:-1, :, 3:], axis=2)
        sign = np.cumprod(np.concatenate([np.ones((1, poses.shape[1])), np.where(cosine < 0, -1.0, 1.0)]), axis=0)
        poses = np.concatenate([poses[..., :3], poses[..., 3:] * sign[..., None]], axis=2)
    sampled = resample(motion.time, poses, time)
    if motion.in_space:
        sampled[..., 3:] /= np.linalg.norm(sampled[..., 3:], axis=2, keepdims=True)
    bent = {i: resample(motion.time, points, time) for i, points in motion.bent.items()}
    forces = {
        body: (resample(motion.time, points, time), resample(motion.time, vectors, time))
        for body, (points, vectors) in motion.forces.items()
    }
    return replace(motion, time=time, poses=sampled, bent=bent, forces=forces)


def write(runs: Sequence[tuple[str, Results]], folder: Path) -> None:
    """Write the histories of several runs, and their common motion, into a folder.

    Parameters
    ----------
    runs : sequence of pairs
        Name and results of each run. Without a motion of every run, all in the plane or all in space, none is written.
    folder : Path
        An existing folder.

    Raises
    ------
    OSError
        A file cannot be written.
    """
    compared = [history(*run) for run in runs]
    columns = table(compared)
    with (folder / OVERLAY).open("w", encoding="utf-8", newline="") as file:
        np.savetxt(file, np.column_stack(list(columns.values())), "%.8g", ",", header=",".join(columns), comments="")
    if (common_motion := motion(compared)) is not None:
        (folder / MOTION).write_text(motion_text(common_motion, runs[-1][1]), encoding="utf-8")


# ---- panels ----


def panels(names: Sequence[str], columns: Mapping[str, Array], reference: str = "") -> list[Group]:
    """Groups of panels of a `table`, each panel of one quantity with a curve for each run.

    names: of the runs; reference: name of the reference run, from which further panels show the differences of angles
    and lengths.
    """
    runs = dict(zip(keys(names), names, strict=True))
    first_groups: dict[str, Group] = {}  # by name, from the first run that has it
    quantities: dict[str, dict[str, dict[str, Panel]]] = {}  # by name of the group, title of the panel, and run
    for key in runs:
        start = f"{key}."
        run_columns = {name.removeprefix(start): values for name, values in columns.items() if name.startswith(start)}
        run_columns["time_s"] = columns["time_s"]
        terms = [name.removesuffix("_force_x_N") for name in run_columns if name.endswith("_force_x_N")]
        for group in groups(list(run_columns), terms, run_columns.__getitem__):
            first_groups.setdefault(group.name, group)
            by_title = quantities.setdefault(group.name, {})
            for panel in _quantities(group, key, runs[key]):
                by_title.setdefault(panel.title, {})[key] = panel
    base = next((key for key, name in runs.items() if name == reference), "")
    compared = [
        replace(group, panels=tuple(_compared(quantities[name].values(), columns, base, reference)))
        for name, group in first_groups.items()
    ]
    return distinct(compared, columns.__getitem__, compared=True)


def _quantities(group: Group, key: str, name: str) -> Iterator[Panel]:
    """Panels of a run with one curve each, for comparison with other runs.

    Of the terms of a force only the sum is compared, of energies only those in `_BALANCE`, and of any other panel with
    more than `MOST_CURVES` curves the first two. key: prefix of the columns of the run; name: of the run.
    """
    for panel in group.panels:
        curves = panel.curves
        if group.name == "energy":
            curves = tuple(curve for curve in curves if curve.terms[0][0] in _BALANCE)
        elif curves[0].label == "sum":
            curves = curves[:1]
        elif len(curves) > MOST_CURVES:
            curves = curves[:2]
        single = group.name in ("wheel", "forces", "depth") and len(curves) == 1
        for curve in curves:
            for label in curve.label.split(", "):  # a curve with several labels stands for several equal curves
                title = panel.title if single else label if group.name == "energy" else f"{panel.title}: {label}"
                along = f"{key}.{panel.along}" if panel.along else ""
                terms = tuple((f"{key}.{column}", factor) for column, factor in curve.terms)
                run_curve = replace(curve, label=name, terms=terms, along=along)
                yield replace(panel, title=title, curves=(run_curve,), along=along)


def _compared(
    quantities: Iterable[Mapping[str, Panel]], columns: Mapping[str, Array], base: str, reference: str
) -> Iterator[Panel]:
    """Yield a panel of each quantity with a curve for each run, and a panel of the differences from the reference run.

    quantities: panels by key of the run; base: key of the reference run, whose name is `reference`; empty for none.
    Differences are shown of angles and lengths over time alone, and only if they are larger than round-off.
    """
    column = columns.__getitem__
    for panels_by_run in quantities:
        first = next(iter(panels_by_run.values()))
        curves = {key: panel.curves[0] for key, panel in panels_by_run.items()}
        yield in_unit(replace(first, curves=tuple(curves.values())), column)
        if base not in curves or len(curves) < 2 or first.base not in _SMOOTH or first.along:
            continue
        subtracted = tuple((name, -factor) for name, factor in curves[base].terms)
        differences = tuple(
            replace(curve, terms=(*curve.terms, *subtracted)) for key, curve in curves.items() if key != base
        )
        largest = max(greatest(curve.values(column)) for curve in differences)
        if largest > ROUND_OFF * greatest(curves[base].values(column)):
            yield in_unit(replace(first, title=f"{first.title}, less {reference}", curves=differences), column)
