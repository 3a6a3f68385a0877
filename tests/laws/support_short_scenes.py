"""Short scenes of every law and of every engine; as a script, the numbers of all of them as JSON.

NUMBA_DISABLE_JIT=1 python tests/laws/support_short_scenes.py
"""

from __future__ import annotations

import json
import sys
import traceback
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from support_every_law import sample
from support_runs import scenario_of

import granular_contact
from granular_contact import Floor, Layer, Rft
from granular_contact.laws import lee_marghitu
from granular_contact.laws.catalogue import LAWS
from granular_contact.laws.law import Law
from granular_contact.laws.scatter import Scatter
from granular_contact.run import run
from granular_contact.scene import build

PACKAGE = Path(granular_contact.__file__).parent

SWUNG = """
model:
  name: swung
  bodies:
    arm: {type: rigid, density_kg_m3: 7700, shapes: [SHAPE]}
  joints:
    pivot: {type: hinge, parent: ground, child: arm, friction: {torque_Nm: 0.01}}
surface_height_m: -0.03
initial: {impact_angle_deg: 15, impact_speed_rad_s: 5}
load: {strips_per_rigid_part: 3}
solver: {end_time_s: 1.5e-3, step_s: 5.0e-4, rest_time_s: null}
output: {figures: false}
"""
THROWN = """
model:
  name: thrown
  in_space: true
  bodies:
    body: {type: rigid, density_kg_m3: 2000, shapes: [SHAPE]}
  joints:
    free: {type: free, parent: ground, child: body}
bed: {height_m: 0}
initial: {joints: {free: {z_m: 0.01, rpy_deg: [20, 35, 10], vx_m_s: 0.5, vz_m_s: -1, spin_rad_s: [5, 0, 3]}}}
solver: {end_time_s: 1.0e-3, step_s: 5.0e-4, rest_time_s: null}
output: {figures: false}
"""
ROUND = "{type: cylinder, start_m: [0, 0], end_m: [0.15, 0], diameter_m: 0.008}"
BALL = "{type: sphere, diameter_m: 0.03, center_m: [0.1, -0.01]}"
# Of laws of surfaces, bars and balls: shapes in space, geoms of MuJoCo.
BOX = "{type: box, size_m: [0.06, 0.04, 0.03], facet_size_m: 0.04}"
BAR = "{type: bar, points_m: [[-0.05, 0, 0.01], [0.05, 0, 0]], diameter_m: 0.008}"
SPHERE = "{type: sphere, diameter_m: 0.04, facet_size_m: 0.03}"
ARM = f"""    arm: {{type: rigid, density_kg_m3: 2000, shapes: [{SPHERE}]}}
  joints:
    knee: {{type: hinge, parent: body, child: arm, parent_point_m: [0.04, 0, 0], child_point_m: [-0.03, 0, 0]}}
"""
BALL_JOINT = "type: ball, spring: {stiffness_Nm_per_rad: 0.1}, damping_Nm_s_per_rad: 1.0e-3"
GEOMS = {
    BOX: '<geom name="body" type="box" size="0.03 0.02 0.015" density="2000"/>',
    BAR: '<geom name="body" type="capsule" size="0.004 0.05" euler="0 80 0" density="2000"/>',
    SPHERE: '<geom name="body" type="sphere" size="0.02" density="2000"/>',
}
REDUCED = ("{modes: 1, static: elastoplastic}", "{modes: 1, static: true_sign}", "{modes: 0, static: true_sign}")


def shape_of(law: type[Law]) -> str:
    if "ball" in law.takes:
        return SPHERE
    return BOX if "flat" in law.takes else BAR


def final(text: str, medium: Any, *overrides: str) -> dict[str, float]:
    """Every column at the end of a run."""
    scenario = scenario_of(text, *overrides)
    scenario = scenario.replace(medium) if isinstance(medium, dict) else scenario.replace({"medium": medium})
    results = run(build(scenario), scenario)
    assert results.status.code == "end_time", results.status
    return {column.name: float(results[column.name][-1]) for column in results.columns}


def by_mujoco(geom: str, medium: Any, **options: Any) -> dict[str, float]:
    """Where a body in MuJoCo is after three steps, and what the bed does to it."""
    import mujoco

    from granular_contact.mujoco import MujocoBed

    model = mujoco.MjModel.from_xml_string(
        '<mujoco><option timestep="5e-4"/><worldbody><body name="body" pos="0 0 0.01" euler="0 35 0"><freejoint/>'
        f"{geom}</body></worldbody></mujoco>"
    )
    data, bed = mujoco.MjData(model), MujocoBed(model, medium, **options)
    bed.add_geoms("body", facet_size=None if "plane" in options else 0.04)
    data.qvel[:] = (0.5, 0.0, -1.0, 0.0, 3.0, 0.0) if "plane" in options else (0.5, 0.2, -1.0, 1.0, 2.0, 3.0)
    for _ in range(3):
        kept = bed.apply(data)
        mujoco.mj_step(model, data)
    state = {f"{i}": float(value) for i, value in enumerate((*data.qpos, *data.qvel, *data.xfrc_applied.ravel()))}
    return state | {"work": kept.work, "depth_m": kept.depth}


def laws() -> Iterator[tuple[str, Any]]:
    """Every law in the plane and in space, by name, with what runs it; engines take turns, since laws know none."""
    for turn, (tag, law) in enumerate(LAWS.items()):
        medium, shape = sample(law), shape_of(law)
        flat = SWUNG.replace("SHAPE", BALL if shape == SPHERE else ROUND)
        space, geom = THROWN.replace("SHAPE", shape), GEOMS[shape]
        ways = {
            "engine": lambda text, m=medium, **_: final(text, m, "method=engine"),
            "minimal": lambda text, m=medium, **_: final(text, m, "method=minimal"),
            "mujoco": lambda _, m=medium, g=geom, **options: by_mujoco(g, m, **options),
        }
        methods = [name for name in ways if name != "mujoco" or shape != BAR]  # MuJoCo has no bars in the plane
        method = methods[turn % len(methods)]
        yield f"{tag}, plane, {method}", lambda t=flat, way=ways[method]: way(t, plane=(1, 0, 0))
        method = [*ways][(turn + 1) % len(ways)]
        yield f"{tag}, space, {method}", lambda t=space, way=ways[method]: way(t)
        if "round" in law.takes and not sample(law).needs_path_length:
            yield f"{tag}, plane, reduced", lambda m=medium: reduced(m, REDUCED[0])


def reduced(medium: Any, settings: str) -> dict[str, float]:
    short = ("solver.end_time_s=2e-3", "load.strips_per_element=1", "model.bodies.link.flexible.elements=4")
    return final("pendulum", medium, f"method={{reduced: {settings}}}", *short)


def others() -> Iterator[tuple[str, Any]]:
    """What laws do not show: links that bend, chosen steps, robots and loops in space, layers, floors, scatter."""
    yield "true sign", lambda: reduced({}, REDUCED[1])
    yield "true sign, rigid", lambda: reduced({}, REDUCED[2])
    few = ("load.strips_per_element=1", "model.bodies.link.flexible.elements=2", "solver.end_time_s=1e-3")
    yield "flexible", lambda: final("pendulum", {}, *few)
    for method in ("engine", "minimal"):
        chosen = ("solver.accuracy=1e-2", "solver.step_s=null", f"method={method}")
        yield f"chosen steps, {method}", lambda c=chosen: final(SWUNG.replace("SHAPE", ROUND), "play_sand", *c)
    linked = THROWN.replace("SHAPE", BOX).replace("  joints:\n", ARM)
    yield "joint in space, minimal", lambda: final(linked, sample(LAWS["rft3d"]), "method=minimal")
    sprung = BALL_JOINT.join(linked.split("type: hinge"))
    for method in ("engine", "minimal"):
        way = f"method={method}"
        yield f"ball joint in space, {method}", lambda w=way: final(sprung, sample(LAWS["rft3d"]), w)
    rough = Rft(scatter=Scatter(0.3, 0.02, 1))
    yield "scatter", lambda: final(SWUNG.replace("SHAPE", ROUND), rough, "method=engine")
    yield "scatter in space", lambda: final(THROWN.replace("SHAPE", BOX), rough)
    layers = (Layer(Rft(), 0.0, 0.006), Layer(Rft(zeta=3.0), 0.006))
    yield "layers and a floor in MuJoCo", lambda: by_mujoco(GEOMS[BOX], layers, floor=Floor(-0.012, 2e6, 0.3))
    yield (
        "a floor in the plane in MuJoCo",
        lambda: by_mujoco(GEOMS[BOX], Rft(), plane=(1, 0, 0), floor=Floor(-0.012, 2e4, 0.3)),
    )


def numbers() -> dict[str, dict[str, float]]:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return {name: make() for name, make in (*laws(), *others())}


def walk() -> list[str]:
    """Files and functions from Exudyn's call before a residual to the drag on a strip; where nothing is compiled."""
    names_called: list[str] = []
    drag = lee_marghitu.drag_force

    def noting(*arguments: Any) -> None:
        frames = [(Path(frame.filename), frame.name) for frame in traceback.extract_stack()[:-1]]
        names, functions = [path.name for path, _ in frames], {name for _, name in frames}
        if not names_called and "predictor.py" in names and "evaluate" in functions:
            called = [*frames[names.index("predictor.py") :], (PACKAGE / "laws" / "lee_marghitu.py", "drag_force")]
            names_called.extend(f"{path.relative_to(PACKAGE).as_posix()} {name}" for path, name in called)
        drag(*arguments)

    lee_marghitu.drag_force = noting
    try:
        final("pendulum", {}, "solver.end_time_s=2e-3")
    finally:
        lee_marghitu.drag_force = drag
    return names_called


if __name__ == "__main__":
    json.dump({"numbers": numbers(), "walk": walk()}, sys.stdout)
