"""Scene -> System: the mechanism in Exudyn, with the granular load on all shapes that can reach the surface."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from itertools import pairwise
from typing import TYPE_CHECKING, Any, TypeVar

import exudyn as exu
import numpy as np
from exudyn import itemInterface as items

from granular_contact.engines.exudyn.joint_actions import JointActions
from granular_contact.engines.exudyn.joints import add_joint
from granular_contact.engines.exudyn.overlay import Overlay
from granular_contact.engines.exudyn.views import EngineCoordinates
from granular_contact.mechanics.mass_and_gravity import gravity_loads
from granular_contact.mechanics.system import LinkHandle, RigidHandle, System
from granular_contact.scene.parts import FlexibleLink, RigidBody, rotation
from granular_contact.scene.types import Scene, Vector
from granular_contact.scene.workspace import immersible, immersible_elements

if TYPE_CHECKING:
    from granular_contact.engines.exudyn.coupling import Coupling

AnySystem = TypeVar("AnySystem", bound=System)


def build(scene: Scene) -> System:
    """Build the mechanism of a scene in the plane in a new Exudyn system, and assemble it."""
    if scene.wheel_test is not None:
        from granular_contact.sand.rolling import at_steady_sinkage

        scene = at_steady_sinkage(scene)
    container = exu.SystemContainer()
    mbs = container.AddSystem()
    ground = mbs.AddObject(items.ObjectGround())
    origin = np.round(scene.bodies[0].motion.position)
    system = System(
        scene=scene,
        coordinates=EngineCoordinates(mbs),
        container=container,
        mbs=mbs,
        rigid={body.name: _add_rigid(mbs, body, origin) for body in scene.rigid},
        links={link.name: _add_link(mbs, link, origin) for link in scene.links},
        bed=None,
        origin=origin,
    )
    for joint in scene.joints:
        add_joint(system, ground, joint)
    return assembled(replace(system, bed=_granular_load(system)))


def assembled(system: AnySystem) -> AnySystem:
    """Add weights, bed and actions of joints to a system, through one overlay, and assemble it for a solve."""
    system = _attach(system)
    system.mbs.Assemble()
    if system.joints is not None:
        system.joints.start()
    return system


def _attach(system: AnySystem) -> AnySystem:
    """Attach bed, joints and weights to the system."""
    mbs, bed, weights = system.mbs, system.bed, gravity_loads(system)
    overlay = Overlay(mbs) if bed is None else bed.overlay
    has_actions = system.loads or system.turning
    joints = JointActions(overlay, list(system.loads.values()), system.turning) if has_actions else None
    if bed is not None:
        bed.attach(weights, joints)
    elif joints is not None:
        overlay.coordinates(*_any_node(system))  # the engine calls the trigger only if the overlay has a node
        joints.attach(weights)
    elif weights:
        overlay.attach(weights)
    return replace(system, joints=joints)


def _any_node(system: AnySystem) -> tuple[list[int], int]:
    """Any node of the system, in a list, and its number of coordinates."""
    for rigid in system.rigid.values():
        return [rigid.node], len(rigid.body.levers(0.0))
    return [next(iter(system.links.values())).nodes[0]], 4


def _add_rigid(mbs: Any, body: RigidBody, origin: Vector) -> RigidHandle[RigidBody]:
    """Add a rigid body; origin (2,) m: origin of the engine's coordinates in the world frame."""
    motion = body.motion
    node = mbs.AddNode(
        items.NodeRigidBody2D(
            referenceCoordinates=[*(motion.position - origin), motion.angle],
            initialVelocities=[*motion.velocity, motion.rate],
        )
    )
    obj = mbs.AddObject(items.ObjectRigidBody2D(mass=body.mass, inertia=body.inertia, nodeNumber=node, name=body.name))
    return RigidHandle(body, node, obj)


def _add_link(mbs: Any, link: FlexibleLink, origin: Vector) -> LinkHandle:
    """Add a flexible link: a straight row of ANCF cable elements, with the initial velocities of a rigid body."""
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
                    referenceCoordinates=[*(motion.position - origin + arm), *axis],
                    initialVelocities=[*velocity, *slope_rate],
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


def _granular_load(system: System) -> Coupling | None:
    """Load on all parts that can reach the surface of the bed, not yet attached; None if no part can."""
    scene = system.scene
    if scene.bed is None or not scene.media:
        return None
    shapes = immersible(scene.bed, scene.rigid)
    cables = [(handle, immersible_elements(scene.bed, handle.link)) for handle in system.links.values()]
    if not shapes and not any(reaching for _, reaching in cables):
        return None
    from granular_contact.engines.exudyn.coupling import Coupling
    from granular_contact.sand.from_scene import lines_from_shape, load_from_scene, section_size
    from granular_contact.sand.rolling import take_rolled_state

    coupling = Coupling(system.mbs, load_from_scene(scene), system.origin)
    coupling.roll_in = partial(take_rolled_state, scene)
    load, strips = coupling.load, scene.load
    for body, shape in shapes:
        load.add(lines_from_shape(coupling.body(system.rigid[body.name].object), shape, strips.strips_per_rigid_part))
    for handle, reaching in cables:
        if reaching:
            link, each = handle.link, strips.strips_per_element
            elements = handle.elements[reaching.start : reaching.stop]
            coupling.cables(elements, link.name, each, link.free, in_space=False, **section_size(link))
    return coupling
