"""The sizes of the facets that bodies of a run have, for its summary and for people."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from granular_contact.mechanics import mechanism
from granular_contact.mechanics.space.kinematics import SpatialKinematics
from granular_contact.mechanics.strip_error import asked, strip_error
from granular_contact.sand.kernels.facet_records import RIM, TRIANGLE
from granular_contact.sand.space.facets import as_facets
from granular_contact.scene.space.types import Vector
from granular_contact.scene.types import link_of


def edges(rows: Vector) -> Vector:
    """Greatest edge (n,) m of facets, rows as of `sand.space.facets`."""
    facets = as_facets(rows)
    a, b = facets["a"], facets["b"]
    lengths = [np.linalg.norm(one, axis=1) for one in (2.0 * a, 2.0 * b)]
    of_triangle = [np.linalg.norm(one, axis=1) for one in (a - b, 2.0 * a + b, a + 2.0 * b)]
    return np.asarray(np.where(facets["form"] == TRIANGLE, np.max(of_triangle, axis=0), np.max(lengths, axis=0)))


def numbers(motion: SpatialKinematics, error: float) -> dict[str, Any]:
    """Of the summary: the estimated error; of each body number and edges."""
    bodies: dict[str, dict[str, float]] = {}
    for one in (one for one in motion.system.facets.lines if one.element_kind == "surface"):
        rows = one.rows[as_facets(one.rows)["form"] != RIM]
        body = bodies.setdefault(mechanism.label(link_of(one.body.name)), {"number": 0, "edge_m": 0.0})
        body["number"] += len(rows)
        body["edge_m"] = max(body["edge_m"], float(edges(rows).max()))
    return {"error": float(error), "bodies": bodies} if bodies else {}


def explained(system: Any, trajectory: Any) -> Iterator[str]:
    """Sentences for people: the size of facets by body, what they were chosen for, and the error."""
    if trajectory.load is None:
        return
    motion = SpatialKinematics(system, trajectory)
    found = numbers(motion, strip_error(motion))
    shares = {mechanism.label(name): share for name, share in motion.scene.facet_shares.items()}
    for name, body in found.get("bodies", {}).items():
        share = shares.get(name, 1.0)
        smaller = f", {share:.2g} times their first size" if share < 1.0 else ""
        yield f"facets of {name}: {body['number']}, with edges of at most {1e3 * body['edge_m']:.3g} mm{smaller}"
    if not found:
        return
    allowed = asked(motion.scene)
    chosen = "as the config has them" if allowed is None else f"for an error of {100.0 * allowed:g} % of the path"
    yield f"facets are chosen {chosen}; estimated error of the motion by them: {100.0 * found['error']:.2g} %"
