"""Inertias that no body can have, mended in the XML as little as serves."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from granular_contact.robot.elements import Reader
from granular_contact.robot.inertia import impossible, raised
from granular_contact.robot.inspection import Inspection
from granular_contact.robot.links import MOMENTS, tensor_of
from granular_contact.robot.source import Element
from granular_contact.robot.types import Vector

ROUND_OFF = 1e-12  # of the largest moment of inertia: is written as 0, as its digits differ between processors


def mend_inertias(root: Element, inspection: Inspection) -> Iterator[str]:
    """Mend impossible inertias; says what was done, a sentence for each link.

    Mass and centre of mass stay. The small moments are raised until they reach the largest, which stays with the axes;
    where the shapes of the link are too small for the largest, the tensor becomes that of their convex hull.
    """
    for link in root.findall("link"):
        inertial, name = link.find("inertial"), link.get("name") or ""
        reader = Reader(inspection.robot.file)
        mass = None if inertial is None or inertial.find("mass") is None else inertial.find("mass").get("value")
        weight = reader.number(inertial.find("mass"), "value", "") if mass is not None else None
        if not weight or weight < 0.0:
            continue
        tensor = tensor_of(reader, inertial, "", weight)
        if tensor is None or impossible(tensor) is None:
            continue
        yield f"link {name}: {_mended(inertial, tensor, weight, _corners(inspection, name), reader)}"


def _corners(inspection: Inspection, link: str) -> Vector:
    """Corners (n, 3) m of all shapes of a link."""
    found = [one.corners for one in inspection.shapes if one.shape.link == link]
    return np.concatenate([np.zeros((0, 3)), *(one.reshape(-1, 3) for one in found if one is not None)])


def _mended(inertial: Element, tensor: Vector, mass: float, corners: Vector, reader: Reader) -> str:
    """Mend an inertia (3, 3) kg m^2 about its centre in the XML, and say how; corners (n, 3) m are those of shapes."""
    moments = np.linalg.eigvalsh(tensor)
    center = reader.pose(inertial, "").xyz
    reach = float(np.linalg.norm(corners - center, axis=1).max()) if len(corners) else np.inf
    if 0.0 < moments[2] <= mass * reach**2:
        new = raised(tensor)
        _write_tensor(inertial, new)
        was, now = (", ".join(f"{one:.4g}" for one in np.linalg.eigvalsh(one)[:2]) for one in (tensor, new))
        return f"its smaller moments of inertia are raised from {was} to {now} kg m^2; all else of it stays"
    if len(corners) == 0:
        return "its inertia stays, as it has no shape to take one from"
    if (origin := inertial.find("origin")) is not None:  # whose axes are those of the link from now on
        origin.attrib.pop("rpy", None)
    _write_tensor(inertial, _of_hull(corners, mass))
    return "its inertia is now that of the hull of its shapes, which are too small for it; mass and centre of mass stay"


def _of_hull(points: Vector, mass: float) -> Vector:
    """Inertia (3, 3) kg m^2 of the convex hull of points (n, 3) m about its centre of mass, of one density."""
    from trimesh import Trimesh

    hull = Trimesh(points, np.zeros((0, 3), int), process=False).convex_hull
    hull.density = mass / hull.volume
    return np.asarray(hull.moment_inertia, float)


def _write_tensor(inertial: Element, tensor: Vector) -> None:
    tensor = np.where(np.abs(tensor) < ROUND_OFF * np.abs(tensor).max(), 0.0, tensor)
    for name in MOMENTS:
        inertial.find("inertia").set(name, f"{tensor['xyz'.index(name[1]), 'xyz'.index(name[2])]:.9g}")
