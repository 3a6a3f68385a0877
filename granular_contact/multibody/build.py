"""Scene -> System: the mechanism in Exudyn, with the granular bed laid over what can reach the surface."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import exudyn as exu
import numpy as np
from exudyn import itemInterface as items

from granular_contact.multibody.overlay import Overlay
from granular_contact.multibody.weights import weights
from granular_contact.scene.types import Connection, FlexibleLink, RigidBody, Scene, Vector, rotation

# A stretched beam may be a little longer than its reference; what is this close to reaching the surface gets the load.
REACH_MARGIN = 1.02


@dataclass(frozen=True)
class RigidHandle:
    """Exudyn numbers of a rigid body, and its body."""

    body: RigidBody
    node: int
    object: int


@dataclass(frozen=True)
class LinkHandle:
    """Exudyn numbers of a flexible link's nodes and cable elements, and the link."""

    link: FlexibleLink
    nodes: tuple[int, ...]
    elements: tuple[int, ...]


@dataclass(frozen=True)
class System:
    """An assembled Exudyn system and where the scene's bodies are in it. `bed` is None where no load is needed."""

    scene: Scene
    container: Any
    mbs: Any
    rigid: dict[str, RigidHandle]
    links: dict[str, LinkHandle]
    bed: Any


def build(scene: Scene) -> System:
    """Set the scene up in Exudyn and assemble it, once."""
    container = exu.SystemContainer()
    mbs = container.AddSystem()
    ground = mbs.AddObject(items.ObjectGround())
    system = System(
        scene=scene,
        container=container,
        mbs=mbs,
        rigid={body.name: _add_rigid(mbs, body) for body in scene.rigid},
        links={link.name: _add_link(mbs, link) for link in scene.links},
        bed=None,
    )
    for connection in scene.connections:
        _add_joint(system, ground, connection)
    bed = _add_bed(system)
    if bed is not None:
        bed.attach(weights(system))
    elif scene.gravity != 0.0:
        Overlay(mbs, {}, weights(system)).attach()
    mbs.Assemble()
    return System(scene, container, mbs, system.rigid, system.links, bed)


def _add_rigid(mbs: Any, body: RigidBody) -> RigidHandle:
    motion = body.motion
    node = mbs.AddNode(
        items.NodeRigidBody2D(
            referenceCoordinates=[*motion.position, motion.angle],
            initialVelocities=[*motion.velocity, motion.rate],
        )
    )
    obj = mbs.AddObject(items.ObjectRigidBody2D(mass=body.mass, inertia=body.inertia, nodeNumber=node, name=body.name))
    return RigidHandle(body, node, obj)


def _add_link(mbs: Any, link: FlexibleLink) -> LinkHandle:
    """Straight run of ANCF cable elements that starts out as if rigid."""
    motion = link.motion
    axis = rotation(motion.angle)[:, 0]
    nodes = []
    for s in np.linspace(0.0, link.length, link.elements + 1):
        arm = s * axis
        velocity = motion.velocity + motion.rate * np.array([-arm[1], arm[0]])
        slope_rate = motion.rate * np.array([-axis[1], axis[0]])
        nodes.append(
            mbs.AddNode(
                items.NodePoint2DSlope1(
                    referenceCoordinates=[*(motion.position + arm), *axis], initialVelocities=[*velocity, *slope_rate]
                )
            )
        )
    elements = []
    for first, second in pairwise(nodes):
        elements.append(
            mbs.AddObject(
                items.ObjectANCFCable2D(
                    length=link.length / link.elements,
                    massPerLength=link.mass_per_length,
                    bendingStiffness=link.bending_stiffness,
                    axialStiffness=link.axial_stiffness,
                    bendingDamping=link.bending_damping,
                    axialDamping=link.axial_damping,
                    nodeNumbers=[first, second],
                )
            )
        )
    return LinkHandle(link, tuple(map(int, nodes)), tuple(map(int, elements)))


def _add_joint(system: System, ground: Any, connection: Connection) -> None:
    mbs = system.mbs
    ends = (
        _seat(system, ground, connection.parent, connection.parent_point),
        _seat(system, ground, connection.child, connection.child_point),
    )
    if connection.kind == "hinge":
        markers = [mbs.AddMarker(items.MarkerBodyPosition(bodyNumber=n, localPosition=p)) for n, p in ends]
        mbs.AddObject(items.ObjectJointRevolute2D(markerNumbers=markers))
    else:
        # Both bodies must see the weld along the same direction: the joint keeps the angle that they start with.
        angles = (_angle(system, connection.child) - _angle(system, connection.parent), 0.0)
        markers = [_rigid_marker(mbs, *end, angle) for end, angle in zip(ends, angles, strict=True)]
        mbs.AddObject(items.ObjectJointGeneric(markerNumbers=markers, constrainedAxes=[1, 1, 0, 0, 0, 1]))


def _rigid_marker(mbs: Any, body: Any, point: list[float], angle: float) -> Any:
    turn = np.eye(3)
    turn[:2, :2] = rotation(angle)
    return mbs.AddMarker(items.MarkerBodyRigid(bodyNumber=body, localHT=exu.HT(rotation=turn, translation=point)))


def _seat(system: System, ground: Any, name: str | None, point: Vector) -> tuple[Any, list[float]]:
    """Exudyn body and local position of a joint's end."""
    if name is None:
        return ground, [*point, 0.0]
    if name in system.rigid:
        return system.rigid[name].object, [*point, 0.0]
    handle = system.links[name]
    if point[0] > 0.5 * handle.link.length:
        return handle.elements[-1], [handle.link.length / handle.link.elements, 0.0, 0.0]
    return handle.elements[0], [0.0, 0.0, 0.0]


def _angle(system: System, name: str | None) -> float:
    return 0.0 if name is None else system.scene.body(name).motion.angle


def _add_bed(system: System) -> Any:
    """Bed with all parts that can reach its surface, to be attached; None when there are none."""
    scene = system.scene
    if scene.medium is None or scene.surface is None:
        return None
    cylinders = [
        (h, c) for h in system.rigid.values() for c in h.body.cylinders if _reaches(scene, h.body, c.start, c.end)
    ]
    runs = [(handle, _reaching_elements(scene, handle)) for handle in system.links.values()]
    if not cylinders and not any(elements for _, elements in runs):
        return None
    from granular_contact.multibody.bed import GranularBed

    load = scene.load
    bed = GranularBed(
        system.mbs,
        scene.medium,
        scene.surface,
        gravity=scene.gravity,
        static=load.static,
        form="resultant" if load.resultant else "distributed",
        end_cap=load.end_cap,
    )
    for handle, c in cylinders:
        bed.add_rigid(
            handle.object, c.start, c.end, c.diameter, strips=load.strips_per_rigid_part, free_end=c.free
        )  # fmt: skip
    for link, elements in runs:
        if elements:
            bed.add_cables(
                elements, link.link.diameter, strips_per_element=load.strips_per_element, free_end=link.link.free
            )
    return bed


def _reaches(scene: Scene, body: RigidBody | FlexibleLink, *points: Vector) -> bool:
    """Whether one of the points (body frame) can get below the surface, however the joints turn."""
    assert scene.surface is not None
    return any(-REACH_MARGIN * body.tether.reach(point) < scene.surface for point in points)


def _reaching_elements(scene: Scene, handle: LinkHandle) -> tuple[int, ...]:
    """Elements of a link from the first to the last that can reach the surface."""
    places = np.linspace(0.0, handle.link.length, handle.link.elements + 1)
    near = [_reaches(scene, handle.link, np.array([a, 0.0]), np.array([b, 0.0])) for a, b in pairwise(places)]
    if not any(near):
        return ()
    return handle.elements[near.index(True) : len(near) - near[::-1].index(True)]
