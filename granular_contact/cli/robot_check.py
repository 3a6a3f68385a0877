"""What `check` says of a robot file: a table of its shapes and bodies, its faults and notes, and a mended copy."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from granular_contact.cli.common import complain, print_wide

if TYPE_CHECKING:
    from granular_contact.robot.inspection import InspectedShape, Inspection

SUFFIXES = (".urdf", ".xacro", ".xml", ".sdf")
_HEADS = ("link", "shape", "triangles", "size mm", "closed", "outward", "parts", "inside %", "volume cm3")


def is_robot_file(path: str) -> bool:
    """Whether a file is one of robots, by its name."""
    return Path(path).suffix.lower() in SUFFIXES


def check(path: str, shapes: str | None, packages: dict[str, Path], mend: str | None, hull: bool = False) -> bool:
    """Print what is wrong with a robot file, and write a mended copy if asked; returns whether a run would take it.

    Raises
    ------
    ConfigError
        The file can't be read as XML, or the copy can't be written.
    """
    from granular_contact.robot.inspection import inspect

    found = inspect(path, shapes, packages)
    _print_shapes(found)
    _print_bodies(found)
    for fault in found.faults:
        complain(str(fault))
    for note in found.notes:
        complain(f"note: {note}")
    if mend is not None:
        _mend(found, Path(mend), packages, hull)
    if not found.faults:
        count = len(found.notes)
        print(f"{path}: ok" + f", with {count} note{'s' * (count != 1)}" * (count > 0))
    return not found.faults


def _mend(found: Inspection, out: Path, packages: dict[str, Path], hull: bool) -> None:
    """Write the copy, and say what was mended, and what a run would refuse in it still."""
    from granular_contact.robot.inspection import inspect
    from granular_contact.robot.mending import mend

    mended = mend(found, out, packages, hull)
    for words in mended.done:
        print(f"mended: {words}")
    print(f"mended copy: {mended.path}" + ("" if mended.done else f" (it has no {found.which} meshes)"))
    for fault in inspect(mended.path, found.which, packages).faults:
        complain(f"not mended: {fault}")


def _print_shapes(found: Inspection) -> None:
    from rich.table import Table
    from rich.text import Text

    if not found.shapes:
        return
    table = Table(title=f"{found.which} shapes", title_justify="left", box=None, pad_edge=False)
    for head in _HEADS:
        table.add_column(head, justify="left" if head in _HEADS[:2] else "right", overflow="fold")
    for one in found.shapes:
        table.add_row(*map(Text, _row(one)))
    print_wide(table)


def _row(one: InspectedShape) -> list[str]:
    from granular_contact.geometry.mesh_quality import sides

    named, got = [one.shape.link, one.name], one.quality
    if got is None:
        size = " x ".join(f"{1e3 * side:.4g}" for side in one.shape.geometry.size)
        return [*named, "-", size or "not read", *"-----"]
    words = ["yes" if good else "no" for good in (got.closed, got.outward)]
    numbers = [str(got.parts), f"{100 * got.inner:.0f}", f"{1e6 * got.volume:.4g}"]
    return [*named, str(got.triangles), sides(1e3 * got.size), *words, *numbers]


def _print_bodies(found: Inspection) -> None:
    robot = found.robot
    masses = [link.inertial.mass for link in robot.links.values() if link.inertial is not None]
    kinds = [joint.kind for joint in robot.joints.values()]
    joints = ", ".join(f"{kinds.count(kind)} {kind}" for kind in dict.fromkeys(kinds)) or "none"
    triangles = sum(one.quality.triangles for one in found.shapes if one.quality is not None)
    print(f"{robot.name}: {len(robot.links)} links, {len(masses)} with mass, {sum(masses):.4g} kg; joints: {joints}")
    print(f"{len(found.shapes)} {found.which} shapes, {triangles} triangles of meshes")
