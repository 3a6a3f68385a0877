"""Mass matrix and weight of the bodies in the engine's coordinates; both are constant.

One load object of Exudyn for each body would give the same weights and cost a sixth of a Newton iteration of a long
chain.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from granular_contact.mechanics.system import System
from granular_contact.scene.parts import FlexibleLink, RigidBody

Vector = NDArray[np.float64]

SPARSE_FROM = 100  # coordinates, above which the matrix is sparse: that of a chain has mostly zeros

# Integrals of N_i N_j and of N_i over a cubic element of length 1; N_i: Hermite shape functions.
_MASS = np.array([[156, 22, 54, -13], [22, 4, 13, -3], [54, 13, 156, -22], [-13, -3, -22, 4]]) / 420.0
_FIRST = np.array([1.0 / 2.0, 1.0 / 12.0, 1.0 / 2.0, -1.0 / 12.0])


def _scales(length: float) -> Vector:
    """Factors (4,) of the Hermite shape functions of an element of a length (m)."""
    return np.array([1.0, length, 1.0, length])


def body_mass(body: RigidBody | FlexibleLink) -> Vector:
    """Mass matrix of a rigid body, or (8, 8) of one element of a link: r_x, r_y, r'_x, r'_y of both nodes."""
    if not isinstance(body, FlexibleLink):
        return body.mass_matrix()
    length = body.length / body.elements
    scales = _scales(length)
    return np.asarray(np.kron(body.mass_per_length * length * _MASS * np.outer(scales, scales), np.eye(2)), float)


def gravity_load(body: RigidBody | FlexibleLink, gravity: float) -> Vector:
    """Generalised forces of the weight, in the coordinates of `body_mass`."""
    if not isinstance(body, FlexibleLink):
        return body.weight(gravity)
    length = body.length / body.elements
    return np.asarray(np.kron(body.mass_per_length * length * _FIRST * _scales(length), [0.0, -gravity]), float)


def pieces(system: System) -> Iterator[tuple[RigidBody | FlexibleLink, list[int]]]:
    """Yield rigid bodies, and each link once for each of its elements, with the nodes of `body_mass`."""
    for rigid in system.rigid.values():
        yield rigid.body, [rigid.node]
    for link in system.links.values():
        for pair in pairwise(link.nodes):
            yield link.link, list(pair)


def gravity_loads(system: System) -> dict[int, Vector]:
    """Generalised forces of the weight by node; empty without gravity."""
    by_node: dict[int, Vector] = {}
    if system.scene.gravity == 0.0:
        return by_node
    for body, nodes in pieces(system):
        for node, part in zip(nodes, np.split(gravity_load(body, system.scene.gravity), len(nodes)), strict=True):
            by_node[node] = by_node.get(node, 0.0) + part
    return by_node


def center_shares(mass: Any, nodes: NDArray[np.int64]) -> Vector:
    """Shares (2, m) of all coordinates in the centre of mass x, y of a link; nodes (k, 4): indices of its coordinates.

    mass (m, m): mass matrix of the system, in which the link shares no node with other bodies.
    """
    shares = []
    for axis in (0, 1):
        translation = np.zeros(mass.shape[0])
        translation[nodes[:, axis]] = 1.0
        momenta = mass @ translation
        shares.append(momenta / (translation @ momenta))
    return np.array(shares)


def mass_matrix(system: System) -> Any:
    """Mass matrix of the assembled system, sparse if it is large."""
    coordinates = system.coordinates
    size = coordinates.size
    rows, columns, values = [np.zeros(0, int)], [np.zeros(0, int)], [np.zeros(0)]
    for body, nodes in pieces(system):
        mass = body_mass(body)
        places = np.array([place for node in nodes for place in coordinates.places(node)])
        i, j = np.nonzero(mass)
        rows.append(places[i])
        columns.append(places[j])
        values.append(mass[i, j])
    entries = np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))
    if size <= SPARSE_FROM:
        dense = np.zeros((size, size))
        np.add.at(dense, entries[1], entries[0])
        return dense
    from scipy import sparse  # here, as the import takes a fifth of a second

    return sparse.csr_matrix(entries, shape=(size, size))
