"""Scenario -> Scene: place the bodies, merge what is welded, find the surface, check that it all fits together."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from granular_contact.config import schema
from granular_contact.errors import Fault, SceneError, scene_error
from granular_contact.media.lee_marghitu import LeeMarghitu, VerticalResistance
from granular_contact.media.static_friction import Elastoplastic, Smooth
from granular_contact.scene.types import (
    Connection,
    Cylinder,
    Disc,
    FlexibleLink,
    Load,
    Motion,
    RigidBody,
    Scene,
    Solver,
    Tether,
    Vector,
    place,
    rotation,
)

GROUND = "ground"
ZERO = np.zeros(2)


@dataclass(frozen=True)
class Frame:
    """Where a body's frame lies at the start: origin (2,) m in the world, angle rad."""

    origin: Vector
    angle: float

    def world(self, point: Vector) -> Vector:
        """World position of a point (2,) m of the body."""
        moved: Vector = self.origin + rotation(self.angle) @ point
        return moved

    def local(self, point: Vector) -> Vector:
        """Body-frame position of a world point (2,) m."""
        moved: Vector = rotation(-self.angle) @ (point - self.origin)
        return moved


def build(scenario: schema.Scenario) -> Scene:
    """Resolve a scenario into a scene.

    Raises
    ------
    SceneError
        The geometry contradicts itself; every fault names its key and the numbers.
    """
    faults: list[Fault] = []
    model = scenario.model
    frames = _frames(model, math.radians(scenario.initial.impact_angle_deg))
    groups = _weld_groups(model)
    tethers = _tethers(model)
    spin = _Spin(_axis(model), -scenario.initial.impact_speed_rad_s)
    if spin.rate != 0.0 and not any(isinstance(j, schema.Hinge) and j.parent == GROUND for j in model.joints.values()):
        faults.append(_fault("initial.impact_speed_rad_s", f"{-spin.rate:g}, but no hinge joins the model to the ground"))

    rigid, homes = [], {GROUND: (None, Frame(ZERO, 0.0))}
    for group in groups:
        if GROUND in group:
            homes.update({name: (None, Frame(ZERO, 0.0)) for name in group})
            continue
        body = _rigid_body(model, group, frames, tethers, spin)
        rigid.append(body)
        homes.update({name: (body.name, Frame(body.motion.position, body.motion.angle)) for name in group})
    links = []
    for name, spec in model.bodies.items():
        if isinstance(spec, schema.Link) and spec.flexible is not None:
            links.append(_flexible_link(name, spec, spec.flexible, model, frames[name], tethers[name], spin))
            homes[name] = (name, frames[name])
            faults += _off_axis(name, spec, model)
    connections = tuple(_connections(model, frames, homes))
    if not rigid and not links:
        raise scene_error("model.joints", "every body is welded to the ground, nothing can move")

    surface = _surface(scenario, rigid, links, faults)
    if faults:
        raise SceneError(faults)
    return Scene(
        name=scenario.name or model.name,
        rigid=tuple(rigid),
        links=tuple(links),
        connections=connections,
        gravity=scenario.gravity_m_s2,
        surface=surface,
        medium=_medium(scenario.medium),
        load=_load(scenario.load),
        solver=Solver(
            end_time=scenario.solver.end_time_s,
            step=scenario.solver.step_s,
            rest_time=scenario.solver.rest_time_s,
            rest_speed=scenario.solver.rest_speed_m_s,
            spectral_radius=scenario.solver.spectral_radius,
            tolerance=scenario.solver.tolerance,
        ),
        impact_angle=math.radians(scenario.initial.impact_angle_deg),
        impact_speed=scenario.initial.impact_speed_rad_s,
        tip=_tip(rigid, links),
        output_interval=scenario.output.interval_s,
    )


def _fault(key: str, message: str) -> Fault:
    return Fault(file="", line=None, key=key, message=message)


def _point(xy: tuple[float, float]) -> Vector:
    return np.array(xy, dtype=float)


def _joints_outward(model: schema.Model) -> Iterator[tuple[str, schema.Joint]]:
    """Joints in an order in which every parent is placed before its children."""
    placed, waiting = {GROUND}, dict(model.joints)
    while waiting:
        name = next(n for n, joint in waiting.items() if joint.parent in placed)
        placed.add(waiting[name].child)
        yield name, waiting.pop(name)


def _frames(model: schema.Model, impact_angle: float) -> dict[str, Frame]:
    """Frames of all bodies in the undeformed pose; what hangs on the ground points impact_angle (rad) below horizontal."""
    frames = {GROUND: Frame(ZERO, -impact_angle)}
    for _, joint in _joints_outward(model):
        parent = frames[joint.parent]
        angle = parent.angle + math.radians(joint.angle_deg if isinstance(joint, schema.Weld) else 0.0)
        pin = _point(joint.parent_point_m) if joint.parent == GROUND else parent.world(_point(joint.parent_point_m))
        frames[joint.child] = Frame(pin - rotation(angle) @ _point(joint.child_point_m), angle)
    return frames


def _tethers(model: schema.Model) -> dict[str, Tether]:
    """How far from the ground joint each body can get, whatever the joints do in between."""
    tethers = {GROUND: Tether(ZERO, 0.0)}
    for _, joint in _joints_outward(model):
        length = tethers[joint.parent].reach(_point(joint.parent_point_m))
        tethers[joint.child] = Tether(_point(joint.child_point_m), length)
    return tethers


def _is_rigid(model: schema.Model, name: str) -> bool:
    if name == GROUND:
        return True
    body = model.bodies[name]
    return not (isinstance(body, schema.Link) and body.flexible is not None)


def _weld_groups(model: schema.Model) -> list[list[str]]:
    """Rigid bodies (and the ground) grouped by the welds between them: each group moves as one."""
    groups = {name: [name] for name in (GROUND, *model.bodies) if _is_rigid(model, name)}
    for _, joint in _joints_outward(model):
        if isinstance(joint, schema.Weld) and joint.parent in groups and joint.child in groups:
            merged = groups[joint.parent]
            merged += groups[joint.child]
            for name in groups[joint.child]:
                groups[name] = merged
    distinct = {id(group): group for group in groups.values()}
    return list(distinct.values())


@dataclass(frozen=True)
class _Spin:
    """Initial motion: everything turns about one axis (2,) m at one rate (rad/s, counter-clockwise)."""

    axis: Vector
    rate: float

    def motion(self, frame: Frame) -> Motion:
        arm = frame.origin - self.axis
        return Motion(frame.origin, frame.angle, self.rate * np.array([-arm[1], arm[0]]), self.rate)


def _axis(model: schema.Model) -> Vector:
    hinges = (j for j in model.joints.values() if isinstance(j, schema.Hinge) and j.parent == GROUND)
    hinge = next(hinges, None)
    return ZERO if hinge is None else _point(hinge.parent_point_m)


@dataclass(frozen=True)
class _Lump:
    """Mass (kg), centre (2,) m in the body's frame and inertia about it (kg m2) of one shape."""

    mass: float
    center: Vector
    inertia: float


def _shapes(name: str, body: schema.Body) -> Iterator[tuple[Cylinder | Disc, _Lump]]:
    """Shapes of a rigid body in its own frame with their mass properties."""
    if isinstance(body, schema.Link):
        yield _bar(name, ZERO, np.array([body.length_m, 0.0]), body.diameter_m, body.density_kg_m3)
        return
    for shape in body.shapes:
        if isinstance(shape, schema.DiscShape):
            mass = body.density_kg_m3 * math.pi / 4 * shape.diameter_m**2 * shape.thickness_m
            center = _point(shape.center_m)
            yield Disc(name, center, shape.diameter_m), _Lump(mass, center, mass * shape.diameter_m**2 / 8)
        else:
            yield _bar(name, _point(shape.start_m), _point(shape.end_m), shape.diameter_m, body.density_kg_m3)


def _bar(name: str, start: Vector, end: Vector, diameter: float, density: float) -> tuple[Cylinder, _Lump]:
    length = float(np.linalg.norm(end - start))
    mass = density * math.pi / 4 * diameter**2 * length
    lump = _Lump(mass, (start + end) / 2, mass * (length**2 / 12 + diameter**2 / 16))
    return Cylinder(name, start, end, diameter), lump


def _rigid_body(
    model: schema.Model, group: list[str], frames: dict[str, Frame], tethers: dict[str, Tether], spin: _Spin
) -> RigidBody:
    """Merge a group of welded bodies about their common centre of mass."""
    shapes = [(frames[n], shape, lump) for n in group for shape, lump in _shapes(n, model.bodies[n])]
    mass = sum(lump.mass for _, _, lump in shapes)
    center: Vector = sum((lump.mass * frame.world(lump.center) for frame, _, lump in shapes), ZERO) / mass
    inertia = sum(
        lump.inertia + lump.mass * float(np.sum((frame.world(lump.center) - center) ** 2)) for frame, _, lump in shapes
    )
    own = Frame(center, frames[group[0]].angle)
    cylinders, discs = [], []
    for frame, shape, _ in shapes:
        if isinstance(shape, Disc):
            discs.append(Disc(shape.part, own.local(frame.world(shape.center)), shape.diameter))
        else:
            start, end = own.local(frame.world(shape.start)), own.local(frame.world(shape.end))
            free = _is_free(model, shape.part, shape.end)
            cylinders.append(Cylinder(shape.part, start, end, shape.diameter, free))
    root = tethers[group[0]]
    tether = Tether(own.local(frames[group[0]].world(root.point)), root.length)
    return RigidBody("+".join(group), mass, inertia, tuple(cylinders), tuple(discs), spin.motion(own), tether)


def _is_free(model: schema.Model, name: str, end: Vector) -> bool:
    """Whether nothing is joined to a body at this end of it."""
    points = [_point(j.parent_point_m) for j in model.joints.values() if j.parent == name]
    points += [_point(j.child_point_m) for j in model.joints.values() if j.child == name]
    return not any(np.allclose(point, end, rtol=0.0, atol=1e-9) for point in points)


def _flexible_link(
    name: str,
    spec: schema.Link,
    flexible: schema.Flexible,
    model: schema.Model,
    frame: Frame,
    tether: Tether,
    spin: _Spin,
) -> FlexibleLink:
    area = math.pi / 4 * spec.diameter_m**2
    second_moment = math.pi / 64 * spec.diameter_m**4
    bending = flexible.bending_stiffness_N_m2
    if bending is None:
        assert flexible.youngs_modulus_Pa is not None  # the schema takes exactly one of the two
        bending = flexible.youngs_modulus_Pa * second_moment
    axial = flexible.axial_stiffness_N
    return FlexibleLink(
        name=name,
        length=spec.length_m,
        diameter=spec.diameter_m,
        mass_per_length=spec.density_kg_m3 * area,
        bending_stiffness=bending,
        axial_stiffness=bending * area / second_moment if axial is None else axial,
        bending_damping=flexible.bending_damping_N_m2_s,
        axial_damping=flexible.axial_damping_N_s,
        elements=flexible.elements,
        motion=spin.motion(frame),
        tether=tether,
        free=_is_free(model, name, np.array([spec.length_m, 0.0])),
    )


def _off_axis(name: str, spec: schema.Link, model: schema.Model) -> Iterator[Fault]:
    """Joints on a flexible link sit at its root or its tip."""
    for joint_name, joint in model.joints.items():
        for side, body, xy in (("parent", joint.parent, joint.parent_point_m), ("child", joint.child, joint.child_point_m)):
            if body == name and tuple(xy) not in ((0.0, 0.0), (spec.length_m, 0.0)):
                yield _fault(
                    f"model.joints.{joint_name}.{side}_point_m",
                    f"got {list(xy)}, but {name} is flexible: allowed are its root [0, 0] and its tip [{spec.length_m:g}, 0]",
                )


def _connections(
    model: schema.Model, frames: dict[str, Frame], homes: dict[str, tuple[str | None, Frame]]
) -> Iterator[Connection]:
    """Joints that are left once welded rigid bodies are one."""
    for name, joint in model.joints.items():
        parent, parent_frame = homes[joint.parent]
        child, child_frame = homes[joint.child]
        if child is None or parent == child:
            continue
        pin = frames[joint.child].world(_point(joint.child_point_m))
        kind = "weld" if isinstance(joint, schema.Weld) else "hinge"
        yield Connection(name, kind, parent, parent_frame.local(pin), child, child_frame.local(pin))


def _ends(rigid: list[RigidBody], links: list[FlexibleLink]) -> Iterator[tuple[str, Vector, Vector]]:
    """Ends of all immersible parts: body, point in its frame, initial world position."""
    for body in rigid:
        for cylinder in body.cylinders:
            for point in (cylinder.start, cylinder.end):
                yield body.name, point, place(body.motion, point)
    for link in links:
        for x in (0.0, link.length):
            point = np.array([x, 0.0])
            yield link.name, point, place(link.motion, point)


def _tip(rigid: list[RigidBody], links: list[FlexibleLink]) -> tuple[str, Vector]:
    """End that is farthest from the origin; of equals the last, which a link's tip is."""
    ends = [(name, point, float(np.linalg.norm(world))) for name, point, world in _ends(rigid, links)]
    if not ends:
        return rigid[0].name, ZERO
    farthest = max(distance for _, _, distance in ends)
    return next((n, p) for n, p, distance in reversed(ends) if distance >= farthest * (1 - 1e-12))


def _surface(
    scenario: schema.Scenario, rigid: list[RigidBody], links: list[FlexibleLink], faults: list[Fault]
) -> float | None:
    """Height of the free surface (m): as given, or where the lowest end of the mechanism touches it."""
    heights = [float(world[1]) for _, _, world in _ends(rigid, links)]
    if scenario.medium is None:
        return scenario.surface_height_m
    if not heights:
        faults.append(_fault("model.bodies", "no part is a cylinder or a link, so the medium has nothing to act on"))
        return None
    lowest = min(heights)
    if scenario.surface_height_m is None:
        return lowest
    if lowest < scenario.surface_height_m - 1e-12:
        faults.append(
            _fault(
                "surface_height_m",
                f"got {scenario.surface_height_m:g} m, but at impact_angle_deg = {scenario.initial.impact_angle_deg:g} the lowest "
                f"end is at {lowest:.6g} m, {scenario.surface_height_m - lowest:.3g} m below the sand: at most {lowest:.6g} m, "
                "or leave the key out",
            )
        )
    return scenario.surface_height_m


def _medium(medium: schema.LeeMarghitu | None) -> LeeMarghitu | None:
    if medium is None:
        return None
    plunging = VerticalResistance(medium.plunging.eta_v, medium.plunging.lambda_)
    withdrawing = plunging
    if medium.withdrawing is not None:
        withdrawing = VerticalResistance(medium.withdrawing.eta_v, medium.withdrawing.lambda_)
    name = medium.name or medium.law
    return LeeMarghitu(medium.density_kg_m3, medium.eta_d, medium.eta_h, plunging, withdrawing, name)


def _load(load: schema.Load) -> Load:
    friction = load.friction
    static = (
        Elastoplastic(friction.yield_displacement_m, friction.damping_time_s)
        if isinstance(friction, schema.Elastoplastic)
        else Smooth(friction.reference_speed_m_s)
    )
    return Load(load.form == "resultant", load.end_cap, load.strips_per_element, load.strips_per_rigid_part, static)
