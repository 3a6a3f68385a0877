"""Check which scenes minimal coordinates and the modal model support."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from granular_contact.config.schema.joints import joint_of, joints_of
from granular_contact.errors import scene_error
from granular_contact.scene.layout import FREEDOMS
from granular_contact.scene.parts import FlexibleLink, RigidBody
from granular_contact.scene.types import Joint, Minimal, Reduced, Scene


def check(scene: Scene) -> None:
    """Refuse a scene that its method does not support.

    Raises
    ------
    SceneError
        As `check_minimal` and `check_reduced`.
    """
    if isinstance(scene.method, Minimal):
        check_minimal(scene)
    elif isinstance(scene.method, Reduced):
        check_reduced(scene, scene.method.modes)


def check_minimal(scene: Scene) -> None:
    """Refuse a scene that minimal coordinates do not support.

    Raises
    ------
    SceneError
        With the key `method`, all obstacles, and what is supported.
    """
    obstacles = list(_obstacles(scene))
    if obstacles:
        raise scene_error("method", f"{', and '.join(obstacles)}: {_supported_in_minimal(scene)}")


def fits_minimal(scene: Scene) -> bool:
    """Whether minimal coordinates support a scene."""
    return next(_obstacles(scene), None) is None


def reason(scene: Scene) -> str:
    """Sentence on why `method: auto` chose the method of a scene."""
    if isinstance(scene.method, Minimal):
        return "in minimal coordinates, the faster way for a tree of rigid bodies"
    return f"by the engine: {' and '.join(_obstacles(scene))}; {_supported_in_minimal(scene)}"


def _supported_in_minimal(scene: Scene) -> str:
    """Sentence on the mechanisms that minimal coordinates support, in the plane or in space."""
    freedoms, where, bodies = FREEDOMS, "", "rigid bodies"
    if scene.in_space:
        from granular_contact.scene.space import layout

        freedoms, where, bodies = layout.FREEDOMS, " in space", "bodies and links"
    joints = joints_of(kind for kind, free in freedoms.items() if any(free) and kind != "free")
    return f"minimal coordinates{where} are for trees of {bodies} that {joints} join, on the ground or free"


def _obstacles(scene: Scene) -> Iterator[str]:
    """Properties of a scene that minimal coordinates do not support, in words."""
    if scene.links:
        yield f"{scene.links[0].name} is flexible"
    joints: dict[tuple[str, str], list[str]] = {}  # names of joints by their predicate in singular and plural
    for joint in scene.joints:
        if joint.closes or joint.kind == "weld":
            words = f"is a {joint_of(joint.kind)}", f"are {joint_of(joint.kind)}s"
            joints.setdefault(("closes a loop", "close loops") if joint.closes else words, []).append(joint.name)
    for (singular, plural), names in joints.items():
        yield f"{listed(names)} {singular if len(names) == 1 else plural}"


def listed(names: list[str]) -> str:
    """At most three names, and the number of the others."""
    shown = ", ".join(names[:3])
    return f"{shown} and {len(names) - 3} more" if len(names) > 3 else shown


IN_MODAL = (
    "the reduced model is for one hinge on the ground, a rigid body on it (any welded parts), and at most one flexible "
    "link, welded to that body by its root, in one medium with a level surface"
)


def check_reduced(scene: Scene, modes: int) -> None:
    """Refuse a scene that the reduced model with so many modes does not support.

    Raises
    ------
    SceneError
        With the key `method`, all obstacles, and what is supported.
    """
    obstacles = [
        *_body_obstacles(scene),
        *_joint_obstacles(scene),
        *_joint_load_obstacles(scene),
        *medium_obstacles(scene),
    ]
    if not obstacles and modes > 0 and not scene.links:
        raise scene_error("method.reduced.modes", f"got {modes}, but the model has no flexible link: allowed is 0")
    if obstacles:
        raise scene_error("method", f"{', and '.join(obstacles)}: {IN_MODAL}")


def _joint_load_obstacles(scene: Scene) -> Iterator[str]:
    """Drives, settling, springs, dampers, stops and friction of joints, in words."""
    if scene.drives:
        yield f"{scene.drives[0].joint} is driven"
    if scene.settle:
        yield "initial.settle is true"
    names = [joint.name for joint in scene.joints if not joint.law.is_idle]
    if names:
        yield f"{listed(names)} {'has' if len(names) == 1 else 'have'} a spring, damper, stops or friction"


def medium_obstacles(scene: Scene) -> Iterator[str]:
    """Properties of a scene's bed and media that the reduced model does not support, in words."""
    if scene.bed is None:
        return
    if not scene.bed.plain:
        yield "its bed is not level, or has several media or a stiff floor"
    true_sign = isinstance(scene.method, Reduced) and scene.method.static == "true_sign"
    for medium in scene.media:
        if medium.needs_path_length:
            yield f"{medium.name} scatters, or its shear grows with the path, which the engine alone records"
        if true_sign and not medium.by_component:
            yield f"the law of {medium.name} has no sign of each component of the velocity for static: true_sign"


def _body_obstacles(scene: Scene) -> Iterator[str]:
    """Numbers of bodies and links that the reduced model does not support, in words."""
    if len(scene.rigid) != 1:
        yield f"the model has {len(scene.rigid) or 'no'} rigid bod{'y' if not scene.rigid else 'ies'}"
    if len(scene.links) > 1:
        yield f"it has {len(scene.links)} flexible links"


def _joint_obstacles(scene: Scene) -> Iterator[str]:
    """Joints that the reduced model does not support, in words."""
    hinges = [joint for joint in scene.joints if joint.kind == "hinge"]
    if len(hinges) != 1:
        yield f"it has {len(hinges) or 'no'} hinges"
    for joint in scene.joints:
        child, is_supported = _child_in_reduced(scene, joint)
        if not is_supported:
            where = "the ground" if joint.parent is None else joint.parent
            yield f"{joint.name} is a {joint_of(joint.kind)} between {where} and {child}"


def _child_in_reduced(scene: Scene, joint: Joint) -> tuple[str, bool]:
    """The child of a joint, in words, and whether the reduced model supports the joint."""
    child = scene.body(joint.child)
    if isinstance(child, RigidBody):
        return f"the rigid {child.name}", joint.kind == "hinge" and joint.parent is None
    by_root = not np.any(joint.child_point)
    end = f"the {'root' if by_root else 'tip'} of the flexible {child.name}"
    on_rigid = joint.parent is not None and not isinstance(scene.body(joint.parent), FlexibleLink)
    return end, joint.kind == "weld" and on_rigid and by_root
