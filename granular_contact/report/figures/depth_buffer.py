"""Orthographic picture of bodies with hidden surfaces removed, in NumPy alone.

A depth buffer (Catmull 1974): each pixel keeps the triangle that is nearest to the eye. Shading is flat. Edges are
drawn between parts and at sharp bends of a surface. Far surfaces are paler.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from granular_contact.report.units import Array

LIGHT = np.array([-0.3, 0.6, 0.74])  # from above the left shoulder of whoever looks: across, up, towards the eye
DARK, PALE = 0.72, 0.45  # share of the colour on faces along the light; of white in what is farthest
SHARP = 0.45  # cosine between the normals of two facets, below which there is an edge
EDGE = 0.35  # share of the colour on edges


def seen(triangles: Array, parts: NDArray[np.int64], colour: Array, low: Array, high: Array, pixels: int) -> Array:
    """Picture (rows, columns, 4) of triangles, upper row first; empty pixels are transparent.

    triangles: (n, 3, 3) corners across, up and towards the eye (m); parts: (n,) part of each triangle. colour: red,
    green, blue. low, high: (2,) corners of the picture (m); pixels: its width.
    """
    scale = pixels / float(high[0] - low[0])
    flat, depth = (triangles[:, :, :2] - low) * scale, triangles[:, :, 2]
    shape = round(float(high[1] - low[1]) * scale), pixels
    near, owner = _nearest(flat, depth, shape)
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    normals *= np.where(normals[:, 2:] < 0.0, -1.0, 1.0)  # those of the side that is seen
    covered = owner >= 0
    far = (depth.max() - near) / max(float(np.ptp(depth)), 1e-300)
    shade = DARK + (1.0 - DARK) * np.clip(normals @ LIGHT, 0.0, 1.0)
    tone = shade[owner][..., None] * colour
    tone = tone + PALE * np.where(covered, far, 0.0)[..., None] * (1.0 - tone)
    tone[_edges(owner, parts, normals)] *= EDGE
    return np.concatenate([np.clip(tone, 0.0, 1.0), covered[..., None]], axis=2)[::-1]


def _nearest(flat: Array, depth: Array, shape: tuple[int, int]) -> tuple[Array, NDArray[np.int64]]:
    """Depth of the nearest triangle at each pixel, and its index, -1 for none; flat: triangles (n, 3, 2) in pixels."""
    near, owner = np.full(shape, -np.inf), np.full(shape, -1)
    first = np.clip(np.floor(flat.min(axis=1)), 0, None).astype(int)
    last = np.minimum(np.ceil(flat.max(axis=1)).astype(int) + 1, (shape[1], shape[0]))
    for i, ((x0, y0), (x1, y1)) in enumerate(zip(first, last, strict=True)):
        (ax, ay), (bx, by), (cx, cy) = flat[i]
        area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
        if abs(area) < 1e-9 or x1 <= x0 or y1 <= y0:
            continue
        x, y = np.arange(x0, x1) + 0.5 - ax, np.arange(y0, y1)[:, None] + 0.5 - ay
        b, c = (x * (cy - ay) - y * (cx - ax)) / area, (y * (bx - ax) - x * (by - ay)) / area
        z = depth[i, 0] + b * (depth[i, 1] - depth[i, 0]) + c * (depth[i, 2] - depth[i, 0])
        of = near[y0:y1, x0:x1]
        new = (b >= 0.0) & (c >= 0.0) & (b + c <= 1.0) & (z > of)
        of[new] = z[new]
        owner[y0:y1, x0:x1][new] = i
    return near, owner


def _edges(owner: NDArray[np.int64], parts: NDArray[np.int64], normals: Array) -> NDArray[np.bool_]:
    """Mask of pixels at the border of a part, or between facets at a sharp angle."""
    part = np.where(owner >= 0, parts[owner], -1)
    edges = np.zeros(owner.shape, bool)
    for first, second in ((np.s_[:, :-1], np.s_[:, 1:]), (np.s_[:-1], np.s_[1:])):
        sharp = np.sum(normals[owner[first]] * normals[owner[second]], axis=-1) < SHARP
        edge = (part[first] != part[second]) | (sharp & (part[first] >= 0))
        edges[first] |= edge & (owner[first] >= 0)
        edges[second] |= edge & (owner[first] < 0) & (owner[second] >= 0)
    return edges
