"""Which mechanisms minimal coordinates support."""

from __future__ import annotations

from collections.abc import Iterator

from granular_contact.config.schema.joints import PLURAL, SINGULAR
from granular_contact.errors import scene_error
from granular_contact.scene.types import Minimal, Scene

SUPPORTED = "minimal coordinates are for trees of rigid bodies that hinges and sliders join, on the ground or free"


def check_minimal(scene: Scene) -> None:
    """Refuse a scene that minimal coordinates do not support.

    Raises
    ------
    SceneError
        With the key `method`, all obstacles, and what is supported.
    """
    obstacles = list(_obstacles(scene))
    if obstacles:
        raise scene_error("method", f"{', and '.join(obstacles)}: {SUPPORTED}")


def serves(scene: Scene) -> bool:
    """Whether minimal coordinates support a scene in the plane."""
    return next(_obstacles(scene), None) is None


def reason(scene: Scene) -> str:
    """Why `method: auto` has a scene solved as it is."""
    if isinstance(scene.method, Minimal):
        return "in minimal coordinates, the faster way for a tree of rigid bodies in the plane"
    if scene.in_space:
        return "by the engine: it is in space"
    return f"by the engine: {' and '.join(_obstacles(scene))}; {SUPPORTED}"


def _obstacles(scene: Scene) -> Iterator[str]:
    if scene.links:
        yield f"{scene.links[0].name} is flexible"
    if scene.settle:
        yield "initial.settle is true"
    others: dict[tuple[str, str], list[str]] = {}
    for joint in scene.joints:
        if joint.closes or joint.kind == "weld":
            words = f"is {SINGULAR[joint.kind]}", f"are {PLURAL[joint.kind]}"
            others.setdefault(("closes a loop", "close loops") if joint.closes else words, []).append(joint.name)
    for (one, many), names in others.items():
        yield f"{named(names)} {one if len(names) == 1 else many}"


def named(names: list[str]) -> str:
    """At most three names, and how many more there are."""
    shown = ", ".join(names[:3])
    return f"{shown} and {len(names) - 3} more" if len(names) > 3 else shown
