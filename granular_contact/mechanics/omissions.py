"""Omissions: what a run leaves out and why, from the system as built and from its trajectory."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from typing import Any

from granular_contact.laws.law import Law
from granular_contact.laws.lee_marghitu import VerticalResistance
from granular_contact.mechanics.system import System, Trajectory
from granular_contact.scene.stiff import LEAST_BOW
from granular_contact.scene.types import link_of
from granular_contact.scene.workspace import can_be_immersed

# Packages that are imported only where they are used, and the reason if they are not.
PACKAGES = (
    ("numba", "no force of a medium was compiled"),
    ("matplotlib", "the run itself draws nothing"),
    ("scipy", "no use"),
)

# Coefficients of media that are factors of a force.
FACTORS = (
    *("eta_d", "eta_h", "mu_surf", "lam"),
    *("drag", "stiffness", "friction", "viscosity", "yield_force", "constant_force"),
)


def left_out(system: System, trajectory: Trajectory) -> Iterator[str]:
    """Yield sentences on what a run leaves out."""
    for name in system.scene.stiff:
        yield f"beam of {name}: it would bend by less than {LEAST_BOW:g} of its length, so it is rigid"
    if not system.scene.bends and not system.scene.stiff:
        yield "beams: no body is flexible, so there are no cable elements and no elastic energies"
    if system.scene.gravity == 0.0:
        yield "weight: gravity is 0, so no body has a load for it"
    yield from _joints(system)
    yield from _bed(system, trajectory)
    yield from _rest(trajectory)
    yield from (f"{name}: not imported; {why}" for name, why in PACKAGES if name not in sys.modules)


def _joints(system: System) -> Iterator[str]:
    """Yield sentences on joints without forces and on settling."""
    acting = {*system.loads, *system.motions}
    free = [joint.name for joint in system.scene.joints if joint.is_idle and joint.name not in acting]
    if free:
        yield f"loads in joints: {', '.join(free)}: no spring, damping, friction, stop or drive"
    if not system.scene.settle:
        yield "settling: not asked for"


def _bed(system: System, trajectory: Trajectory) -> Iterator[str]:
    """Yield sentences on shapes, elements, terms and faces on which no load acts."""
    scene = system.scene
    if trajectory.load is None:
        if not scene.media:
            yield "the bed: there is no medium"
        else:
            yield "the bed: no shape of any body reaches the surface, however the joints turn"
        return
    assert scene.bed is not None  # as there is a load
    loaded = set() if system.bed is None else set(system.bed.nodes)
    for handle in system.rigid.values():
        body: Any = handle.body
        shapes = body.parts if scene.in_space else body.shapes
        outside, inside = [s for s in shapes if not s.in_sand], [s for s in shapes if s.in_sand]
        far = [] if scene.in_space else [s for s in inside if not can_be_immersed(scene.bed, body, s)]
        for unloaded, why in ((far, "cannot reach the surface"), (outside, "meet no medium (in_sand: false)")):
            if unloaded:
                yield f"load on {handle.body.name}: {len(unloaded)} of its {len(shapes)} shapes {why}"
    for link in system.links.values():
        bare = sum(not {a, b} <= loaded for a, b in zip(link.nodes, link.nodes[1:], strict=False))
        if bare:
            yield f"load on {link.link.name}: {bare} of its {len(link.elements)} elements cannot reach the surface"
    for medium in scene.media:
        names = list(_zeros(medium))
        if names:
            yield f"terms of {medium.name}: {', '.join(names)} = 0, so they add nothing"
    if scene.load.end_cap and not any(hasattr(medium, "cap_force") for medium in scene.media):
        yield f"end caps: {', '.join(medium.name for medium in scene.media)} have no force on end faces"
    if scene.bed.floor is None:
        yield "contact with a floor: there is no stiff one"


def _zeros(medium: Law) -> Iterator[str]:
    """Yield the coefficients of a medium that are 0, so that a force vanishes, as keys of YAML without units."""
    for name, value in vars(medium).items():
        if isinstance(value, VerticalResistance):
            if value.eta_v == 0.0:
                yield f"{name}.eta_v"
        elif name in FACTORS and value == 0.0:
            yield "lambda" if name == "lam" else name


def _rest(trajectory: Trajectory) -> Iterator[str]:
    """Yield sentences on instants without contact and bodies that were never immersed."""
    load = trajectory.load
    if load is None:
        return
    dry, steps = int((load.depth <= 0.0).sum()), len(load.time)
    if dry:
        yield f"forces of the medium: nothing was immersed at {dry} of {steps} instants: the load was not evaluated"
    immersed = {link_of(body) for body, _, _ in load.immersed}
    never = {link_of(body) for body in load.body_names} - immersed
    if never:
        yield f"forces on {', '.join(sorted(never))}: laid out, but never immersed in this run"
