"""What no scene may be, in the plane or in space: numbers that overflow, loops closed at a body that can't move."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from granular_contact.errors import Fault, scene_fault
from granular_contact.scene.layout import GROUND
from granular_contact.scene.types import FASTEST

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
            yield scene_fault(f"model.bodies.{body.name.split('+')[0]}", words)
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
            words = f"{closure.child} is fixed to the ground: make it the parent"
            yield scene_fault(f"model.closures.{name}.child", words)
