"""Compare runs of one config in several media."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path

import numpy as np

from granular_contact.config import load
from granular_contact.errors import ConfigError, Fault, SceneError
from granular_contact.results import Compiling, Results
from granular_contact.results.frames import MOST
from granular_contact.results.series import resultant
from granular_contact.run import run, uninterrupted
from granular_contact.scene import build
from granular_contact.studies.compare import write_runs


@dataclass(frozen=True)
class Row:
    """One medium: its name as given, and the results of its run."""

    name: str
    results: Results

    @property
    def peak_force(self) -> float:
        """Largest resultant force of the medium on the mechanism (N), without the floor."""
        terms = [term for term in self.results.terms if term != "floor"]
        return float(np.linalg.norm(resultant(self.results, terms), axis=0).max())


def compare_media(
    path: str | PathLike[str],
    media: Sequence[str],
    *,
    overrides: Sequence[str] = (),
    progress: Callable[[str], None] | None = None,
    compiling: Compiling | None = None,
) -> tuple[Row, ...]:
    """Run a config in each of several media, named as in a config (preset, file, or several joined by +).

    progress: called with the name of the next medium; compiling: see `run`.

    Raises
    ------
    ConfigError, SceneError
        The config or one of the media has a fault. All are read before the first run starts.
    """
    if not media:
        raise ConfigError([Fault("", None, "--media", "got none; allowed are names, as play_sand,rft_generic")])
    if faults := list(_replaced(overrides)):
        raise ConfigError(faults)
    configs = [load(path, [*overrides, f"medium={_value(name)}"]) for name in media]
    scenes = []
    for config in configs:
        try:
            scenes.append(build(config.scenario))
        except SceneError as error:  # noqa: PERF203
            faults += config.sources.place(error.faults)
    if faults:
        raise SceneError(faults)
    rows = []
    for name, scene in zip(media, scenes, strict=True):
        if progress is not None:
            progress(name)
        rows.append(Row(name, uninterrupted(run(scene, most_frames=MOST, compiling=compiling))))
    return tuple(rows)


def _replaced(overrides: Sequence[str]) -> Iterator[Fault]:
    """Faults of overrides that the compared media would replace."""
    for text in overrides:
        key = text.partition("=")[0].strip()
        if key.split(".")[0].strip() == "medium":
            reason = "is set by --media; to change numbers, write a medium file, as {from: play_sand, eta_h: 80}, "
            yield Fault(f"--set {text}", None, key, f"{reason}and give its name to --media")


def _value(name: str) -> str:
    """YAML text of a medium: one name, or a list for names joined by +."""
    parts = [part.strip() for part in name.split("+")]
    return parts[0] if len(parts) == 1 else f"[{', '.join(parts)}]"


def cells(row: Row) -> dict[str, str | float | None]:
    """Cells of a row of the table, by column name."""
    summary = row.results.summary
    return {
        "medium": row.name,
        **{key: summary[key] for key in ("status", "stopping_time_s", "angle_at_stop_deg", "max_depth_m")},
        **{key: summary.get(key) for key in ("distance_m", "forward_speed_m_s", "cost_of_transport")},
        "peak_force_N": row.peak_force,
        "granular_work_J": summary["energy"]["granular_work_J"],
        "energy_imbalance_relative": summary["energy"]["imbalance_relative"],
        "warnings": "; ".join(row.results.warnings),
    }


def write(rows: Sequence[Row], directory: Path, figures: bool = True) -> None:
    """Write the table, the scenario of the first run, histories and motions, completely or not at all; then figures.

    Parameters
    ----------
    rows : sequence of Row
        A run in each medium.
    directory : Path
        The folder. Results of an earlier comparison in it are replaced.
    figures : bool, optional
        Whether figures are drawn.

    Raises
    ------
    OSError
        The folder cannot be written, or contains something else.
    """
    runs = [(row.name, row.results) for row in rows]
    write_runs(directory, "compare-media", map(cells, rows), runs, figures=figures)
