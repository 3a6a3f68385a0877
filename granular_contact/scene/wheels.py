"""The run of a wheel -> drives of its rig, and what is doubtful about it."""

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
from granular_contact.scene.bed import places
from granular_contact.scene.bodies import mass_of
from granular_contact.scene.shapes import effective_radius
from granular_contact.scene.types import Drive
from granular_contact.scene.wheel_test import WheelTest


def wheel_drives(scenario: schema.Scenario, faults: list[Fault]) -> tuple[Drive, ...]:
    """Drives of the rig of a scenario with a `wheel`: of the load, and of the slip or the torque."""
    run, rig = scenario.wheel, None if scenario.wheel is None else rig_of(scenario.model)
    if run is None or rig is None:  # which the schema refuses
        return ()
    made = []
    if run.load_N is not None:
        if scenario.gravity_m_s2 <= 0.0:
            words = f"got {run.load_N:g}, but gravity is {scenario.gravity_m_s2:g}: allowed is null"
            faults.append(scene_fault("wheel.load_N", words))
        more = run.load_N - scenario.gravity_m_s2 * _carried(scenario.model, rig.upright)
        made.append(Drive(rig.upright, "load", signals.Constant(-rig.upward * more)))
    if run.slip is None:
        made.append(Drive(rig.axle, "load", signals.Constant(run.torque_Nm or 0.0)))
        if run.pull_N != 0.0:
            made.append(Drive(rig.level, "load", signals.Constant(-rig.ahead * run.pull_N)))
        return tuple(made)
    assert run.speed_m_s is not None
    rate = run.rate(effective_radius(rig.shape.radius_m, rig.shape.grousers))
    beyond = 2.0 * scenario.solver.end_time_s
    for joint, speed in ((rig.level, rig.ahead * run.speed_m_s), (rig.axle, rate)):
        steady = signals.piecewise(np.array([0.0, beyond]), np.array([0.0, speed * beyond]), False)
        made.append(Drive(joint, "motion", steady))
    return tuple(made)


def wheel_test(scenario: schema.Scenario) -> WheelTest | None:
    """What a scenario with a `wheel` is to begin with; None of others."""
    run, rig = scenario.wheel, rig_of(scenario.model)
    if run is None or rig is None:
        return None
    load = run.load_N or scenario.gravity_m_s2 * _carried(scenario.model, rig.upright)
    body = scenario.model.all_joints[rig.axle].child
    begins = _begins(scenario, rig.upright)
    if run.slip is None:
        return WheelTest(body, rig.upright, rig.upward, load, begins=begins)
    assert run.speed_m_s is not None
    rate = -run.rate(effective_radius(rig.shape.radius_m, rig.shape.grousers))
    return WheelTest(body, rig.upright, rig.upward, load, run.speed_m_s, rate, begins)


def _begins(scenario: schema.Scenario, upright: str) -> bool:
    """Whether a wheel begins in steady motion: not where the run says how deep, nor where something else holds it."""
    joint, bed = scenario.model.all_joints[upright], scenario.bed
    held = isinstance(joint, schema.Slider) and (joint.spring or joint.stops or joint.friction)
    uneven = bed is not None and (bed.profile_m is not None or bed.slope_deg != 0.0)
    given = upright in (scenario.initial.joints or {})
    return bool(scenario.media) and scenario.gravity_m_s2 > 0.0 and not (held or uneven or given)


def wheel_notes(scenario: schema.Scenario) -> Iterator[Fault]:
    """Media whose shear is there at once, where a wheel is driven."""
    if not _drives_a_wheel(scenario):
        return
    for medium, key, *_ in places(scenario):
        if isinstance(medium, SurfacePressure) and not medium.shear_grows:
            words = "is 0, so that all of the shear is there at once, and the pull of a wheel hardly depends on its "
            words += "slip; give K (m), as cmu_dry_sand_bekker has it"
            yield scene_fault(f"{key}.shear_deformation_modulus_m", words)


def _drives_a_wheel(scenario: schema.Scenario) -> bool:
    """Whether the rim of a wheel is driven: by a torque, a positive slip, or a drive of its axle."""
    run, bodies = scenario.wheel, scenario.model.all_bodies
    if run is not None:
        return bool(run.torque_Nm) or (run.slip or 0.0) > 0.0
    driven = (bodies[joint.child] for name, joint in scenario.model.all_joints.items() if name in scenario.drives)
    return any(isinstance(s, WheelShape) for body in driven if isinstance(body, Rigid) for s in body.shapes)


def _carried(model: schema.Model, joint: str) -> float:
    """Mass (kg) of all that hangs on a joint of the tree."""
    joints, bodies = model.all_joints, model.all_bodies
    on, mass = [joints[joint].child], 0.0
    while on:
        name = on.pop()
        mass += mass_of(name, bodies[name])
        on += [one.child for one in joints.values() if one.parent == name]
    return mass if math.isfinite(mass) else 0.0
