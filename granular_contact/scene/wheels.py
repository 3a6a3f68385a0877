"""Run of one wheel -> drives of its rig, and notes on it."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from granular_contact.config import schema
from granular_contact.config.schema.mechanism import Rigid
from granular_contact.config.schema.shapes import WheelShape
from granular_contact.config.schema.wheel import rig_of
from granular_contact.errors import Fault, scene_fault
from granular_contact.laws.surface_pressure import SurfacePressure
from granular_contact.scene import signals
from granular_contact.scene.bed import media_layers
from granular_contact.scene.bodies import mass_of
from granular_contact.scene.shapes import effective_radius
from granular_contact.scene.types import Drive
from granular_contact.scene.wheel_test import WheelTest


def wheel_drives(scenario: schema.Scenario, faults: list[Fault]) -> tuple[Drive, ...]:
    """Drives of the rig of a scenario with a `wheel`: for the load, and for the slip or the torque; else none."""
    run, rig = scenario.wheel, None if scenario.wheel is None else rig_of(scenario.model)
    if run is None or rig is None:  # the schema refuses a wheel without a rig
        return ()
    drives = []
    if run.load_N is not None:
        if scenario.gravity_m_s2 <= 0.0:
            words = f"got {run.load_N:g}, but gravity is {scenario.gravity_m_s2:g}: allowed is null"
            faults.append(scene_fault("wheel.load_N", words))
        force = run.load_N - scenario.gravity_m_s2 * _carried_mass(scenario.model, rig.upright)
        drives.append(Drive(rig.upright, "load", signals.Constant(-rig.upward * force)))
    if run.slip is None:
        drives.append(Drive(rig.axle, "load", signals.Constant(run.torque_Nm or 0.0)))
        if run.pull_N != 0.0:
            drives.append(Drive(rig.level, "load", signals.Constant(-rig.ahead * run.pull_N)))
        return tuple(drives)
    assert run.speed_m_s is not None
    rate = run.rate(effective_radius(rig.shape.radius_m, rig.shape.grousers))
    last = 2.0 * scenario.solver.end_time_s  # beyond the run, as the rate of a table is 0 after its last instant
    for joint, speed in ((rig.level, rig.ahead * run.speed_m_s), (rig.axle, rate)):
        steady = signals.piecewise(np.array([0.0, last]), np.array([0.0, speed * last]), False)
        drives.append(Drive(joint, "motion", steady))
    return tuple(drives)


def wheel_test(scenario: schema.Scenario) -> WheelTest | None:
    """Data of the start of a scenario with a `wheel`; None for other scenarios."""
    run, rig = scenario.wheel, rig_of(scenario.model)
    if run is None or rig is None:
        return None
    load = run.load_N or scenario.gravity_m_s2 * _carried_mass(scenario.model, rig.upright)
    body = scenario.model.all_joints[rig.axle].child
    begins = _begins_steadily(scenario, rig.upright)
    if run.slip is None:
        return WheelTest(body, rig.upright, rig.upward, load, begins=begins)
    assert run.speed_m_s is not None
    rate = -run.rate(effective_radius(rig.shape.radius_m, rig.shape.grousers))
    return WheelTest(body, rig.upright, rig.upward, load, run.speed_m_s, rate, begins)


def _begins_steadily(scenario: schema.Scenario, upright: str) -> bool:
    """Whether a wheel starts in steady motion, or with a torque in static equilibrium.

    It does not without a medium or gravity, if the run gives its height, if a spring, stops or friction act in its
    upright joint, or if the surface is not level.
    """
    joint, bed = scenario.model.all_joints[upright], scenario.bed
    held = isinstance(joint, schema.Slider) and (joint.spring or joint.stops or joint.friction)
    uneven = bed is not None and (bed.profile_m is not None or bed.slope_deg != 0.0)
    given = upright in (scenario.initial.joints or {})
    return bool(scenario.media) and scenario.gravity_m_s2 > 0.0 and not (held or uneven or given)


def wheel_notes(scenario: schema.Scenario) -> Iterator[Fault]:
    """Notes on media whose shear stress does not grow with the slip path, if a wheel is driven."""
    if not _has_driven_wheel(scenario):
        return
    for medium, key, *_ in media_layers(scenario):
        if isinstance(medium, SurfacePressure) and not medium.shear_grows:
            words = "is 0, so that the full shear stress acts at once, and the pull of a wheel hardly depends on its "
            words += "slip; give K (m), as in cmu_dry_sand_bekker"
            yield scene_fault(f"{key}.shear_deformation_modulus_m", words)


def _has_driven_wheel(scenario: schema.Scenario) -> bool:
    """Whether the rim of a wheel is driven: by a torque, a positive slip, or a drive of its axle."""
    run, bodies = scenario.wheel, scenario.model.all_bodies
    if run is not None:
        return bool(run.torque_Nm) or (run.slip or 0.0) > 0.0
    driven = (bodies[joint.child] for name, joint in scenario.model.all_joints.items() if name in scenario.drives)
    return any(isinstance(shape, WheelShape) for body in driven if isinstance(body, Rigid) for shape in body.shapes)


def _carried_mass(model: schema.Model, joint: str) -> float:
    """Mass (kg) of all bodies outward of a joint of the tree; 0 if it overflows, which is refused elsewhere."""
    joints, bodies = model.all_joints, model.all_bodies
    remaining, mass = [joints[joint].child], 0.0
    while remaining:
        name = remaining.pop()
        mass += mass_of(name, bodies[name])
        remaining += [outer.child for outer in joints.values() if outer.parent == name]
    return mass if math.isfinite(mass) else 0.0
