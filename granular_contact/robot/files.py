"""Where a mesh of a robot file is. Nothing is fetched; `package://NAME/` is looked up in the folders above the file.

A package is a folder of its name, or with a `package.xml` of its name; if there is none, what the file names is looked
for in each of these folders themselves.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from pathlib import Path

from granular_contact.errors import short

_URL = re.compile(r"([A-Za-z][A-Za-z0-9+.-]+)://(.*)")
_PACKAGES = ("package", "model")


def find(name: str, robot: Path, packages: Mapping[str, Path] | None = None) -> Path | str:
    """The file that a robot file at `robot` calls `name`, or a sentence that says why there is none.

    packages: folders of packages by name, which are taken before others.
    """
    given = name.replace("\\", "/")
    url = _URL.fullmatch(given)
    if url is None or url[1] == "file":
        path = robot.parent / (given if url is None else url[2])
        return path if is_file(path) else f"got {short(name, 80)!r}, but there is no file {path.resolve()}"
    if url[1] not in _PACKAGES:
        return f"got {short(name, 80)!r}; allowed are paths and package://, nothing is fetched"
    package, _, rest = url[2].partition("/")
    looked = []
    folders = _folders(package, robot.resolve(), packages or {})
    for folder in (*folders, *([] if folders else robot.resolve().parents)):  # which may have another name than it
        if is_file(folder / rest):
            return folder / rest
        looked += [str(folder / rest)] if folder in folders else []
    if looked:
        return f"got {short(name, 80)!r}, but there is no file {' or '.join(looked[:3])}"
    above = robot.resolve().parent
    lost = f"neither a folder {package}, nor a package.xml of this name, nor {rest[:80]}"
    where = f"in {above} or the {len(above.parents)} folders above it"
    return f"got {short(name, 80)!r}, but there is {lost} {where}; give its place, as packages: {{{package}: PATH}}"


def _folders(package: str, robot: Path, packages: Mapping[str, Path]) -> list[Path]:
    """Folders that may be the package, the likeliest first."""
    found = [packages[package]] if package in packages else []
    for above in robot.parents:
        if above.name == package or _package_name(above / "package.xml") == package:
            found.append(above)
        if _is_there(above / package, Path.is_dir):
            found.append(above / package)
    return list(dict.fromkeys(found))


def _package_name(path: Path) -> str | None:
    """Name in the `package.xml` of ROS; of a file that names itself nothing, None."""
    try:
        with path.open(encoding="utf-8", errors="replace") as file:
            found = re.search(r"<name>\s*([^<\s]+)\s*</name>", file.read(20_000))
    except OSError:
        return None
    return found[1] if found else None


def is_file(path: Path) -> bool:
    """Whether there is such a file; a name too long for the system, or one it can't express, is that of none."""
    return _is_there(path, Path.is_file)


def _is_there(path: Path, kind: Callable[[Path], bool]) -> bool:
    try:
        return kind(path)
    except (OSError, ValueError):
        return False
