"""Results -> figures at the size journals print them: time series one column wide, the mechanism two columns wide.

looks    style                      sizes, colours, matplotlib's settings; the units of axes are those of `report.units`
series   panels, events, hinges     panels over time, what is marked in them, what the hinges are called
         motion, series             their figures
picture  outlines, views            edges and depths; windows on the plane
         mechanism                  their figure
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from matplotlib.figure import Figure

from granular_contact.report.figures.mechanism import mechanism
from granular_contact.report.figures.motion import motion
from granular_contact.report.figures.series import deflection, energy, forces
from granular_contact.report.figures.style import DPI, style
from granular_contact.results import Results

__all__ = ["draw", "figures", "style"]


def draw(results: Results, directory: Path) -> None:
    """Write every figure that `results` has the columns for to `directory` as NAME.png; OSError as the disk has it."""
    with style():
        for name, figure in figures(results).items():
            figure.savefig(directory / f"{name}.png", dpi=DPI, metadata={"Software": None})


def figures(results: Results) -> dict[str, Figure]:
    """The figures of `results` by name, on Agg canvases; to be made and drawn within `style()`."""
    has = {column.name for column in results.columns}
    made: dict[str, Callable[[Results], Figure]] = {}
    if len(results.table):
        made["motion"] = motion
        if "deflection_m" in has:
            made["deflection"] = deflection
        if results.terms:
            made["forces"] = forces
        if "kinetic_J" in has:
            made["energy"] = energy
    if results.snapshots:
        made["mechanism"] = mechanism
    return {name: make(results) for name, make in made.items()}
