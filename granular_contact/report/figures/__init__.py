"""Results -> figures at the size journals print them: time series one column wide, the mechanism two columns wide.

style    style                      sizes, colours, matplotlib's settings; the units of axes are those of `report.units`
series   panels, events, hinges     panels over time, what is marked in them, what the hinges are called
         motion, series, chosen     their figures
         robots, space_views        figures of what travels: first body, joints, contacts; views in space
picture  outlines, views            edges and depths; windows on the plane
         mechanism                  their figure
film     stage, animation, film     a view to scale, pictures on it, GIF and MP4
studies  histories, media, laws     models and media compared, a law
         overview, slip, sensitivity, ensembles, search, fits    sweeps, wheels, Sobol indices, seeds, searches, fits
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from matplotlib.figure import Figure

from granular_contact.report.figures.mechanism import mechanism
from granular_contact.report.figures.motion import motion
from granular_contact.report.figures.robots import against_depth, contacts, groups_of, in_contact, joints, over_time
from granular_contact.report.figures.series import deflection, energy, forces
from granular_contact.report.figures.space_views import views
from granular_contact.report.figures.style import DPI, style
from granular_contact.results import Results

__all__ = ["draw", "figures", "style"]


# Of each format what would change from run to run, left out.
_UNDATED: dict[str, dict[str, None]] = {"png": {"Software": None}, "pdf": {"CreationDate": None}, "svg": {"Date": None}}


def draw(results: Results, directory: Path, formats: Sequence[str] = ("png",)) -> None:
    """Write every figure that `results` has the columns for to `directory` as NAME.png, and in the other formats asked
    for, of `report.FORMATS`; OSError as the disk has it.
    """
    with style():
        for name, figure in figures(results).items():
            layout = figure.get_layout_engine()
            if layout is not None:  # once, and not again for each file
                layout.execute(figure)
                figure.set_layout_engine("none")
            for one in dict.fromkeys(("png", *formats)):
                figure.savefig(directory / f"{name}.{one}", dpi=DPI, metadata=_UNDATED[one])


def figures(results: Results) -> dict[str, Figure]:
    """The figures of `results` by name, on Agg canvases; to be made and drawn within `style()`."""
    has = {column.name for column in results.columns}
    made: dict[str, Figure] = {}
    histories = groups_of(results) if len(results.table) > 1 else {}
    if "travel" in histories:
        made["travel"] = over_time(results, list(histories["travel"].panels))
        if "joints" in histories:
            made["joints"] = joints(results, histories["joints"])
    elif len(results.table):
        made["motion"] = motion(results)
    if len(results.table):
        if "deflection_m" in has:
            made["deflection"] = deflection(results)
        if results.terms:
            made["forces"] = forces(results)
        if "kinetic_J" in has:
            made["energy"] = energy(results)
    if histories and len(in_contact(results)) > 1:
        made["contacts"] = contacts(results, histories.get("depth"))
    elif "travel" in histories and "depth" in histories and any(one.along for one in histories["depth"].panels):
        made["depth"] = against_depth(results, histories["depth"])
    if results.motion is not None and results.motion.in_space and results.motion.parts:
        made["views"] = views(results, results.motion)
    elif results.snapshots:
        made["mechanism"] = mechanism(results)
    return made
