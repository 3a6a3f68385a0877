"""Scenario in space -> Scene: place the bodies, merge what is welded, find the surface, check the geometry."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from granular_contact.config.schema import space as schema
from granular_contact.errors import Fault, SceneError, scene_fault
from granular_contact.laws.law import Law
from granular_contact.sand.space.load import kinds, laws_for
from granular_contact.scene.bed import places
from granular_contact.scene.checks import beyond_numbers, closure_faults, media_notes, too_steep
from granular_contact.scene.drives import drives
from granular_contact.scene.layout import GROUND, weld_groups
from granular_contact.scene.loops import closed
from granular_contact.scene.methods import check, serves
from granular_contact.scene.space.beams import beams, cut
from granular_contact.scene.space.bed import SpatialBed, bed
from granular_contact.scene.space.bodies import bodies_of, joints_of, on_ground, rigid_body
from granular_contact.scene.space.layout import pose, slides, start
from granular_contact.scene.space.loops import SpatialLoops, needed
from granular_contact.scene.space.modes import check as check_modes
from granular_contact.scene.space.types import Part, SpatialRigidBody, SpatialScene, Vector
from granular_contact.scene.steps import steps
from granular_contact.scene.stiff import LEAST_BOW, bow, with_rigid
from granular_contact.scene.types import Minimal

MOST_NAMED = 6  # bodies in a sentence
MOST_BODIES = 32  # whose motion is reported unless the run asks for it


def built(scenario: schema.SpatialScenario) -> SpatialScene:
    """Scene of a scenario in space.

    Raises
    ------
    SceneError
        The geometry contradicts itself; every fault names its key and the numbers.
    """
    faults, notes = list[Fault](), list[Fault]()
    model = cut(scenario.model)
    solver = steps(scenario)
    driven = drives(scenario, solver, faults)
    states = closed(SpatialLoops(model), start(scenario, driven, faults), faults, notes)
    held = needed(model, states, driven, faults) if not faults else {}
    met = {kind for medium, *_ in places(scenario) for kind in kinds(medium)}
    made = bodies_of(model, met, scenario.load, faults, notes)
    if faults or made is None:
        raise SceneError(faults)
    placed, groups = pose(model, states), weld_groups(model)
    rigid = tuple(rigid_body(made, group, placed) for group in groups if GROUND not in group)
    if not rigid:
        faults.append(scene_fault("model.joints", "every body is welded to the ground, so nothing can move"))
    faults += closure_faults(model, groups)
    surface = bed(scenario, rigid, faults)
    faults += [*too_steep(scenario), *_inapplicable(scenario, rigid)]
    notes += [*media_notes(scenario, surface, "bed.height_map"), *_links_as_bars(scenario)]
    notes += _beside_map(surface, rigid)
    if faults:
        raise SceneError(faults)
    reduced = scenario.method.reduced
    scene = SpatialScene(
        name=scenario.name or model.name,
        rigid=rigid,
        links=(),
        joints=tuple(joints_of(model, placed, rigid, states, held)),
        gravity=scenario.gravity_m_s2,
        bed=surface,
        load=scenario.load,
        solver=solver,
        tip=_tip(model, rigid),
        output_interval=scenario.output.interval_s,
        drives=driven,
        method=scenario.method.chosen if reduced is None else Minimal(),
        modes=None if reduced is None else reduced.modes,
        settle=scenario.initial.settle,
        body_columns=_has_body_columns(scenario, rigid),
        notes=tuple(notes),
        travel=scenario.output.ahead,
        beams=tuple(beams(scenario.model, placed, rigid)),
    )
    if faults := list(beyond_numbers(scene)):
        raise SceneError(faults)
    check(scene)
    check_modes(scene)
    if scene.modes is None and (stiff := tuple(_too_stiff(scene))):
        return replace(built(with_rigid(scenario, stiff)), stiff=stiff)
    return replace(scene, method=Minimal()) if scenario.method.name == "auto" and serves(scene) else scene


def _too_stiff(scene: SpatialScene) -> Iterator[str]:
    """Links that bend, twist and stretch too little to show."""
    for beam in scene.beams:
        area = math.prod(beam.section) * (0.25 * math.pi if beam.round else 1.0)
        axial = beam.moduli[2] * area if beam.stretches else math.inf
        if bow(scene.force_scale, beam.length, float(min(beam.stiffness)), axial) < LEAST_BOW:
            yield beam.name


def _inapplicable(scenario: schema.SpatialScenario, rigid: tuple[SpatialRigidBody, ...]) -> Iterator[Fault]:
    """Shapes without a law that takes them, and media without a shape to act on."""
    given = places(scenario)
    parts = [part for body in rigid for part in body.parts if part.in_sand]
    if not given:
        return
    if not parts:
        words = "no part is a link or a shape in_sand, so the medium has nothing to act on"
        yield scene_fault("model.bodies", words)
        return
    if len({top for *_, top, _ in given}) > 1 and any("ball" in part.meets for part in parts):
        yield scene_fault("bed.layers", "a sphere is met as a whole: no layers are allowed with one")
        return
    for top in sorted({top for *_, top, _ in given}):
        here = {key: one for one, key, begins, _ in given if begins == top}
        yield from _inapplicable_at(top, here, parts)


def _inapplicable_at(top: float, here: dict[str, Law], parts: list[Part]) -> Iterator[Fault]:
    """Mismatches between the media that begin at a depth (m), by their keys, and parts, all of which may get there."""
    media = {key: (one, kinds(one)) for key, one in here.items()}
    taken = {kind for _, found in media.values() for kind in found}
    accepted = "; ".join(f"{one.name} takes {_listed(found)}" for one, found in media.values())
    for name, shape, meets in dict.fromkeys((p.name, type(p.shape).__name__.lower(), p.meets) for p in parts):
        if not taken & set(meets):
            key, what = f"model.bodies.{name}", f"its {shape} can get into the sand"
            if top > 0.0:
                key, what = next(iter(media)), f"the {shape} of {name} may get that deep"
            fit = f"laws for it are {', '.join(laws_for(meets))}; in_sand: false leaves a shape out"
            yield scene_fault(key, f"{what}, but in space {accepted}; {fit}")
    met = {kind for part in parts for kind in part.meets}
    for key, (one, found) in media.items():
        if not met & set(found):
            words = f"in space {one.name} takes {_listed(found)}, and there is nothing of the kind"
            why = "; round links are bars beside a medium that takes these" if {"bar"} <= taken & met else ""
            yield scene_fault(key, words + why)


def _beside_map(surface: SpatialBed | None, rigid: tuple[SpatialRigidBody, ...]) -> Iterator[Fault]:
    """Bodies that begin beside a map of heights, above or below a surface that is level there."""
    if surface is None or surface.heights is None:
        return
    low, high = surface.heights.extent
    beside = []
    for body in rigid:
        for part in body.parts:
            at = (part.points @ body.motion.rotation.T + body.motion.position)[:, :2]
            if part.in_sand and not ((at >= low) & (at <= high)).all():
                beside.append(part.name)
    if beside:
        (a, b), (c, d) = low, high
        some = ", ".join(list(dict.fromkeys(beside))[:MOST_NAMED])
        words = f"the map is from x = {a:g} to {c:g} m and from y = {b:g} to {d:g} m, and the ground level beyond;"
        yield scene_fault("bed.height_map", f"{words} there at the start: {some}; corner_m moves the map")


def _links_as_bars(scenario: schema.SpatialScenario) -> Iterator[Fault]:
    """Media of surfaces that do not act on round links, as these are bars for another medium."""
    media = [(key, medium, kinds(medium)) for medium, key, *_ in places(scenario)]
    of_bars = [medium.name for _, medium, found in media if "bar" in found]
    links = [body for body in scenario.model.all_bodies.values() if isinstance(body, schema.SpatialLink)]
    if not of_bars or not any(link.diameter_m is not None for link in links):
        return
    for key, _, found in media:
        if "surface" in found and "bar" not in found:
            words = f"it does not act on round links, which are bars for {' and '.join(of_bars)}"
            yield scene_fault(key, f"{words}; a rigid one may be a cylinder in shapes instead")


def _listed(found: list[str]) -> str:
    words = {"surface": "surfaces", "bar": "bars", "ball": "spheres"}
    return " and ".join(words[kind] for kind in found) or "nothing"


def _tip(model: schema.SpatialModel, rigid: tuple[SpatialRigidBody, ...]) -> tuple[str, Vector]:
    """Point that is lowest, or farthest from the first joint on the ground where none slides or is free there."""
    ends = [(body, part) for body in rigid for part in body.parts if part.in_sand]
    if not ends:
        return rigid[0].name, np.zeros(3)
    roots = on_ground(model)
    flies = any(joint.type == "free" or slides(joint) for joint in roots)
    root = np.array(roots[0].parent_point_m)
    best, found = -math.inf, (rigid[0].name, np.zeros(3))
    for body, part in ends:
        placed = body.motion.world(part.points)
        ways = np.tile([0.0, 0.0, -1.0], (len(placed), 1)) if flies else placed - root
        score = part.drop + (-placed[:, 2] if flies else np.linalg.norm(ways, axis=1))
        k = int(score.argmax())
        if score[k] > best + 1e-12:
            drop = 0.0 if part.meets == ("ball",) else part.drop / max(1e-300, float(np.linalg.norm(ways[k])))
            best, found = float(score[k]), (body.name, body.motion.local(placed[k] + drop * ways[k]))
    return found


def _has_body_columns(scenario: schema.SpatialScenario, rigid: tuple[SpatialRigidBody, ...]) -> bool:
    """Whether the motion of every body is reported."""
    if scenario.output.bodies != "auto":
        return scenario.output.bodies == "all"
    return len([body for body in rigid if not body.is_element]) <= MOST_BODIES
