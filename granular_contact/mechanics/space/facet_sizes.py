"""Sizes of the facets of bodies in a run, for its summary and for people."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from granular_contact.mechanics import mechanism
from granular_contact.mechanics.space.kinematics import SpatialKinematics
from granular_contact.mechanics.strip_error import allowed_error, strip_error
from granular_contact.sand.kernels.facet_records import RIM, TRIANGLE
from granular_contact.sand.space.facets import as_facets
from granular_contact.scene.space.types import Vector
from granular_contact.scene.types import link_of


def edges(rows: Vector) -> Vector:
    """Longest edge (n,) m of facets, rows as in `sand.space.facets`."""
    facets = as_facets(rows)
    a, b = facets["a"], facets["b"]
    parallelogram = [np.linalg.norm(edge, axis=1) for edge in (2.0 * a, 2.0 * b)]
    triangle = [np.linalg.norm(edge, axis=1) for edge in (a - b, 2.0 * a + b, a + 2.0 * b)]
    return np.asarray(np.where(facets["form"] == TRIANGLE, np.max(triangle, axis=0), np.max(parallelogram, axis=0)))


def numbers(motion: SpatialKinematics, error: float) -> dict[str, Any]:
    """Numbers of the summary: the estimated error, and number and longest edge of the facets of each body."""
    bodies: dict[str, dict[str, float]] = {}
    for shape in (shape for shape in motion.system.facets.lines if shape.element_kind == "surface"):
        rows = shape.rows[as_facets(shape.rows)["form"] != RIM]
        body = bodies.setdefault(mechanism.label(link_of(shape.body.name)), {"number": 0, "edge_m": 0.0})
        body["number"] += len(rows)
        body["edge_m"] = max(body["edge_m"], float(edges(rows).max()))
    return {"error": float(error), "bodies": bodies} if bodies else {}


def explained(system: Any, trajectory: Any) -> Iterator[str]:
    """Yield sentences for people: sizes of facets by body, the error they were chosen for, and the estimated one."""
    if trajectory.load is None:
        return
    motion = SpatialKinematics(system, trajectory)
    facets = numbers(motion, strip_error(motion))
    shares = {mechanism.label(name): share for name, share in motion.scene.facet_shares.items()}
    for name, body in facets.get("bodies", {}).items():
        share = shares.get(name, 1.0)
        smaller = f", {share:.2g} times their first size" if share < 1.0 else ""
        yield f"facets of {name}: {body['number']}, with edges of at most {1e3 * body['edge_m']:.3g} mm{smaller}"
    if not facets:
        return
    allowed = allowed_error(motion.scene)
    chosen = "as the config has them" if allowed is None else f"for an error of {100.0 * allowed:g} % of the path"
    yield f"facets are chosen {chosen}; estimated error of the motion by them: {100.0 * facets['error']:.2g} %"
