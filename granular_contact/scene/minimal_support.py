"""Which mechanisms minimal coordinates support."""

from __future__ import annotations

from collections.abc import Iterator

from granular_contact.config.schema.joints import PLURAL, SINGULAR
from granular_contact.errors import scene_error
from granular_contact.scene.types import Scene

SUPPORTED = (
    "minimal coordinates are for trees of rigid bodies that hang on the ground by hinges alone, in one medium, "
    "without drives, springs, dampers, stops or friction in them"
)


def check_minimal(scene: Scene) -> None:
    """Refuse a scene that minimal coordinates do not support.

    Raises
    ------
    SceneError
        With the key `method`, all obstacles, and what is supported.
    """
    obstacles = [*_mechanism(scene), *acting_on_joints(scene), *_bed(scene)]
    if obstacles:
        raise scene_error("method", f"{', and '.join(obstacles)}: {SUPPORTED}")


def _mechanism(scene: Scene) -> Iterator[str]:
    if scene.links:
        yield f"{scene.links[0].name} is flexible"
    others: dict[tuple[str, str], list[str]] = {}
    for joint in scene.joints:
        if joint.closes or joint.kind != "hinge":
            words = f"is {SINGULAR[joint.kind]}", f"are {PLURAL[joint.kind]}"
            others.setdefault(("closes a loop", "close loops") if joint.closes else words, []).append(joint.name)
    for (one, many), names in others.items():
        yield f"{_named(names)} {one if len(names) == 1 else many}"


def acting_on_joints(scene: Scene) -> Iterator[str]:
    """Drives, settling, springs, dampers, stops and friction of joints, which no method but the engine has."""
    if scene.drives:
        yield f"{scene.drives[0].joint} is driven"
    if scene.settle:
        yield "initial.settle is true"
    names = [joint.name for joint in scene.joints if not joint.law.is_idle]
    if names:
        yield f"{_named(names)} {'has' if len(names) == 1 else 'have'} a spring, damper, stops or friction"


def _named(names: list[str]) -> str:
    """At most three names, and how many more there are."""
    shown = ", ".join(names[:3])
    return f"{shown} and {len(names) - 3} more" if len(names) > 3 else shown


def _bed(scene: Scene) -> Iterator[str]:
    if scene.bed is None:
        return
    if len(scene.bed.layers) > 1:
        yield f"its bed has {len(scene.bed.layers)} media"
    if scene.bed.floor is not None and scene.bed.floor.stiffness is not None:
        yield "its bed has a stiff floor"
