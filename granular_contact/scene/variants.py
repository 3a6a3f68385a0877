"""Scenes that differ from another scene only in the medium and in the impact of a pendulum.

Masses, shapes and joints follow from the model alone, so that many runs of one model can share them.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from granular_contact.config import schema
from granular_contact.config.differences import same_but
from granular_contact.errors import SceneError
from granular_contact.scene.bed import bed_of
from granular_contact.scene.build import End, build_checked, ends_of, verify
from granular_contact.scene.checks import bed_slope_faults, magnitude_faults, media_notes
from granular_contact.scene.methods import medium_obstacles
from granular_contact.scene.parts import InitialMotion, rotation
from granular_contact.scene.types import Joint, Reduced, Scene, Vector

_IMPACT = ("impact_angle_deg", "impact_speed_rad_s")


class Builder:
    """Builder of scenes that derives those of the reduced model from one base scene, where their models are the same.

    Scenes and faults are those of `scene.build` up to round-off. Scenes of other methods are built completely.
    Scenarios must come straight from configs.

    Parameters
    ----------
    base : Scenario, optional
        Scenario of the base scene; the first one that is built unless given.
    """

    def __init__(self, base: schema.Scenario | None = None) -> None:
        self._base = base
        self._set_base_scene(None if base is None else _scene_or_none(base))

    def _set_base_scene(self, scene: Scene | None) -> None:
        """Keep a scene of the reduced model as the base scene; a scene of another method can't be one."""
        self._scene = scene if scene is not None and isinstance(scene.method, Reduced) else None
        self._ends: Sequence[End] = () if self._scene is None else ends_of(self._scene.rigid, self._scene.links)

    def __call__(self, scenario: schema.Scenario) -> Scene:
        """Build the scene of a scenario; raises SceneError as `scene.build`."""
        derived = None if self._scene is None else variant(self._scene, self._ends, scenario)
        scene = build_checked(scenario) if derived is None else derived
        if self._scene is None and self._base is None:
            self._set_base_scene(scene)
        return scene

    def __getstate__(self) -> dict[str, Any]:  # another process takes a new base scene
        return {"_base": None, "_scene": None, "_ends": ()}


def _scene_or_none(scenario: schema.Scenario) -> Scene | None:
    """Scene of a base scenario; None if it has faults; these are not reported, as only other scenarios are run."""
    try:
        return build_checked(scenario)
    except SceneError:
        return None


def variant(base: Scene, ends: Sequence[End], scenario: schema.Scenario) -> Scene | None:
    """Derive the scene of a scenario from a base scene; None if more than the medium and the impact differ.

    ends: ends and corners of the base scene that a medium may act on.

    Raises
    ------
    SceneError
        As `scene.build`.
    """
    if base.scenario is None or not isinstance(base.method, Reduced) or not _is_variant(base.scenario, scenario):
        return None
    faults = list(bed_slope_faults(scenario))
    turn = _Turn.of(base, scenario.initial)
    bed = bed_of(scenario, [turn.point(end.world) - (0.0, end.drop) for end in ends], faults)
    if faults:
        raise SceneError(faults)
    scene = replace(
        base,
        rigid=tuple(replace(body, motion=turn.motion(body.motion)) for body in base.rigid),
        links=tuple(replace(link, motion=turn.motion(link.motion)) for link in base.links),
        joints=tuple(turn.joint(joint) if joint is base.pivot else joint for joint in base.joints),
        bed=bed,
        notes=tuple(media_notes(scenario, bed, "bed.profile_m")),
    )
    vars(scene).update(mass=base.mass, length=base.length, least_path=base.least_path)  # cached, and unchanged
    _verify(scene, scenario)
    vars(scene).update(scenario=scenario, variant_of=base)
    return scene


def _is_variant(base: schema.Scenario, scenario: schema.Scenario) -> bool:
    """Whether two scenarios differ only in the medium and in the angle and the speed of the impact."""
    first, second = base.initial, scenario.initial
    if not same_but(base, scenario, "medium", "initial") or not same_but(first, second, *_IMPACT):
        return False
    # With a law that has no sign by component, `method.reduced.static: auto` may choose another friction.
    by_component = all(medium.by_component for medium in (*base.media, *scenario.media))
    at_an_angle = None not in (first.impact_angle_deg, second.impact_angle_deg)
    turns = at_an_angle and first.joints is None and first.impact_tip_speed_m_s is None
    return turns and by_component and bool(base.media) == bool(scenario.media)


def _verify(scene: Scene, scenario: schema.Scenario) -> None:
    """`verify` for a variant; checks that the base scene passed are left out if the media take all its shapes."""
    kinds = {link.kind for link in scene.links}
    kinds |= {shape.kind for body in scene.rigid for shape in body.shapes if shape.in_sand}
    if any(medium_obstacles(scene)) or not all(kinds <= set(medium.takes) for medium in scene.media):
        verify(scene, scenario)
    elif faults := list(magnitude_faults(scene)):
        raise SceneError(faults)


@dataclass(frozen=True)
class _Turn:
    """Rotation of a pendulum about its pivot from the base scene to another impact angle.

    pin: position (2,) m of the pivot. start, rate: coordinate and rate of its joint at the impact (rad, rad/s,
    clockwise). angle: of the rotation (rad, counter-clockwise), with its matrix (2, 2).
    """

    pin: Vector
    start: float
    rate: float
    angle: float
    matrix: Vector

    @staticmethod
    def of(base: Scene, initial: schema.Initial) -> _Turn:
        pivot, impact_angle = base.pivot, initial.impact_angle_deg
        assert pivot is not None
        assert impact_angle is not None
        start = math.radians(impact_angle)
        angle = pivot.start - start
        return _Turn(pivot.parent_point, start, initial.impact_speed_rad_s, angle, rotation(angle))

    def point(self, world: Vector) -> Vector:
        """Rotated world position (2,) m."""
        rotated: Vector = self.pin + self.matrix @ (world - self.pin)
        return rotated

    def motion(self, base: InitialMotion) -> InitialMotion:
        """Rotated initial motion of a body, with the rate of the impact."""
        arm: Vector = self.matrix @ (base.position - self.pin)
        return InitialMotion(
            self.pin + arm, base.angle + self.angle, self.rate * np.array([arm[1], -arm[0]]), -self.rate
        )

    def joint(self, pivot: Joint) -> Joint:
        """The pivot with coordinate and rate of the impact."""
        return replace(pivot, start=self.start, rate=self.rate)
