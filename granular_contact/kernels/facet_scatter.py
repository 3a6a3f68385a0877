"""Scatter on facets (see `scatter`): the path of each, and by how much the static terms of a block of them scatter.

A facet takes the value of a cube of the size of a grain, fixed to its body: facets whose middles lie in one cube share
it, and as they stay there nothing jumps. One larger than a grain takes s L / sqrt(area).

Where a medium scatters the anchors of facets have more columns: PATH, the path length (m) of the middle since the
start; LAST and the two after it, where it was at the end of the last step (m); KEPT and the two after it: the number of
the grain that its path was in when forces were last asked for, and s r of `scatter` at both ends of that grain. These
change once a grain only, and to find them costs more than all the rest; none is taken for another grain, so that they
are no part of any state.
"""

from __future__ import annotations

import math

import numpy as np

from granular_contact.kernels.compiled import part
from granular_contact.kernels.scatter import value

PATH, LAST, KEPT = 3, 4, 7
COLUMNS = 10  # of anchors, without that of the shear displacement
ALONG, ACROSS, UPWARD, BODY = 73856093, 19349663, 83492791, 49979687  # primes: cubes nearby have numbers of their own


@part
def scatters(anchors):
    """Whether anchors have these columns."""
    return anchors.shape[1] >= COLUMNS


@part
def shears(anchors):
    """Whether the last column of anchors is the shear displacement (m) of `path_length`."""
    return anchors.shape[1] == 4 or anchors.shape[1] > COLUMNS


@part
def start(anchors, i):
    """Begin the path of a facet where its anchor is."""
    anchors[i, PATH], anchors[i, KEPT] = 0.0, np.nan
    for k in range(3):
        anchors[i, LAST + k] = anchors[i, k]


@part
def count_path(anchors, i, x, y, z):
    """Add to the path of a facet the step that ends with its middle at (x, y, z) m."""
    dx, dy, dz = x - anchors[i, LAST], y - anchors[i, LAST + 1], z - anchors[i, LAST + 2]
    anchors[i, PATH] += math.sqrt(dx * dx + dy * dy + dz * dz)
    anchors[i, LAST], anchors[i, LAST + 1], anchors[i, LAST + 2] = x, y, z


@part
def keep(anchors, i, grain, x, y, z, area, cluster):
    """Keep what a facet has within a grain (its number) of its path; its middle in the frame of its body (m), m^2."""
    size = cluster.grain
    s = cluster.scatter if area <= size * size else cluster.scatter * size / math.sqrt(area)
    cube = math.floor(x / size) * ALONG + math.floor(y / size) * ACROSS + math.floor(z / size) * UPWARD
    cube += cluster.body * BODY
    at, seed = int(grain), int(cluster.seed)
    anchors[i, KEPT] = grain
    anchors[i, KEPT + 1], anchors[i, KEPT + 2] = s * value(seed, at, cube), s * value(seed, at + 1, cube)


@part
def note(B, n, row, anchors, i, x, y, z):
    """Note in column n of a block, from `row` on, what `factors` asks of facet i with its middle at (x, y, z) m."""
    dx, dy, dz = x - anchors[i, LAST], y - anchors[i, LAST + 1], z - anchors[i, LAST + 2]
    B[row, n], B[row + 1, n] = anchors[i, PATH], dx * dx + dy * dy + dz * dz
    B[row + 2, n], B[row + 3, n], B[row + 4, n] = anchors[i, KEPT], anchors[i, KEPT + 1], anchors[i, KEPT + 2]


@part
def factors(B, n, row, numbers, out, elements, anchors, cluster):
    """Set rows `out` and out + 1 of a block to what the two static terms of its n facets are multiplied by.

    row: as of `note`; numbers: the row of the block with the rows of the facets in elements and anchors.
    """
    others, one = 0.0, 1.0 / cluster.grain
    for k in range(n):
        path = (B[row, k] + math.sqrt(B[row + 1, k])) * one
        B[row, k] = path
        others += 0.0 if path - B[row + 2, k] >= 0.0 and path - B[row + 2, k] < 1.0 else 1.0
    if others > 0.0:
        for k in range(n):
            grain = math.floor(B[row, k])
            if grain != B[row + 2, k]:
                i = int(B[numbers, k])
                x, y, z, area = elements[i, 0], elements[i, 1], elements[i, 2], elements[i, 7]
                keep(anchors, i, grain, x, y, z, area, cluster)
                B[row + 2, k], B[row + 3, k], B[row + 4, k] = grain, anchors[i, KEPT + 1], anchors[i, KEPT + 2]
    first, second = 1.0 if cluster.static & 1 else 0.0, 1.0 if cluster.static & 2 else 0.0
    for k in range(n):
        t = B[row, k] - B[row + 2, k]
        q = t * t * (3.0 - 2.0 * t)
        xi = ((1.0 - q) * B[row + 3, k] + q * B[row + 4, k]) / math.sqrt((1.0 - q) * (1.0 - q) + q * q)
        B[out, k], B[out + 1, k] = 1.0 + first * xi, 1.0 + second * xi
