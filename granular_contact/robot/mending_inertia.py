"""Inertias that no body can have, replaced in the XML by those of the shapes of their links."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from granular_contact.robot.elements import Reader
from granular_contact.robot.inertia import impossible
from granular_contact.robot.inspection import Inspection
from granular_contact.robot.links import MOMENTS, tensor_of
from granular_contact.robot.source import Element
from granular_contact.robot.types import Vector

NEGLIGIBLE = 1e-6  # of the largest moment of inertia


def mend_inertias(root: Element, inspection: Inspection) -> Iterator[str]:
    """Replace impossible inertias; says what was done, a sentence for each link.

    The mass stays. The new inertia and centre are those of the convex hull of all shapes of the link, of one density;
    without shapes the largest moment is lowered to what is possible, or gets others beside it.
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
        of_link = [one.corners for one in inspection.shapes if one.shape.link == name]
        corners = [one.reshape(-1, 3) for one in of_link if one is not None]
        if corners:
            center, found = _of_hull(np.concatenate(corners), weight)
            _write_place(inertial, center)
            _write_tensor(inertial, found)
            yield f"link {name}: inertia and centre of mass are now those of the hull of its shapes; its mass stays"
        elif (low := np.linalg.eigvalsh(tensor))[2] > 0.0:
            _write_tensor(inertial, _nearest(tensor))
            what = "largest moment of inertia is now the sum of the two others"
            if low[0] + low[1] <= NEGLIGIBLE * low[2]:
                what = "smaller moments of inertia are now half the largest, as of a thin plate"
            yield f"link {name}: it has no shape; its {what}"
        else:
            yield f"link {name}: its inertia stays, as it has no {inspection.which} shape to take one from"


def _nearest(tensor: Vector) -> Vector:
    """The tensor (3, 3) with its largest principal moment lowered to the sum of the two others.

    Where these are nothing the largest is that of a thin plate, whose others are half of it.
    """
    moments, axes = np.linalg.eigh(tensor)
    if moments[0] + moments[1] <= NEGLIGIBLE * moments[2]:
        moments[:2] = 0.5 * moments[2]
    else:
        moments[0] = max(moments[0], NEGLIGIBLE * moments[2])
        moments[2] = min(moments[2], moments[0] + moments[1])
    found: Vector = (axes * moments) @ axes.T
    return found


def _of_hull(points: Vector, mass: float) -> tuple[Vector, Vector]:
    """Centre (3,) m and inertia (3, 3) kg m^2 about it of the convex hull of points (n, 3), of one density."""
    from trimesh import Trimesh

    hull = Trimesh(points, np.zeros((0, 3), int), process=False).convex_hull
    hull.density = mass / hull.volume
    return np.asarray(hull.center_mass), np.asarray(hull.moment_inertia)


def _write_place(inertial: Element, center: Vector) -> None:
    """Write the centre of mass (3,) m, with the axes of the link."""
    origin = inertial.find("origin")
    if origin is None:
        origin = inertial.makeelement("origin")
        inertial.insert(0, origin)
    origin.attrib.pop("rpy", None)
    origin.set("xyz", " ".join(f"{x:.9g}" for x in center))


def _write_tensor(inertial: Element, tensor: Vector) -> None:
    for name in MOMENTS:
        inertial.find("inertia").set(name, f"{tensor['xyz'.index(name[1]), 'xyz'.index(name[2])]:.9g}")
