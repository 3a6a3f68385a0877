"""Depths of bodies below the surface along a trajectory."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from granular_contact.mechanics.kinematics import Kinematics
from granular_contact.results.interpolation import Track, rates
from granular_contact.scene.bed import Bed
from granular_contact.scene.types import Vector

STATIONS = 16  # pieces of a side of a body where the surface is not level


def depths_by_body(motion: Kinematics) -> dict[str, list[Track]]:
    """Depth (m) of every corner and node that the medium may touch, by body; negative above the surface.

    A surface that is not level can touch a body between its corners; then points between them are added.
    """
    tracks: dict[str, list[Track]] = {}
    bed = motion.scene.bed
    if bed is None:
        return tracks
    for name, handle in motion.system.rigid.items():
        for shape in (shape for shape in handle.body.shapes if shape.in_sand):
            points = shape.points if bed.level else _between(shape.points)
            of_shape = [_depth(bed, *motion.position(name, point), shape.drop) for point in points]
            tracks[name] = tracks.get(name, []) + of_shape
    q, v = motion.trajectory.q, motion.trajectory.v
    for name in motion.system.links:
        tracks[name] = [_depth(bed, q[:, node[:2]], v[:, node[:2]]) for node in motion.nodes(name)]
    return tracks


def _between(corners: Vector) -> Vector:
    """Corners (k, 2) of a line with points between them; a single point unchanged."""
    if len(corners) < 2:
        return corners
    share = np.arange(STATIONS)[:, None] / STATIONS
    sides = [a + share * (b - a) for a, b in pairwise(corners)]
    return np.concatenate([*sides, corners[-1:]])


def _depth(bed: Bed, position: Vector, velocity: Vector, drop: float = 0.0) -> Track:
    """Depth of a point from its positions and velocities (n, 2); drop (m): how much lower the body reaches there."""
    x, y = position.T
    slope = 0.0 if bed.level else bed.slope_at(x)
    return Track(bed.height(x) - y + drop, slope * velocity[:, 0] - velocity[:, 1])


def all_depths(motion: Kinematics, by_body: dict[str, list[Track]]) -> list[Track]:
    """Depths of all points, and of the load's stations where these are deeper, as on a bent link."""
    points = [track for tracks in by_body.values() for track in tracks]
    load, time = motion.trajectory.load, motion.trajectory.time
    if load is None or not len(load.depth):
        return points
    known = np.max([track.values for track in points], axis=0) if points else np.full(len(time), -np.inf)
    deeper = load.depth > known + 1e-9
    if not deeper.any():
        return points
    # Cubic interpolation only where stations are the deepest at both ends of a step; elsewhere other points are.
    flat = ~(deeper & np.roll(deeper, 1) & np.roll(deeper, -1))
    slopes = rates(time, load.depth)
    slopes[flat] = 0.0
    return [*points, Track(np.where(deeper, load.depth, known), slopes)]
