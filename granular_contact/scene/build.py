"""Scenario -> Scene: place the bodies, merge what is welded, find the surface, check that it all fits together."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from granular_contact.config import load_medium, schema
from granular_contact.errors import Fault, SceneError
from granular_contact.media.kinds import WORDS, Kind, Medium, what_it_takes
from granular_contact.media.lee_marghitu import LeeMarghitu, VerticalResistance
from granular_contact.media.static_friction import Elastoplastic, Smooth
from granular_contact.scene.bodies import flexible_links, rigid_body
from granular_contact.scene.drives import drives
from granular_contact.scene.joints import connections
from granular_contact.scene.layout import GROUND, ZERO, JointState, Layout, lay_out, point
from granular_contact.scene.loops import closed, redundant
from granular_contact.scene.reach import dips, reaches
from granular_contact.scene.reducible import check_reducible
from granular_contact.scene.start import start
from granular_contact.scene.types import (
    Drive,
    FlexibleLink,
    Load,
    Reduced,
    RigidBody,
    Scene,
    Solver,
    Vector,
    place,
)

MOST_BODIES = 32  # whose motion is reported unless the run asks for it


def build(scenario: schema.Scenario) -> Scene:
    """Resolve a scenario into a scene.

    Raises
    ------
    SceneError
        The geometry contradicts itself; every fault names its key and the numbers.
    """
    solver, faults = scenario.solver, list[Fault]()
    driven = drives(scenario, faults)
    layout, states = _laid_out(scenario, driven, scenario.initial.impact_speed_rad_s, faults)
    if scenario.initial.impact_tip_speed_m_s is not None:
        layout, states = _laid_out(scenario, driven, _speed_of_tip(scenario, layout), faults)
    rigid, links = _bodies(layout, scenario.load.strips_per_rigid_part)
    ends = list(_ends(rigid, links))
    faults += [*_motion_faults(scenario), *_joint_faults(layout), *_closure_faults(layout)]
    if rigid or links:
        faults += _surface_faults(scenario, ends)
    else:
        faults.append(_fault("model.joints", "every body is welded to the ground, so nothing can move"))
    if faults:
        raise SceneError(faults)
    scene = Scene(
        name=scenario.name or scenario.model.name,
        rigid=rigid,
        links=links,
        connections=tuple(connections(layout, rigid, states)),
        gravity=scenario.gravity_m_s2,
        surface=_surface(scenario, ends),
        medium=medium(scenario.medium) if scenario.medium is not None else None,
        load=_load(scenario.load),
        solver=Solver(
            end_time=solver.end_time_s,
            step=solver.step_s,
            rest_time=solver.rest_time_s,
            rest_speed=solver.rest_speed_m_s,
            spectral_radius=solver.spectral_radius,
            tolerance=solver.tolerance,
        ),
        tip=_tip(ends, rigid, layout),
        output_interval=scenario.output.interval_s,
        method=_method(scenario),
        drives=driven,
        settle=scenario.initial.settle,
        body_columns=_has_body_columns(scenario, rigid, links),
    )
    if faults := list(_unsuited(scene)):
        raise SceneError(faults)
    if scene.method is not None:
        check_reducible(scene, scene.method.modes)
    return scene


def _fault(key: str, message: str) -> Fault:
    return Fault(file="", line=None, key=key, message=message)


def _laid_out(
    scenario: schema.Scenario, driven: tuple[Drive, ...], speed: float, faults: list[Fault]
) -> tuple[Layout, dict[str, JointState]]:
    """The model in its initial state, and the states of its joints. speed: rate of the ground hinges (rad/s).

    Raises
    ------
    SceneError
        There is no such state, so that nothing can be said about the rest.
    """
    model, angle = scenario.model, -math.radians(scenario.initial.impact_angle_deg or 0.0)
    begun = start(scenario, driven, speed, faults)
    states = closed(scenario, begun, angle, faults)
    if not faults:
        faults += redundant(model, states, angle, driven)
    if faults:
        raise SceneError(faults)
    return lay_out(model, states, angle), states


def _bodies(layout: Layout, strips: int) -> tuple[tuple[RigidBody, ...], tuple[FlexibleLink, ...]]:
    return tuple(rigid_body(layout, g, strips) for g in layout.groups if GROUND not in g), tuple(flexible_links(layout))


def _speed_of_tip(scenario: schema.Scenario, layout: Layout) -> float:
    """Rate (rad/s) of the ground hinge at which the tip has the speed that the run says."""
    speed, pins = scenario.initial.impact_tip_speed_m_s, _pins(scenario.model)
    assert speed is not None
    if not pins:
        return 0.0  # which is refused
    rigid, links = _bodies(layout, scenario.load.strips_per_rigid_part)
    name, at = _tip(list(_ends(rigid, links)), rigid, layout)
    body = next(body for body in (*rigid, *links) if body.name == name)
    return speed / float(np.linalg.norm(place(body.motion, at) - pins[0]))


def _pins(model: schema.Model) -> list[Vector]:
    """Where hinges sit on the ground, (2,) m each."""
    joints = model.all_joints.values()
    return [point(j.parent_point_m) for j in joints if isinstance(j, schema.Hinge) and j.parent == GROUND]


def _motion_faults(scenario: schema.Scenario) -> Iterator[Fault]:
    hinged = bool(_pins(scenario.model))
    for key in ("impact_speed_rad_s", "impact_tip_speed_m_s"):
        speed = getattr(scenario.initial, key)
        if speed and not hinged:
            yield _fault(f"initial.{key}", f"got {speed:g}, but no hinge joins the model to the ground: allowed is 0")


def _joint_faults(layout: Layout) -> Iterator[Fault]:
    """Joints on a flexible link sit at its root or its tip."""
    bodies = layout.model.all_bodies
    for kind, name, joint in _all_joints(layout.model):
        sides = (("parent", joint.parent, joint.parent_point_m), ("child", joint.child, joint.child_point_m))
        for side, body, xy in sides:
            link = bodies.get(body)
            if not isinstance(link, schema.Link) or link.flexible is None:
                continue
            if isinstance(joint, schema.SliderClosure) and side == "parent":
                yield _fault(f"model.{kind}.{name}.parent", f"{body} is flexible; a slider has a rigid parent")
            elif tuple(xy) not in ((0.0, 0.0), (link.length_m, 0.0)):
                yield _fault(
                    f"model.{kind}.{name}.{side}_point_m",
                    f"got {list(xy)}, but {body} is flexible: allowed are its root [0, 0] and its tip "
                    f"[{link.length_m:g}, 0]",
                )


def _all_joints(model: schema.Model) -> Iterator[tuple[str, str, schema.Joint | schema.Closure]]:
    """Joints that are written out, by the key under which they stand and their name."""
    yield from (("joints", name, joint) for name, joint in model.joints.items())
    yield from (("closures", name, closure) for name, closure in model.closures.items())


def _closure_faults(layout: Layout) -> Iterator[Fault]:
    """The child of a closure can move; welded to the ground it would have to be the parent."""
    fixed = next((group for group in layout.groups if GROUND in group), [])
    for name, closure in layout.model.closures.items():
        if closure.child in fixed:
            yield _fault(f"model.closures.{name}.child", f"{closure.child} is fixed to the ground: make it the parent")


@dataclass(frozen=True)
class _End:
    """End or corner of an immersible part: its body, place in that body's frame and initial world position, (2,) m.

    drop: how far the part reaches below it (m).
    """

    body: str
    point: Vector
    world: Vector
    drop: float = 0.0

    @property
    def lowest(self) -> float:
        """Height (m) of the lowest point there."""
        return float(self.world[1]) - self.drop


def _ends(rigid: tuple[RigidBody, ...], links: tuple[FlexibleLink, ...]) -> Iterator[_End]:
    for body in rigid:
        for shape in body.shapes:
            if shape.in_sand:
                for corner in shape.points:
                    yield _End(body.name, corner, place(body.motion, corner), shape.drop)
    for link in links:
        for x in (0.0, link.length):
            end = np.array([x, 0.0])
            yield _End(link.name, end, place(link.motion, end))


def _tip(ends: list[_End], rigid: tuple[RigidBody, ...], layout: Layout) -> tuple[str, Vector]:
    """End that is farthest from the origin, or lowest if the mechanism slides or flies; of several the last."""
    if not ends:
        return rigid[0].name, ZERO
    joints = layout.model.all_joints.values()
    if any(j.parent == GROUND and isinstance(j, schema.Slider | schema.Free) for j in joints):
        lowest = min(float(end.world[1]) for end in ends)
        return next((e.body, e.point) for e in reversed(ends) if e.world[1] <= lowest + 1e-12)
    farthest = max(float(np.linalg.norm(end.world)) for end in ends)
    return next((e.body, e.point) for e in reversed(ends) if np.linalg.norm(e.world) >= farthest * (1 - 1e-12))


def _unsuited(scene: Scene) -> Iterator[Fault]:
    """Shapes that can get into the sand and for which the law of the medium is not made."""
    if scene.medium is None or scene.surface is None:
        return
    for body in scene.rigid:
        for shape in body.shapes:
            if shape.kind not in scene.medium.takes and dips(scene.surface, body, shape):
                yield _unfit(shape.part, shape.kind, scene.medium)
    for link in scene.links:
        if link.kind not in scene.medium.takes and reaches(scene.surface, link, np.array([link.length, 0.0])):
            yield _unfit(link.name, link.kind, scene.medium)


def _unfit(part: str, kind: Kind, medium: Medium) -> Fault:
    hint = "take another law, or in_sand: false for a shape that has no part in it"
    return _fault(
        f"model.bodies.{part}", f"can get into the sand, but {what_it_takes(medium)}, not {WORDS[kind]}: {hint}"
    )


def _has_body_columns(
    scenario: schema.Scenario, rigid: tuple[RigidBody, ...], links: tuple[FlexibleLink, ...]
) -> bool:
    """Whether the motion of every body is reported."""
    if scenario.output.bodies != "auto":
        return scenario.output.bodies == "all"
    moving = [joint for joint in scenario.model.all_joints.values() if not isinstance(joint, schema.Weld)]
    pendulum = len(moving) == 1 and isinstance(moving[0], schema.Hinge)
    return bool(moving) and not pendulum and len(rigid) + len(links) <= MOST_BODIES


def _surface(scenario: schema.Scenario, ends: list[_End]) -> float | None:
    """Height of the free surface (m): as given, or where the lowest end of the mechanism touches it."""
    if scenario.surface_height_m is not None or scenario.medium is None:
        return scenario.surface_height_m
    return min(end.lowest for end in ends)


def _surface_faults(scenario: schema.Scenario, ends: list[_End]) -> Iterator[Fault]:
    if scenario.medium is None:
        return
    if not ends:
        yield _fault("model.bodies", "no part is a link or a shape in_sand, so the medium has nothing to act on")
        return
    lowest = min(end.lowest for end in ends)
    height = scenario.surface_height_m
    if height is not None and lowest < height - 1e-12:
        yield _fault(
            "surface_height_m",
            f"got {height:g} m, but {_as_it_starts(scenario)} the lowest end is at "
            f"{lowest:.6g} m, {height - lowest:.3g} m below the sand: allowed is at most {lowest:.6g} m, or no value",
        )


def _as_it_starts(scenario: schema.Scenario) -> str:
    angle = scenario.initial.impact_angle_deg
    return "at the start" if angle is None else f"at impact_angle_deg {angle:g}"


def medium(spec: schema.LeeMarghitu) -> LeeMarghitu:
    """Medium of a checked config; what withdrawing leaves out is as for plunging."""
    plunging = VerticalResistance(spec.plunging.eta_v, spec.plunging.lambda_)
    withdrawing = plunging
    if spec.withdrawing is not None:
        withdrawing = VerticalResistance(spec.withdrawing.eta_v, spec.withdrawing.lambda_)
    return LeeMarghitu(spec.density_kg_m3, spec.eta_d, spec.eta_h, plunging, withdrawing, spec.name or spec.law)


def preset(name: str) -> LeeMarghitu:
    """Medium by the name of its preset (`play_sand`) or by the path of a YAML file.

    Raises
    ------
    ConfigError
        There is no such medium; the message lists those there are.
    """
    return medium(load_medium(name))


def _method(scenario: schema.Scenario) -> Reduced | None:
    reduced = scenario.method.reduced
    if reduced is None:
        return None
    static = reduced.static
    if static == "auto":
        static = "true_sign" if reduced.modes == 0 else scenario.load.friction.type
    return Reduced(reduced.modes, static, reduced.rtol, reduced.integrator)


def _load(load: schema.Load) -> Load:
    friction = load.friction
    static = (
        Elastoplastic(friction.yield_displacement_m, friction.damping_time_s)
        if isinstance(friction, schema.Elastoplastic)
        else Smooth(friction.reference_speed_m_s)
    )
    return Load(load.form == "resultant", load.end_cap, load.strips_per_element, load.strips_per_rigid_part, static)
