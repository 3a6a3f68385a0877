"""Checks of a MuJoCo model for a bed.

Warnings: rigid geoms that carry bodies in place of the sand, and joints that keep mechanisms from moving. Errors: data
of another model, and bodies that the model does not have or that cannot move.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from granular_contact.engines.mujoco.engine import mujoco, name_of
from granular_contact.errors import scene_error

Vector = NDArray[np.float64]
NEAR = 1e-3  # m: a rigid geom within this distance of the surface carries bodies that should stand on sand


def warnings_of(model: Any, bodies: Iterable[int], height: Any, up: Vector) -> Iterator[str]:
    """Warnings of a model whose bodies (numbers) are in sand.

    height: function of a position (3,) m that returns the height (m) of the surface along up. up (3,): unit vector,
    world frame.
    """
    numbers = list(bodies)
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    yield from _floors(model, data, set(numbers), height, up)
    yield from _fixed(model, numbers)


def movable(model: Any, name: str | int) -> int:
    """Number of a body, by its name or number; SceneError if the model has none such, or it is fixed to the world."""
    number = name if isinstance(name, int) else mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, name)
    if not 0 < number < model.nbody:
        known = ", ".join(name_of(model, "body", n) for n in range(1, model.nbody))
        raise scene_error("bed", f"got the body {name!r}, the model has {known or 'none'}")
    if int(model.body_weldid[number]) == 0:
        raise scene_error("bed", f"body {name} is fixed to the world: sand does not move it (a missing <freejoint/>?)")
    return number


def refuse_other(model: Any, data: Any) -> None:
    """Raise SceneError if the sizes of an MjData are not those of the model."""
    sizes = [(len(data.qpos), len(data.qvel), len(data.xpos)), (model.nq, model.nv, model.nbody)]
    if sizes[0] != sizes[1]:
        got, own = ("{} coordinates, {} velocities and {} bodies".format(*size) for size in sizes)
        raise scene_error("bed", f"got data of another model, with {got}; that of the bed has {own}")


def _floors(model: Any, data: Any, bodies: set[int], height: Any, up: Vector) -> Iterator[str]:
    """Warnings of rigid geoms of the world at the surface that bodies in sand can touch, and of such contact pairs."""
    colliding = [g for g in range(model.ngeom) if int(model.geom_bodyid[g]) in bodies]
    for g in range(model.ngeom):
        if int(model.body_weldid[model.geom_bodyid[g]]) != 0:
            continue
        touching = [b for b in colliding if _can_touch(model, g, b)]
        if not touching:
            continue
        position, axes = data.geom_xpos[g], data.geom_xmat[g].reshape(3, 3)
        top = float(position @ up + _reach(model, g, axes.T @ up))
        bottom = float(position @ up - _reach(model, g, axes.T @ up)) if _is_closed(model, g) else -np.inf
        if bottom <= height(position) + NEAR and top >= height(position) - NEAR:
            yield (
                f"geom {name_of(model, 'geom', g)} is rigid at the surface of the sand and carries "
                f"{name_of(model, 'body', int(model.geom_bodyid[touching[0]]))} instead of it: remove it, or set its "
                "contype and conaffinity to 0"
            )
    for p in range(model.npair):
        first, second = int(model.pair_geom1[p]), int(model.pair_geom2[p])
        for in_sand, other in ((first, second), (second, first)):
            if int(model.geom_bodyid[in_sand]) in bodies and int(model.body_weldid[model.geom_bodyid[other]]) == 0:
                yield (
                    f"contact pair {p} of geoms {name_of(model, 'geom', in_sand)} and {name_of(model, 'geom', other)} "
                    "is left on beside the sand: remove it"
                )


def _is_closed(model: Any, g: int) -> bool:
    """Whether a geom has a lower side: planes and height fields have none."""
    return int(model.geom_type[g]) not in (mujoco.mjtGeom.mjGEOM_PLANE, mujoco.mjtGeom.mjGEOM_HFIELD)


def _reach(model: Any, g: int, direction: Vector) -> float:
    """Distance (m) that a geom reaches from its centre along a direction (3,) in its frame; an upper bound for most."""
    kind, size, geom = int(model.geom_type[g]), model.geom_size[g], mujoco.mjtGeom
    if kind == geom.mjGEOM_PLANE:
        return 0.0
    if kind == geom.mjGEOM_HFIELD:
        return float(model.hfield_size[model.geom_dataid[g], 2])
    if kind == geom.mjGEOM_BOX:
        return float(np.abs(direction) @ size)
    return float(model.geom_rbound[g])


def _can_touch(model: Any, a: int, b: int) -> bool:
    """Whether two geoms can touch by their contact types and affinities."""
    return bool(model.geom_contype[a] & model.geom_conaffinity[b] or model.geom_contype[b] & model.geom_conaffinity[a])


def _fixed(model: Any, bodies: list[int]) -> Iterator[str]:
    """Warnings of mechanisms with bodies in sand whose first body has no joint, or was merged with the world."""
    roots = list(dict.fromkeys(int(model.body_rootid[b]) for b in bodies))
    for root in roots:
        if model.body_dofnum[root] == 0:
            yield (
                f"body {name_of(model, 'body', root)} is fixed to the world, so its limbs move in the sand and it does "
                "not: if it should walk, give it a <freejoint/>"
            )
    hinged = [name_of(model, "body", root) for root in roots if _is_hinged(model, root)]
    if len(hinged) > 1:
        yield (
            f"bodies {', '.join(hinged)} turn on hinges of the world: if they are limbs of one robot, as of a URDF, "
            "whose first link MuJoCo makes a part of the world, give that a <freejoint/>"
        )


def _is_hinged(model: Any, body: int) -> bool:
    """Whether a body has hinges and no other joints."""
    first, count = int(model.body_jntadr[body]), int(model.body_jntnum[body])
    kinds = model.jnt_type[first : first + count]
    return count > 0 and bool((kinds == int(mujoco.mjtJoint.mjJNT_HINGE)).all())
