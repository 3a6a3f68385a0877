"""CPU time of loading a robot with many facets: from its URDF and STL files to a system ready to run.

    python validation/robot_loading.py

The robot is a chain of eight links of about 13 000 triangles each, with facets as large as the triangles, all in sand
of 3D-RFT. CPU times are those in a fresh process with compiled kernels in the cache, the least of three processes,
since noise can only add to a time. Bound for everything, with imports: 3 s.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
import time
from itertools import pairwise
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

import numpy as np

from validation.tables import machine, markdown

LINKS, SIZE, BOUND, PROCESSES = 8, 5.7e-3, 3.0, 3  # greatest edge (m), bound (s)
LINK = """<link name="link_{0}"><inertial><mass value="0.5"/><inertia ixx="1e-3" iyy="1e-3" izz="1e-3"/></inertial>
<collision><geometry><mesh filename="link_{0}.stl"/></geometry></collision></link>
"""
JOINT = """<joint name="joint_{0}" type="continuous"><parent link="link_{1}"/><child link="link_{0}"/>
<origin xyz="0.2 0 0"/><axis xyz="0 1 0"/></joint>
"""
RUN = {"medium": "rft3d_sand", "initial": {"joints": {"link_0": {"z_m": 0.1}}}, "solver": {"end_time_s": 0.01}}


def write_robot(folder: Path) -> int:
    """Write the robot, with a sphere for each link; return the number of its triangles."""
    from granular_contact import Sphere

    corners = Sphere(0.15).corners(SIZE)
    record = np.zeros(len(corners), [("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("more", "<u2")])
    record["corners"] = corners
    for i in range(LINKS):
        (folder / f"link_{i}.stl").write_bytes(bytes(80) + np.uint32(len(corners)).tobytes() + record.tobytes())
    parts = [LINK.format(i) for i in range(LINKS)] + [JOINT.format(i, i - 1) for i in range(1, LINKS)]
    (folder / "chain.urdf").write_text(f'<robot name="chain">\n{"".join(parts)}</robot>\n', encoding="utf-8")
    return LINKS * len(corners)


def load_once(urdf: str) -> dict[str, float]:
    """CPU time (s) of each stage in this process."""
    marks = {"": 0.0, "Python and numpy": time.process_time()}
    from granular_contact import config, scene
    from granular_contact.engines.exudyn.build_in_space import build

    marks["importing the package"] = time.process_time()
    loaded = config.load({**RUN, "model": {"urdf": urdf, "facet_size_m": 1.0}})
    marks["load: XML to a checked config"] = time.process_time()
    built = scene.build(loaded)
    marks["build: meshes read and checked, mass, poses"] = time.process_time()
    build(built)  # type: ignore[arg-type]
    marks["ready: facets and clusters, joints, the engine's system"] = time.process_time()
    names = list(marks)
    return {name: marks[name] - marks[before] for before, name in pairwise(names)}


def in_fresh_processes(urdf: str) -> dict[str, float]:
    """Least CPU time (s) of each stage over the processes."""
    repeats = []
    for _ in range(PROCESSES + 1):  # the first process fills the caches
        done = subprocess.run([sys.executable, __file__, urdf], capture_output=True, text=True, check=True)
        repeats.append(json.loads(done.stdout))
    return {name: min(times[name] for times in repeats[1:]) for name in repeats[0]}


def main() -> int:
    """Print the table; return 0 if the bound is kept, else 1."""
    with tempfile.TemporaryDirectory() as folder:
        number = write_robot(Path(folder))
        costs = in_fresh_processes(str(Path(folder, "chain.urdf")))
    costs["together"] = sum(costs.values())
    print(
        f"{machine('trimesh', 'lxml', 'exudyn')}; {number} triangles in {LINKS} links, least of {PROCESSES} processes\n"
    )
    print(markdown(["", "CPU s"], [[name, f"{seconds:.2f}"] for name, seconds in costs.items()]))
    kept = costs["together"] <= BOUND
    print(f"\n{'kept' if kept else 'NOT KEPT'}: {costs['together']:.2f} s of {BOUND:g} s")
    return 0 if kept else 1


if __name__ == "__main__":
    if len(sys.argv) > 1:
        print(json.dumps(load_once(sys.argv[1])))
    else:
        sys.exit(main())
