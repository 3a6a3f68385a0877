"""Scatter of the static resistance from place to place, as grains are no continuum.

The static terms of a strip are multiplied by 1 + s xi. xi is a smooth random function of the path length w of the strip
(`path_length`) and of its place along its line, so that neighbours share it. It does not depend on time, so a run with
one seed converges with its step as any other run. A lattice over w and place, with cells of the length L of a grain,
has values of +1 or -1; between them

    xi = sum_ij a_i b_j r_ij,      a = (1 - q, q) / sqrt((1 - q)^2 + q^2),    q = t^2 (3 - 2 t),    t in [0, 1),

and b likewise in the other direction. The squares of the weights add to 1, so xi has the mean 0 and the variance 1
everywhere, a continuous first derivative, and |xi| <= 2. With s <= MOST the factor is never negative: no strip is
driven. A strip longer than a grain has the standard deviation of a mean over several grains, s sqrt(L / length). Facets
in space: `facet_paths`. The form is [ours]; no published spectrum is known.
"""

from __future__ import annotations

import math

import numpy as np

from granular_contact.jit.compiled import part
from granular_contact.sand.kernels.path_length import path_length

MOST = 0.5
GOLDEN, FIRST, SECOND = (np.uint64(x) for x in (0x9E3779B97F4A7C15, 0xBF58476D1CE4E5B9, 0x94D049BB133111EB))
ONE, S27, S30, S31 = (np.uint64(x) for x in (1, 27, 30, 31))


@part
def value(seed, i, j):
    """Value +1 or -1 of the lattice at (i, j), from a hash in the manner of splitmix64."""
    x = np.uint64(seed) * GOLDEN + np.uint64(i) * FIRST + np.uint64(j) * SECOND
    x = (x ^ (x >> S30)) * FIRST
    x = (x ^ (x >> S27)) * SECOND
    return 1.0 if (x ^ (x >> S31)) & ONE else -1.0


@part
def weights(t):
    """Weights of the two values around a position t in [0, 1) in a cell."""
    q = t * t * (3.0 - 2.0 * t)
    inverse = 1.0 / math.sqrt((1.0 - q) * (1.0 - q) + q * q)
    return (1.0 - q) * inverse, q * inverse


@part
def xi(seed, path, place):
    """Random function in [-2, 2] of a path length and a place, both in grains."""
    i, j = math.floor(path), math.floor(place)
    a0, a1 = weights(path - i)
    b0, b1 = weights(place - j)
    i, j = int(i), int(j)
    return a0 * (b0 * value(seed, i, j) + b1 * value(seed, i, j + 1)) + a1 * (
        b0 * value(seed, i + 1, j) + b1 * value(seed, i + 1, j + 1)
    )


@part
def factor(path, place, length, line):
    """Factor of the static terms of a strip; path, place of its middle and length (m) of the strip."""
    s = line.scatter if length <= line.grain else line.scatter * math.sqrt(line.grain / length)
    return 1.0 + s * xi(int(line.seed), path / line.grain, place / line.grain)


@part
def scattered(f, P, anchors, i, place, length, line):
    """Multiply the static terms of the end forces f[term, end, xy] of strip i; place and length as in `factor`."""
    share = factor(0.5 * (path_length(P, anchors, i) + path_length(P, anchors, i + 1)), place, length, line)
    for term in range(f.shape[0]):
        if (line.static >> term) & 1:
            for end in range(2):
                for xy in range(2):
                    f[term, end, xy] *= share
