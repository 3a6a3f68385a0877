"""Links that bend, in space: rigid elements joined by springs of bending and torsion (rigid finite elements).

A link of length L with n elements of l = L / n is cut at their middles: two rigid pieces of l / 2 at its ends and n - 1
of l between them, joined at n points, where the rotation vector theta from one piece to the next (twist about the axis,
bending about y and z) stores the energy sum_k K_k theta_k^2 / 2 with K = (G J, E I_y, E I_z) / l, and a damper takes
D_k of its rate (Kruszewski 1975, Wittbrodt et al. 2006; as lumped beams of other multibody programs). The error of
deflections and frequencies goes with l^2. A link has a constant length and no shear: its bending line is Kirchhoff's.
As every piece is a rigid body, what acts on bodies acts on a link: laws of bars, facets, joints at any place of it.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, Literal

import numpy as np

from granular_contact.config.schema import space as schema
from granular_contact.config.schema.space.turned import ORIGIN, Point3
from granular_contact.scene.space.layout import Pose
from granular_contact.scene.space.section import Element, section, stiffness
from granular_contact.scene.space.types import Elastic, SpatialBeam, SpatialRigidBody, Vector
from granular_contact.scene.types import link_of


@dataclass(frozen=True)
class ElasticJoint:
    """Between neighbouring elements of a link; its frame is that of the link. The parent is nearer to the ground."""

    parent: str
    child: str
    parent_point_m: Point3
    elastic: Elastic
    rpy_deg: None = None
    quaternion: None = None

    @property
    def type(self) -> Literal["elastic", "stretching"]:
        """As of `SpatialJoint`."""
        return "elastic" if self.elastic.axial is None else "stretching"

    @property
    def child_point_m(self) -> Point3:
        """As on the parent: the frames of both are those of the link where it is straight."""
        return self.parent_point_m


def bending_links(model: schema.SpatialModel) -> dict[str, schema.SpatialLink]:
    """Links of a model that bend, by name."""
    found = model.all_bodies.items()
    return {name: one for name, one in found if isinstance(one, schema.SpatialLink) and one.flexible is not None}


def cut(model: schema.SpatialModel) -> schema.SpatialModel:
    """A model with the elements of its links that bend in their places, `NAME.0` to `NAME.n`, and joints between them.

    What was joined to a link at some place along it is joined to the element that is there.
    """
    links = bending_links(model)
    if not links:
        return model
    joints, closures = ({name: _on_elements(joint, links) for name, joint in some.items()} for some in _all(model))
    bodies: dict[str, Any] = {}
    for name, body in model.all_bodies.items():
        if name not in links:
            bodies[name] = body
            continue
        held = next(joint.child for joint in joints.values() if link_of(joint.child) == name)
        bodies |= {f"{name}.{k}": one for k, one in enumerate(_elements(links[name]))}
        joints |= _elastic_joints(name, links[name], int(held.split(".")[1]))
    return schema.SpatialModel.model_construct(
        in_space=True, name=model.name, bodies=bodies, joints=joints, closures=closures, chain=None
    )


def _all(model: schema.SpatialModel) -> tuple[dict[str, Any], dict[str, Any]]:
    return model.all_joints, model.closures


def _cuts(link: schema.SpatialLink) -> Vector:
    """Places (n,) m at which a link is cut."""
    assert link.flexible is not None
    n = link.flexible.elements
    return (np.arange(n) + 0.5) * link.length_m / n


def _elements(link: schema.SpatialLink) -> list[Element]:
    at = [0.0, *_cuts(link).tolist(), link.length_m]
    last = len(at) - 2
    return [Element(link, *ends, 0.5 if k in (0, last) else 1.0) for k, ends in enumerate(pairwise(at))]


def _on_elements(joint: Any, links: dict[str, schema.SpatialLink]) -> Any:
    """A joint whose ends are on elements in place of links."""
    ends = {}
    for end in ("parent", "child"):
        name = getattr(joint, end)
        if name in links:
            x = getattr(joint, f"{end}_point_m")[0]
            ends[end] = f"{name}.{int(np.searchsorted(_cuts(links[name]), x))}"
    return joint.model_copy(update=ends) if ends else joint


def _elastic_joints(name: str, link: schema.SpatialLink, held: int) -> dict[str, ElasticJoint]:
    """Joints between the elements of a link, outward from the one by which it is held."""
    flexible = link.flexible
    assert flexible is not None
    piece = link.length_m / flexible.elements
    damping = np.array([flexible.torsion_damping_N_m2_s, *[flexible.bending_damping_N_m2_s] * 2])
    stretch, loss = flexible.axial_stiffness_N, flexible.axial_damping_N_s
    axial = None if stretch is None else (stretch / piece, loss / piece)
    law = Elastic(stiffness(link) / piece, damping / piece, axial)
    joints = {}
    for k, x in enumerate(_cuts(link).tolist()):
        inner, outer = (k, k + 1) if k >= held else (k + 1, k)
        joints[f"{name}.{k}-{k + 1}"] = ElasticJoint(f"{name}.{inner}", f"{name}.{outer}", (x, *ORIGIN[1:]), law)
    return joints


def beams(model: schema.SpatialModel, placed: Pose, rigid: tuple[SpatialRigidBody, ...]) -> Iterator[SpatialBeam]:
    """Links that bend, once their elements are bodies; model: before it was cut; placed: all elements."""
    homes = {name: body for body in rigid for name in body.members}
    for name, link in bending_links(model).items():
        own, flexible, pieces = section(link), link.flexible, []
        assert flexible is not None
        stretch = flexible.axial_stiffness_N
        for k, element in enumerate(_elements(link)):
            frame = _frame(homes.get(f"{name}.{k}"), placed[f"{name}.{k}"])
            mass = link.density_kg_m3 * own.area * (element.end - element.start)
            pieces.append((frame, 0.5 * (element.start + element.end), mass))
        yield SpatialBeam(
            name=name,
            length=link.length_m,
            section=(own.width, own.thickness),
            round=own.diameter is not None,
            stiffness=(K := stiffness(link)),
            moduli=(
                float(K[1] / own.second_moments[0]),
                float(K[0] / own.torsion_constant),
                (stretch or 0.0) / own.area,
            ),
            stretches=stretch is not None,
            yield_stress=flexible.yield_stress_Pa,
            elements=len(pieces) - 1,
            pieces=tuple((body, at + x * axes[:, 0], mass) for (body, at, axes), x, mass in pieces),
            joints=tuple(f"{name}.{k}-{k + 1}" for k in range(len(pieces) - 1)),
            root=pieces[0][0],
            tip=pieces[-1][0],
        )


def _frame(body: SpatialRigidBody | None, placed: Any) -> tuple[str | None, Vector, Vector]:
    """A body, None of the ground, with the origin (3,) m and the axes (3, 3) of a link's frame in it."""
    if body is None:
        return None, placed.position, placed.rotation
    motion = body.motion
    return body.name, motion.local(placed.position), motion.rotation.T @ placed.rotation
