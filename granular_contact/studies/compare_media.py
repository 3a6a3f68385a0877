"""One config in several media: the same impact, compared."""

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
    """A medium as it was named, and its results."""

    name: str
    results: Results

    @property
    def peak_force(self) -> float:
        """Greatest resultant of the medium on the mechanism (N)."""
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

    progress: called with the name of what is run next; compiling: see `run`.

    Raises
    ------
    ConfigError, SceneError
        The config or one of the media is at fault; nothing is run before all are read.
    """
    if not media:
        raise ConfigError([Fault("", None, "--media", "got none; allowed are names, as play_sand,rft_generic")])
    if faults := list(_idle(overrides)):
        raise ConfigError(faults)
    configs = [load(path, [*overrides, f"medium={_value(name)}"]) for name in media]
    scenes = []
    for one in configs:
        try:
            scenes.append(build(one.scenario))
        except SceneError as error:  # noqa: PERF203
            faults += one.sources.place(error.faults)
    if faults:
        raise SceneError(faults)
    rows = []
    for name, scene in zip(media, scenes, strict=True):
        if progress is not None:
            progress(name)
        rows.append(Row(name, uninterrupted(run(scene, most_frames=MOST, compiling=compiling))))
    return tuple(rows)


def _idle(overrides: Sequence[str]) -> Iterator[Fault]:
    """Overrides that the media compared would replace."""
    for text in overrides:
        key = text.partition("=")[0].strip()
        if key.split(".")[0].strip() == "medium":
            why = "is set by --media; write a medium with other numbers into a file, as {from: play_sand, eta_h: 80}, "
            yield Fault(f"--set {text}", None, key, f"{why}and name the file there")


def _value(name: str) -> str:
    """A medium as the text of a YAML value: a name, or a list of those joined by +."""
    parts = [part.strip() for part in name.split("+")]
    return parts[0] if len(parts) == 1 else f"[{', '.join(parts)}]"


def cells(row: Row) -> dict[str, str | float | None]:
    """A row of the table, by the names of its columns."""
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
    """Write the table, the first run's scenario, histories and motions, completely or not at all; then figures."""
    runs = [(row.name, row.results) for row in rows]
    write_runs(directory, "compare-media", map(cells, rows), runs, figures=figures)
