"""The command `check`: faults of configs, sweeps, searches, fit files and robots, without running anything."""

from __future__ import annotations

import argparse
from collections.abc import Iterable
from pathlib import Path

from granular_contact.cli import robot_check
from granular_contact.cli.common import FAULTY_INPUT, FINE, Refusal, complain, read
from granular_contact.errors import ConfigError, Fault, SceneError

HELP = "read configs, sweeps, searches, fit files and robots (URDF), with their geometry and data"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("configs", metavar="FILE", nargs="+", help="one or more of them")
    words = "where loops do not close with the homes of the joints, write the nearest at which they do into the file"
    parser.add_argument("--write-homes", action="store_true", help=words)
    robot = parser.add_argument_group("of a robot file (URDF)")
    robot.add_argument("--shapes", choices=("collision", "visual"), help="shapes to look at (collision, if any)")
    words = "folder of a package that package:// names; repeatable. Else it is looked up above the file"
    robot.add_argument("--package", metavar="NAME=PATH", action="append", default=[], help=words)
    robot.add_argument(
        "--mend", metavar="OUT", help="write a copy with closed meshes and possible inertias into the folder OUT"
    )
    words = "with --mend: take the convex hull of a mesh that nothing else mends, which may be much larger"
    robot.add_argument("--hull", action="store_true", help=words)


def execute(chosen: argparse.Namespace) -> int:
    """Run the command; returns the exit code."""
    robots = [path for path in chosen.configs if robot_check.is_robot_file(path)]
    if chosen.mend is not None and not (robots and len(chosen.configs) == 1):
        raise Refusal(f"--mend {chosen.mend}: allowed with one robot file (URDF)")
    if chosen.hull and chosen.mend is None:
        raise Refusal("--hull: allowed with --mend OUT")
    if (chosen.shapes or chosen.package) and not robots:
        raise Refusal("--shapes and --package: allowed with robot files (URDF)")
    fine = [_is_fine(path, chosen) for path in chosen.configs]
    return FINE if all(fine) else FAULTY_INPUT


def _is_fine(path: str, chosen: argparse.Namespace) -> bool:
    try:
        if robot_check.is_robot_file(path):
            return robot_check.check(path, chosen.shapes, _packages(chosen.package), chosen.mend, chosen.hull)
        _read(path, chosen.write_homes)
    except (ConfigError, SceneError) as error:
        complain(str(error))
        return False
    print(f"{path}: ok")
    return True


def _packages(given: list[str]) -> dict[str, Path]:
    pairs = [one.partition("=") for one in given]
    for name, equals, path in pairs:
        if not (name and equals and path):
            raise Refusal(f"--package {name}{equals}{path}: allowed is NAME=PATH")
    return {name: Path(path) for name, _, path in pairs}


def _read(path: str, write_homes: bool) -> None:
    from granular_contact import config, scene

    if config.is_sweep(path):
        config.load_sweep(path, probe=scene.build)
    elif config.is_optimise(path):
        config.load_optimise(path, probe=scene.build)
    elif config.is_fit(path):
        from granular_contact.studies.fit import load_specification, prepare

        prepare(load_specification(path))
    else:
        _, built = read(path)
        if write_homes:
            _write_homes(path, built.notes)


def _write_homes(path: str, notes: Iterable[Fault]) -> None:
    from granular_contact import config
    from granular_contact.scene.homes import HomeNote

    homes = {note.key: note.home for note in notes if isinstance(note, HomeNote) and note.home is not None}
    for file in config.write_numbers(config.load(path).sources, homes):
        print(f"{file}: homes written")
