"""Which mechanisms can be solved in minimal coordinates, told without solving one."""

from __future__ import annotations

from collections.abc import Iterator

from granular_contact.errors import scene_error
from granular_contact.scene.types import Scene

CAN = (
    "minimal coordinates are for trees of rigid bodies that hang on the ground by hinges alone, in one medium, "
    "without drives, springs, dampers, stops or friction in them"
)


def check_treelike(scene: Scene) -> None:
    """Refuse a scene that minimal coordinates are not for.

    Raises
    ------
    SceneError
        With the key `method`, all that stands in the way, and what is possible.
    """
    obstacles = [*_mechanism(scene), *_extras(scene), *_bed(scene)]
    if obstacles:
        raise scene_error("method", f"{', and '.join(obstacles)}: {CAN}")


def _mechanism(scene: Scene) -> Iterator[str]:
    if scene.links:
        yield f"{scene.links[0].name} is flexible"
    for joint in scene.connections:
        if joint.closes:
            yield f"{joint.name} closes a loop"
        elif joint.kind != "hinge":
            yield f"{joint.name} is a {joint.kind}"


def _extras(scene: Scene) -> Iterator[str]:
    if scene.drives:
        yield f"{scene.drives[0].joint} is driven"
    if scene.settle:
        yield "initial.settle is true"
    for joint in scene.connections:
        if not joint.law.is_idle:
            yield f"{joint.name} has a spring, damper, stops or friction"


def _bed(scene: Scene) -> Iterator[str]:
    if scene.bed is None:
        return
    if len(scene.bed.layers) > 1:
        yield f"its bed has {len(scene.bed.layers)} media"
    if scene.bed.floor is not None and scene.bed.floor.stiffness is not None:
        yield "its bed has a floor that carries"
