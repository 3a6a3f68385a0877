"""Scene -> System: the mechanism in Exudyn, with the granular bed laid over what can reach the surface."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from typing import Any

import exudyn as exu
import numpy as np
from exudyn import itemInterface as items

from granular_contact.multibody.joints import add_joint
from granular_contact.multibody.settle import add_dampers
from granular_contact.multibody.system import LinkHandle, RigidHandle, System
from granular_contact.scene.types import FlexibleLink, RigidBody, Scene, Vector, rotation

# A stretched beam may be a little longer than its reference; what is this close to reaching the surface gets the load.
REACH_MARGIN = 1.02


def build(scene: Scene) -> System:
    """Set the scene up in Exudyn and assemble it, once."""
    container = exu.SystemContainer()
    mbs = container.AddSystem()
    ground = mbs.AddObject(items.ObjectGround())
    system = System(
        scene=scene,
        container=container,
        mbs=mbs,
        rigid={body.name: _add_rigid(mbs, body, scene.gravity) for body in scene.rigid},
        links={link.name: _add_link(mbs, link, scene.gravity) for link in scene.links},
        bed=None,
    )
    for joint in scene.connections:
        add_joint(system, ground, joint)
    if scene.settle:
        add_dampers(system)
    system = replace(system, bed=_add_bed(system))
    mbs.Assemble()
    for load in system.loads.values():
        load.start(mbs)
    return system


def _add_rigid(mbs: Any, body: RigidBody, gravity: float) -> RigidHandle:
    motion = body.motion
    node = mbs.AddNode(
        items.NodeRigidBody2D(
            referenceCoordinates=[*motion.position, motion.angle],
            initialVelocities=[*motion.velocity, motion.rate],
        )
    )
    obj = mbs.AddObject(items.ObjectRigidBody2D(mass=body.mass, inertia=body.inertia, nodeNumber=node, name=body.name))
    _add_weight(mbs, obj, gravity)
    return RigidHandle(body, node, obj)


def _add_link(mbs: Any, link: FlexibleLink, gravity: float) -> LinkHandle:
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
        _add_weight(mbs, elements[-1], gravity)
    return LinkHandle(link, tuple(map(int, nodes)), tuple(map(int, elements)))


def _add_weight(mbs: Any, obj: Any, gravity: float) -> None:
    if gravity != 0.0:
        marker = mbs.AddMarker(items.MarkerBodyMass(bodyNumber=obj))
        mbs.AddLoad(items.LoadMassProportional(markerNumber=marker, loadVector=[0.0, -gravity, 0.0]))


def _add_bed(system: System) -> Any:
    """Lay the medium over the parts that can reach its surface; None when there are none."""
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
                elements,
                link.link.diameter,
                strips_per_element=load.strips_per_element,
                free_end=link.link.free,
                name=link.link.name,
            )
    bed.attach()
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
