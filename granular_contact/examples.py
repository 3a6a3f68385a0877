"""The models and configs that come with the package, written to a folder for a user to run and change."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

PACKAGE = Path(__file__).parent
FOLDERS = ("models", "configs")
ENDINGS = (".yaml", ".csv", ".txt", ".urdf", ".stl")  # (.txt: licences of data)


def home() -> Path:
    """The folder that holds them; of an editable install its checkout.

    Raises
    ------
    FileNotFoundError
        The package was installed without them.
    """
    found = next((place for place in (PACKAGE, PACKAGE.parent) if (place / FOLDERS[0]).is_dir()), None)
    if found is None:
        raise FileNotFoundError(f"no models in {PACKAGE}: this installation is incomplete")
    return found


def config(name: str) -> Path | None:
    """The shipped config of a name, as `runner` or `runner.yaml`; None if there is none."""
    folder = home() / FOLDERS[1]
    path = folder / (name if name.endswith(".yaml") else f"{name}.yaml")
    return path if path.parent == folder and path.is_file() else None


def named(path: Path, folder: Path | None = None) -> Path:
    """The file of a path, from a folder where one is given; else the shipped config of that name, if there is one."""
    file = path if folder is None else folder / path
    if file.exists() or path.name != str(path):
        return file
    return config(path.name) or file


def config_names() -> list[str]:
    """Names of the shipped configs."""
    return sorted(path.stem for path in (home() / FOLDERS[1]).glob("*.yaml"))


def shipped() -> dict[str, bytes]:
    """Contents of all files by their relative path, `configs/pendulum.yaml` for example; errors as of `home`."""
    top = home()
    files = [path for folder in FOLDERS for path in sorted((top / folder).rglob("*")) if path.suffix in ENDINGS]
    return {path.relative_to(top).as_posix(): path.read_bytes() for path in files}


def write(directory: Path, further: Mapping[str, bytes] | None = None) -> list[str]:
    """Write all files below `directory`, and return their relative paths.

    further: contents of other files by their relative path.

    Raises
    ------
    FileExistsError
        Files of these names with another content are there; the message names them, and nothing was written.
    OSError
        As the disk has it.
    """
    files = {**shipped(), **(further or {})}
    other = [name for name, content in files.items() if _differs(directory / name, content)]
    if other:
        rest = f" and {len(other) - 3} more" if len(other) > 3 else ""
        raise FileExistsError(f"{', '.join(other[:3])}{rest} in {directory} would be overwritten: give another folder")
    for name, content in files.items():
        path = directory / name
        path.parent.mkdir(parents=True, exist_ok=True)
        if not path.exists():
            path.write_bytes(content)
    return list(files)


def _differs(path: Path, content: bytes) -> bool:
    return path.exists() and not (path.is_file() and path.read_bytes() == content)
