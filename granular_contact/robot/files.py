"""Find mesh files of a robot file. Nothing is fetched; `package://NAME/` is looked up in the folders above the file.

A package is a folder with its name, or a folder with a `package.xml` of its name. If there is none, the rest of the
path is looked up in each folder above the robot file.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from pathlib import Path

from granular_contact.errors import short

_URL = re.compile(r"([A-Za-z][A-Za-z0-9+.-]+)://(.*)")
_PACKAGES = ("package", "model")


def find(name: str, robot: Path, packages: Mapping[str, Path] | None = None) -> Path | str:
    """Path of the file `name` of a robot file at `robot`, or a sentence that says why there is none.

    packages: folders of packages by name, which come before others.
    """
    posix = name.replace("\\", "/")
    url = _URL.fullmatch(posix)
    if url is None or url[1] == "file":
        path = robot.parent / (posix if url is None else url[2])
        return path if is_file(path) else f"got {short(name, 80)!r}, but there is no file {path.resolve()}"
    if url[1] not in _PACKAGES:
        return f"got {short(name, 80)!r}; allowed are paths and package://, nothing is fetched"
    package, _, rest = url[2].partition("/")
    tried = []
    folders = _folders(package, robot.resolve(), packages or {})
    for folder in (*folders, *([] if folders else robot.resolve().parents)):  # a package may be in a renamed folder
        if is_file(folder / rest):
            return folder / rest
        tried += [str(folder / rest)] if folder in folders else []
    if tried:
        return f"got {short(name, 80)!r}, but there is no file {' or '.join(tried[:3])}"
    above = robot.resolve().parent
    missing = f"neither a folder {package}, nor a package.xml of this name, nor {rest[:80]}"
    where = f"in {above} or the {len(above.parents)} folders above it"
    return f"got {short(name, 80)!r}, but there is {missing} {where}; give its place, as packages: {{{package}: PATH}}"


def _folders(package: str, robot: Path, packages: Mapping[str, Path]) -> list[Path]:
    """Folders that may be the package, the most likely one first."""
    folders = [packages[package]] if package in packages else []
    for above in robot.parents:
        if above.name == package or _package_name(above / "package.xml") == package:
            folders.append(above)
        if _exists(above / package, Path.is_dir):
            folders.append(above / package)
    return list(dict.fromkeys(folders))


def _package_name(path: Path) -> str | None:
    """Name in a `package.xml` of ROS; None without a file or a name."""
    try:
        with path.open(encoding="utf-8", errors="replace") as file:
            match = re.search(r"<name>\s*([^<\s]+)\s*</name>", file.read(20_000))
    except OSError:
        return None
    return match[1] if match else None


def is_file(path: Path) -> bool:
    """Whether a path is a file; no if the system does not allow the name, for example as it is too long."""
    return _exists(path, Path.is_file)


def _exists(path: Path, kind: Callable[[Path], bool]) -> bool:
    try:
        return kind(path)
    except (OSError, ValueError):
        return False
