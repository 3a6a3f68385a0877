"""The command `check`: report faults of configs, sweeps, optimisations, fit files and robot files, without a run."""

from __future__ import annotations

import argparse
from collections.abc import Iterable
from pathlib import Path

from granular_contact.cli import robot_check
from granular_contact.cli.common import FAULTY_INPUT, FINE, Refusal, complain, read
from granular_contact.errors import ConfigError, Fault, SceneError

HELP = "check configs, sweeps, searches, fit files and robot files (URDF), with their geometry and data"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("configs", metavar="FILE", nargs="+", help="files to check")
    text = "if loops do not close in the reference configuration, write the nearest home positions (home_deg, home_m) "
    text += "that close them into the file"
    parser.add_argument("--write-homes", action="store_true", help=text)
    robot = parser.add_argument_group("options for a robot file (URDF)")
    robot.add_argument(
        "--shapes", choices=("collision", "visual"), help="shapes to check (collision, if there are any)"
    )
    text = "folder of the package NAME in package://NAME; repeatable. Other packages are searched in the folders above "
    text += "the file"
    robot.add_argument("--package", metavar="NAME=PATH", action="append", default=[], help=text)
    text = "write a copy with closed meshes and physically possible inertias into the folder OUT"
    robot.add_argument("--mend", metavar="OUT", help=text)
    text = "with --mend: use the convex hull of a mesh that can't be mended otherwise; it may be much larger"
    robot.add_argument("--hull", action="store_true", help=text)


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
    """Check one file and print the result; return whether it has no fault."""
    try:
        if robot_check.is_robot_file(path):
            return robot_check.check(path, chosen.shapes, _packages(chosen.package), chosen.mend, chosen.hull)
        _read(path, chosen.write_homes)
    except (ConfigError, SceneError) as error:
        complain(str(error))
        return False
    print(f"{path}: ok")
    return True


def _packages(texts: list[str]) -> dict[str, Path]:
    """Folders of packages by name, from the texts NAME=PATH of --package."""
    pairs = [text.partition("=") for text in texts]
    for name, equals, path in pairs:
        if not (name and equals and path):
            raise Refusal(f"--package {name}{equals}{path}: allowed is NAME=PATH")
    return {name: Path(path) for name, _, path in pairs}


def _read(path: str, write_homes: bool) -> None:
    """Read a config, sweep, optimisation or fit file; raises ConfigError or SceneError with its faults."""
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
    """Write the home positions that close the loops of a config into the files of their joints."""
    from granular_contact import config
    from granular_contact.scene.homes import HomeNote

    homes = {note.key: note.home for note in notes if isinstance(note, HomeNote) and note.home is not None}
    for file in config.write_numbers(config.load(path).sources, homes):
        print(f"{file}: homes written")
