"""Robots of MuJoCo Menagerie on sand without changes: which of them load, whether they stand, CPU time of a step.

    git clone https://github.com/google-deepmind/mujoco_menagerie
    python validation/menagerie.py mujoco_menagerie [unitree_go1 ...]

The script reads the robot's own file, which has no floor (the floor is in scene.xml), and changes only the time step.
All bodies are in sand with their contact geoms; bodies that have visual geoms only use the convex hull. A robot starts
in its first keyframe, or in its reference configuration, with its lowest point at the surface. Its servos hold that
configuration for 3 s. The speed of sinking is the mean of the last second; the tilt is the rotation of the trunk since
the start. A robot with torque motors and without servos falls, as it does on any ground.

This project contains no file of the Menagerie.
"""

from __future__ import annotations

import sys
import time
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[1]))

import mujoco
import numpy as np

from granular_contact import preset
from granular_contact.errors import GranularContactError
from granular_contact.mujoco import MujocoBed
from validation.tables import machine, markdown

ROBOTS = ("unitree_go1", "unitree_a1", "anybotics_anymal_b", "anybotics_anymal_c", "robotis_op3", "agility_cassie")
STEPS, SECONDS, LAST = (1e-3, 2e-3), 3.0, 1.0  # s


@dataclass(frozen=True)
class Stood:
    """Result of a robot that was put on sand.

    heights: of the trunk at the start of the last second and at the end, m; tilt: rad; carried, weight: force of the
    sand and weight, N; us, alone: CPU time of the bed and of MuJoCo in a step, us; told: warnings.
    """

    facets: int
    weight: float
    carried: float
    heights: tuple[float, float]
    tilt: float
    us: float
    alone: float
    told: tuple[str, ...]


def model_of(folder: Path, step: float) -> Any:
    """MuJoCo model of the robot in a folder, from its file without a floor."""
    (path,) = [
        file for file in sorted(folder.glob("*.xml")) if not file.name.startswith("scene") and "mjx" not in file.name
    ]
    model = mujoco.MjModel.from_xml_path(str(path))
    model.opt.timestep = step
    return model


def start(model: Any, bed: MujocoBed) -> Any:
    """State of the robot in its first keyframe, held by its servos, with its lowest facet at the surface."""
    data = mujoco.MjData(model)
    if model.nkey:
        mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_kinematics(model, data)
    lowest = np.inf
    for line in bed.load.lines:
        number = model.body(line.body.name).id
        lowest = min(
            lowest, float((data.xpos[number] + line.rows[:, :3] @ data.xmat[number].reshape(3, 3).T)[:, 2].min())
        )
    data.qpos[2] -= lowest
    return data


def stand(model: Any) -> Stood:
    """Put a robot on sand and simulate it."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        bed = MujocoBed(model, preset("rft3d_sand"))
        bed.add_geoms(".*", hull=True)
        data = start(model, bed)
        bed.of(data)
    up = data.qpos[3:7].copy()
    spent = {"bed": 0.0, "alone": 0.0}
    before = 0.0
    while data.time < SECONDS:
        if before == 0.0 and data.time >= SECONDS - LAST:
            before = float(data.qpos[2])
        begin = time.process_time()
        bed.apply(data)
        middle = time.process_time()
        mujoco.mj_step(model, data)
        spent["bed"] += middle - begin
        spent["alone"] += time.process_time() - middle
    turn = np.zeros(3)
    mujoco.mju_subQuat(turn, data.qpos[3:7], up)
    count = SECONDS / model.opt.timestep
    return Stood(
        sum(len(line.rows) for line in bed.load.lines),
        float(9.81 * model.body_mass.sum()),
        float(bed.of(data).force[2]),
        (before, float(data.qpos[2])),
        float(np.linalg.norm(turn)),
        1e6 * spent["bed"] / count,
        1e6 * spent["alone"] / count,
        tuple(str(warning.message) for warning in caught),
    )


def rows_of(name: str, folder: Path) -> list[list[str]]:
    """Row of the table for each step, or one row with the reason why the robot does not load."""
    rows = []
    for step in STEPS:
        try:
            model = model_of(folder, step)
            result = stand(model)
        except (GranularContactError, ValueError) as error:
            return [[name, f"{1e3 * step:g}", f"not loaded: {str(error).splitlines()[0]}", *[""] * 7]]
        stands = result.tilt < 0.2 and abs(result.carried / result.weight - 1.0) < 1e-3
        sinks = 1e6 * (result.heights[0] - result.heights[1]) / LAST
        rows.append([
            name, f"{1e3 * step:g}", f"{model.nbody - 1}", f"{result.facets}", "yes" if stands else "falls",
            f"{sinks:.2g}" if stands else "", f"{np.degrees(result.tilt):.1f}",
            f"{result.us:.0f}", f"{result.alone:.0f}", f"{1e6 * step / (result.us + result.alone):.1f}",
        ])  # fmt: skip
        for sentence in result.told:
            print(f"{name}: {sentence}")
    return rows


def main() -> int:
    """Print the table; return 0 if all robots load and all robots with servos stand, else 1."""
    if len(sys.argv) < 2:
        print(__doc__)
        return 2
    root, names = Path(sys.argv[1]), sys.argv[2:] or ROBOTS
    print(f"{machine('mujoco', 'numba')}; {SECONDS:g} s on rft3d_sand\n")
    rows = [row for name in names for row in rows_of(name, root / name)]
    head = ["robot", "step ms", "bodies", "facets", "stands", "sinks um/s", "tilt deg", "bed us", "MuJoCo us"]
    print(markdown([*head, "times real time"], rows))
    failed = [row for row in rows if not (row[4] == "yes" or (row[4] == "falls" and row[0] == "agility_cassie"))]
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
