"""Scenario -> Scene: place the bodies, merge what is welded, find the surface, check that it all fits together."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from granular_contact.config import schema
from granular_contact.errors import Fault, SceneError
from granular_contact.media.kinds import Kind
from granular_contact.media.static_friction import Elastoplastic, Smooth
from granular_contact.scene.bed import Bed, bed
from granular_contact.scene.bodies import flexible_links, rigid_body
from granular_contact.scene.layout import GROUND, ZERO, Frame, Layout, lay_out, point
from granular_contact.scene.reducible import check_reducible
from granular_contact.scene.types import (
    Connection,
    FlexibleLink,
    Load,
    Reduced,
    RigidBody,
    Scene,
    Solver,
    Vector,
    place,
)


def build(scenario: schema.Scenario) -> Scene:
    """Resolve a scenario into a scene.

    Raises
    ------
    SceneError
        The geometry contradicts itself; every fault names its key and the numbers.
    """
    initial, solver = scenario.initial, scenario.solver
    layout = lay_out(scenario.model, math.radians(initial.impact_angle_deg), initial.impact_speed_rad_s)
    rigid = tuple(rigid_body(layout, group) for group in layout.groups if GROUND not in group)
    links = tuple(flexible_links(layout))
    ends = list(_ends(rigid, links))
    faults = [*_motion_faults(scenario, layout), *_joint_faults(layout)]
    placed = bed(scenario, [end.world for end in ends], _kinds(ends), faults)
    if rigid or links:
        faults += _nothing_to_act_on(scenario, ends)
    else:
        faults.append(_fault("model.joints", "every body is welded to the ground, so nothing can move"))
    if faults:
        raise SceneError(faults)
    scene = Scene(
        name=scenario.name or scenario.model.name,
        rigid=rigid,
        links=links,
        connections=tuple(_connections(layout, rigid)),
        gravity=scenario.gravity_m_s2,
        bed=placed,
        load=_load(scenario.load),
        solver=Solver(
            end_time=solver.end_time_s,
            step=solver.step_s,
            rest_time=solver.rest_time_s,
            rest_speed=solver.rest_speed_m_s,
            spectral_radius=solver.spectral_radius,
            tolerance=solver.tolerance,
        ),
        impact_angle=math.radians(initial.impact_angle_deg),
        impact_speed=initial.impact_speed_rad_s,
        tip=_tip(ends, rigid),
        output_interval=scenario.output.interval_s,
        method=_method(scenario, placed),
    )
    if scene.method is not None:
        check_reducible(scene, scene.method.modes)
    return scene


def _fault(key: str, message: str) -> Fault:
    return Fault(file="", line=None, key=key, message=message)


def _motion_faults(scenario: schema.Scenario, layout: Layout) -> Iterator[Fault]:
    speed = scenario.initial.impact_speed_rad_s
    hinged = any(isinstance(j, schema.Hinge) and j.parent == GROUND for j in layout.model.joints.values())
    if speed != 0.0 and not hinged:
        yield _fault(
            "initial.impact_speed_rad_s", f"got {speed:g}, but no hinge joins the model to the ground: allowed is 0"
        )


def _joint_faults(layout: Layout) -> Iterator[Fault]:
    """Joints on a flexible link sit at its root or its tip."""
    bodies = layout.model.bodies
    for name, joint in layout.model.joints.items():
        sides = (("parent", joint.parent, joint.parent_point_m), ("child", joint.child, joint.child_point_m))
        for side, body, xy in sides:
            link = bodies.get(body)
            if not isinstance(link, schema.Link) or link.flexible is None:
                continue
            if tuple(xy) not in ((0.0, 0.0), (link.length_m, 0.0)):
                yield _fault(
                    f"model.joints.{name}.{side}_point_m",
                    f"got {list(xy)}, but {body} is flexible: allowed are its root [0, 0] and its tip "
                    f"[{link.length_m:g}, 0]",
                )


@dataclass(frozen=True)
class _End:
    """End of an immersible part: its body, place in that body's frame and initial world position, (2,) m each."""

    body: str
    point: Vector
    world: Vector


def _ends(rigid: tuple[RigidBody, ...], links: tuple[FlexibleLink, ...]) -> Iterator[_End]:
    for body in rigid:
        for cylinder in body.cylinders:
            for end in (cylinder.start, cylinder.end):
                yield _End(body.name, end, place(body.motion, end))
    for link in links:
        for x in (0.0, link.length):
            end = np.array([x, 0.0])
            yield _End(link.name, end, place(link.motion, end))


def _tip(ends: list[_End], rigid: tuple[RigidBody, ...]) -> tuple[str, Vector]:
    """End that is farthest from the origin; of several the last, which is a link's tip."""
    if not ends:
        return rigid[0].name, ZERO
    farthest = max(float(np.linalg.norm(end.world)) for end in ends)
    return next((e.body, e.point) for e in reversed(ends) if np.linalg.norm(e.world) >= farthest * (1 - 1e-12))


def _kinds(ends: list[_End]) -> set[Kind]:
    """Kinds of shape that may meet the medium."""
    return {"round"} if ends else set()


def _nothing_to_act_on(scenario: schema.Scenario, ends: list[_End]) -> Iterator[Fault]:
    if scenario.media and not ends:
        yield _fault("model.bodies", "no part is a cylinder or a link, so the medium has nothing to act on")


def _connections(layout: Layout, rigid: tuple[RigidBody, ...]) -> Iterator[Connection]:
    """Joints that are left once welded rigid bodies are one."""
    homes: dict[str, tuple[str | None, Frame]] = {name: (name, frame) for name, frame in layout.frames.items()}
    merged = {body.name: body for body in rigid}
    for group in layout.groups:
        body = merged.get("+".join(group))
        home = (None, Frame(ZERO, 0.0)) if body is None else (body.name, Frame(body.motion.position, body.motion.angle))
        homes |= dict.fromkeys(group, home)
    for name, joint in layout.model.joints.items():
        parent, parent_frame = homes[joint.parent]
        child, child_frame = homes[joint.child]
        if child is None or parent == child:
            continue
        pin = layout.frames[joint.child].world(point(joint.child_point_m))
        yield Connection(name, joint.type, parent, parent_frame.local(pin), child, child_frame.local(pin))


def _method(scenario: schema.Scenario, placed: Bed | None) -> Reduced | None:
    reduced = scenario.method.reduced
    if reduced is None:
        return None
    static = reduced.static
    if static == "auto":
        has_sign = placed is None or all(medium.by_component for medium in placed.media)
        static = "true_sign" if reduced.modes == 0 and has_sign else scenario.load.friction.type
    return Reduced(reduced.modes, static, reduced.rtol, reduced.integrator)


def _load(load: schema.Load) -> Load:
    friction = load.friction
    static = (
        Elastoplastic(friction.yield_displacement_m, friction.damping_time_s)
        if isinstance(friction, schema.Elastoplastic)
        else Smooth(friction.reference_speed_m_s)
    )
    return Load(load.form == "resultant", load.end_cap, load.strips_per_element, load.strips_per_rigid_part, static)
