"""Scene of a scenario that differs from another one's in its medium and in how a pendulum strikes, and in nothing else.

Masses, shapes and joints follow from the model. Many runs of one model need them once.
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
from granular_contact.scene.bed import bed
from granular_contact.scene.build import End, ends_of, verified
from granular_contact.scene.build import built as built_anew
from granular_contact.scene.checks import beyond_numbers, media_notes, too_steep
from granular_contact.scene.methods import medium_obstacles
from granular_contact.scene.parts import InitialMotion, rotation
from granular_contact.scene.types import Joint, Reduced, Scene, Vector

_STRIKE = ("impact_angle_deg", "impact_speed_rad_s")


class Builder:
    """Builds scenes of the reduced model, each from that of one and the same scenario where their models are the same.

    They are those of `scene.build` up to round-off, and so are the faults; those of other methods are built anew.
    Scenarios come straight from configs.

    Parameters
    ----------
    base : Scenario, optional
        Of the scene that others are made from; the first one unless given.
    """

    def __init__(self, base: schema.Scenario | None = None) -> None:
        self._base = base
        self._begin_with(None if base is None else _or_none(base))

    def _begin_with(self, scene: Scene | None) -> None:
        """Keep what the next scenes are made from: one of the reduced model, as others are built anew anyway."""
        self._scene = scene if scene is not None and isinstance(scene.method, Reduced) else None
        self._ends: Sequence[End] = () if self._scene is None else ends_of(self._scene.rigid, self._scene.links)

    def __call__(self, scenario: schema.Scenario) -> Scene:
        """The scene; raises SceneError as `scene.build`."""
        found = None if self._scene is None else again(self._scene, self._ends, scenario)
        made = built_anew(scenario) if found is None else found
        if self._scene is None and self._base is None:
            self._begin_with(made)
        return made

    def __getstate__(self) -> dict[str, Any]:  # another process begins anew
        return {"_base": None, "_scene": None, "_ends": ()}


def _or_none(scenario: schema.Scenario) -> Scene | None:
    """The scene of a scenario that need not have one, as all that is run differs from it."""
    try:
        return built_anew(scenario)
    except SceneError:
        return None


def again(like: Scene, ends: Sequence[End], scenario: schema.Scenario) -> Scene | None:
    """The scene of a scenario from one that is like it; None where more than the medium and the strike differ.

    ends: what a medium may act on, of the scene that it is like.

    Raises
    ------
    SceneError
        As `scene.build`.
    """
    before = like.scenario
    if before is None or not isinstance(like.method, Reduced) or not _same_but_strike(before, scenario):
        return None
    faults = list(too_steep(scenario))
    turn = _Turn.of(like, scenario.initial)
    placed = bed(scenario, [turn.place(end.world) - (0.0, end.drop) for end in ends], faults)
    if faults:
        raise SceneError(faults)
    made = replace(
        like,
        rigid=tuple(replace(body, motion=turn.motion(body.motion)) for body in like.rigid),
        links=tuple(replace(link, motion=turn.motion(link.motion)) for link in like.links),
        joints=tuple(turn.joint(joint) if joint is like.pivot else joint for joint in like.joints),
        bed=placed,
        notes=tuple(media_notes(scenario, placed, "bed.profile_m")),
    )
    vars(made).update(mass=like.mass, length=like.length, least_path=like.least_path)  # which do not change
    _check(made, scenario)
    vars(made).update(scenario=scenario, like=like)
    return made


def _same_but_strike(one: schema.Scenario, other: schema.Scenario) -> bool:
    """Whether two scenarios have all in common but the medium, and how the pendulum strikes it."""
    first, second = one.initial, other.initial
    if not same_but(one, other, "medium", "initial") or not same_but(first, second, *_STRIKE):
        return False
    # Static friction that is chosen by the medium has to be chosen anew.
    by_component = all(medium.by_component for medium in (*one.media, *other.media))
    at_an_angle = None not in (first.impact_angle_deg, second.impact_angle_deg)
    turns = at_an_angle and first.joints is None and first.impact_tip_speed_m_s is None
    return turns and by_component and bool(one.media) == bool(other.media)


def _check(made: Scene, scenario: schema.Scenario) -> None:
    """`verified`, where that follows from the one that it is like: the medium takes all that is in the sand."""
    kinds = {link.kind for link in made.links}
    kinds |= {shape.kind for body in made.rigid for shape in body.shapes if shape.in_sand}
    if any(medium_obstacles(made)) or not all(kinds <= set(medium.takes) for medium in made.media):
        verified(made, scenario)
    elif faults := list(beyond_numbers(made)):
        raise SceneError(faults)


@dataclass(frozen=True)
class _Turn:
    """How a pendulum is turned about its pivot, at pin (2,) m, to where it strikes.

    start, rate: of its joint (rad, rad/s, clockwise); by: rad, counter-clockwise, with its matrix.
    """

    pin: Vector
    start: float
    rate: float
    by: float
    matrix: Vector

    @staticmethod
    def of(like: Scene, initial: schema.Initial) -> _Turn:
        pivot, angle = like.pivot, initial.impact_angle_deg
        assert pivot is not None
        assert angle is not None
        start = math.radians(angle)
        by = pivot.start - start
        return _Turn(pivot.parent_point, start, initial.impact_speed_rad_s, by, rotation(by))

    def place(self, point: Vector) -> Vector:
        placed: Vector = self.pin + self.matrix @ (point - self.pin)
        return placed

    def motion(self, before: InitialMotion) -> InitialMotion:
        arm: Vector = self.matrix @ (before.position - self.pin)
        return InitialMotion(
            self.pin + arm, before.angle + self.by, self.rate * np.array([arm[1], -arm[0]]), -self.rate
        )

    def joint(self, pivot: Joint) -> Joint:
        return replace(pivot, start=self.start, rate=self.rate)
