"""Makes the hexapod: meshes of its trunk and its C-leg, and the URDF that puts one trunk and six legs together.

    python models/hexapod/make_hexapod.py

writes hexapod.urdf and meshes/*.stl beside this file. All sizes and masses are ours. Masses, centres and inertias are
those of the meshes, each of one density. Needs numpy alone.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

HERE = Path(__file__).parent
# Trunk: section in the x-z plane, m; its nose and tail rise so that it can slide. The hips are at z = 0.
TRUNK = np.array([[-0.12, 0.0], [-0.09, -0.018], [0.09, -0.018], [0.12, 0.0], [0.12, 0.018], [-0.12, 0.018]])
TRUNK_WIDTH, TRUNK_MASS = 0.10, 1.2  # m, kg
# C-leg: half a circle from the hip down to the toe, its back behind (x < 0) when the toe points down.
RADIUS, THICKNESS, LEG_WIDTH, LEG_MASS = 0.03, 0.004, 0.02, 0.04
SEGMENTS = 12
HIPS = {f"{place}_{side}": (x, y) for place, x in (("front", 0.09), ("middle", 0.0), ("rear", -0.09))
        for side, y in (("left", 0.064), ("right", -0.064))}  # fmt: skip
EFFORT, RATE = 2.0, 30.0  # N m, rad/s
ROUND_OFF = 1e-12  # of the largest of some numbers: smaller ones mean nothing


def prism(section: np.ndarray, width: float) -> np.ndarray:
    """Triangles (n, 3, 3) of a section (k, 2) in the x-z plane, convex or a C, along y; outward."""
    x, z = section.T
    if np.sum(x * np.roll(z, -1) - z * np.roll(x, -1)) > 0.0:
        section = section[::-1]
    near, far = (
        np.column_stack([section[:, 0], np.full(len(section), y), section[:, 1]]) for y in (-width / 2, width / 2)
    )
    sides = []
    for i in range(len(section)):
        j = (i + 1) % len(section)
        sides += [[near[i], near[j], far[j]], [near[i], far[j], far[i]]]
    return np.array(sides + _caps(near, far))


def _caps(near: np.ndarray, far: np.ndarray) -> list[list[np.ndarray]]:
    """Both ends, cut into strips between the first half of the corners and the second, backwards."""
    count, found = len(near), []
    for k in range((count - 1) // 2):
        a, b, c, d = k, k + 1, count - 2 - k, count - 1 - k
        for corners in ((a, d, c), (a, c, b)) if b != c else ((a, d, b),):
            found.append([near[i] for i in corners])
            found.append([far[i] for i in reversed(corners)])
    return found


def c_section() -> np.ndarray:
    """Section (2 k, 2) m of the C-leg: its outer side from the hip to the toe, then the inner one back."""
    angles = np.linspace(0.5 * np.pi, 1.5 * np.pi, SEGMENTS + 1)
    around = np.column_stack([np.cos(angles), np.sin(angles)])
    outer, inner = ((RADIUS + side * THICKNESS / 2) * around for side in (1, -1))
    return np.vstack([outer, inner[::-1]]) - [0.0, RADIUS]


def mass_properties(corners: np.ndarray, mass: float) -> tuple[np.ndarray, np.ndarray]:
    """Centre (3,) m and inertia (3, 3) kg m^2 about it of a closed mesh (n, 3, 3), by tetrahedra from the origin."""
    volumes = np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6.0
    assert volumes.sum() > 0.0, "inside out"
    sums = corners.sum(axis=1)
    center = volumes @ sums / (4.0 * volumes.sum())
    # Integral of x x^T over a tetrahedron with one corner at the origin: V/20 (sum_i c_i c_i^T + s s^T).
    second = np.einsum("n,nki,nkj->ij", volumes, corners, corners) + np.einsum("n,ni,nj->ij", volumes, sums, sums)
    second = mass / volumes.sum() * second / 20.0 - mass * np.outer(center, center)
    return center, np.trace(second) * np.eye(3) - second


def cleared(values: np.ndarray) -> np.ndarray:
    """Values, but 0 for those that are only round-off of the largest: their digits differ between processors."""
    return np.where(np.abs(values) < ROUND_OFF * np.abs(values).max(), 0.0, values)


def write_stl(path: Path, corners: np.ndarray) -> None:
    """Write a binary STL file (m)."""
    record = np.zeros(len(corners), np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("more", "<u2")]))
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    record["normal"] = cleared(cross / np.linalg.norm(cross, axis=1, keepdims=True))
    record["corners"] = cleared(corners)
    path.parent.mkdir(exist_ok=True)
    path.write_bytes(b"hexapod, ours".ljust(80, b"\0") + np.uint32(len(corners)).tobytes() + record.tobytes())


def link(name: str, mesh: str, mass: float, corners: np.ndarray) -> str:
    """A link whose shape, in pictures and in sand, is a mesh; on the right its mirror image, triangle by triangle."""
    center, tensor = mass_properties(corners, mass)
    x, y, z = np.where(np.abs(center) < ROUND_OFF * np.abs(corners).max(), 0.0, center)
    tensor = cleared(tensor)
    moments = " ".join(
        f'i{a}{b}="{tensor["xyz".index(a), "xyz".index(b)]:.6g}"' for a, b in ("xx", "yy", "zz", "xy", "xz", "yz")
    )
    scale = ' scale="1 -1 1"' if name.endswith("right") else ""
    geometry = f'<geometry><mesh filename="meshes/{mesh}.stl"{scale}/></geometry>'
    return f"""  <link name="{name}">
    <inertial>
      <origin xyz="{x:.6g} {y:.6g} {z:.6g}"/>
      <mass value="{mass}"/>
      <inertia {moments}/>
    </inertial>
    <visual>{geometry}</visual>
    <collision>{geometry}</collision>
  </link>
"""


def hip(name: str, place: tuple[float, float]) -> str:
    """The joint of a leg; a positive angle swings the toe back, so that a positive rate walks ahead."""
    x, y = place
    return f"""  <joint name="hip_{name}" type="continuous">
    <parent link="trunk"/>
    <child link="leg_{name}"/>
    <origin xyz="{x} {y} 0"/>
    <axis xyz="0 1 0"/>
    <limit effort="{EFFORT}" velocity="{RATE}"/>
  </joint>
"""


def main() -> None:
    """Write the meshes and the URDF."""
    trunk, leg = prism(TRUNK, TRUNK_WIDTH), prism(c_section(), LEG_WIDTH)
    write_stl(HERE / "meshes" / "trunk.stl", trunk)
    write_stl(HERE / "meshes" / "leg.stl", leg)
    parts = [link("trunk", "trunk", TRUNK_MASS, trunk)]
    parts += [link(f"leg_{name}", "leg", LEG_MASS, leg) + hip(name, place) for name, place in HIPS.items()]
    head = '<?xml version="1.0"?>\n<!-- Written by make_hexapod.py. -->\n<robot name="hexapod">\n'
    text = head + "".join(parts) + "</robot>\n"
    (HERE / "hexapod.urdf").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
