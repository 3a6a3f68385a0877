"""Whether every shape has a law at every depth it can reach, and every medium a shape that it can act on."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from granular_contact.config import schema
from granular_contact.errors import Fault, scene_fault
from granular_contact.laws.catalogue import laws_for
from granular_contact.laws.kinds import WORDS, Kind
from granular_contact.laws.law import Law, what_it_takes
from granular_contact.scene.bed import Bed, places
from granular_contact.scene.types import Scene
from granular_contact.scene.workspace import can_get_below, immersible


def inapplicable(scene: Scene, scenario: schema.Scenario) -> Iterator[Fault]:
    """Shapes that can reach a depth without a law for them, media without a shape to act on, balls in layers."""
    if scene.bed is None or not scene.media:
        return
    layers, keys = scene.bed.layers, [key for _, key, _, _ in places(scenario)]
    parts = _getting_to(scene, scene.bed, 0.0)
    if not all(layer.whole for layer in layers) and any(kind == "ball" for _, kind in parts):
        yield scene_fault("bed.layers", "a sphere is met as a whole: no layers are allowed with one")
        return
    for top in sorted({layer.top for layer in layers}):
        here = {keys[i]: layer.medium for i, layer in enumerate(layers) if layer.top == top}
        yield from _inapplicable_at(top, here, _getting_to(scene, scene.bed, top))


def _inapplicable_at(top: float, media: dict[str, Law], parts: list[tuple[str, Kind]]) -> Iterator[Fault]:
    """Mismatches below a depth (m), between the media there, by their keys, and the parts that can get there."""
    taken = {kind for medium in media.values() for kind in medium.takes}
    given = "; ".join(dict.fromkeys(map(what_it_takes, media.values())))
    spared = [(part, kind) for part, kind in parts if kind not in taken]
    for part, kind in spared:
        key, what = f"model.bodies.{part}", "can get into the sand"
        if top > 0.0:
            key, what = next(iter(media)), f"{part} can get that deep"
        yield scene_fault(key, f"{what}, but {given}; {_fitting(kind)}; or say in_sand: false of the shape")
    if spared or not parts:
        return
    kinds = dict.fromkeys(kind for _, kind in parts)
    for key, medium in media.items():
        if not kinds.keys() & set(medium.takes):
            fit = "; ".join(map(_fitting, kinds))
            yield scene_fault(key, f"{what_it_takes(medium)}, and nothing of the kind can get into it; {fit}")


def _fitting(kind: Kind) -> str:
    return f"laws for {WORDS[kind]} are {', '.join(laws_for(kind))}"


def _getting_to(scene: Scene, bed: Bed, depth: float) -> list[tuple[str, Kind]]:
    """Parts that can get below a depth (m), each once, with the kind of shape that a medium meets."""
    ends = [(link, np.array([[0.0, 0.0], [link.length, 0.0]])) for link in scene.links]
    parts = [(link.name, link.kind) for link, both in ends if can_get_below(bed, link, both, depth=depth)]
    parts += [(shape.part, shape.kind) for _, shape in immersible(bed, scene.rigid, depth)]
    return list(dict.fromkeys(parts))
