"""CPU time of the load in space: of a facet, of a body out of reach, and of loading and building a large mesh.

    python validation/space_cost.py

The script measures the CPU time a facet of one call of the kernels that the engine calls, the least of many rounds,
since noise can only add to a time. A sphere of some 5 000 facets moves down and rotates, fully immersed, with all
bristles at yield; it has only its leading or only its trailing facets. A strip of the plane with the same law is timed
in the same run for comparison, since ratios do not depend on the load of the machine. Loading means reading an STL file
of 100 000 triangles, checking it, and building its facets and clusters.

Bounds: 120 ns for a leading facet with 3D-RFT and its bristle, 10 ns for a facet above the surface, 3 s for the large
mesh.
"""

from __future__ import annotations

import itertools
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[1]))

import numpy as np

from granular_contact import Drft, Mesh, Rft, Rft3d, Sphere
from granular_contact.laws.law import Law
from granular_contact.sand.contact_lines import Body, polyline
from granular_contact.sand.load import GranularLoad
from granular_contact.sand.space.facets import half_sides
from granular_contact.sand.space.load import SpatialLoad
from granular_contact.sand.space.triangles import clusters_of
from validation.study import Claim, Outcome, script
from validation.tables import markdown

ROUNDS, CALLS = 40, 10
LEADING, ABOVE, LOADING = 120.0, 10.0, 3.0  # ns, ns, s
ABOVE_IT, STRIP = "above the surface", "(a strip of the plane)"
BODY = Body("body", [0, 1, 2, 3, 4, 5, 6])
STILL = [1.0, 0.0, 0.0, 0.0]
SPEED = np.array([0.1, 0.05, -0.3, 0.0, 0.05, 0.1, 0.05])
MEDIA: dict[str, Law] = {"rft3d": Rft3d(1600.0, 0.5, 0.3), "drft": Drft(density=1600.0, lam=1.1), "rft": Rft()}


def least(call: Callable[..., object], *arguments: Any, calls: int = CALLS) -> float:
    """CPU time (s) of one call: least over the rounds, after a warm-up."""
    call(*arguments)
    times = []
    for _ in range(ROUNDS):
        start = time.process_time()
        for _ in range(calls):
            call(*arguments)
        times.append((time.process_time() - start) / calls)
    return min(times)


def sphere(medium: Law, leading: bool | None, height: float = -0.5) -> tuple[SpatialLoad, np.ndarray, int]:
    """Load of a sphere, its coordinates, and its number of facets.

    leading: keep the leading (True) or the trailing (False) facets; None: all. height: of the centre, m.
    """
    load = SpatialLoad(medium, 0.0)
    load.add_shape(BODY, Sphere(0.2), facet_size=0.012)
    line = load.lines[0]
    rows = line.rows
    if leading is not None:
        ahead = rows[:, 4:7] @ SPEED[:3] > 0.05 * np.linalg.norm(SPEED[:3])
        rows = np.ascontiguousarray(rows[ahead if leading else ~ahead])
    load.lines[0] = replace(line, rows=rows, clusters=clusters_of(rows[:, :3], rows[:, 3], half_sides(rows)))
    q = np.array([0.0, 0.0, height, *STILL])
    load.start(q)
    for i in range(3):
        load.accept(1e-3 * i, q, SPEED)
        q = q + 1e-3 * SPEED
    return load, q, len(rows)


def strip_ns(medium: Law) -> float:
    """CPU time (ns) of a strip of the plane."""
    load, strips = GranularLoad(medium, 0.0), 2000
    load.add(polyline(Body("body", [0, 1, 2]), [[-0.1, 0.0], [0.1, 0.0]], width=0.1, strips=strips))
    q, v, out = np.array([0.0, -0.5, 0.3]), np.array([0.1, -0.3, 0.0]), np.zeros(3)
    load.start(q)
    for i in range(3):
        load.accept(1e-3 * i, q, v)
        q = q + 1e-3 * v
    return 1e9 * least(load.force, q, v, out) / strips


def anew(load: SpatialLoad, q: np.ndarray) -> Callable[..., object]:
    """Function that computes the force at two coordinates in turn, a picometre apart.

    The load keeps the force at the last coordinates and would not compute it again.
    """
    places = itertools.cycle([q, q + np.array([0.0, 0.0, 1e-12, 0.0, 0.0, 0.0, 0.0])])
    return lambda *arguments: load.force(next(places), *arguments)


def facet_rows() -> list[tuple[str, str, float]]:
    """Rows of law, measured case, and CPU time a facet (ns)."""
    rows, out = [("rft3d", STRIP, strip_ns(MEDIA["rft3d"]))], np.zeros(7)
    for name, medium in MEDIA.items():
        load, q, number = sphere(medium, True)
        rows.append((name, "leads", 1e9 * least(anew(load, q), SPEED, out) / number))
    medium = MEDIA["rft3d"]
    load, q, number = sphere(medium, True)
    rows.append(("rft3d", "leads, tangent", 1e9 * least(load.tangent, q, SPEED, 1.0, 1.0, calls=2) / number))
    rows.append(("rft3d", "leads, end of a step", 1e9 * least(load.accept, 1.0, q, SPEED) / number))
    load, q, number = sphere(medium, False)
    rows.append(("rft3d", "trails", 1e9 * least(anew(load, q), SPEED, out) / number))
    load, q, number = sphere(medium, None, 0.15)
    rows.append(("rft3d", ABOVE_IT, 1e9 * least(anew(load, q), SPEED, out) / number))
    load, q, number = sphere(medium, None, 1.0)
    load.update_active(1e-3)
    far = 1e9 * least(anew(load, q), SPEED, out, calls=1000)
    return [*rows, ("rft3d", f"out of reach, all {number} together", far)]


def loading() -> dict[str, float]:
    """CPU time (s) of reading a mesh of 100 000 triangles, of building its load, and of starting it."""
    corners = Sphere(0.3).corners(0.0042)
    load = SpatialLoad(MEDIA["rft3d"], 0.0)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "large.stl"
        _write_stl(path, corners)
        start = time.process_time()
        mesh = Mesh.read(path)
        read = time.process_time()
    load.add_shape(BODY, mesh, facet_size=1.0)
    built = time.process_time()
    load.start(np.array([0.0, 0.0, 1.0, *STILL]))
    return {
        "triangles": float(len(mesh.faces)),
        "reading and checking": read - start,
        "facets and clusters": built - read,
        "starting": time.process_time() - built,
    }


def _write_stl(path: Path, corners: np.ndarray) -> None:
    record = np.zeros(len(corners), [("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("more", "<u2")])
    record["corners"] = corners
    path.write_bytes(bytes(80) + np.uint32(len(corners)).tobytes() + record.tobytes())


def study(quick: bool) -> Outcome:  # noqa: ARG001  # one form
    """Measure the time a facet, and the time of a large mesh."""
    rows, costs = facet_rows(), loading()
    number = costs.pop("triangles")
    costs["together"] = sum(costs.values())
    table = [[law, case, f"{ns:.3g}", f"{ns / rows[0][2]:.2f}"] for law, case, ns in rows]
    text = (
        f"Least of {ROUNDS} rounds after a warm-up.\n\n"
        f"{markdown(['law', 'facet', 'CPU ns', 'ratio to a strip'], table)}\n\n"
        f"{number:.0f} triangles from an STL file:\n\n"
        + markdown(["", "CPU s"], [[case, f"{seconds:.2f}"] for case, seconds in costs.items()])
    )
    ns = {case: value for law, case, value in rows if law == "rft3d"}
    bounds = (
        ("a leading facet", ns["leads"], LEADING, "ns"),
        ("a facet above the surface", ns[ABOVE_IT], ABOVE, "ns"),
        ("loading a large mesh", costs["together"], LOADING, "s"),
    )
    claims = [
        Claim(f"space_cost.{name}", value <= most, f"{value:.3g} {unit} (at most {most:g})")
        for name, value, most, unit in bounds
    ]
    return Outcome(text, tuple(claims))


if __name__ == "__main__":
    sys.exit(script(study))
