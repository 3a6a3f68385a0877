"""Scenario in space -> Scene: place the bodies, merge welded bodies, find the surface, check the geometry."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from granular_contact.config.schema import space as schema
from granular_contact.errors import Fault, SceneError, scene_fault
from granular_contact.laws.law import Law
from granular_contact.sand.space.load import element_kinds, laws_for
from granular_contact.scene.bed import media_layers
from granular_contact.scene.checks import bed_slope_faults, closure_faults, magnitude_faults, media_notes
from granular_contact.scene.drives import drives_of
from granular_contact.scene.layout import GROUND, weld_groups
from granular_contact.scene.loops import close_loops
from granular_contact.scene.methods import check, fits_minimal
from granular_contact.scene.space.beams import beams, with_elements
from granular_contact.scene.space.bed import SpatialBed, bed_of
from granular_contact.scene.space.bodies import bodies_of, joints_of, on_ground, rigid_body
from granular_contact.scene.space.layout import initial_states, pose_of, slides
from granular_contact.scene.space.loops import SpatialLoops, independent_constraints
from granular_contact.scene.space.modes import check as check_modes
from granular_contact.scene.space.types import Part, SpatialRigidBody, SpatialScene, Vector
from granular_contact.scene.steps import steps
from granular_contact.scene.stiff import LEAST_BOW, bow, with_rigid
from granular_contact.scene.types import Minimal

MOST_NAMED = 6  # bodies in a sentence
MOST_BODIES = 32  # up to so many bodies, `output.bodies: auto` reports the motion of every body


def build_spatial(scenario: schema.SpatialScenario) -> SpatialScene:
    """Build the scene of a scenario in space.

    Raises
    ------
    SceneError
        The geometry contradicts itself; every fault names its key and the numbers.
    """
    faults, notes = list[Fault](), list[Fault]()
    model = with_elements(scenario.model)
    solver = steps(scenario)
    drives = drives_of(scenario, solver, faults)
    states = close_loops(SpatialLoops(model), initial_states(scenario, drives, faults), faults, notes)
    constraints = independent_constraints(model, states, drives, faults) if not faults else {}
    media_kinds = {kind for medium, *_ in media_layers(scenario) for kind in element_kinds(medium)}
    bodies = bodies_of(model, media_kinds, scenario.load, faults, notes)
    if faults or bodies is None:
        raise SceneError(faults)
    pose, groups = pose_of(model, states), weld_groups(model)
    rigid = tuple(rigid_body(bodies, group, pose) for group in groups if GROUND not in group)
    if not rigid:
        faults.append(scene_fault("model.joints", "every body is welded to the ground, so nothing can move"))
    faults += closure_faults(model, groups)
    bed = bed_of(scenario, rigid, faults)
    faults += [*bed_slope_faults(scenario), *_law_faults(scenario, rigid)]
    notes += [*media_notes(scenario, bed, "bed.height_map"), *_bar_link_notes(scenario)]
    notes += _beside_map_notes(bed, rigid)
    if faults:
        raise SceneError(faults)
    reduced = scenario.method.reduced
    scene = SpatialScene(
        name=scenario.name or model.name,
        rigid=rigid,
        links=(),
        joints=tuple(joints_of(model, pose, rigid, states, constraints)),
        gravity=scenario.gravity_m_s2,
        bed=bed,
        load=scenario.load,
        solver=solver,
        tip=_tip(model, rigid),
        output_interval=scenario.output.interval_s,
        drives=drives,
        method=scenario.method.chosen if reduced is None else Minimal(),
        modes=None if reduced is None else reduced.modes,
        settle=scenario.initial.settle,
        body_columns=_has_body_columns(scenario, rigid),
        notes=tuple(notes),
        travel=scenario.output.ahead,
        beams=tuple(beams(scenario.model, pose, rigid)),
    )
    if faults := list(magnitude_faults(scene)):
        raise SceneError(faults)
    check(scene)
    check_modes(scene)
    if scene.modes is None and (stiff := tuple(_too_stiff(scene))):
        return replace(build_spatial(with_rigid(scenario, stiff)), stiff=stiff)
    return replace(scene, method=Minimal()) if scenario.method.name == "auto" and fits_minimal(scene) else scene


def _too_stiff(scene: SpatialScene) -> Iterator[str]:
    """Names of links that bend, twist and stretch too little to show."""
    for beam in scene.beams:
        area = math.prod(beam.section) * (0.25 * math.pi if beam.round else 1.0)
        axial = beam.moduli[2] * area if beam.stretches else math.inf
        if bow(scene.force_scale, beam.length, float(min(beam.stiffness)), axial) < LEAST_BOW:
            yield beam.name


def _law_faults(scenario: schema.SpatialScenario, rigid: tuple[SpatialRigidBody, ...]) -> Iterator[Fault]:
    """Faults of shapes without a law for them, media without a shape to act on, balls in layers."""
    media = media_layers(scenario)
    parts = [part for body in rigid for part in body.parts if part.in_sand]
    if not media:
        return
    if not parts:
        words = "no part is a link or a shape in_sand, so the medium has nothing to act on"
        yield scene_fault("model.bodies", words)
        return
    if len({top for *_, top, _ in media}) > 1 and any("ball" in part.meets for part in parts):
        yield scene_fault("bed.layers", "a sphere is met as a whole: no layers are allowed with one")
        return
    for top in sorted({top for *_, top, _ in media}):
        at_top = {key: medium for medium, key, begins, _ in media if begins == top}
        yield from _law_faults_at(top, at_top, parts)


def _law_faults_at(top: float, media: dict[str, Law], parts: list[Part]) -> Iterator[Fault]:
    """Faults of the media (by their keys) of the layer below a depth (m) and of parts, all of which may get there."""
    kinds_of = {key: element_kinds(medium) for key, medium in media.items()}
    taken = {kind for accepted in kinds_of.values() for kind in accepted}
    given = "; ".join(f"{medium.name} takes {_listed(kinds_of[key])}" for key, medium in media.items())
    for name, shape, meets in dict.fromkeys((p.name, type(p.shape).__name__.lower(), p.meets) for p in parts):
        if not taken & set(meets):
            key, reached = f"model.bodies.{name}", f"its {shape} can get into the sand"
            if top > 0.0:
                key, reached = next(iter(media)), f"the {shape} of {name} may get that deep"
            laws = f"laws for it are {', '.join(laws_for(meets))}; in_sand: false leaves a shape out"
            yield scene_fault(key, f"{reached}, but in space {given}; {laws}")
    present = {kind for part in parts for kind in part.meets}
    for key, medium in media.items():
        if not present & set(kinds_of[key]):
            words = f"in space {medium.name} takes {_listed(kinds_of[key])}, and there is nothing of the kind"
            why = "; round links are bars if another medium takes bars" if {"bar"} <= taken & present else ""
            yield scene_fault(key, words + why)


def _beside_map_notes(bed: SpatialBed | None, rigid: tuple[SpatialRigidBody, ...]) -> Iterator[Fault]:
    """Note on bodies that start beside a map of heights, where the surface is level."""
    if bed is None or bed.heights is None:
        return
    low, high = bed.heights.extent
    beside = []
    for body in rigid:
        for part in body.parts:
            xy = (part.points @ body.motion.rotation.T + body.motion.position)[:, :2]
            if part.in_sand and not ((xy >= low) & (xy <= high)).all():
                beside.append(part.name)
    if beside:
        names = ", ".join(list(dict.fromkeys(beside))[:MOST_NAMED])
        yield scene_fault(
            "bed.height_map", f"{bed.heights.place}; beyond it at the start: {names}; corner_m moves the map"
        )


def _bar_link_notes(scenario: schema.SpatialScenario) -> Iterator[Fault]:
    """Notes on media for surfaces that do not act on round links, as these are bars for another medium."""
    media = [(key, medium, element_kinds(medium)) for medium, key, *_ in media_layers(scenario)]
    bar_media = [medium.name for _, medium, accepted in media if "bar" in accepted]
    links = [body for body in scenario.model.all_bodies.values() if isinstance(body, schema.SpatialLink)]
    if not bar_media or not any(link.diameter_m is not None for link in links):
        return
    for key, _, accepted in media:
        if "surface" in accepted and "bar" not in accepted:
            words = f"it does not act on round links, which are bars for {' and '.join(bar_media)}"
            yield scene_fault(key, f"{words}; a rigid one may be a cylinder in shapes instead")


def _listed(accepted: list[str]) -> str:
    """Kinds of shapes, in words."""
    words = {"surface": "surfaces", "bar": "bars", "ball": "spheres"}
    return " and ".join(words[kind] for kind in accepted) or "nothing"


def _tip(model: schema.SpatialModel, rigid: tuple[SpatialRigidBody, ...]) -> tuple[str, Vector]:
    """Body and point (3,) m: the farthest one from the first joint on the ground, or the lowest one if a joint on the
    ground slides or is free.
    """
    in_sand = [(body, part) for body in rigid for part in body.parts if part.in_sand]
    if not in_sand:
        return rigid[0].name, np.zeros(3)
    roots = on_ground(model)
    flies = any(joint.type == "free" or slides(joint) for joint in roots)
    root = np.array(roots[0].parent_point_m)
    greatest, tip = -math.inf, (rigid[0].name, np.zeros(3))
    for body, part in in_sand:
        points = body.motion.world(part.points)
        directions = np.tile([0.0, 0.0, -1.0], (len(points), 1)) if flies else points - root
        distance = part.drop + (-points[:, 2] if flies else np.linalg.norm(directions, axis=1))
        k = int(distance.argmax())
        if distance[k] > greatest + 1e-12:
            drop = 0.0 if part.meets == ("ball",) else part.drop / max(1e-300, float(np.linalg.norm(directions[k])))
            greatest, tip = float(distance[k]), (body.name, body.motion.local(points[k] + drop * directions[k]))
    return tip


def _has_body_columns(scenario: schema.SpatialScenario, rigid: tuple[SpatialRigidBody, ...]) -> bool:
    """Whether the motion of every body is reported."""
    if scenario.output.bodies != "auto":
        return scenario.output.bodies == "all"
    return len([body for body in rigid if not body.is_element]) <= MOST_BODIES
