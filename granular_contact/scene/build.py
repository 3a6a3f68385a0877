"""Scenario -> Scene: place the bodies, merge welded bodies, find the surface, check the geometry."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from granular_contact.config import Given, Loaded, loaded, schema
from granular_contact.config.changed import checked
from granular_contact.config.schema.joints import joint_of
from granular_contact.errors import Fault, SceneError, scene_fault
from granular_contact.scene.bed import Bed, bed_of
from granular_contact.scene.bodies import flexible_links, rigid_body
from granular_contact.scene.checks import bed_slope_faults, closure_faults, law_faults, magnitude_faults, media_notes
from granular_contact.scene.drives import drives_of
from granular_contact.scene.joints import joints_of
from granular_contact.scene.layout import FREEDOMS, GROUND, ZERO, JointState, Layout, initial_states, lay_out, point
from granular_contact.scene.loops import PlanarLoops, close_loops, redundancy_faults
from granular_contact.scene.methods import check, fits_minimal
from granular_contact.scene.parts import FlexibleLink, RigidBody, Shape, scene_angle
from granular_contact.scene.shapes import farthest, lowest
from granular_contact.scene.steps import steps
from granular_contact.scene.stiff import LEAST_BOW, bow, with_rigid
from granular_contact.scene.types import Drive, Minimal, Reduced, Scene, Vector
from granular_contact.scene.wheels import wheel_drives, wheel_notes, wheel_test

MOST_BODIES = 32  # up to so many bodies, `output.bodies: auto` reports the motion of every body


def build(scenario: Given) -> Scene:
    """Resolve a scenario into a scene, which keeps the scenario as `scenario`.

    Parameters
    ----------
    scenario : Scenario, Loaded, str, path or mapping
        What `load` returns or takes. Faults name the lines of their keys, except those of a Scenario.

    Returns
    -------
    Scene

    Raises
    ------
    ConfigError
        The scenario was changed in Python to values that no config may have.
    SceneError
        The geometry contradicts itself; every fault names its key and the numbers.

    Examples
    --------
    >>> scene = build(load("pendulum_rigid"))  # doctest: +SKIP
    >>> simulate(scene).status.code  # doctest: +SKIP
    'rest'
    """
    scenario = loaded(scenario)
    if isinstance(scenario, Loaded):
        try:
            return build(scenario.scenario)
        except SceneError as error:
            raise SceneError(scenario.sources.place(error.faults)) from None
    return build_checked(checked(scenario))


def build_checked(scenario: schema.Scenario) -> Scene:
    """`build` for a scenario that has not changed since it was checked, as one just made from a config.

    Raises
    ------
    SceneError
        As `build`.
    """
    scene = _spatial_scene(scenario) if type(scenario) is not schema.Scenario else _planar_scene(scenario)
    object.__setattr__(scene, "scenario", scenario)  # no argument of Scene, so that no other code can set it
    return scene


def _spatial_scene(scenario: schema.Scenario) -> Scene:
    """Scene of a mechanism in space; planar scenes do not import the code for space."""
    from granular_contact.config.schema.space import SpatialScenario
    from granular_contact.scene.space.build import build_spatial

    assert isinstance(scenario, SpatialScenario)
    return build_spatial(scenario)


def _planar_scene(scenario: schema.Scenario) -> Scene:
    faults, notes = list[Fault](), list[Fault]()
    solver = steps(scenario)
    drives = (*drives_of(scenario, solver, faults), *wheel_drives(scenario, faults))
    layout, states = _initial_layout(scenario, drives, scenario.initial.impact_speed_rad_s, faults, notes)
    if scenario.initial.impact_tip_speed_m_s is not None:
        hinge_rate = _hinge_rate_of_tip_speed(scenario, layout, faults)
        layout, states = _initial_layout(scenario, drives, hinge_rate, faults, [])
    rigid, links = _bodies(layout, scenario.load.strips_per_rigid_part)
    ends = ends_of(rigid, links)
    faults += [
        *_impact_speed_faults(scenario),
        *_joint_faults(layout),
        *bed_slope_faults(scenario),
        *closure_faults(layout.model, layout.groups),
    ]
    if scenario.output.travel not in ("x", "path"):
        words = f"got {scenario.output.travel}, but y is up in the plane: allowed are x and path"
        faults.append(scene_fault("output.travel", words))
    bed = bed_of(scenario, [end.world - (0.0, end.drop) for end in ends], faults)
    if rigid or links:
        faults += _medium_faults(scenario, ends)
        faults += _mass_faults(rigid)
    else:
        faults.append(scene_fault("model.joints", "every body is welded to the ground, so nothing can move"))
    if faults:
        raise SceneError(faults)
    scene = Scene(
        name=scenario.name or scenario.model.name,
        rigid=rigid,
        links=links,
        joints=tuple(joints_of(layout, (*rigid, *links), states)),
        gravity=scenario.gravity_m_s2,
        bed=bed,
        load=scenario.load,
        solver=solver,
        tip=_tip(ends, rigid, layout),
        output_interval=scenario.output.interval_s,
        method=_method(scenario, bed),
        drives=drives,
        settle=scenario.initial.settle,
        body_columns=_has_body_columns(scenario, rigid, links),
        notes=(*notes, *media_notes(scenario, bed, "bed.profile_m"), *wheel_notes(scenario)),
        wheel_test=wheel_test(scenario),
        travel=None if scenario.output.ahead is None else (1.0,),
    )
    if stiff := verify(scene, scenario):
        return replace(_planar_scene(with_rigid(scenario, stiff)), stiff=stiff)
    return replace(scene, method=Minimal()) if scenario.method.name == "auto" and fits_minimal(scene) else scene


def verify(scene: Scene, scenario: schema.Scenario) -> tuple[str, ...]:
    """Refuse a scene that its method can't solve; return the names of links that Exudyn gets as rigid ones.

    These are the links that bend too little to show. A scene with another method has none.

    Raises
    ------
    SceneError
        The scene can't be solved.
    """
    if faults := [*magnitude_faults(scene), *law_faults(scene, scenario)]:
        raise SceneError(faults)
    check(scene)
    if scene.method is not None:
        return ()
    return tuple(
        link.name
        for link in scene.links
        if bow(scene.force_scale, link.length, link.bending_stiffness, link.axial_stiffness) < LEAST_BOW
    )


def _initial_layout(
    scenario: schema.Scenario, drives: tuple[Drive, ...], hinge_rate: float, faults: list[Fault], notes: list[Fault]
) -> tuple[Layout, dict[str, JointState]]:
    """Lay out the model in its initial state; return also the states of its joints.

    hinge_rate: rate of the ground hinges (rad/s, clockwise).

    Raises
    ------
    SceneError
        There is no such state, so that further checks are impossible.
    """
    model, angle = scenario.model, scene_angle(scenario.initial.impact_angle_deg or 0.0)
    initial = initial_states(scenario, drives, hinge_rate, faults)
    states = close_loops(PlanarLoops(model, angle), initial, faults, notes)
    if not faults:
        faults += redundancy_faults(model, states, angle, drives)
    if faults:
        raise SceneError(faults)
    return lay_out(model, states, angle), states


def _bodies(layout: Layout, strips: int) -> tuple[tuple[RigidBody, ...], tuple[FlexibleLink, ...]]:
    groups = [group for group in layout.groups if GROUND not in group]
    return tuple(rigid_body(layout, group, strips) for group in groups), tuple(flexible_links(layout))


def _hinge_rate_of_tip_speed(scenario: schema.Scenario, layout: Layout, faults: list[Fault]) -> float:
    """Rate (rad/s) of the ground hinge at which the tip has the impact speed of the run."""
    speed, pins = scenario.initial.impact_tip_speed_m_s, _ground_pins(scenario.model)
    assert speed is not None
    if not pins:
        return 0.0  # `_impact_speed_faults` refuses this
    rigid, links = _bodies(layout, scenario.load.strips_per_rigid_part)
    name, tip = _tip(ends_of(rigid, links), rigid, layout)
    motions = {body.name: body.motion for body in rigid} | {link.name: link.motion for link in links}
    arm = float(np.linalg.norm(motions[name].world(tip) - pins[0]))
    if not arm > 0.0:
        why = f"got {speed:g}, but no shape reaches beyond the hinge, where there is no speed; give impact_speed_rad_s"
        faults.append(scene_fault("initial.impact_tip_speed_m_s", why))
        return 0.0
    return speed / arm


def _ground_pins(model: schema.Model) -> list[Vector]:
    """World positions of the hinges on the ground, (2,) m each."""
    joints = model.all_joints.values()
    return [
        point(joint.parent_point_m) for joint in joints if isinstance(joint, schema.Hinge) and joint.parent == GROUND
    ]


def _impact_speed_faults(scenario: schema.Scenario) -> Iterator[Fault]:
    """Faults of impact speeds of a model without a hinge on the ground."""
    hinged = bool(_ground_pins(scenario.model))
    for key in ("impact_speed_rad_s", "impact_tip_speed_m_s"):
        speed = getattr(scenario.initial, key)
        if speed and not hinged:
            yield scene_fault(
                f"initial.{key}", f"got {speed:g}, but no hinge joins the model to the ground: allowed is 0"
            )


def _mass_faults(rigid: tuple[RigidBody, ...]) -> Iterator[Fault]:
    """Faults of bodies so small and light that volume times density underflows to 0."""
    for body in rigid:
        if not body.mass > 0.0:
            yield scene_fault(f"model.bodies.{body.name}", "got a mass of 0 kg by its shapes; allowed is more")


def _joint_faults(layout: Layout) -> Iterator[Fault]:
    """Faults of joints on a flexible link: not at its root or tip, or with an axis that is fixed in the link."""
    bodies = layout.model.all_bodies
    for kind, name, joint in _all_joints(layout.model):
        sides = (("parent", joint.parent, joint.parent_point_m), ("child", joint.child, joint.child_point_m))
        for side, body, xy in sides:
            link = bodies.get(body)
            if not isinstance(link, schema.Link) or link.flexible is None:
                continue
            if hasattr(joint, "axis") and side == "parent":
                words = f"{body} is flexible; a {joint_of(joint.type)} has a rigid parent"
                yield scene_fault(f"model.{kind}.{name}.parent", words)
            elif tuple(xy) not in ((0.0, 0.0), (link.length_m, 0.0)):
                yield scene_fault(
                    f"model.{kind}.{name}.{side}_point_m",
                    f"got {list(xy)}, but {body} is flexible: allowed are its root [0, 0] and its tip "
                    f"[{link.length_m:g}, 0]",
                )


def _all_joints(model: schema.Model) -> Iterator[tuple[str, str, schema.Joint | schema.Closure]]:
    """Joints and closures of the config: the key above them, name, and joint. Joints of a chain are not included."""
    yield from (("joints", name, joint) for name, joint in model.joints.items())
    yield from (("closures", name, closure) for name, closure in model.closures.items())


@dataclass(frozen=True)
class End:
    """End or corner of a part that a medium may act on.

    point: (2,) m in the frame of the body. world: initial world position (2,) m. drop (m): how far the part reaches
    below the point.
    """

    body: str
    point: Vector
    world: Vector
    drop: float = 0.0

    @property
    def lowest(self) -> float:
        """Height (m) of the lowest point of the part at this end."""
        return float(self.world[1]) - self.drop


def ends_of(rigid: tuple[RigidBody, ...], links: tuple[FlexibleLink, ...]) -> list[End]:
    """Ends, corners and lowest points of all parts that a medium may act on."""
    ends = []
    for body, shape in _shapes_in_sand(rigid):
        points = [*lowest(shape, body.motion), *shape.points]
        ends += [End(body.name, corner, body.motion.world(corner), shape.drop) for corner in points]
    link_ends = [(link, np.array([x, 0.0])) for link in links for x in (0.0, link.length)]
    return ends + [End(link.name, end, link.motion.world(end)) for link, end in link_ends]


def _shapes_in_sand(rigid: tuple[RigidBody, ...]) -> list[tuple[RigidBody, Shape]]:
    """Shapes that a medium may act on, with their bodies."""
    return [(body, shape) for body in rigid for shape in body.shapes if shape.in_sand]


def _tip(ends: list[End], rigid: tuple[RigidBody, ...], layout: Layout) -> tuple[str, Vector]:
    """End that is farthest from the first joint on the ground, or lowest if the mechanism slides or flies.

    Of several such ends it is the last.
    """
    if not ends:
        return rigid[0].name, ZERO
    on_ground = [joint for joint in layout.model.all_joints.values() if joint.parent == GROUND]
    if any(FREEDOMS[joint.type][0] for joint in on_ground):
        lowest = min(end.lowest for end in ends)
        return next((e.body, e.point) for e in reversed(ends) if e.lowest <= lowest + 1e-12)
    root = point(on_ground[0].parent_point_m)
    on_arcs = [(body, at) for body, shape in _shapes_in_sand(rigid) for at in farthest(shape, body.motion, root)]
    ends = [*(End(body.name, at, body.motion.world(at)) for body, at in on_arcs), *ends]
    greatest = max(float(np.linalg.norm(end.world - root)) for end in ends)
    return next((e.body, e.point) for e in reversed(ends) if np.linalg.norm(e.world - root) >= greatest * (1 - 1e-12))


def _has_body_columns(scenario: schema.Scenario, rigid: tuple[RigidBody, ...], links: tuple[FlexibleLink, ...]) -> bool:
    """Whether the motion of every body is reported."""
    if scenario.output.bodies != "auto":
        return scenario.output.bodies == "all"
    moving = [joint for joint in scenario.model.all_joints.values() if not isinstance(joint, schema.Weld)]
    pendulum = len(moving) == 1 and isinstance(moving[0], schema.Hinge)
    return bool(moving) and not pendulum and len(rigid) + len(links) <= MOST_BODIES


def _medium_faults(scenario: schema.Scenario, ends: list[End]) -> Iterator[Fault]:
    """Fault of a scenario with a medium, in which no part can be in the medium."""
    if scenario.media and not ends:
        yield scene_fault("model.bodies", "no part is a link or a shape in_sand, so the medium has nothing to act on")


def _method(scenario: schema.Scenario, bed: Bed | None) -> schema.AnyMethod | None:
    """Method of the scenario, with `static: auto` of the reduced model replaced; None for Exudyn and for `auto`."""
    chosen = scenario.method.chosen
    if not isinstance(chosen, Reduced) or chosen.static != "auto":
        return chosen
    has_sign = bed is None or all(medium.by_component for medium in bed.media)
    static = "true_sign" if chosen.modes == 0 and has_sign else scenario.load.friction.type
    return chosen.model_copy(update={"static": static})
