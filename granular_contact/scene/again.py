"""Scene of a scenario that differs from another one's in its medium and in how a pendulum strikes, and in nothing else.

Masses, shapes and joints follow from the model. Many runs of one model need them once.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np

from granular_contact.config import schema
from granular_contact.errors import Fault, SceneError
from granular_contact.scene.bed import bed
from granular_contact.scene.build import built as built_anew
from granular_contact.scene.build import ends_of, verified
from granular_contact.scene.types import InitialMotion, Joint, Reduced, Scene, Vector, rotation

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
        self._base, self._scene = base, None if base is None else _or_none(base)

    def __call__(self, scenario: schema.Scenario) -> Scene:
        """The scene; raises SceneError as `scene.build`."""
        found = None if self._scene is None else again(self._scene, scenario)
        made = built_anew(scenario) if found is None else found
        if self._scene is None and self._base is None:
            self._scene = made
        return made

    def __getstate__(self) -> dict[str, Any]:  # another process begins anew
        return {"_base": None, "_scene": None}


def _or_none(scenario: schema.Scenario) -> Scene | None:
    """The scene of a scenario that need not have one, as all that is run differs from it."""
    try:
        return built_anew(scenario)
    except SceneError:
        return None


def again(like: Scene, scenario: schema.Scenario) -> Scene | None:
    """The scene of a scenario from one that is like it; None where more than the medium and the strike differ.

    Raises
    ------
    SceneError
        As `scene.build`.
    """
    before = like.scenario
    if before is None or not isinstance(like.method, Reduced):
        return None
    if type(before) is not type(scenario) or not _same_but_strike(before, scenario):
        return None
    faults = list[Fault]()
    turned = like if before.initial is scenario.initial else _struck(like, scenario.initial)
    ends = ends_of(turned.rigid, turned.links)
    placed = bed(scenario, [end.world - (0.0, end.drop) for end in ends], faults)
    if faults:
        raise SceneError(faults)
    made = replace(turned, bed=placed)
    verified(made, scenario)
    object.__setattr__(made, "scenario", scenario)
    return made


def _same_but_strike(one: schema.Scenario, other: schema.Scenario) -> bool:
    """Whether two scenarios have all in common but the medium, and how the pendulum strikes it."""
    for name in type(one).model_fields:
        mine, theirs = getattr(one, name), getattr(other, name)
        if name in ("medium", "initial") or mine is theirs:
            continue
        if mine != theirs:
            return False
    # Static friction that is chosen by the medium has to be chosen anew.
    by_component = all(medium.by_component for medium in (*one.media, *other.media))
    first, second = one.initial, other.initial
    rest = (key for key in type(first).model_fields if key not in _STRIKE)
    alike = by_component and bool(one.media) == bool(other.media)
    alike = alike and first.joints is None and first.impact_tip_speed_m_s is None
    angles = first.impact_angle_deg, second.impact_angle_deg
    return alike and None not in angles and all(getattr(first, key) == getattr(second, key) for key in rest)


def _struck(like: Scene, initial: schema.Initial) -> Scene:
    """The pendulum turned about its pivot to where it strikes, at its speed."""
    pivot, angle = like.pivot, initial.impact_angle_deg
    assert pivot is not None
    assert angle is not None
    start, rate, pin = math.radians(angle), initial.impact_speed_rad_s, pivot.parent_point
    turn = pivot.start - start
    matrix = rotation(turn)

    def moved(motion: InitialMotion) -> InitialMotion:
        arm: Vector = matrix @ (motion.position - pin)
        return InitialMotion(pin + arm, motion.angle + turn, -rate * np.array([-arm[1], arm[0]]), -rate)

    def joined(joint: Joint) -> Joint:
        return replace(joint, start=start, rate=rate) if joint is pivot else joint

    return replace(
        like,
        rigid=tuple(replace(body, motion=moved(body.motion)) for body in like.rigid),
        links=tuple(replace(link, motion=moved(link.motion)) for link in like.links),
        joints=tuple(map(joined, like.joints)),
    )
