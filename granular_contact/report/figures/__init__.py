"""Figures of results at the size of print: time series one column wide, the mechanism two columns wide.

style    style                      sizes, colours and settings of matplotlib; units of axes are in `report.units`
series   panels                     panels over time, with marks of touch and stop
         over_time                  figures of such panels: of a run, of several runs, of columns by name
         contacts, space_views      contacts and footprints; views in space
         depth_buffer               hidden surfaces in views of bodies
picture  outlines                   edges, fixed points and depths of outlines; hinges
         mechanism                  figure of the mechanism in the plane
film     stage, animation           view to scale of a film in the plane; its pictures
         rendering, film            shaded pictures in space; GIF and MP4
studies  laws                       forces of a law
         studies, fits              sweeps, wheels, Sobol indices, ensembles, searches; fits
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path

from matplotlib.figure import Figure

from granular_contact.report.drawn import drawn
from granular_contact.report.figures.contacts import against_depth, contacts, in_contact
from granular_contact.report.figures.mechanism import mechanism
from granular_contact.report.figures.over_time import of_groups
from granular_contact.report.figures.space_views import views
from granular_contact.report.figures.style import DPI, style
from granular_contact.report.histories import groups_of
from granular_contact.results import Results

__all__ = ["draw", "figures", "style"]


# Metadata of each format that would change from run to run; None leaves them out.
_UNDATED: dict[str, dict[str, None]] = {"png": {"Software": None}, "pdf": {"CreationDate": None}, "svg": {"Date": None}}


def draw(results: Results, directory: Path, formats: Sequence[str] = ("png",)) -> None:
    """Write every figure that `results` has the columns for to `directory`, as NAME.png and in the given formats.

    formats: of `report.FORMATS`. A figure that fails is a `FigureWarning`.
    """
    with style():
        for name, make in makers(results).items():
            figure: Figure | None = None
            for suffix in dict.fromkeys(("png", *formats)):
                with drawn(directory / f"{name}.{suffix}") as file:
                    figure = _laid_out(make()) if figure is None else figure
                    figure.savefig(file, dpi=DPI, metadata=_UNDATED[suffix])


def _laid_out(figure: Figure) -> Figure:
    """Lay out a figure once, so that the layout is not repeated for each file."""
    layout = figure.get_layout_engine()
    if layout is not None:
        layout.execute(figure)
        figure.set_layout_engine("none")
    return figure


def figures(results: Results) -> dict[str, Figure]:
    """Make the figures of `results` by name; to be called and drawn within `style()`."""
    return {name: make() for name, make in makers(results).items()}


def makers(results: Results) -> dict[str, Callable[[], Figure]]:
    """Functions that make the figures of `results`, by name, on Agg canvases; to be called within `style()`."""
    groups = groups_of(results.names, results.terms, results.__getitem__) if len(results.table) > 1 else []
    functions = of_groups(results, groups)
    against = [panel for group in groups for panel in group.panels if panel.along]
    if len(in_contact(results)) > 1:
        functions["contacts"] = partial(contacts, results, against)
    elif "travel" in functions and against:
        functions["depth"] = partial(against_depth, results, against)
    if results.motion is not None and results.motion.in_space and results.motion.parts:
        functions["views"] = partial(views, results, results.motion)
    elif results.snapshots:
        functions["mechanism"] = partial(mechanism, results)
    return functions
