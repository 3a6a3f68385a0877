"""`check` for a robot file: print a table of its shapes and bodies, its faults and notes; write a mended copy."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from granular_contact.cli.common import complain, print_wide

if TYPE_CHECKING:
    from granular_contact.robot.inspection import InspectedShape, Inspection

SUFFIXES = (".urdf", ".xacro", ".xml", ".sdf")
_HEADS = ("link", "shape", "triangles", "size mm", "closed", "outward", "parts", "inside %", "volume cm3")


def is_robot_file(path: str) -> bool:
    """Whether a file is a robot file, by its suffix."""
    return Path(path).suffix.lower() in SUFFIXES


def check(path: str, shapes: str | None, packages: dict[str, Path], mend: str | None, hull: bool = False) -> bool:
    """Print the faults of a robot file, and write a mended copy if `mend` names a folder; return whether it has none.

    Raises
    ------
    ConfigError
        The file can't be read as XML, or the copy can't be written.
    """
    from granular_contact.robot.inspection import inspect

    inspection = inspect(path, shapes, packages)
    _print_shapes(inspection)
    _print_bodies(inspection)
    for fault in inspection.faults:
        complain(str(fault))
    for note in inspection.notes:
        complain(f"note: {note}")
    if mend is not None:
        _mend(inspection, Path(mend), packages, hull)
    if not inspection.faults:
        count = len(inspection.notes)
        print(f"{path}: ok" + f", with {count} note{'s' * (count != 1)}" * (count > 0))
    return not inspection.faults


def _mend(inspection: Inspection, out: Path, packages: dict[str, Path], hull: bool) -> None:
    """Write the copy, and print what was mended and the faults that the copy still has."""
    from granular_contact.robot.inspection import inspect
    from granular_contact.robot.mending import mend

    mended = mend(inspection, out, packages, hull)
    for change in mended.done:
        print(f"mended: {change}")
    print(f"mended copy: {mended.path}" + ("" if mended.done else f" (it has no {inspection.which} meshes)"))
    for fault in inspect(mended.path, inspection.which, packages).faults:
        complain(f"not mended: {fault}")


def _print_shapes(inspection: Inspection) -> None:
    """Print a table of the shapes."""
    from rich.table import Table
    from rich.text import Text

    if not inspection.shapes:
        return
    table = Table(title=f"{inspection.which} shapes", title_justify="left", box=None, pad_edge=False)
    for head in _HEADS:
        table.add_column(head, justify="left" if head in _HEADS[:2] else "right", overflow="fold")
    for inspected in inspection.shapes:
        table.add_row(*map(Text, _row(inspected)))
    print_wide(table)


def _row(inspected: InspectedShape) -> list[str]:
    """Cells of the row of a shape."""
    from granular_contact.geometry.mesh_quality import sides

    names, mesh = [inspected.shape.link, inspected.name], inspected.quality
    if mesh is None:
        size = " x ".join(f"{1e3 * side:.4g}" for side in inspected.shape.geometry.size)
        return [*names, "-", size or "not read", *"-----"]
    answers = ["yes" if is_good else "no" for is_good in (mesh.closed, mesh.outward)]
    numbers = [str(mesh.parts), f"{100 * mesh.inner:.0f}", f"{1e6 * mesh.volume:.4g}"]
    return [*names, str(mesh.triangles), sides(1e3 * mesh.size), *answers, *numbers]


def _print_bodies(inspection: Inspection) -> None:
    """Print the numbers of links, joints, shapes and triangles, and the mass."""
    robot = inspection.robot
    masses = [link.inertial.mass for link in robot.links.values() if link.inertial is not None]
    kinds = [joint.kind for joint in robot.joints.values()]
    joints = ", ".join(f"{kinds.count(kind)} {kind}" for kind in dict.fromkeys(kinds)) or "none"
    triangles = sum(shape.quality.triangles for shape in inspection.shapes if shape.quality is not None)
    print(f"{robot.name}: {len(robot.links)} links, {len(masses)} with mass, {sum(masses):.4g} kg; joints: {joints}")
    print(f"{len(inspection.shapes)} {inspection.which} shapes, {triangles} triangles of meshes")
