"""What of a model doubles the sand, or keeps it from acting: one line each, as a warning.

And what is refused: data of another model, bodies that are not in it or cannot move.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from granular_contact.engines.mujoco.engine import mujoco, name_of
from granular_contact.errors import scene_error

Vector = NDArray[np.float64]
AT = 1e-3  # m below the surface, to which a rigid floor still carries what should stand on sand


def warnings_of(model: Any, bodies: Iterable[int], height: Any, up: Vector) -> Iterator[str]:
    """Sentences on a model whose bodies (numbers) are in sand; height(x): of its surface at x (3,) m."""
    numbers = list(bodies)
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    yield from _floors(model, data, set(numbers), height, up)
    yield from _fixed(model, numbers)


def movable(model: Any, name: str | int) -> int:
    """Number of a body by its name or number; one that the model has, and that is not fixed to the world."""
    number = name if isinstance(name, int) else mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, name)
    if not 0 < number < model.nbody:
        known = ", ".join(name_of(model, "body", n) for n in range(1, model.nbody))
        raise scene_error("bed", f"got the body {name!r}, the model has {known or 'none'}")
    if int(model.body_weldid[number]) == 0:
        raise scene_error("bed", f"body {name} is fixed to the world: sand does not move it (a missing <freejoint/>?)")
    return number


def refuse_other(model: Any, data: Any) -> None:
    """Refuse an MjData of another model, as its sizes tell."""
    sizes = [(len(data.qpos), len(data.qvel), len(data.xpos)), (model.nq, model.nv, model.nbody)]
    if sizes[0] != sizes[1]:
        got, own = ("{} coordinates, {} velocities and {} bodies".format(*size) for size in sizes)
        raise scene_error("bed", f"got data of another model, with {got}; that of the bed has {own}")


def _floors(model: Any, data: Any, bodies: set[int], height: Any, up: Vector) -> Iterator[str]:
    """Rigid geoms of the world, at the surface or above it, that bodies in the sand can touch."""
    colliding = [g for g in range(model.ngeom) if int(model.geom_bodyid[g]) in bodies]
    for g in range(model.ngeom):
        if int(model.body_weldid[model.geom_bodyid[g]]) != 0:
            continue
        touching = [b for b in colliding if _pair(model, g, b)]
        if not touching:
            continue
        place, turn = data.geom_xpos[g], data.geom_xmat[g].reshape(3, 3)
        top = float(place @ up + _reach(model, g, turn.T @ up))
        bottom = float(place @ up - _reach(model, g, turn.T @ up)) if _is_closed(model, g) else -np.inf
        if bottom <= height(place) + AT and top >= height(place) - AT:
            yield (
                f"geom {name_of(model, 'geom', g)} is rigid at the surface of the sand and carries "
                f"{name_of(model, 'body', int(model.geom_bodyid[touching[0]]))} instead of it: remove it, or set its "
                "contype and conaffinity to 0"
            )
    for p in range(model.npair):
        one, two = int(model.pair_geom1[p]), int(model.pair_geom2[p])
        for sand, other in ((one, two), (two, one)):
            if int(model.geom_bodyid[sand]) in bodies and int(model.body_weldid[model.geom_bodyid[other]]) == 0:
                yield (
                    f"contact pair {p} of geoms {name_of(model, 'geom', sand)} and {name_of(model, 'geom', other)} "
                    "is left on beside the sand: remove it"
                )


def _is_closed(model: Any, g: int) -> bool:
    return int(model.geom_type[g]) not in (mujoco.mjtGeom.mjGEOM_PLANE, mujoco.mjtGeom.mjGEOM_HFIELD)


def _reach(model: Any, g: int, direction: Vector) -> float:
    """How far a geom reaches from its centre (m) along a direction (3,) of its frame."""
    kind, size, geom = int(model.geom_type[g]), model.geom_size[g], mujoco.mjtGeom
    if kind == geom.mjGEOM_PLANE:
        return 0.0
    if kind == geom.mjGEOM_HFIELD:
        return float(model.hfield_size[model.geom_dataid[g], 2])
    if kind == geom.mjGEOM_BOX:
        return float(np.abs(direction) @ size)
    return float(model.geom_rbound[g])


def _pair(model: Any, a: int, b: int) -> bool:
    """Whether two geoms can touch by their types."""
    return bool(model.geom_contype[a] & model.geom_conaffinity[b] or model.geom_contype[b] & model.geom_conaffinity[a])


def _fixed(model: Any, bodies: list[int]) -> Iterator[str]:
    """Mechanisms whose first body has no joint, while others of it are in the sand, or was made a part of the world."""
    tops = list(dict.fromkeys(int(model.body_rootid[b]) for b in bodies))
    for top in tops:
        if model.body_dofnum[top] == 0:
            yield (
                f"body {name_of(model, 'body', top)} is fixed to the world, so its limbs move in the sand and it does "
                "not: if it should walk, give it a <freejoint/>"
            )
    hinged = [name_of(model, "body", top) for top in tops if _is_hinged(model, top)]
    if len(hinged) > 1:
        yield (
            f"bodies {', '.join(hinged)} turn on hinges of the world: if they are limbs of one robot, as of a URDF, "
            "whose first link MuJoCo makes a part of the world, give that a <freejoint/>"
        )


def _is_hinged(model: Any, body: int) -> bool:
    """Whether a body has hinges, and no other joint."""
    first, count = int(model.body_jntadr[body]), int(model.body_jntnum[body])
    kinds = model.jnt_type[first : first + count]
    return count > 0 and bool((kinds == int(mujoco.mjtJoint.mjJNT_HINGE)).all())
