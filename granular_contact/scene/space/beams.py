"""Links that bend, in space: rigid elements joined by springs of bending and torsion (rigid finite element method).

A link of length L with n elements of length l = L / n is cut at the middles of the elements. This gives two rigid
pieces of length l / 2 at its ends and n - 1 pieces of length l between them, joined at n points. At each joint, the
rotation vector theta from one piece to the next (twist about the axis, bending about y and z) stores the energy
sum_k K_k theta_k^2 / 2 with K = (G J, E I_y, E I_z) / l, and a damper gives the moment D_k times its rate (Kruszewski
1975, Wittbrodt et al. 2006; like the lumped beams of other multibody programs). The error of deflections and
frequencies is proportional to l^2. A link has no shear and, without axial_stiffness_N, a constant length: it is a
Kirchhoff rod. As every piece is a rigid body, laws of bars and facets act on a link as on other bodies, and joints can
be at any place along it.
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
    """Joint between neighbouring elements of a link, with the frame of the link; the parent is nearer to the ground."""

    parent: str
    child: str
    parent_point_m: Point3
    elastic: Elastic
    rpy_deg: None = None
    quaternion: None = None

    @property
    def type(self) -> Literal["elastic", "stretching"]:
        """Kind of the joint, as in `SpatialJoint`."""
        return "elastic" if self.elastic.axial is None else "stretching"

    @property
    def child_point_m(self) -> Point3:
        """The same point as on the parent, as both frames are the frame of the straight link."""
        return self.parent_point_m


def bending_links(model: schema.SpatialModel) -> dict[str, schema.SpatialLink]:
    """Links of a model that bend, by name."""
    links = {name: body for name, body in model.all_bodies.items() if isinstance(body, schema.SpatialLink)}
    return {name: link for name, link in links.items() if link.flexible is not None}


def with_elements(model: schema.SpatialModel) -> schema.SpatialModel:
    """Replace each link that bends by its elements, `NAME.0` to `NAME.n`, and joints between them.

    A joint at some place along a link then joins the element at this place.
    """
    links = bending_links(model)
    if not links:
        return model
    joints: dict[str, Any] = {name: _on_elements(joint, links) for name, joint in model.all_joints.items()}
    closures = {name: _on_elements(closure, links) for name, closure in model.closures.items()}
    bodies: dict[str, Any] = {}
    for name, body in model.all_bodies.items():
        if name not in links:
            bodies[name] = body
            continue
        held = next(joint.child for joint in joints.values() if link_of(joint.child) == name)
        bodies |= {f"{name}.{k}": element for k, element in enumerate(_elements(links[name]))}
        joints |= _elastic_joints(name, links[name], int(held.split(".")[1]))
    return schema.SpatialModel.model_construct(
        in_space=True, name=model.name, bodies=bodies, joints=joints, closures=closures, chain=None
    )


def _cuts(link: schema.SpatialLink) -> Vector:
    """Coordinates (n,) m along a link at which it is cut."""
    assert link.flexible is not None
    n = link.flexible.elements
    return (np.arange(n) + 0.5) * link.length_m / n


def _elements(link: schema.SpatialLink) -> list[Element]:
    bounds = [0.0, *_cuts(link).tolist(), link.length_m]
    last = len(bounds) - 2
    return [Element(link, *ends, 0.5 if k in (0, last) else 1.0) for k, ends in enumerate(pairwise(bounds))]


def _on_elements(joint: Any, links: dict[str, schema.SpatialLink]) -> Any:
    """The same joint or closure on the elements of links instead of the links."""
    ends = {}
    for end in ("parent", "child"):
        name = getattr(joint, end)
        if name in links:
            x = getattr(joint, f"{end}_point_m")[0]
            ends[end] = f"{name}.{int(np.searchsorted(_cuts(links[name]), x))}"
    return joint.model_copy(update=ends) if ends else joint


def _elastic_joints(name: str, link: schema.SpatialLink, held: int) -> dict[str, ElasticJoint]:
    """Joints between the elements of a link, outward from the element by which it is held (its index)."""
    flexible = link.flexible
    assert flexible is not None
    piece = link.length_m / flexible.elements
    damping = np.array([flexible.torsion_damping_N_m2_s, *[flexible.bending_damping_N_m2_s] * 2])
    stretch, stretch_damping = flexible.axial_stiffness_N, flexible.axial_damping_N_s
    axial = None if stretch is None else (stretch / piece, stretch_damping / piece)
    law = Elastic(stiffness(link) / piece, damping / piece, axial)
    joints = {}
    for k, x in enumerate(_cuts(link).tolist()):
        inner, outer = (k, k + 1) if k >= held else (k + 1, k)
        joints[f"{name}.{k}-{k + 1}"] = ElasticJoint(f"{name}.{inner}", f"{name}.{outer}", (x, *ORIGIN[1:]), law)
    return joints


def beams(model: schema.SpatialModel, pose: Pose, rigid: tuple[SpatialRigidBody, ...]) -> Iterator[SpatialBeam]:
    """Links that bend, from the bodies of their elements.

    model: with links, as before `with_elements`; pose: of all elements; rigid: bodies with elements.
    """
    body_of = {name: body for body in rigid for name in body.members}
    for name, link in bending_links(model).items():
        cross_section, flexible, pieces = section(link), link.flexible, []
        assert flexible is not None
        stretch = flexible.axial_stiffness_N
        for k, element in enumerate(_elements(link)):
            frame = _frame(body_of.get(f"{name}.{k}"), pose[f"{name}.{k}"])
            mass = link.density_kg_m3 * cross_section.area * (element.end - element.start)
            pieces.append((frame, 0.5 * (element.start + element.end), mass))
        yield SpatialBeam(
            name=name,
            length=link.length_m,
            section=(cross_section.width, cross_section.thickness),
            round=cross_section.diameter is not None,
            stiffness=(K := stiffness(link)),
            moduli=(
                float(K[1] / cross_section.second_moments[0]),
                float(K[0] / cross_section.torsion_constant),
                (stretch or 0.0) / cross_section.area,
            ),
            stretches=stretch is not None,
            yield_stress=flexible.yield_stress_Pa,
            elements=len(pieces) - 1,
            pieces=tuple((body, origin + x * axes[:, 0], mass) for (body, origin, axes), x, mass in pieces),
            joints=tuple(f"{name}.{k}-{k + 1}" for k in range(len(pieces) - 1)),
            root=pieces[0][0],
            tip=pieces[-1][0],
        )


def _frame(body: SpatialRigidBody | None, pose: Any) -> tuple[str | None, Vector, Vector]:
    """Name of a body (None for the ground), and origin (3,) m and axes (3, 3) of a link's frame in its frame."""
    if body is None:
        return None, pose.position, pose.rotation
    motion = body.motion
    return body.name, motion.local(pose.position), motion.rotation.T @ pose.rotation
