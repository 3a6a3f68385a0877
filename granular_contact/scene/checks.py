"""Faults and notes of scenes, in the plane and in space.

Faults: numbers that overflow; closures with a fixed child; shapes without a law at a depth that they can reach; slopes
steeper than the angle of repose of their medium. An endless slope that is steeper is refused, as no bed of that medium
can have it. Steeper pieces of a profile or of a map of heights give a note, as measured ground has edges and noise.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from granular_contact.config import schema
from granular_contact.errors import Fault, scene_fault
from granular_contact.laws.catalogue import laws_for
from granular_contact.laws.gravity import gravity_notes
from granular_contact.laws.kinds import SHAPE_NAMES, Kind
from granular_contact.laws.law import Law, accepted_shapes
from granular_contact.laws.repose import slope_faults, slope_notes
from granular_contact.scene.bed import Bed, media_layers
from granular_contact.scene.layout import GROUND
from granular_contact.scene.types import FASTEST, Scene, link_of
from granular_contact.scene.workspace import can_get_below, immersible

FARTHEST = 1e6  # m: beyond any mechanism in sand; from some 1e8 m on, round-off of positions is as large as depths


def magnitude_faults(scene: Any) -> Iterator[Fault]:
    """Faults of forces that overflow, and of bodies that are too large, start too far away or too fast."""
    if not math.isfinite(scene.force_scale):
        moved = f"{scene.mass:.3g} kg at {scene.speed:.3g} m/s"
        yield scene_fault("initial", f"got {moved} and a gravity of {scene.gravity:.3g} m/s2: forces overflow")
        return
    for body in scene.bodies:
        size = body.length if hasattr(body, "length") else scene.radius(body)
        far = math.hypot(*body.motion.position)
        if not max(size, far) < FARTHEST:
            got = f"reaches {size:.3g} m" if not size < FARTHEST else f"starts at a distance of {far:.3g} m"
            words = f"{got}; allowed is less than {FARTHEST:g} m: is it in another unit than m?"
            yield scene_fault(f"model.bodies.{link_of(body.name.split('+')[0])}", words)
        speed, rate = math.hypot(*body.motion.velocity), math.hypot(*np.atleast_1d(body.motion.rate))
        for value, unit in ((speed, "m/s"), (rate, "rad/s")):
            if not value < FASTEST:
                words = f"{body.name} starts with {value:.3g} {unit}: allowed is less than {FASTEST:g}"
                yield scene_fault("initial", words)


def closure_faults(model: Any, groups: list[list[str]]) -> Iterator[Fault]:
    """Faults of closures whose child is welded to the ground; such a body has to be the parent."""
    fixed = next((group for group in groups if GROUND in group), [])
    for name, closure in model.closures.items():
        if closure.child in fixed:
            words = f"{link_of(closure.child)} is fixed to the ground: make it the parent"
            yield scene_fault(f"model.closures.{name}.child", words)


def bed_slope_faults(scenario: Any) -> Iterator[Fault]:
    """Faults of a slope that is steeper than the angle of repose of a medium, in the plane or in space."""
    if scenario.bed is not None:
        media = [medium for medium, *_ in media_layers(scenario)]
        yield from (scene_fault("bed.slope_deg", words) for words in slope_faults(media, scenario.bed.slope_deg))


def media_notes(scenario: Any, bed: Any, uneven_key: str) -> Iterator[Fault]:
    """Notes on media: on gravity unlike that of their source or upward, and on steep pieces of the surface.

    bed: of the scene, or None; uneven_key: key of the config for a surface of several pieces.
    """
    gravity, media = scenario.gravity_m_s2, list(media_layers(scenario))
    if media and gravity < 0.0:
        words = f"got {gravity:g}, which lifts every body out of the medium: positive gravity is downward"
        yield scene_fault("gravity_m_s2", words)
    for medium, key, *_ in media:
        yield from (scene_fault(key, words) for words in gravity_notes(medium, gravity))
    if bed is not None:
        yield from (scene_fault(uneven_key, words) for words in slope_notes(bed.media, bed.pieces()))


def law_faults(scene: Scene, scenario: schema.Scenario) -> Iterator[Fault]:
    """Faults of shapes that can reach a depth without a law for them, media without a shape, balls in layers."""
    if scene.bed is None or not scene.media:
        return
    layers, keys = scene.bed.layers, [key for _, key, _, _ in media_layers(scenario)]
    parts = _parts_below(scene, scene.bed, 0.0)
    if not all(layer.whole for layer in layers) and any(kind == "ball" for _, kind in parts):
        yield scene_fault("bed.layers", "a sphere is met as a whole: no layers are allowed with one")
        return
    for top in sorted({layer.top for layer in layers}):
        media = {keys[i]: layer.medium for i, layer in enumerate(layers) if layer.top == top}
        yield from _law_faults_at(top, media, _parts_below(scene, scene.bed, top))


def _law_faults_at(top: float, media: dict[str, Law], parts: list[tuple[str, Kind]]) -> Iterator[Fault]:
    """Faults of the media (by their keys) of the layer below a depth (m) and of the parts that can get there."""
    taken = {kind for medium in media.values() for kind in medium.takes}
    given = "; ".join(dict.fromkeys(map(accepted_shapes, media.values())))
    without_law = [(part, kind) for part, kind in parts if kind not in taken]
    for part, kind in without_law:
        key, reached = f"model.bodies.{part}", "can get into the sand"
        if top > 0.0:
            key, reached = next(iter(media)), f"{part} can get that deep"
        yield scene_fault(key, f"{reached}, but {given}; {_laws(kind)}; in_sand: false leaves a shape out")
    if without_law or not parts:
        return
    kinds = dict.fromkeys(kind for _, kind in parts)
    for key, medium in media.items():
        if not kinds.keys() & set(medium.takes):
            laws = "; ".join(map(_laws, kinds))
            yield scene_fault(key, f"{accepted_shapes(medium)}, and nothing of the kind can get into it; {laws}")


def _laws(kind: Kind) -> str:
    """Sentence on the laws for a kind of shape."""
    return f"laws for {SHAPE_NAMES[kind]} are {', '.join(laws_for(kind))}"


def _parts_below(scene: Scene, bed: Bed, depth: float) -> list[tuple[str, Kind]]:
    """Parts that can get below a depth (m), each once, with their kind for the law."""
    ends = [(link, np.array([[0.0, 0.0], [link.length, 0.0]])) for link in scene.links]
    parts = [(link.name, link.kind) for link, both in ends if can_get_below(bed, link, both, depth=depth)]
    parts += [(shape.part, shape.kind) for _, shape in immersible(bed, scene.rigid, depth)]
    return list(dict.fromkeys(parts))
