"""Playback of a solved system in the engine's own viewer, until its window is closed."""

from __future__ import annotations

import os
import sys
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
from exudyn import graphics

from granular_contact.engines.exudyn.views import reference
from granular_contact.geometry.polygon import doubled_area
from granular_contact.mechanics.kinematics import Kinematics
from granular_contact.mechanics.system import System, Trajectory
from granular_contact.results import Outline
from granular_contact.results.frames import instants, resample
from granular_contact.scene.parts import InitialMotion, rotation
from granular_contact.scene.types import Vector

MOST_FRAMES, PERIOD = 501, 0.04  # number of frames, and time (s) between two frames
STEEL, SAND = [0.56, 0.70, 0.80, 1.0], [0.85, 0.75, 0.55, 0.6]


def problem() -> str | None:
    """Reason why the viewer cannot be used on this machine, or None.

    It is checked beforehand because the engine ends the whole process if there is no display.
    """
    if sys.platform.startswith("linux") and not os.environ.get("DISPLAY"):
        return "there is no display here (DISPLAY is not set)"
    try:
        import tkinter
    except ImportError:
        return "the engine's viewer needs tkinter, which this Python does not have"
    try:
        tkinter.Tk().destroy()
    except tkinter.TclError as error:
        return f"the display can't be opened ({error})"
    return None


def show(system: System, trajectory: Trajectory) -> None:
    """Play a trajectory; returns when the viewer is closed. `problem` must have returned None."""
    times = instants(float(trajectory.time[0]), float(trajectory.time[-1]), MOST_FRAMES)
    q, v = (resample(trajectory.time, values, times) for values in (trajectory.q, trajectory.v))
    add_graphics(system, Kinematics(system, replace(trajectory, time=times, q=q, v=v)))
    settings = system.container.visualizationSettings
    settings.window.renderWindowSize = [1100, 800]
    settings.nodes.show = settings.markers.show = settings.loads.show = settings.connectors.show = False
    settings.general.drawCoordinateSystem = False
    solution = solution_data(system, times, q, v)
    system.mbs.SolutionViewer(solution, timeout=PERIOD, runMode=0, title=system.scene.name)


def solution_data(system: System, times: Vector, q: Vector, v: Vector) -> dict[str, Any]:
    """States in the form in which the engine reads a solution file; times (k,) s, q and v (k, m)."""
    displacements = q - reference(system.mbs, system.nodes, system.origin)
    data = np.column_stack([times, displacements, v])
    return {
        "data": data,
        "columnsExported": [q.shape[1], v.shape[1], 0, 0, 0, 0, 0],  # numbers of coordinates and rates; no others
        "nColumns": data.shape[1] - 1,
        "nRows": len(data),
    }


def add_graphics(system: System, motion: Kinematics) -> None:
    """Add graphics of bodies, beams and the medium to the objects of the system."""
    outlines = motion.outlines(0)
    for name, handle in system.rigid.items():
        body_outlines = [outline for outline in outlines if outline.part in name.split("+")]
        solids = [solid for outline in body_outlines for solid in _solids(outline, handle.body.motion)]
        system.mbs.SetObjectParameter(handle.object, "VgraphicsData", solids)
    for link in system.links.values():
        for element in link.elements:
            system.mbs.SetObjectParameter(element, "VdrawHeight", link.link.thickness)
            system.mbs.SetObjectParameter(element, "Vcolor", STEEL)
    if system.scene.media:
        objects = range(system.mbs.systemData.NumberOfObjects())
        ground = next(i for i in objects if system.mbs.GetObject(i)["objectType"] == "Ground")
        system.mbs.SetObjectParameter(ground, "VgraphicsData", _medium(system, motion))


def _solids(outline: Outline, motion: InitialMotion) -> list[Any]:
    """Graphics of an outline, in the frame of its body; motion: pose of the body at the outline's instant."""
    points = (outline.points - motion.position) @ rotation(motion.angle)
    radius = outline.diameter / 2
    if len(points) == 1:
        return [graphics.Cylinder([*points[0], -radius], [0, 0, 2 * radius], radius, STEEL, nTiles=48)]
    if len(points) > 3 and np.array_equal(outline.points[0], outline.points[-1]):
        corners = points[:-1]
        if doubled_area(corners.tolist()) < 0.0:
            corners = corners[::-1]
        n, depth = len(corners), 0.2 * float(np.max(np.ptp(corners, axis=0)))
        edges = [[i, (i + 1) % n] for i in range(n)]
        return [graphics.SolidExtrusion(corners.tolist(), edges, depth, pOff=[0, 0, -depth / 2], color=STEEL)]
    return [graphics.Cylinder([*a, 0.0], [*(b - a), 0.0], radius, STEEL, nTiles=24) for a, b in pairwise(points)]


def _medium(system: System, motion: Kinematics) -> list[Any]:
    """Graphics of the medium: a sheet behind the mechanism, as wide as the range of its motion."""
    assert system.scene.bed is not None
    times = np.unique(np.linspace(0, len(motion.trajectory.time) - 1, 9).astype(int))
    points = np.concatenate([outline.points for i in times for outline in motion.outlines(int(i))])
    low, high = points.min(axis=0), points.max(axis=0)
    size = float(np.max(high - low))
    x = np.linspace(low[0] - 0.2 * size, high[0] + 0.2 * size, 33)
    top = system.scene.bed.height(x)
    bottom = min(float(low[1]), float(top.min())) - 0.15 * size
    z = -0.05 * size
    strips = pairwise(zip(x - system.origin[0], top - system.origin[1], strict=True))
    floor = bottom - system.origin[1]
    return [graphics.Quad([[a, floor, z], [b, floor, z], [b, d, z], [a, c, z]], SAND) for (a, c), (b, d) in strips]
