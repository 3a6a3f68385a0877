"""Quantities of facets that depend on their paths: shear displacement (see `path_length`) and scatter (see `scatter`).

Compiled only for media that need one of them, see `space_joining`.

Scatter: a facet takes the value of a cube of the size of a grain, fixed to its body. Facets with their centroids in one
cube share its value, and they stay in their cube, so no force jumps. A facet larger than a grain has the standard
deviation s L / sqrt(area).

With scatter the anchors of facets have more columns: PATH, the path length (m) of the centroid since the start; LAST
and the two columns after it, the position of the centroid at the end of the last step (m); KEPT and the two columns
after it: the number of the grain in which the path was at the last evaluation of forces, and s r of `scatter` at both
ends of this grain. These three change only once per grain, and computing them costs more than all other work. They are
never used for another grain, so they are no part of the state.

With shear displacements the last three columns of anchors are the displacement S (m) of the anchor along the surface
since the centroid got into the medium; S turns with the normal. With the displacement d (m) of the centroid from its
anchor along the surface, whose direction is e,

    j = max(0, S . e) + |d|,    S <- S - min(0, S . e) e + d    with the d of the anchor, where it is dragged.

So a shear displacement against e is counted anew, as in the plane (`path_length`), and a shear displacement across e
counts again when the motion turns back to its direction. Wong and Chiang (2001) sum vectors in the frame of the ground
likewise, for tracks that turn. A sum of path lengths would depend on the length of steps, as it misses turns within a
step.
"""

from __future__ import annotations

import math

import numpy as np

from granular_contact.jit.compiled import part
from granular_contact.sand.kernels.facet_blocks import vector
from granular_contact.sand.kernels.facet_records import as_facets
from granular_contact.sand.kernels.scatter import value
from granular_contact.sand.kernels.vectors import at, dot, minus, norm, put, times

PATH, LAST, KEPT = 3, 4, 7
COLUMNS, SHEARED = 10, 3  # of anchors with scatter, without shear displacement; of the shear displacement
ALONG, ACROSS, UPWARD, BODY = 73856093, 19349663, 83492791, 49979687  # primes: cubes nearby have different numbers


@part
def scatters(anchors):
    """Return whether anchors have the columns of scatter."""
    return anchors.shape[1] >= COLUMNS


@part
def shears(anchors):
    """Return whether the last three columns of anchors are the shear displacement (m)."""
    return anchors.shape[1] == 3 + SHEARED or anchors.shape[1] > COLUMNS


@part
def begin(anchors, first, last, anew):
    """Begin the shear displacements of facets first to last - 1 at their anchors; anew: their paths, too."""
    for i in range(first, last):
        if shears(anchors):
            for k in range(1, 1 + SHEARED):
                anchors[i, anchors.shape[1] - k] = 0.0
        if anew and scatters(anchors):
            anchors[i, PATH], anchors[i, KEPT] = 0.0, np.nan
            put(at(anchors, i, 0), anchors, i, LAST)


@part
def sheared(anchors, i):
    """Shear displacement S (3,) m of the anchor of a facet."""
    return at(anchors, i, anchors.shape[1] - SHEARED)


@part
def shear_displacement(s, e, n):
    """Shear displacement j (m) of a facet and its direction (3,); s: S; e (3,) m: from the anchor; n: normal."""
    along = minus(e, times(dot(n, e), n))
    d = norm(along)
    if d == 0.0:
        return 0.0, along
    u = along[0] / d, along[1] / d, along[2] / d
    return max(0.0, dot(s, u)) + d, u


@part
def count(anchors, i, p, a, n, immersed):
    """Add a step that ends with the centroid of facet i at p (3,) m; then its anchor goes to a (3,) m; n: normal."""
    if scatters(anchors):
        anchors[i, PATH] += norm(minus(p, at(anchors, i, LAST)))
        put(p, anchors, i, LAST)
    if shears(anchors):
        first = anchors.shape[1] - SHEARED
        s = along_surface(sheared(anchors, i), n)
        j, e = shear_displacement(s, minus(a, at(anchors, i, 0)), n)
        increase = j - dot(s, e)
        for k in range(3):
            anchors[i, first + k] = s[k] + increase * e[k] if immersed else 0.0


@part
def along_surface(s, n):
    """A vector (3,) of the same length along a surface whose normal has turned to n."""
    across, square = dot(s, n), dot(s, s)
    left = square - across * across
    k = math.sqrt(square / left) if left > 0.0 else 0.0
    return times(k, minus(s, times(across, n)))


@part
def keep(anchors, i, grain, facet, cluster):
    """Keep the scatter s r at both ends of a grain (its number) that the path of facet i has come into."""
    x, y, z, size = facet.centroid[0], facet.centroid[1], facet.centroid[2], cluster.grain
    s = cluster.scatter if facet.area <= size * size else cluster.scatter * size / math.sqrt(facet.area)
    cube = math.floor(x / size) * ALONG + math.floor(y / size) * ACROSS + math.floor(z / size) * UPWARD
    cube += cluster.body * BODY
    number, seed = int(grain), int(cluster.seed)
    anchors[i, KEPT] = grain
    anchors[i, KEPT + 1], anchors[i, KEPT + 2] = s * value(seed, number, cube), s * value(seed, number + 1, cube)


@part
def note(block, n, elements, anchors, cluster):
    """Fill in the shear displacements of the n facets of a block, and the scatter of the terms."""
    rows, stretch = block.row, block.stretch
    if shears(anchors):
        for k in range(n):
            s, e = sheared(anchors, rows[k]), vector(stretch, k)
            block.shear[k] = shear_displacement(s, e, vector(block.normal, k))[0]
    if scatters(anchors):
        for k in range(n):
            i = rows[k]
            square = 0.0
            for axis in range(3):
                square += (anchors[i, axis] + stretch[axis, k] - anchors[i, LAST + axis]) ** 2
            block.path[k], block.ahead[k], block.grain[k] = anchors[i, PATH], square, anchors[i, KEPT]
            block.grain_ends[0, k], block.grain_ends[1, k] = anchors[i, KEPT + 1], anchors[i, KEPT + 2]
        scatter(block, n, elements, anchors, cluster)


@part
def scatter(block, n, elements, anchors, cluster):
    """Fill in the factors of the two static terms of the n facets of a block, from the work arrays that `note` filled.

    path: path length up to the last step (m), on return the whole path in grains; ahead: square of the distance since
    that step (m^2); grain, grain_ends: number of the grain kept last, and s r at its ends.
    """
    path, grain, ends = block.path, block.grain, block.grain_ends
    changed, inverse = 0.0, 1.0 / cluster.grain
    for k in range(n):
        grains = (path[k] + math.sqrt(block.ahead[k])) * inverse
        path[k] = grains
        changed += 0.0 if grains - grain[k] >= 0.0 and grains - grain[k] < 1.0 else 1.0
    if changed > 0.0:
        facets = as_facets(elements)
        for k in range(n):
            number = math.floor(path[k])
            if number != grain[k]:
                i = block.row[k]
                keep(anchors, i, number, facets[i], cluster)
                grain[k], ends[0, k], ends[1, k] = number, anchors[i, KEPT + 1], anchors[i, KEPT + 2]
    growing, constant = 1.0 if cluster.static & 1 else 0.0, 1.0 if cluster.static & 2 else 0.0
    for k in range(n):
        t = path[k] - grain[k]
        q = t * t * (3.0 - 2.0 * t)
        xi = ((1.0 - q) * ends[0, k] + q * ends[1, k]) / math.sqrt((1.0 - q) * (1.0 - q) + q * q)
        block.scatter[0, k], block.scatter[1, k] = 1.0 + growing * xi, 1.0 + constant * xi
