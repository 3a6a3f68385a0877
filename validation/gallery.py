"""Gallery of the configs: runs every config in configs/ and writes a picture and a key number, which tests check.

    python validation/gallery.py

writes configs/README.md and figures/gallery_*.png. A new config is included without further changes.
"""

from __future__ import annotations

import itertools
import re
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parent))

from granular_contact import config
from granular_contact.results import Results
from granular_contact.run import run
from granular_contact.scene import build

CONFIGS, FIGURES, PAGE = HERE.parent / "configs", HERE / "figures", HERE.parent / "configs" / "README.md"
# Key numbers of a summary, the most important first: key, name, factor, unit.
NUMBERS = (
    ("wheel.sinkage_m", "sinkage", 1e3, "mm"),
    ("forward_speed_m_s", "forward speed", 1.0, "m/s"),
    ("penetration_time_s", "penetration time", 1e3, "ms"),
    ("stopping_time_s", "stopping time", 1e3, "ms"),
    ("max_deflection_m", "largest deflection", 1e3, "mm"),
    ("max_depth_m", "largest depth", 1e3, "mm"),
    ("energy.final_J", "energy at the end", 1e3, "mJ"),
)
STAYS = 0.01  # m/s; below this speed a mechanism counts as standing still
EDITORS = "# yaml-language-server:"  # start of the line for editors, which does not describe the config
PANELS, WIDTH, FRAMES = 4, 1200, 151  # panels of a picture, its width (px), frames of a run
COLUMNS = 3  # pictures in a row of the page
INTRODUCTION = """# Configs

Every file here runs as it is, after `granular-contact examples DIR` from an installed package too:

```sh
granular-contact run configs/pendulum.yaml --animate
```

This page is written by `python validation/gallery.py`; the tests run every config and hold the number that stands here.
Arrows are forces of the medium, thin lines the path of the tip. A picture leads to itself in full size.
"""
FITS = """## Fits

`granular-contact fit configs/fit_cmu_plates.yaml` takes these; their data lie beside them, with their licence."""
SEARCHES = """## Searches

`granular-contact optimise configs/optimise_speed_close.yaml` takes these; what they gain over the config as it is
stands in [validation](../docs/studies/gaits.md)."""


@dataclass(frozen=True)
class Entry:
    """A config of one run: its name, first sentence of its comment (words), whether it is in space, and its results."""

    name: str
    words: str
    in_space: bool
    results: Results

    @property
    def number(self) -> str:
        """Key number as a cell of the table."""
        return number(self.results.summary)


def names(is_kind: Callable[[Path], bool]) -> list[str]:
    """Names of the configs of a kind: one run, sweeps, searches or fits."""
    return [path.stem for path in sorted(CONFIGS.glob("*.yaml")) if is_kind(path)]


def number(summary: dict[str, Any]) -> str:
    """Most important number of a run, with its name and unit."""
    energy = {f"energy.{key}": value for key, value in summary.get("energy", {}).items()}
    flat = summary | energy | {f"wheel.{key}": value for key, value in summary.get("wheel", {}).items()}
    if abs(flat.get("forward_speed_m_s") or 0.0) < STAYS:
        flat["forward_speed_m_s"] = None
    key, words, factor, unit = next(one for one in NUMBERS if flat.get(one[0]) is not None)
    return f"{words} {factor * flat[key]:.4g} {unit}"


def entry(name: str, frames: int = 0, overrides: Sequence[str] = ()) -> Entry:
    """Run a config with overrides; return its entry."""
    path = CONFIGS / f"{name}.yaml"
    scenario = config.load(path, overrides).scenario
    results = run(build(scenario), scenario, most_frames=frames)
    return Entry(name, comment(path), scenario.model.in_space, results)


def cases(name: str, every: int = 1) -> str:
    """Run a sweep, or every n-th of its cases, and count the cases that reached their end, as a cell of the table."""
    sweep = config.load_sweep(CONFIGS / f"{name}.yaml", probe=build)
    count = 0
    chosen = sweep.cases[::every]
    for case in chosen:
        scenario = sweep.scenario(case)
        count += run(build(scenario), scenario).status.code in ("rest", "end_time")
    return f"{count} of {len(chosen)} cases came to an end"


def runs(name: str) -> str:
    """Number of runs of a search, as a cell of the table."""
    return f"{config.load_optimise(CONFIGS / f'{name}.yaml', probe=build).file.evaluations} runs"


def rows(name: str) -> str:
    """Number of measured rows of a fit, as a cell of the table."""
    from granular_contact.studies.fit import load_specification, prepare

    problem = prepare(load_specification(CONFIGS / f"{name}.yaml"))
    return f"{sum(len(run.measured.time) for run in problem.runs)} rows"


def comment(path: Path) -> str:
    """First sentence of the comment at the start of a file."""
    text = path.read_text(encoding="utf-8").splitlines()
    lines = itertools.takewhile(
        lambda line: line.startswith("#"), (line for line in text if not line.startswith(EDITORS))
    )
    joined = " ".join(line.lstrip("#").strip() for line in lines)
    return re.split(r"(?<=\.) ", joined)[0]


def draw(example: Entry) -> Path:
    """Write the picture of a config as a PNG of few colours; return its path."""
    from validation.stills import write_strip

    path = FIGURES / f"gallery_{example.name}.png"
    write_strip(example.results, path, PANELS, WIDTH)
    return path


def grid(cells: Sequence[tuple[str, str, str, Path]]) -> str:
    """Markdown of rows of small pictures; below each picture its config, the description and the key number."""
    pictures = [
        f"[![{words}]({link})]({link})<br>**[{name}]({name}.yaml)**: {words}<br>{result}"
        for name, words, result, path in cells
        for link in [f"../{path.relative_to(HERE.parent).as_posix()}"]
    ]
    pictures += [""] * (-len(pictures) % COLUMNS)
    lines = [f"|{' |' * COLUMNS}", f"|{' --- |' * COLUMNS}"]
    lines += [f"| {' | '.join(pictures[i : i + COLUMNS])} |" for i in range(0, len(pictures), COLUMNS)]
    return "\n".join(lines) + "\n"


# Figures of the studies of sweeps and fits.
PICTURES = {
    "paper_cases": "paper_cases_stopping",
    "sensitivity": "sensitivity_six",
    "wheel_slip": "measured_wheel",
    "fit_cmu_plates": "measured_plates",
}


def table(rows: list[tuple[str, str, str]]) -> str:
    """Markdown table of configs, descriptions and numbers."""
    lines = ["| config | what happens | number |", "| --- | --- | --- |"]
    lines += [f"| [{name}]({name}.yaml) | {words} | {result} |" for name, words, result in rows]
    return "\n".join(lines) + "\n"


def of_kind(is_kind: Callable[[Path], bool], count: Callable[[str], str]) -> list[tuple[str, str, str]]:
    """Configs of a kind: name, description and number."""
    return [(name, comment(CONFIGS / f"{name}.yaml"), count(name)) for name in names(is_kind)]


def with_studies(kind: list[tuple[str, str, str]]) -> str:
    """Grid of sweeps or fits, with the figures of their studies."""
    return grid([(*cell, FIGURES / f"{PICTURES[cell[0]]}.png") for cell in kind])


def main() -> None:
    """Write the page and the pictures."""
    entries = [entry(name, FRAMES) for name in names(config.is_run)]
    space = [example for example in entries if example.in_space]
    plane = [example for example in entries if not example.in_space]
    runs_of = [
        grid([(example.name, example.words, example.number, draw(example)) for example in kind])
        for kind in (space, plane)
    ]
    parts = [
        INTRODUCTION,
        f"## In space\n\n{runs_of[0]}",
        f"## In the plane\n\n{runs_of[1]}",
        f"## Sweeps\n\n{with_studies(of_kind(config.is_sweep, cases))}",
        f"{SEARCHES}\n\n{table(of_kind(config.is_optimise, runs))}",
        f"{FITS}\n\n{with_studies(of_kind(config.is_fit, rows))}",
    ]
    PAGE.write_text("\n".join(parts), encoding="utf-8")


if __name__ == "__main__":
    main()
