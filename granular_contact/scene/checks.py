"""What no scene may be, in the plane or in space: numbers that overflow, loops closed at a body that can't move; shapes
without a law at a depth that they can reach; media on slopes that they do not keep.

A slope without end that is steeper than the angle of repose is refused: no bed of that medium stands so. Corners of a
profile and of a map of heights are told in a note, as measured ground has edges and noise that a pile has not.
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
from granular_contact.scene.bed import Bed, places
from granular_contact.scene.layout import GROUND
from granular_contact.scene.types import FASTEST, Scene, link_of
from granular_contact.scene.workspace import can_get_below, immersible

FARTHEST = 1e6  # m: no mechanism in sand, and from some 1e8 on round-off of positions is as large as depths


def beyond_numbers(scene: Any) -> Iterator[Fault]:
    """Faults of forces that overflow, and of bodies that are too large, start too far away or too fast."""
    if not math.isfinite(scene.force_scale):
        moved = f"{scene.mass:.3g} kg at {scene.speed:.3g} m/s"
        yield scene_fault("initial", f"got {moved} and a gravity of {scene.gravity:.3g} m/s2: forces overflow")
        return
    for body in scene.bodies:
        size = body.length if hasattr(body, "length") else scene.radius(body)
        far = math.hypot(*body.motion.position)
        if not max(size, far) < FARTHEST:
            what = f"reaches {size:.3g} m" if not size < FARTHEST else f"starts at a distance of {far:.3g} m"
            words = f"{what}; allowed is less than {FARTHEST:g} m: is it in another unit than m?"
            yield scene_fault(f"model.bodies.{link_of(body.name.split('+')[0])}", words)
        speed, rate = math.hypot(*body.motion.velocity), math.hypot(*np.atleast_1d(body.motion.rate))
        for got, unit in ((speed, "m/s"), (rate, "rad/s")):
            if not got < FASTEST:
                words = f"{body.name} starts with {got:.3g} {unit}: allowed is less than {FASTEST:g}"
                yield scene_fault("initial", words)


def closure_faults(model: Any, groups: list[list[str]]) -> Iterator[Fault]:
    """Faults of closures whose child is welded to the ground: it has to be the parent."""
    fixed = next((group for group in groups if GROUND in group), [])
    for name, closure in model.closures.items():
        if closure.child in fixed:
            words = f"{link_of(closure.child)} is fixed to the ground: make it the parent"
            yield scene_fault(f"model.closures.{name}.child", words)


def too_steep(scenario: Any) -> Iterator[Fault]:
    """Faults of a slope, in the plane or in space."""
    if scenario.bed is not None:
        media = [medium for medium, *_ in places(scenario)]
        yield from (scene_fault("bed.slope_deg", words) for words in slope_faults(media, scenario.bed.slope_deg))


def media_notes(scenario: Any, placed: Any, uneven: str) -> Iterator[Fault]:
    """What is assumed of the media of a scenario; placed: its bed, or None; uneven: key of a surface of pieces."""
    for medium, key, *_ in places(scenario):
        yield from (scene_fault(key, words) for words in gravity_notes(medium, scenario.gravity_m_s2))
    if placed is not None:
        yield from (scene_fault(uneven, words) for words in slope_notes(placed.media, placed.pieces()))


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
    given = "; ".join(dict.fromkeys(map(accepted_shapes, media.values())))
    spared = [(part, kind) for part, kind in parts if kind not in taken]
    for part, kind in spared:
        key, what = f"model.bodies.{part}", "can get into the sand"
        if top > 0.0:
            key, what = next(iter(media)), f"{part} can get that deep"
        yield scene_fault(key, f"{what}, but {given}; {_fitting(kind)}; in_sand: false leaves a shape out")
    if spared or not parts:
        return
    kinds = dict.fromkeys(kind for _, kind in parts)
    for key, medium in media.items():
        if not kinds.keys() & set(medium.takes):
            fit = "; ".join(map(_fitting, kinds))
            yield scene_fault(key, f"{accepted_shapes(medium)}, and nothing of the kind can get into it; {fit}")


def _fitting(kind: Kind) -> str:
    return f"laws for {SHAPE_NAMES[kind]} are {', '.join(laws_for(kind))}"


def _getting_to(scene: Scene, bed: Bed, depth: float) -> list[tuple[str, Kind]]:
    """Parts that can get below a depth (m), each once, with the kind of shape that a medium meets."""
    ends = [(link, np.array([[0.0, 0.0], [link.length, 0.0]])) for link in scene.links]
    parts = [(link.name, link.kind) for link, both in ends if can_get_below(bed, link, both, depth=depth)]
    parts += [(shape.part, shape.kind) for _, shape in immersible(bed, scene.rigid, depth)]
    return list(dict.fromkeys(parts))
